# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: Specula's own, and Blender's that make sense for it."""

import bpy

from . import data, render, surface, view_layer
from .panel import ENGINE

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

# EEVEE's panels that only show slots, node trees and previews.
BORROWED_PANELS = (
    "MATERIAL_PT_preview",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
)

PANELS = (*render.PANELS, *view_layer.PANELS, *surface.PANELS, *data.PANELS)


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
