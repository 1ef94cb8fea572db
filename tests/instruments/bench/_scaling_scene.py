# SPDX-License-Identifier: GPL-3.0-or-later
"""In Blender: the scene of `./dev bench scaling`, as large as a job says.

A wavy mirror hangs over a diffuse floor, which is all that the camera sees. Small lamps between
the two light both. There is no world and no other object.
"""

from __future__ import annotations

import bpy
import numpy as np

from blend_scenes.generators import maps, nodes, stage

MIRROR_SIDE, MIRROR_HEIGHT = 2.0, 2.0  # metres
WAVES = 1.0  # along an edge, so few that a hundred triangles still show them
SLOPE = 0.2  # the largest: the mirror's hollows focus the lamps about on the floor
WAVE_NUMBER = 2.0 * np.pi * WAVES / MIRROR_SIDE  # 1/m
FLOOR_SIDE = 8.0
LAMP_HEIGHT, LAMP_RADIUS = 0.8, 0.01
LAMPS_RADIUS = 0.5  # of the disk in which the lamps are
POWER = 100.0  # watts of all lamps together
GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))


def build(job: dict) -> None:
    """Fills an empty file. Of the job: `size` (pixels), `quads` along the mirror's edge, `pieces`
    (along the edge, into which the mirror is cut), `texels` (along the edge of the normal map of a
    flat mirror, 0: the mirror itself is wavy), `lights`."""
    floor = 0.5 * FLOOR_SIDE * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    diffuse = nodes.diffuse("Floor", (0.7, 0.7, 0.7))
    stage.link("Floor", stage.rectangle("Floor", floor, diffuse), "RECEIVER")
    if job["texels"]:
        hang("Mirror", flat_mirror(job["texels"]))
    else:
        add_wavy_mirror(job["quads"], job["pieces"])
    for i in range(job["lights"]):
        radius = LAMPS_RADIUS * np.sqrt(i / job["lights"])  # a sunflower's seeds
        x, y = radius * np.cos(GOLDEN_ANGLE * i), radius * np.sin(GOLDEN_ANGLE * i)
        power = POWER / job["lights"]
        stage.light(f"Lamp {i}", "POINT", power, (x, y, LAMP_HEIGHT), size=LAMP_RADIUS)
    stage.camera((0.0, -2.2, 1.9), (0.0, 0.0, 0.0), 55.0)


def hang(name: str, mesh) -> None:
    """The mirror's upper side looks down."""
    stage.link(name, mesh, "CASTER", (0.0, 0.0, MIRROR_HEIGHT), (180.0, 0.0, 0.0))


def add_wavy_mirror(quads: int, pieces: int) -> None:
    """Each piece is an object with a mesh of its own; together they are always the same surface."""
    material = nodes.glossy("Mirror", (0.9, 0.9, 0.9), 0.0)
    edge = np.linspace(-0.5 * MIRROR_SIDE, 0.5 * MIRROR_SIDE, quads + 1)
    side = quads // pieces  # in quads
    parts = [edge[i * side : (i + 1) * side + 1] for i in range(pieces)]
    for j, y in enumerate(parts):
        for i, x in enumerate(parts):
            hang(f"Mirror {i} {j}", wavy_grid(x, y, material))


def wavy_grid(x: np.ndarray, y: np.ndarray, material):
    """A smooth mesh over a rectangle's ticks. In bulk: a list of a million faces would be counted
    as memory."""
    wave = np.outer(np.sin(WAVE_NUMBER * y), np.sin(WAVE_NUMBER * x))
    points = np.empty((len(y), len(x), 3), np.float32)
    points[..., 0], points[..., 1] = np.meshgrid(x, y)
    points[..., 2] = SLOPE / WAVE_NUMBER * wave
    index = np.arange(len(y) * len(x), dtype=np.int32).reshape(len(y), len(x))
    lower, upper = index[:-1], index[1:]
    corners = (lower[:, :-1], lower[:, 1:], upper[:, 1:], upper[:, :-1])
    faces = np.stack(corners, axis=-1).reshape(-1, 4)
    mesh = bpy.data.meshes.new("Mirror")
    mesh.vertices.add(index.size)
    mesh.vertices.foreach_set("co", points.ravel())
    mesh.loops.add(faces.size)
    mesh.loops.foreach_set("vertex_index", faces.ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, faces.size, 4, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    mesh.update(calc_edges=True)
    mesh.materials.append(material)
    return mesh


def flat_mirror(texels: int):
    """A quad that a normal map makes wavy."""
    material, graph = nodes.material("Mirror")
    normal = graph.normal_map(wavy_map(texels), graph.uv())
    sockets = {"Color": nodes.rgba((0.9, 0.9, 0.9)), "Roughness": 0.0, "Normal": normal}
    graph.finish(graph.add("ShaderNodeBsdfGlossy", sockets, distribution="GGX"))
    h = 0.5 * MIRROR_SIDE
    return stage.rectangle("Mirror", [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], material)


def wavy_map(texels: int):
    """A float image of the wavy mirror's normals: the same waves, the finer the more texels."""
    centres = ((np.arange(texels) + 0.5) / texels - 0.5).astype(np.float32) * MIRROR_SIDE
    sine, cosine = np.sin(WAVE_NUMBER * centres), np.cos(WAVE_NUMBER * centres)
    rgba = np.ones((texels, texels, 4), np.float32)
    rgba[..., :3] = maps.normal_map(SLOPE * np.outer(sine, cosine), SLOPE * np.outer(cosine, sine))
    image = bpy.data.images.new("Waves", texels, texels, float_buffer=True, is_data=True)
    image.pixels.foreach_set(rgba.ravel())
    return image
