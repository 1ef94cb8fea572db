# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, in either Blender: exports and commits a grid of a million triangles.

The last argument is a JSON file, the job: `tangents` (whether the material has a normal map),
`threads` and `result` (the JSON file to write).
"""

from __future__ import annotations

import json
import os
import sys

import bpy
import numpy as np

QUADS = 708  # along an edge: 2 * 708^2 = 1,002,528 triangles
WAVES = 12  # along an edge, so that normals and tangents differ everywhere
IMAGE_SIZE = 256  # small: the triangles are measured


def add_grid(material) -> None:
    """A smooth wavy grid of 2 x 2 m with UVs."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=QUADS, y_subdivisions=QUADS)
    mesh = bpy.context.object.data
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    phase = np.pi * WAVES * positions[:, :2]
    positions[:, 2] = 0.02 * np.sin(phase[:, 0]) * np.cos(phase[:, 1])
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    mesh.update()
    mesh.materials.append(material)


def grid_material(tangents: bool):
    """Diffuse, its colour an image; with `tangents` also a normal map in tangent space."""
    material = bpy.data.materials.new("Grid")
    if not material.node_tree:  # always there from 5.0, where use_nodes is deprecated
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])
    color = nodes.new("ShaderNodeTexImage")
    color.image = bpy.data.images.new("Color", IMAGE_SIZE, IMAGE_SIZE)
    links.new(color.outputs["Color"], diffuse.inputs["Color"])
    if tangents:
        slopes = nodes.new("ShaderNodeTexImage")
        slopes.image = bpy.data.images.new("Slopes", IMAGE_SIZE, IMAGE_SIZE, is_data=True)
        slopes.image.generated_color = (0.5, 0.5, 1.0, 1.0)
        normal = nodes.new("ShaderNodeNormalMap")
        links.new(slopes.outputs["Color"], normal.inputs["Color"])
        links.new(normal.outputs["Normal"], diffuse.inputs["Normal"])
    return material


def main(job: dict) -> None:
    from specula import statistics

    bpy.ops.wm.read_factory_settings(use_empty=True)
    add_grid(grid_material(job["tangents"]))
    bpy.ops.object.camera_add(location=(0, 0, 5))
    scene = bpy.context.scene
    scene.camera = bpy.context.object
    scene.render.engine = "SPECULA"
    scene.render.threads_mode, scene.render.threads = "FIXED", job["threads"]
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.specula.samples = 1
    bpy.ops.render.render()
    stats = statistics.last[scene.name, scene.view_layers[0].name]
    report = {
        "blender": bpy.app.version_string,
        "triangles": stats.scene_stats["triangles"],
        "export_seconds": stats.export_seconds,
        "commit_seconds": stats.scene_stats["commit_seconds"],
        "warnings": stats.warnings,
    }
    with open(job["result"], "w") as file:
        json.dump(report, file)


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
    sys.stdout.flush()
    os._exit(0)
