# SPDX-License-Identifier: GPL-3.0-or-later
"""The render passes: who asks for which, and the way from the film to Blender's render result.

What a pass is called and which channels it has, the core tells.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from . import cryptomatte, native
from .abi import Crypto, CustomPass, Pass
from .export import compat

# Pass -> the switch that asks for it: of a view layer, of Cycles' settings of one, or of ours.
SWITCHES = {
    Pass.COMBINED: "",
    Pass.DEPTH: "use_pass_z",
    Pass.MIST: "use_pass_mist",
    Pass.POSITION: "use_pass_position",
    Pass.NORMAL: "use_pass_normal",
    Pass.UV: "use_pass_uv",
    Pass.OBJECT_INDEX: "use_pass_object_index",
    Pass.MATERIAL_INDEX: "use_pass_material_index",
    Pass.SAMPLE_COUNT: "cycles.pass_debug_sample_count",
    Pass.DENOISING_NORMAL: "cycles.denoising_store_passes",
    Pass.DENOISING_ALBEDO: "cycles.denoising_store_passes",
    Pass.DENOISING_DEPTH: "cycles.denoising_store_passes",
    Pass.DIFFUSE_DIRECT: "use_pass_diffuse_direct",
    Pass.DIFFUSE_INDIRECT: "use_pass_diffuse_indirect",
    Pass.DIFFUSE_COLOR: "use_pass_diffuse_color",
    Pass.GLOSSY_DIRECT: "use_pass_glossy_direct",
    Pass.GLOSSY_INDIRECT: "use_pass_glossy_indirect",
    Pass.GLOSSY_COLOR: "use_pass_glossy_color",
    Pass.TRANSMISSION_DIRECT: "use_pass_transmission_direct",
    Pass.TRANSMISSION_INDIRECT: "use_pass_transmission_indirect",
    Pass.TRANSMISSION_COLOR: "use_pass_transmission_color",
    Pass.EMISSION: "use_pass_emit",
    Pass.ENVIRONMENT: "use_pass_environment",
    Pass.CAUSTICS: "specula.use_pass_caustics",
    Pass.WALK_SUCCESS: "specula.use_pass_walks",
    Pass.WALK_TRIALS: "specula.use_pass_walks",
}

# Switches of passes that Cycles has and Specula has not, with their names.
MISSING = {
    "use_pass_vector": "Vector",
    "use_pass_ambient_occlusion": "Ambient Occlusion",
    "use_pass_shadow": "Shadow",
    "use_pass_subsurface_direct": "Subsurface Direct",
    "use_pass_subsurface_indirect": "Subsurface Indirect",
    "use_pass_subsurface_color": "Subsurface Color",
    "cycles.use_pass_shadow_catcher": "Shadow Catcher",
    "cycles.use_pass_volume_direct": "Volume Direct",
    "cycles.use_pass_volume_indirect": "Volume Indirect",
    "cycles.use_pass_volume_scatter": "Volume Scatter",
    "cycles.use_pass_volume_transmit": "Volume Transmit",
    "cycles.use_pass_volume_majorant": "Volume Majorant",
    "cycles.pass_render_time": "Render Time",
}

# Light groups and AOVs: a letter for each channel.
_CUSTOM_CHANNELS = {
    CustomPass.LIGHT_GROUP: "RGB",
    CustomPass.COLOR_AOV: "RGBA",
    CustomPass.VALUE_AOV: "X",
}

GUIDES = (Pass.DENOISING_ALBEDO, Pass.DENOISING_NORMAL)  # of the denoiser
NOISY = "Noisy Image"  # the picture before it is denoised

# Colours that exposure leaves as they are.
UNEXPOSED = {
    Pass.DIFFUSE_COLOR,
    Pass.GLOSSY_COLOR,
    Pass.TRANSMISSION_COLOR,
    Pass.DENOISING_ALBEDO,
}


@dataclass(frozen=True)
class RenderPass:
    """A pass of a view layer's result."""

    name: str  # in Blender
    channels: str  # one letter each
    # Of the core: its number, or a kind and a level of Cryptomatte.
    source: int | tuple[Crypto, int]
    read: Callable  # (session, width, height) -> (H * W, channels) float32
    is_light: bool = False  # scaled by the film's exposure

    @property
    def type(self) -> str:
        """As Blender's register_pass names it."""
        if len(self.channels) == 1:
            return "VALUE"
        return "COLOR" if self.channels.upper().startswith("RGB") else "VECTOR"


def is_on(view_layer, switch: str) -> bool:
    """Whether a switch such as "use_pass_z" or "cycles.pass_render_time" of a view layer is on."""
    owner, _, name = switch.rpartition(".")
    if owner == "cycles":
        return bool(compat.cycles_value(view_layer, name, False))
    return bool(getattr(getattr(view_layer, owner) if owner else view_layer, name, False))


def sources(view_layer) -> list[Pass]:
    """The core's passes that a view layer delivers, Combined first."""
    return [
        source for source, switch in SWITCHES.items() if not switch or is_on(view_layer, switch)
    ]


def mask(bits: Iterable[int]) -> int:
    """For spc_render_settings.passes, or crypto_kinds."""
    return sum(1 << bit for bit in bits)


def enabled(scene, view_layer) -> list[RenderPass]:
    """The passes that a view layer delivers, Combined first."""
    rows = [_of_core(source) for source in sources(view_layer)] + _custom(view_layer)
    for kind in cryptomatte.kinds(view_layer):
        for level in range(cryptomatte.ranks(view_layer) // 2):
            name = f"{cryptomatte.PASS_NAMES[kind]}{level:02}"
            rows.append(RenderPass(name, "rgba", (kind, level), reader((kind, level))))
    if wants_denoising(scene, view_layer):
        rows.append(replace(rows[0], name=NOISY))
    return rows


def names(view_layer) -> dict[CustomPass, list[str]]:
    """Of the light groups and AOVs of a view layer, in the order of their passes."""
    aovs = [aov for aov in view_layer.aovs if aov.is_valid]
    return {
        CustomPass.LIGHT_GROUP: [group.name for group in view_layer.lightgroups],
        CustomPass.COLOR_AOV: [aov.name for aov in aovs if aov.type == "COLOR"],
        CustomPass.VALUE_AOV: [aov.name for aov in aovs if aov.type == "VALUE"],
    }


def lines(of: list[str]) -> bytes | None:
    """Names for spc_render_settings."""
    return "\n".join(of).encode() or None


def _custom(view_layer) -> list[RenderPass]:
    """The passes of light groups and AOVs, named as in Cycles."""
    rows = []
    for first, channels in _CUSTOM_CHANNELS.items():
        is_light = first == CustomPass.LIGHT_GROUP
        for index, name in enumerate(names(view_layer)[first]):
            called = f"Combined_{name}" if is_light else name
            source = int(first) + index
            rows.append(RenderPass(called, channels, source, reader(source), is_light))
    return rows


def wants_denoising(scene, view_layer) -> bool:
    """Whether Cycles' settings ask for it, those of the scene and those of the view layer."""
    return bool(
        compat.cycles_value(scene, "use_denoising", False)
        and compat.cycles_value(view_layer, "use_denoising", True)
    )


def _of_core(source: Pass) -> RenderPass:
    channels, name = native.passes()[source]
    return RenderPass(
        compat.pass_name(name),
        channels,
        source,
        reader(source),
        is_light=channels.startswith("RGB") and source not in UNEXPOSED,
    )


def reader(source: int | tuple[Crypto, int]) -> Callable:
    """For RenderPass.read."""

    def read(session, width: int, height: int):
        pixels = session.read(source, width, height)
        if source == Pass.SAMPLE_COUNT:
            pixels /= session.samples  # as in Cycles: a share of all samples
        return pixels

    return read


def warn_of_missing(view_layer, log) -> None:
    """Tells which passes a view layer asks for in vain."""
    for switch, name in MISSING.items():
        if is_on(view_layer, switch):
            log.warn(
                f"view layer {view_layer.name}", f"pass {name} is not supported, it is left out"
            )


def register_passes(engine, scene, view_layer) -> None:
    """Tells Blender, for the compositor and the file's layers, which passes will come."""
    for row in enabled(scene, view_layer):
        engine.register_pass(scene, view_layer, row.name, len(row.channels), row.channels, row.type)


def write(session, result_layer, rows: list[RenderPass], size: tuple[int, int], exposure: float):
    """Copies passes of `session` as they stand into a layer of a render result.

    `size` is the crop's width and height. With several views each gets the same picture.
    """
    for row in rows:
        targets = [target for target in result_layer.passes if target.name == row.name]
        if not targets:
            continue
        pixels = row.read(session, *size)
        if row.is_light:
            pixels[:, :3] *= exposure
        for target in targets:
            compat.write_rect(target, pixels)
