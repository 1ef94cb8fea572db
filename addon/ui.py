# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: Specula's own, and Blender's that make sense for it."""

import sys

import bpy
from bl_ui import properties_view_layer

from . import diagnosis, statistics
from .abi import CausticsSearch

ENGINE = "SPECULA"
LABEL_SHARE = 0.4  # of a panel's width, as Blender splits properties

# Objects that have, or are turned into, a mesh.
SURFACE_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}

# (casts, receives) and who searches -> what a panel says.
PARTS = {
    (False, False): "No part in caustics",
    (False, True): "Shows caustics, casts none",
    (True, False): "Casts caustics, shows none",
    (True, True): "Casts and shows caustics",
}

SEARCHES = {
    CausticsSearch.LIGHT_PATHS: "by light paths alone",
    CausticsSearch.MANIFOLD: "by manifold and light paths",
    CausticsSearch.MANIFOLD_IF_COARSE: "by light paths, the manifold too if its map is coarse",
}

# Blender's panels for BLENDER_RENDER are shown, but not those for what Specula does not have.
EXCLUDED_PANELS = {
    "DATA_PT_light",  # replaced by SPECULA_PT_light
    "DATA_PT_spot",
    "DATA_PT_falloff_curve",
    "DATA_PT_area",
    "OBJECT_PT_visibility",  # replaced by SPECULA_PT_visibility
    "RENDER_PT_freestyle",
    "RENDER_PT_gpencil",
    "RENDER_PT_simplify",  # replaced by SPECULA_PT_simplify, which stands where it does with Cycles
    "RENDER_PT_simplify_viewport",
    "RENDER_PT_simplify_render",
    "RENDER_PT_simplify_greasepencil",
    "RENDER_PT_stereoscopy",
    "VIEWLAYER_PT_filter",
    "VIEWLAYER_PT_layer_passes",  # replaced by SPECULA_PT_passes
}

# Of the scene's light paths in Cycles.
IGNORED = (
    "sample_clamp_direct",
    "sample_clamp_indirect",
    "blur_glossy",
    "light_sampling_threshold",
    "use_fast_gi",
)

# EEVEE's panels that only show slots, node trees and previews.
BORROWED_PANELS = (
    "MATERIAL_PT_preview",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
)


def shared_panels() -> list[type]:
    """Blender's panels that Specula uses too.

    Some have a copy for the sidebar of node editors, named NODE_..., with which they share their
    set of engines.
    """
    panels = [
        panel
        for panel in bpy.types.Panel.__subclasses__()
        if "BLENDER_RENDER" in getattr(panel, "COMPAT_ENGINES", ())
        and panel.__name__.removeprefix("NODE_") not in EXCLUDED_PANELS
    ]
    borrowed = (getattr(bpy.types, name, None) for name in BORROWED_PANELS)
    return panels + [panel for panel in borrowed if panel]


class SpeculaPanel:
    """Base of the panels; subclasses say in which tab they are by `bl_context`."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context) -> bool:
        return context.engine in cls.COMPAT_ENGINES

    def column(self):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        return layout.column()


def draw_note(column, text: str, icon: str = "NONE") -> None:
    """Greyed text, in line with the values of properties."""
    row = column.split(factor=LABEL_SHARE)
    row.active = False
    row.label()
    row.label(text=text, icon=icon)


def draw_row(box, label: str, value: str = "", icon: str = "NONE") -> None:
    """A line for each part of `value`: a panel is narrow, and cuts long lines in the middle."""
    row = box.split(factor=LABEL_SHARE)
    row.label(text=label, icon=icon)
    column = row.column(align=True)
    for part in value.split(", "):
        column.label(text=part)


def draw_overrides(column, scene, names: tuple[str, ...]) -> None:
    """Settings that override Cycles', and below those that do not what holds instead."""
    problem = diagnosis.installation_problem()
    for name in names:
        column.prop(scene.specula, name)
        if problem:  # NumPy may be missing, which the export needs
            continue
        from .export.settings import inherited_text, is_inherited

        if is_inherited(scene, name):
            draw_note(column, inherited_text(scene, name))


def draw_ignored(column, owner, names: tuple[str, ...]) -> None:
    """Those of Cycles' settings of `owner` that are set and do nothing here."""
    for name in names:
        if getattr(owner, name, None):
            draw_note(column, f"{owner.bl_rna.properties[name].name}: no effect", icon="INFO")


def draw_forecast(column, ask) -> None:
    """The part in caustics; `ask` gets the module `forecast` and returns what it says."""
    try:
        from . import forecast  # not above: NumPy may be missing

        found = ask(forecast)
    except Exception as error:
        column.label(text=diagnosis.describe(error), icon="ERROR")
        return
    column.label(text=PARTS[found.casts, found.receives], icon="INFO")
    for text in (found.reason, SEARCHES.get(found.search)):
        for line in text.split(", ") if text else ():
            draw_note(column, line)


def draw_live_report(column, context) -> None:
    """What a rendered viewport has found of the active object, if one shows it."""
    viewport = sys.modules.get(f"{__package__}.viewport")  # loaded by the first of them
    lines = viewport.live_report(context.scene, context.object.name) if viewport else []
    if lines:
        column.label(text="In the viewport", icon="SHADING_RENDERED")
    for line in lines:
        for part in line.split(", "):
            draw_note(column, part)


class SPECULA_PT_sampling(SpeculaPanel, bpy.types.Panel):
    bl_label = "Sampling"
    bl_context = "render"

    def draw(self, context):
        scene, column = context.scene, self.column()
        problem = diagnosis.installation_problem()
        if problem:
            column.label(text=problem, icon="ERROR")
        draw_overrides(column, scene, ("samples", "time_limit", "seed"))
        column.prop(scene.specula, "viewport_samples")
        column.separator()
        column.prop(scene.specula, "method")
        if scene.specula.method == "SMS_BIASED":
            column.prop(scene.specula, "set_size")
        if scene.specula.method not in ("PT", "LT"):
            column.prop(scene.specula, "light_tracing")


class SPECULA_PT_advanced(SpeculaPanel, bpy.types.Panel):
    bl_label = "Advanced"
    bl_context = "render"
    bl_parent_id = "SPECULA_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context) -> bool:
        without_walks = ("AUTO", "PT", "LT", "SHEETS", "MNEE", "MNEE_BIASED")
        return super().poll(context) and context.scene.specula.method not in without_walks

    def draw(self, context):
        column = self.column()
        column.prop(context.scene.specula, "constraint")
        column.prop(context.scene.specula, "two_stage")
        column.prop(context.scene.specula, "chain_family")


class SPECULA_PT_glints(SpeculaPanel, bpy.types.Panel):
    bl_label = "Glints"
    bl_context = "render"
    bl_parent_id = "SPECULA_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column, settings = self.column(), context.scene.specula
        column.prop(settings, "glint_method")
        if settings.glint_method == "WALKS_BIASED":
            column.prop(settings, "set_size")


class SPECULA_PT_adaptive(SpeculaPanel, bpy.types.Panel):
    bl_label = "Noise Threshold"
    bl_context = "render"
    bl_parent_id = "SPECULA_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context) -> bool:
        return super().poll(context) and hasattr(context.scene, "cycles")

    def draw_header(self, context):
        self.layout.prop(context.scene.cycles, "use_adaptive_sampling", text="")

    def draw(self, context):
        column, cycles = self.column(), context.scene.cycles
        column.active = cycles.use_adaptive_sampling
        column.prop(cycles, "adaptive_threshold", text="Noise Threshold")
        column.prop(cycles, "adaptive_min_samples", text="Min Samples")


class SPECULA_PT_light_paths(SpeculaPanel, bpy.types.Panel):
    bl_label = "Light Paths"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column = self.column()
        kinds = ("", "diffuse_", "glossy_", "transmission_", "transparent_")
        draw_overrides(column, context.scene, tuple(f"max_{kind}bounces" for kind in kinds))
        cycles = getattr(context.scene, "cycles", None)
        if cycles:
            column.separator()
            column.prop(cycles, "caustics_reflective")
            column.prop(cycles, "caustics_refractive")
            draw_ignored(column, cycles, IGNORED)


class SPECULA_PT_film(SpeculaPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column = self.column()
        column.prop(context.scene.render, "film_transparent")
        cycles = getattr(context.scene, "cycles", None)
        if cycles:
            for name in ("film_exposure", "pixel_filter_type", "filter_width"):
                column.prop(cycles, name)
            column.separator()
            column.prop(cycles, "film_transparent_glass")
            column.prop(cycles, "film_transparent_roughness")


class SPECULA_PT_simplify(SpeculaPanel, bpy.types.Panel):
    bl_label = "Simplify"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column, render = self.column(), context.scene.render
        column.prop(render, "use_simplify")
        column = column.column()
        column.active = render.use_simplify
        column.label(text="Render")
        column.prop(render, "simplify_subdivision_render", text="Max Subdivision")
        column.prop(render, "simplify_child_particles_render", text="Max Child Particles")
        column.label(text="Viewport")
        column.prop(render, "simplify_subdivision", text="Max Subdivision")
        column.prop(render, "simplify_child_particles", text="Max Child Particles")
        column.prop(render, "simplify_volumes", text="Volume Resolution")


class SPECULA_PT_performance(SpeculaPanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        column, render = self.column(), context.scene.render
        column.prop(render, "threads_mode")
        column.prop(render, "threads")
        column.prop(render, "use_persistent_data", text="Persistent Data")
        column.prop(render, "preview_pixel_size", text="Viewport Pixel Size")


class SPECULA_PT_shading(bpy.types.Panel):
    bl_label = "Render Pass"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_parent_id = "VIEW3D_PT_shading"

    @classmethod
    def poll(cls, context) -> bool:
        return context.engine == ENGINE and context.space_data.shading.type == "RENDERED"

    def draw(self, context):
        self.layout.prop(context.space_data.shading.specula, "render_pass", text="")


class DenoisingPanel(SpeculaPanel):
    """Cycles' settings of one use of the denoiser; some Blenders lack some of them."""

    bl_context = "render"
    bl_parent_id = "SPECULA_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}
    SWITCH = ""
    SETTINGS: tuple[str, ...] = ()

    @classmethod
    def poll(cls, context) -> bool:
        return super().poll(context) and hasattr(context.scene, "cycles")

    def draw_header(self, context):
        self.layout.prop(context.scene.cycles, self.SWITCH, text="")

    def draw(self, context):
        column, cycles = self.column(), context.scene.cycles
        column.active = getattr(cycles, self.SWITCH)
        for name in self.SETTINGS:
            if hasattr(cycles, name):
                column.prop(cycles, name)


class SPECULA_PT_denoising(DenoisingPanel, bpy.types.Panel):
    bl_label = "Denoising"
    SWITCH = "use_denoising"
    SETTINGS = ("denoising_input_passes", "denoising_prefilter", "denoising_quality")


class SPECULA_PT_viewport_denoising(DenoisingPanel, bpy.types.Panel):
    bl_label = "Viewport Denoising"
    SWITCH = "use_preview_denoising"
    SETTINGS = (
        "preview_denoising_input_passes",
        "preview_denoising_prefilter",
        "preview_denoising_quality",
        "preview_denoising_start_sample",
    )


class SPECULA_PT_statistics(SpeculaPanel, bpy.types.Panel):
    bl_label = "Statistics"
    bl_context = "render"

    def draw(self, context):
        renders = [
            stats for (scene, _), stats in statistics.last.items() if scene == context.scene.name
        ]
        if not renders:
            self.layout.label(text="Nothing rendered yet")
        for stats in renders:
            self.layout.label(text=stats.view_layer, icon="RENDERLAYERS")
            box = self.layout.box().column(align=True)
            for label, value in stats.rows():
                draw_row(box, label, value)
            for line in stats.report:
                draw_row(box, *line.split(": ", 1))
            for line in stats.warnings:
                draw_row(box, *line.split(": ", 1), icon="ERROR")


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


def draw_light_group(column, owner, view_layer) -> None:
    """The group of an object's or a world's light, with a button that makes it."""
    row = column.row(align=True)
    row.use_property_decorate = False
    row.prop_search(
        owner,
        "lightgroup",
        view_layer,
        "lightgroups",
        text="Light Group",
        results_are_suggestions=True,
    )
    add = row.column(align=True)
    known = {group.name for group in view_layer.lightgroups}
    add.enabled = bool(owner.lightgroup) and owner.lightgroup not in known
    add.operator("scene.view_layer_add_lightgroup", icon="ADD", text="").name = owner.lightgroup


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
            from . import forecast  # not above: NumPy may be missing

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


def draw_pause(header, context) -> None:
    """The pause button of a 3D view in rendered mode; Cycles' own setting."""
    cycles = getattr(context.scene, "cycles", None)
    if context.engine != ENGINE or context.space_data.shading.type != "RENDERED" or not cycles:
        return
    icon = "PLAY" if cycles.preview_pause else "PAUSE"
    header.layout.prop(cycles, "preview_pause", icon=icon, text="")


def redraw_properties() -> None:
    """Lets the panels show new statistics; Blender redraws them only where the mouse is."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()


PANELS = (
    SPECULA_PT_sampling,
    SPECULA_PT_adaptive,
    SPECULA_PT_advanced,
    SPECULA_PT_glints,
    SPECULA_PT_denoising,
    SPECULA_PT_viewport_denoising,
    SPECULA_PT_light_paths,
    SPECULA_PT_simplify,
    SPECULA_PT_film,
    SPECULA_PT_performance,
    SPECULA_PT_shading,
    SPECULA_PT_statistics,
    SPECULA_PT_passes,
    SPECULA_PT_passes_data,
    SPECULA_PT_passes_light,
    SPECULA_PT_passes_cryptomatte,
    SPECULA_PT_passes_aov,
    SPECULA_PT_passes_lightgroups,
    SPECULA_PT_object_light_group,
    SPECULA_PT_object_caustics,
    SPECULA_PT_material_caustics,
    SPECULA_PT_material_settings,
    SPECULA_PT_material_glints,
    SPECULA_PT_visibility,
    SPECULA_PT_light,
    SPECULA_PT_light_nodes,
    SPECULA_PT_panorama,
    SPECULA_PT_world_caustics,
    SPECULA_PT_world_light_group,
)


def register() -> None:
    for panel in PANELS:
        bpy.utils.register_class(panel)
    for panel in shared_panels():
        panel.COMPAT_ENGINES.add(ENGINE)
    bpy.types.VIEW3D_HT_header.append(draw_pause)


def unregister() -> None:
    bpy.types.VIEW3D_HT_header.remove(draw_pause)
    for panel in shared_panels():
        panel.COMPAT_ENGINES.discard(ENGINE)
    for panel in reversed(PANELS):
        bpy.utils.unregister_class(panel)
