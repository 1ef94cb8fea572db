# SPDX-License-Identifier: GPL-3.0-or-later
"""Made-up scenes as large as artists' usually are; `./dev bench speed` renders them, too."""

from __future__ import annotations

import bpy
import numpy as np

from tests.instruments.field._scenes_nodes import bump, math, noise, placed, ramp, shaded
from tests.instruments.field._stage import (
    add,
    clear,
    hdri,
    images,
    maps,
    modifier,
    nodes,
    principled,
    room,
    scene,
    stage,
    sun,
    view,
)

INTERIOR_MATERIALS, INTERIOR_IMAGES = 20, 8
LEAVES = 10_000


def layered(number: int):
    """A Principled material of some fifteen nodes: two textures, a ramp, mixes and a bump."""

    def build(graph):
        scale = 2.0 + 0.7 * (number % 7)
        vector = placed(graph, (scale, scale, scale))
        coarse = noise(graph, vector, 1.5, 5.0)
        cells = graph.add(
            "ShaderNodeTexVoronoi", {"Vector": vector, "Scale": 5.0}, feature="F1"
        ).outputs["Distance"]
        wear = math(graph, "MULTIPLY", coarse, cells)
        hue = 0.05 * number
        tint = graph.add("ShaderNodeCombineHSV", {"H": hue, "S": 0.5, "V": 0.6}).outputs[0]
        if number < INTERIOR_IMAGES:
            colors = [(0.9, 0.85, 0.8), (0.6, 0.5, 0.4), (0.4, 0.3, 0.3)]
            picture = maps.tiles(1024, 8, colors, (0.2, 0.2, 0.2), 0.02, 0.3, number)
            uv = placed(graph, (3.0, 3.0, 3.0), "UV")
            tint = graph.add(
                "ShaderNodeMixRGB",
                {
                    "Fac": 0.8,
                    "Color1": tint,
                    "Color2": graph.image(images.color_image(f"tiles {number}", picture), uv),
                },
                blend_type="MULTIPLY",
            ).outputs[0]
        stops = ((0.0, (0.5, 0.45, 0.4, 1.0)), (0.6, (1.0, 1.0, 1.0, 1.0)))
        color = graph.add(
            "ShaderNodeMixRGB",
            {"Fac": wear, "Color1": tint, "Color2": ramp(graph, coarse, stops)},
            blend_type="OVERLAY",
        ).outputs[0]
        return {
            "Base Color": color,
            "Roughness": math(graph, "MULTIPLY_ADD", wear, 0.4, 0.3),
            "Normal": bump(graph, math(graph, "ADD", coarse, wear), 0.2, 0.02),
        }

    return shaded(f"Layered {number}", build)


def smooth_head(name, material, place, size=0.5, levels=3):
    obj = add("monkey", material, True, size=size, location=place)
    obj.name = name
    modifier(obj, "SUBSURF", render_levels=levels)


@scene
def interior_of_many_materials():
    """Twenty materials, eight of them with images, six lamps, a sky behind a glass pane, half a
    million triangles."""
    materials = [layered(i) for i in range(INTERIOR_MATERIALS)]
    hdri(height=512)
    room(6.0, 8.0, 3.0, window=(-1.5, 1.5, 0.8, 2.4), material=materials[0])
    add("plane", materials[1], size=8.0, location=(0.0, 0.0, 0.002))
    pane = add("cube", clear("Pane"), size=1.0, location=(0.0, 4.0, 1.6))
    pane.scale = (3.0, 0.02, 1.6)
    for i in range(6):
        place = (1.8 * (i % 3 - 1), 3.0 * (i // 3) - 1.5, 2.98)
        lamp = stage.light(f"Lamp {i}", "AREA", 25.0, place, size=0.5)
        lamp.rotation_euler = (0.0, 0.0, 0.0)
    for i in range(18):
        x, y = 0.9 * (i % 6 - 2.5), 1.1 * (i // 6) + 0.3
        height = 0.35 + 0.1 * (i % 4)
        stand = add("cube", materials[2 + i], size=0.5, location=(x, y, 0.5 * height))
        stand.scale.z = 2.0 * height
        smooth_head(f"Head {i}", materials[(7 * i) % 18 + 2], (x, y, height + 0.3))
    view((0.0, -3.8, 1.6), (0.0, 1.0, 1.0), 24.0)


@scene
def meadow_of_leaves():
    """Ten thousand instances of a twig whose leaves are cut out by an image, under sun and sky."""
    hdri(height=512)
    sun()
    add("plane", principled("Soil", (0.2, 0.15, 0.1)), size=60.0)
    v, u = np.mgrid[-1.0:1.0:256j, -1.0:1.0:256j]
    alpha = np.abs(u) < 0.7 * np.sqrt(np.clip(1.0 - v**2, 0.0, 1.0)) * (
        0.8 + 0.2 * np.cos(20.0 * v)
    )
    outline = images.color_image("outline", np.repeat(alpha[..., None].astype(float), 3, axis=2))
    material, graph = nodes.material("Leaf")
    green = {"Color": (0.08, 0.35, 0.04, 1.0)}
    body = graph.add("ShaderNodeBsdfDiffuse", green)
    hole = graph.add("ShaderNodeBsdfTransparent")
    sockets = {0: graph.image(outline), 1: hole.outputs[0], 2: body.outputs[0]}
    graph.finish(graph.add("ShaderNodeMixShader", sockets))
    random = np.random.default_rng(4)
    corners = []
    for _ in range(12):
        centre = np.array((0.0, 0.0, 0.3)) + random.uniform(-0.2, 0.2, 3)
        side = random.normal(size=3)
        up = np.cross(side, random.normal(size=3))
        side, up = 0.08 * side / np.linalg.norm(side), 0.12 * up / np.linalg.norm(up)
        corners.append(
            [tuple(centre + a * side + b * up) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        )
    twig = stage.quads("Twig", corners, material)
    places = random.uniform(-8.0, 8.0, (LEAVES, 2))
    turns = random.uniform(0.0, 2.0 * np.pi, LEAVES)
    for i, ((x, y), turn) in enumerate(zip(places, turns, strict=True)):
        twin = bpy.data.objects.new(f"Twig {i}", twig)
        twin.location, twin.rotation_euler.z = (x, y, 0.0), turn
        bpy.context.scene.collection.objects.link(twin)
    view((0.0, -10.0, 3.0), (0.0, 0.0, 0.3), 40.0)
