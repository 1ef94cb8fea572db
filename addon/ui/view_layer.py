# SPDX-License-Identifier: GPL-3.0-or-later
"""The view layer tab: passes."""

import bpy
from bl_ui import properties_view_layer

from .panel import SpeculaPanel


class PassesPanel(SpeculaPanel):
    """A part of the passes: columns of switches, each with its label or "" for Blender's own."""

    bl_context = "view_layer"
    SWITCHES: tuple[tuple[tuple[str, str], ...], ...] = ()

    def draw(self, context):
        column = self.column()
        for heading in self.SWITCHES:
            part = column.column(align=True)
            for switch, label in heading:
                owner, _, name = switch.rpartition(".")
                layer = context.view_layer
                data = getattr(layer, owner, None) if owner else layer
                if data is not None:
                    part.prop(data, name, **({"text": label} if label else {}))


class SPECULA_PT_passes(PassesPanel, bpy.types.Panel):
    bl_label = "Passes"
    SWITCHES = ((("specula.use_pass_caustics", ""), ("specula.use_pass_walks", "")),)


class SPECULA_PT_passes_data(PassesPanel, bpy.types.Panel):
    bl_parent_id = "SPECULA_PT_passes"
    bl_label = "Data"
    SWITCHES = (
        (
            ("use_pass_z", "Depth"),
            ("use_pass_mist", ""),
            ("use_pass_position", ""),
            ("use_pass_normal", ""),
            ("use_pass_uv", ""),
        ),
        (("use_pass_object_index", ""), ("use_pass_material_index", "")),
        (
            ("cycles.denoising_store_passes", "Denoising Data"),
            ("cycles.pass_debug_sample_count", ""),
        ),
    )


class SPECULA_PT_passes_light(PassesPanel, bpy.types.Panel):
    bl_parent_id = "SPECULA_PT_passes"
    bl_label = "Light"
    SWITCHES = (
        *(
            tuple(
                (f"use_pass_{kind}_{part}", f"{kind.capitalize()} {part.capitalize()}")
                for part in ("direct", "indirect", "color")
            )
            for kind in ("diffuse", "glossy", "transmission")
        ),
        (("use_pass_emit", "Emission"), ("use_pass_environment", "")),
    )


class SPECULA_PT_passes_cryptomatte(PassesPanel, bpy.types.Panel):
    bl_label = "Cryptomatte"
    bl_parent_id = "SPECULA_PT_passes"
    SWITCHES = (
        tuple(
            (f"use_pass_cryptomatte_{kind}", kind.capitalize())
            for kind in ("object", "material", "asset")
        ),
        (("pass_cryptomatte_depth", "Levels"),),
    )


def _of_blender(name: str) -> type:
    """What draws a panel of view layers for several engines, by its name until Blender 4.5."""
    return getattr(properties_view_layer, f"{name}Helper", None) or getattr(
        properties_view_layer, name
    )


class SPECULA_PT_passes_aov(SpeculaPanel, _of_blender("ViewLayerAOVPanel"), bpy.types.Panel):
    bl_label = "Shader AOV"
    bl_context = "view_layer"
    bl_parent_id = "SPECULA_PT_passes"


class SPECULA_PT_passes_lightgroups(
    SpeculaPanel, _of_blender("ViewLayerLightgroupsPanel"), bpy.types.Panel
):
    bl_label = "Light Groups"
    bl_context = "view_layer"
    bl_parent_id = "SPECULA_PT_passes"


PANELS = (
    SPECULA_PT_passes,
    SPECULA_PT_passes_data,
    SPECULA_PT_passes_light,
    SPECULA_PT_passes_cryptomatte,
    SPECULA_PT_passes_aov,
    SPECULA_PT_passes_lightgroups,
)
