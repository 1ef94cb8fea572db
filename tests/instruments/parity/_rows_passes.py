# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of passes: each of Cycles' by itself, of one still life."""

from __future__ import annotations

from tests.instruments.parity._nodes import HUES, UV, N, Row

# Name in Blender 5 -> the switch of the view layer, or of Cycles' settings of it.
SWITCHES = {
    "Depth": "use_pass_z",
    "Mist": "use_pass_mist",
    "Position": "use_pass_position",
    "Normal": "use_pass_normal",
    "UV": "use_pass_uv",
    "Vector": "use_pass_vector",
    "Object Index": "use_pass_object_index",
    "Material Index": "use_pass_material_index",
    "Debug Sample Count": "cycles.pass_debug_sample_count",
    "Denoising Albedo": "cycles.denoising_store_passes",
    "Denoising Normal": "cycles.denoising_store_passes",
    "Denoising Depth": "cycles.denoising_store_passes",
    **{
        f"{kind} {part}": f"use_pass_{kind}_{part}".lower()
        for kind in ("Diffuse", "Glossy", "Transmission", "Subsurface")
        for part in ("Direct", "Indirect", "Color")
    },
    "Volume Direct": "cycles.use_pass_volume_direct",
    "Volume Indirect": "cycles.use_pass_volume_indirect",
    "Emission": "use_pass_emit",
    "Environment": "use_pass_environment",
    "Ambient Occlusion": "use_pass_ambient_occlusion",
    "Shadow Catcher": "cycles.use_pass_shadow_catcher",
}


def still_life(stage) -> None:
    """A ball that glows a little, a card of rough metal and a block of frosted glass, on tiles."""
    copper = (0.9, 0.5, 0.3, 1)
    glow = N("Emission", {"Color": HUES, "Strength": 0.3})
    diffuse = N("BsdfDiffuse", {"Color": HUES})
    stage.dress(N("AddShader", {0: glow, 1: diffuse}))
    metal = N("BsdfGlossy", {"Color": copper, "Roughness": 0.5}, distribution="GGX")
    glass = N("BsdfRefraction", {"Color": copper, "Roughness": 0.5, "IOR": 1.3}, distribution="GGX")
    tinted = N("BsdfDiffuse", {"Color": N("TexChecker", {"Vector": UV, "Scale": 4.0})})
    stage.put(stage.card, metal, index=3)
    stage.put(stage.block, glass, index=4)
    stage.put(stage.floor, tinted, index=5)
    stage.mist(4.0, 5.0)


def row(name: str, switch: str) -> Row:
    def build(stage) -> None:
        still_life(stage)
        stage.switch_on(switch)

    return Row(f"pass/{name.lower().replace(' ', '_')}", build, shows=name)


def rows():
    for name, switch in SWITCHES.items():
        yield row(name, switch)
