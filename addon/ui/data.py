# SPDX-License-Identifier: GPL-3.0-or-later
"""The data tab of lights and cameras, and the world's."""

import bpy

from .panel import SpeculaPanel, draw_light_group, draw_note


class SPECULA_PT_light(SpeculaPanel, bpy.types.Panel):
    bl_label = "Light"
    bl_context = "data"

    # Those that this Blender's light has are shown.
    COMMON = ("use_temperature", "temperature", "color", "energy", "exposure", "normalize")
    PROPERTIES = {
        "POINT": ("shadow_soft_size", "use_soft_falloff"),
        "SPOT": ("shadow_soft_size", "use_soft_falloff", "spot_size", "spot_blend"),
        "SUN": ("angle",),
        "AREA": ("shape", "size", "spread"),
    }
    LABELS = {"shadow_soft_size": "Radius"}

    @classmethod
    def poll(cls, context) -> bool:
        return bool(context.light) and super().poll(context)

    def draw(self, context):
        light = context.light
        self.layout.row().prop(light, "type", expand=True)
        column = self.column()
        for name in (*self.COMMON, *self.PROPERTIES[light.type]):
            if hasattr(light, name):
                column.prop(light, name, text=self.LABELS.get(name))
        if light.type == "AREA" and light.shape in {"RECTANGLE", "ELLIPSE"}:
            column.prop(light, "size_y")
        column.separator()
        cycles = getattr(light, "cycles", None)
        if hasattr(cycles, "cast_shadow"):
            column.prop(cycles, "cast_shadow")
        else:
            column.prop(light, "use_shadow")
        column.prop(light.specula, "caustics")
        if getattr(cycles, "is_portal", False):
            draw_note(column, "A portal gives no light, and is not needed", icon="INFO")
        if cycles:
            column.prop(cycles, "max_bounces")


class SPECULA_PT_light_nodes(SpeculaPanel, bpy.types.Panel):
    bl_label = "Nodes"
    bl_context = "data"

    @classmethod
    def poll(cls, context) -> bool:
        return bool(context.light) and super().poll(context)

    def draw(self, context):
        light, column = context.light, self.column()
        if "use_nodes" in light.bl_rna.properties:
            column.prop(light, "use_nodes")
        output = light.node_tree and light.node_tree.get_output_node("CYCLES")
        if output:
            self.layout.template_node_view(light.node_tree, output, output.inputs["Surface"])


class SPECULA_PT_panorama(SpeculaPanel, bpy.types.Panel):
    bl_label = "Panorama"
    bl_context = "data"

    # Type -> how the names of its properties begin.
    PROPERTIES = {
        "EQUIRECTANGULAR": ("latitude_", "longitude_"),
        "FISHEYE_EQUIDISTANT": ("fisheye_fov",),
        "FISHEYE_EQUISOLID": ("fisheye_lens", "fisheye_fov"),
        "FISHEYE_LENS_POLYNOMIAL": ("fisheye_fov", "fisheye_polynomial_"),
        "CENTRAL_CYLINDRICAL": ("central_cylindrical_",),
    }

    @classmethod
    def poll(cls, context) -> bool:
        camera = context.camera
        return bool(camera) and camera.type == "PANO" and super().poll(context)

    def draw(self, context):
        camera, column = context.camera, self.column()
        owner = camera if hasattr(camera, "panorama_type") else getattr(camera, "cycles", None)
        if owner is None:
            column.label(text="Enable the addon Cycles, which holds the settings", icon="INFO")
            return
        column.prop(owner, "panorama_type")
        of_type = self.PROPERTIES.get(owner.panorama_type, ())
        for name in (prop.identifier for prop in owner.bl_rna.properties):
            if name.startswith(of_type):
                column.prop(owner, name)


class SPECULA_PT_world_caustics(SpeculaPanel, bpy.types.Panel):
    bl_label = "Caustics"
    bl_context = "world"

    @classmethod
    def poll(cls, context) -> bool:
        return bool(context.world) and super().poll(context)

    def draw(self, context):
        self.column().prop(context.world.specula, "caustics")


class SPECULA_PT_world_light_group(SpeculaPanel, bpy.types.Panel):
    bl_label = "Settings"
    bl_context = "world"

    @classmethod
    def poll(cls, context) -> bool:
        return bool(context.world) and super().poll(context)

    def draw(self, context):
        draw_light_group(self.column(), context.world, context.view_layer)


PANELS = (
    SPECULA_PT_light,
    SPECULA_PT_light_nodes,
    SPECULA_PT_panorama,
    SPECULA_PT_world_caustics,
    SPECULA_PT_world_light_group,
)
