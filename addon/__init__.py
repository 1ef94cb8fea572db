# SPDX-License-Identifier: GPL-3.0-or-later
"""Specula, a render engine for caustics by Specular Manifold Sampling."""

# For Blenders before extensions; the same facts as in blender_manifest.toml.
bl_info = {
    "name": "Specula",
    "description": "Render engine for caustics by Specular Manifold Sampling",
    "author": "The Specula contributors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Render Engine",
    "category": "Render",
}


# Blender's own modules are imported by these functions only: what describes and uploads a scene
# works without Blender too.


def register():
    from . import cycles_panels, engine, properties, ui
    from .export import epoch

    for module in (properties, epoch, engine, ui, cycles_panels):
        module.register()


def unregister():
    from . import cycles_panels, engine, properties, ui
    from .export import epoch

    for module in (cycles_panels, ui, engine, epoch, properties):
        module.unregister()
