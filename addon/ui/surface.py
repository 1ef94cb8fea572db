# SPDX-License-Identifier: GPL-3.0-or-later
"""The tabs of an object and of its material."""

import bpy

from .. import diagnosis
from .panel import (
    SURFACE_TYPES,
    SpeculaPanel,
    draw_forecast,
    draw_light_group,
    draw_live_report,
    draw_note,
)


class SPECULA_PT_object_light_group(SpeculaPanel, bpy.types.Panel):
    bl_label = "Shading"
    bl_context = "object"

    @classmethod
    def poll(cls, context) -> bool:
        return super().poll(context) and context.object.type in SURFACE_TYPES | {"LIGHT"}

    def draw(self, context):
        draw_light_group(self.column(), context.object, context.view_layer)


class SPECULA_PT_object_caustics(SpeculaPanel, bpy.types.Panel):
    bl_label = "Caustics"
    bl_context = "object"

    @classmethod
    def poll(cls, context) -> bool:
        return super().poll(context) and context.object.type in SURFACE_TYPES

    def draw(self, context):
        obj, column = context.object, self.column()
        column.prop(obj.specula, "caustics")
        draw_forecast(column, lambda forecast: forecast.of_object(obj))
        draw_live_report(column, context)
        cycles = getattr(obj, "cycles", None)
        if cycles:
            flags = column.column(heading="Cycles")
            flags.active = obj.specula.caustics == "AUTO"
            flags.prop(cycles, "is_caustics_caster")
            flags.prop(cycles, "is_caustics_receiver")


class SPECULA_PT_material_caustics(SpeculaPanel, bpy.types.Panel):
    bl_label = "Caustics"
    bl_context = "material"

    @classmethod
    def poll(cls, context) -> bool:
        return bool(context.material) and super().poll(context)

    def draw(self, context):
        draw_forecast(self.column(), lambda forecast: forecast.of_material(context.material))


class SPECULA_PT_material_settings(SpeculaPanel, bpy.types.Panel):
    bl_label = "Settings"
    bl_context = "material"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context) -> bool:
        return bool(context.material) and super().poll(context)

    def draw(self, context):
        column, material = self.column(), context.material
        column.prop(material, "pass_index")
        owner = material if hasattr(material, "displacement_method") else material.cycles
        column.prop(owner, "displacement_method", text="Displacement")
        cycles = getattr(material, "cycles", None)
        if hasattr(cycles, "use_bump_map_correction"):
            column.prop(cycles, "use_bump_map_correction")
        for owner, name, usual in (
            (material, "use_transparent_shadow", True),
            (cycles, "use_transparent_shadow", True),
            (cycles, "emission_sampling", "AUTO"),
        ):
            if getattr(owner, name, usual) != usual:
                draw_note(column, f"{owner.bl_rna.properties[name].name}: no effect", icon="INFO")


class SPECULA_PT_material_glints(SpeculaPanel, bpy.types.Panel):
    bl_label = "Glints"
    bl_context = "material"

    @classmethod
    def poll(cls, context) -> bool:
        return bool(context.material) and super().poll(context)

    def draw(self, context):
        column, material = self.column(), context.material
        column.prop(material.specula, "glints")
        try:
            from .. import forecast  # not above: NumPy may be missing

            found = forecast.of_material(material)
            why_not = f"None: {found.no_glints}" if found.no_glints else "None"
            draw_note(column, found.glints or why_not)
        except Exception as error:
            column.label(text=diagnosis.describe(error), icon="ERROR")


class SPECULA_PT_visibility(SpeculaPanel, bpy.types.Panel):
    bl_label = "Visibility"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        obj, column = context.object, self.column()
        for name in ("hide_select", "hide_viewport", "hide_render"):
            column.prop(obj, name, invert_checkbox=True, toggle=False)
        column.separator()
        for ray in ("camera", "diffuse", "glossy", "transmission", "shadow"):
            column.prop(obj, f"visible_{ray}")
        column.separator()
        column.prop(obj, "is_holdout")


PANELS = (
    SPECULA_PT_object_light_group,
    SPECULA_PT_object_caustics,
    SPECULA_PT_material_caustics,
    SPECULA_PT_material_settings,
    SPECULA_PT_material_glints,
    SPECULA_PT_visibility,
)
