# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in each panel's place that Cycles has, while Specula is chosen.

An artist finds every setting where Cycles shows it: the panel itself is lent, one of Specula's or
Blender's own has its settings, or a panel of the same name says that it has no effect, and why.
`tests/blender/test_cycles_panels.py` asks each Blender for all of them.
"""

from __future__ import annotations

import bpy

from .ui.panel import ENGINE, SpeculaPanel

# Cycles' own panels, all of whose settings count: copies show for Specula.
LENT = (
    "CYCLES_CAMERA_PT_dof",
    "CYCLES_CAMERA_PT_dof_aperture",
    "CYCLES_LIGHT_PT_preview",
    "CYCLES_MATERIAL_PT_displacement",
    "CYCLES_MATERIAL_PT_volume",
    "CYCLES_RENDER_PT_filter",
    "CYCLES_RENDER_PT_override",
    "CYCLES_WORLD_PT_mist",
    "CYCLES_WORLD_PT_preview",
    "CYCLES_WORLD_PT_ray_visibility",
    "NODE_CYCLES_WORLD_PT_ray_visibility",
    "CYCLES_OBJECT_PT_shading",
    "CYCLES_OBJECT_PT_shading_shadow_terminator",
)
# Blender's own panels that it has for Cycles.
SHARED = ("OBJECT_PT_shadow_terminator", "VIEWLAYER_PT_override")

# Panel of Cycles -> the one that has its settings, as far as they count.
OWN = {
    "CYCLES_RENDER_PT_sampling": "SPECULA_PT_sampling",
    "CYCLES_RENDER_PT_sampling_viewport": "SPECULA_PT_sampling",
    "CYCLES_RENDER_PT_sampling_viewport_denoise": "SPECULA_PT_viewport_denoising",
    "CYCLES_RENDER_PT_sampling_render": "SPECULA_PT_adaptive",
    "CYCLES_RENDER_PT_sampling_render_denoise": "SPECULA_PT_denoising",
    "CYCLES_RENDER_PT_sampling_advanced": "SPECULA_PT_sampling",
    "CYCLES_RENDER_PT_light_paths": "SPECULA_PT_light_paths",
    "CYCLES_RENDER_PT_light_paths_max_bounces": "SPECULA_PT_light_paths",
    "CYCLES_RENDER_PT_light_paths_clamping": "SPECULA_PT_light_paths",
    "CYCLES_RENDER_PT_light_paths_caustics": "SPECULA_PT_light_paths",
    "CYCLES_RENDER_PT_light_paths_fast_gi": "SPECULA_PT_light_paths",
    "CYCLES_RENDER_PT_film": "SPECULA_PT_film",
    "CYCLES_RENDER_PT_film_transparency": "SPECULA_PT_film",
    "CYCLES_RENDER_PT_film_pixel_filter": "SPECULA_PT_film",
    "CYCLES_RENDER_PT_performance": "SPECULA_PT_performance",
    "CYCLES_RENDER_PT_performance_threads": "SPECULA_PT_performance",
    "CYCLES_RENDER_PT_performance_final_render": "SPECULA_PT_performance",
    "CYCLES_RENDER_PT_performance_viewport": "SPECULA_PT_performance",
    "CYCLES_RENDER_PT_passes": "SPECULA_PT_passes",
    "CYCLES_RENDER_PT_passes_data": "SPECULA_PT_passes_data",
    "CYCLES_RENDER_PT_passes_light": "SPECULA_PT_passes_light",
    "CYCLES_RENDER_PT_passes_crypto": "SPECULA_PT_passes_cryptomatte",
    "CYCLES_RENDER_PT_passes_aov": "SPECULA_PT_passes_aov",
    "CYCLES_RENDER_PT_passes_lightgroups": "SPECULA_PT_passes_lightgroups",
    "CYCLES_OBJECT_PT_lightgroup": "SPECULA_PT_object_light_group",
    "CYCLES_WORLD_PT_settings_light_group": "SPECULA_PT_world_light_group",
    "CYCLES_RENDER_PT_simplify": "SPECULA_PT_simplify",
    "CYCLES_RENDER_PT_simplify_viewport": "SPECULA_PT_simplify",
    "CYCLES_RENDER_PT_simplify_render": "SPECULA_PT_simplify",
    "CYCLES_PT_context_material": "EEVEE_MATERIAL_PT_context_material",
    "CYCLES_MATERIAL_PT_preview": "MATERIAL_PT_preview",
    "CYCLES_MATERIAL_PT_surface": "EEVEE_MATERIAL_PT_surface",
    "CYCLES_MATERIAL_PT_settings": "SPECULA_PT_material_settings",
    "NODE_CYCLES_MATERIAL_PT_settings": "SPECULA_PT_material_settings",
    "CYCLES_MATERIAL_PT_settings_surface": "SPECULA_PT_material_settings",
    "NODE_CYCLES_MATERIAL_PT_settings_surface": "SPECULA_PT_material_settings",
    "CYCLES_OBJECT_PT_shading_caustics": "SPECULA_PT_object_caustics",
    "CYCLES_OBJECT_PT_visibility": "SPECULA_PT_visibility",
    "CYCLES_OBJECT_PT_visibility_ray_visibility": "SPECULA_PT_visibility",
    "CYCLES_LIGHT_PT_light": "SPECULA_PT_light",
    "NODE_CYCLES_LIGHT_PT_light": "SPECULA_PT_light",
    "CYCLES_LIGHT_PT_beam_shape": "SPECULA_PT_light",
    "NODE_CYCLES_LIGHT_PT_beam_shape": "SPECULA_PT_light",
    "CYCLES_LIGHT_PT_spot": "SPECULA_PT_light",
    "NODE_CYCLES_LIGHT_PT_spot": "SPECULA_PT_light",
    "CYCLES_LIGHT_PT_settings": "SPECULA_PT_light",
    "NODE_CYCLES_LIGHT_PT_settings": "SPECULA_PT_light",
    "CYCLES_LIGHT_PT_nodes": "SPECULA_PT_light_nodes",
    "CYCLES_WORLD_PT_surface": "EEVEE_WORLD_PT_surface",
    "CYCLES_VIEW3D_PT_shading_render_pass": "SPECULA_PT_shading",
}

_SEARCHED = "Lights are always chosen by a tree; faint ones are not left out"
_CURVES = "Hair and curves are tubes of four sides"
_VOLUMES = "Volumes absorb evenly; there are no steps through them"
_MOTION = "Motion blur is not supported, the frame is still"
_GUIDING = "Paths are not guided; caustics are searched for"
_CULLING = "Objects are not culled"
_BAKING = "Specula cannot bake: choose Cycles for that"
_FAST_GI = "Fast GI is not supported, all light is followed"
_WORLD = "The world's image is sampled at its own resolution"
_VOLUME_OF_WORLD = "Worlds have no volume"
_COMPOSITOR = "Blender's own settings of the compositor hold"

# Panel of Cycles -> why its settings have no effect; a panel of its name says so in its place.
STATED = {
    "CYCLES_RENDER_PT_sampling_path_guiding": _GUIDING,
    "CYCLES_RENDER_PT_sampling_lights": _SEARCHED,
    "CYCLES_RENDER_PT_sampling_advanced_sample_subset": "Parts of a render are chosen otherwise: "
    "see the page on farms",
    "CYCLES_RENDER_PT_subdivision": "Adaptive subdivision is not supported, modifiers' levels hold",
    "CYCLES_RENDER_PT_curves": _CURVES,
    "CYCLES_RENDER_PT_volumes": _VOLUMES,
    "CYCLES_RENDER_PT_motion_blur": _MOTION,
    "CYCLES_RENDER_PT_performance_compositor": _COMPOSITOR,
    "CYCLES_RENDER_PT_performance_memory": "Images are kept whole, and nothing is tiled",
    "CYCLES_RENDER_PT_performance_acceleration_structure": "Embree's trees are always used",
    "CYCLES_RENDER_PT_simplify_culling": _CULLING,
    "CYCLES_RENDER_PT_bake": _BAKING,
    "CYCLES_CAMERA_PT_lens_custom_parameters": "Custom cameras are refused",
    "CYCLES_OBJECT_PT_motion_blur": _MOTION,
    "CYCLES_OBJECT_PT_shading_gi_approximation": _FAST_GI,
    "CYCLES_OBJECT_PT_visibility_culling": _CULLING,
    "CYCLES_MATERIAL_PT_settings_volume": _VOLUMES,
    "CYCLES_WORLD_PT_volume": _VOLUME_OF_WORLD,
    "CYCLES_WORLD_PT_settings": _WORLD,
    "RENDER_PT_stereoscopy": "Stereoscopy is not supported, all views are the same",
}

# Panels of Cycles that nobody looks for while another engine is chosen: they belong to one of those
# above, or are no panels to look at.
WITHOUT_PLACE = {
    "CyclesPresetPanel": "a base class",
    "CYCLES_PT_sampling_presets": "presets, in Cycles' header",
    "CYCLES_PT_viewport_sampling_presets": "presets, in Cycles' header",
    "CYCLES_PT_integrator_presets": "presets, in Cycles' header",
    "CYCLES_PT_performance_presets": "presets, in Cycles' header",
    "CYCLES_RENDER_PT_sampling_path_guiding_debug": "of Path Guiding",
    "CYCLES_RENDER_PT_curves_viewport_display": "of Curves",
    "CYCLES_RENDER_PT_motion_blur_curve": "of Motion Blur",
    "CYCLES_RENDER_PT_performance_compositor_denoise_settings": "of Compositor",
    "CYCLES_RENDER_PT_bake_influence": "of Bake",
    "CYCLES_RENDER_PT_bake_selected_to_active": "of Bake",
    "CYCLES_RENDER_PT_bake_output": "of Bake",
    "CYCLES_RENDER_PT_bake_output_margin": "of Bake",
    "CYCLES_RENDER_PT_debug": "for Cycles' developers",
    "CYCLES_VIEW3D_PT_shading_debug": "for Cycles' developers",
    "CYCLES_VIEW3D_PT_shading_lighting": "lights and world of the scene always hold",
    "CYCLES_PT_post_processing": "RENDER_PT_post_processing, of any engine",
    "CYCLES_VIEW3D_PT_simplify_greasepencil": "grease pencil is not rendered",
    "RENDER_PT_simplify_greasepencil": "grease pencil is not rendered",
    "RENDER_PT_gpencil": "grease pencil is not rendered",
    "RENDER_PT_freestyle": "Freestyle is not supported",
    "RENDER_PT_simplify_viewport": "SPECULA_PT_simplify has them",
    "RENDER_PT_simplify_render": "SPECULA_PT_simplify has them",
    "VIEWLAYER_PT_layer_passes_lightgroups": "SPECULA_PT_passes_lightgroups has them",
    "CYCLES_WORLD_PT_settings_surface": "of Settings",
    "CYCLES_WORLD_PT_settings_volume": "of Settings",
    "NODE_CYCLES_WORLD_PT_settings": "as in the properties",
    "NODE_CYCLES_WORLD_PT_settings_surface": "as in the properties",
    "NODE_CYCLES_WORLD_PT_settings_volume": "as in the properties",
    "NODE_CYCLES_MATERIAL_PT_settings_volume": "as in the properties",
}


class NoEffectPanel(SpeculaPanel):
    """In the place of a panel of Cycles whose settings have no effect."""

    bl_options = {"DEFAULT_CLOSED"}
    CYCLES = ""  # that panel's name

    def draw(self, context):
        column = self.column()
        column.label(text="No effect in Specula", icon="INFO")
        for line in STATED[self.CYCLES].split(", "):
            column.label(text=line)


def find(name: str) -> type | None:
    """Blender's class of a panel, if this Blender has it."""
    return getattr(bpy.types, name, None)


class _AsCycles:
    """A context in which Cycles is chosen: its panels ask for that."""

    engine = "CYCLES"

    def __init__(self, context):
        self._context = context

    def __getattr__(self, name: str):
        return getattr(self._context, name)


def _lent(name: str) -> type | None:
    """A panel of Cycles that shows when that one would, but for the engine."""
    cycles = find(name)
    if cycles is None:
        return None

    def poll(cls, context) -> bool:
        return context.engine == ENGINE and bool(cycles.poll(_AsCycles(context)))

    members = {key: value for key, value in vars(cycles).items() if key not in _OF_A_CLASS}
    members |= {"__module__": __name__, "CYCLES": name}
    members |= {"poll": classmethod(poll), "COMPAT_ENGINES": {ENGINE}}
    if "bl_parent_id" in members:
        members["bl_parent_id"] = _stands_for(members["bl_parent_id"])
    return type(_own_name(name), cycles.__bases__, members)


# What Python and Blender keep in each class by itself.
_OF_A_CLASS = {"__dict__", "__weakref__", "bl_rna", "bl_idname", "is_registered"}


def _stated(name: str) -> type | None:
    """The panel that stands in the place of one whose settings have no effect."""
    cycles = find(name)
    if cycles is None:
        return None
    members = {"bl_label": cycles.bl_label, "bl_context": cycles.bl_context, "CYCLES": name}
    parent = getattr(cycles, "bl_parent_id", "")
    if parent:
        members["bl_parent_id"] = _stands_for(parent)
    return type(_own_name(name), (NoEffectPanel, bpy.types.Panel), members)


def _stands_for(name: str) -> str:
    """The panel that is in the place of another one."""
    if name in OWN:
        return OWN[name]
    return _own_name(name) if name in LENT or name in STATED else name


def _own_name(name: str) -> str:
    owner, _, rest = name.partition("_PT_")
    return f"SPECULA_PT_{owner.lower()}_{rest}"


_registered: list[type] = []


def _shared() -> list[type]:
    return [panel for panel in map(find, SHARED) if panel is not None]


def register() -> None:
    for panel in _shared():
        panel.COMPAT_ENGINES.add(ENGINE)
    for panel in filter(None, (*map(_lent, LENT), *map(_stated, STATED))):
        bpy.utils.register_class(panel)
        _registered.append(panel)


def unregister() -> None:
    while _registered:
        bpy.utils.unregister_class(_registered.pop())
    for panel in _shared():
        panel.COMPAT_ENGINES.discard(ENGINE)
