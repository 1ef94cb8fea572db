# SPDX-License-Identifier: GPL-3.0-or-later
"""The render tab, and the pass that a 3D view shows."""

import bpy

from .. import diagnosis, statistics
from .panel import ENGINE, SpeculaPanel, draw_ignored, draw_overrides, draw_row

# Of the scene's light paths in Cycles.
IGNORED = (
    "sample_clamp_direct",
    "sample_clamp_indirect",
    "blur_glossy",
    "light_sampling_threshold",
    "use_fast_gi",
)


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
)
