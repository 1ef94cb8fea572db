# SPDX-License-Identifier: GPL-3.0-or-later
"""Glowing tiles, each of which shows what one node gives, in one picture by Specula and by Cycles.

The picture has one sample in the middle of each pixel, so that there is no noise; where a value
jumps the two renderers' pixels may fall on either side.
"""

from __future__ import annotations

import bpy
import numpy as np
from scenes import add_camera, add_node, surface

TILE = 16  # pixels
FILTER_WIDTH = 0.01  # pixels, the least that Cycles has
TOLERANCE = 2e-3  # of 1 + the value
MOST_JUMPS = 0.05  # share of a tile's pixels


def show(material, socket) -> None:
    """Lets `material` glow by the value of an output socket, negative values included."""
    shown = add_node(material, "ShaderNodeVectorMath", operation="MULTIPLY_ADD")
    shown.inputs[1].default_value, shown.inputs[2].default_value = (0.1,) * 3, (1,) * 3
    material.node_tree.links.new(socket, shown.inputs[0])
    emission = add_node(material, "ShaderNodeEmission", surface(material))
    material.node_tree.links.new(shown.outputs[0], emission.inputs["Color"])


def place(tile, index: int, columns: int) -> None:
    tile.location = (2 * (index % columns), 2 * (index // columns), 0)


def prepare(size: int):
    """The scene, to be path traced by either engine into square pictures of floats."""
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.specula.method = "PT"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0
    scene.cycles.light_sampling_threshold = scene.cycles.blur_glossy = 0
    return scene


def render(engine: str, folder) -> np.ndarray:
    """The picture (H, W, 3), bottom row first."""
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.filepath = str(folder / f"{engine}.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.array(image.pixels[:]).reshape(*reversed(image.size), 4)[..., :3]
    bpy.data.images.remove(image)
    return pixels


def pictures(names: list[str], columns: int, folder) -> dict[str, list[np.ndarray]]:
    """Name of each placed tile -> its picture by Specula and by Cycles, (TILE, TILE, 3) each."""
    rows = -(-len(names) // columns)
    camera = add_camera((columns - 1, rows - 1, 5))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2 * max(columns, rows)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = TILE * columns, TILE * rows
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.specula.samples = scene.cycles.samples = 1
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", FILTER_WIDTH
    images = [render(engine, folder) for engine in ("SPECULA", "CYCLES")]
    found = {}
    for index, name in enumerate(names):
        y, x = (TILE * k for k in divmod(index, columns))
        found[name] = [image[y : y + TILE, x : x + TILE] for image in images]
    return found


def assert_same(ours: np.ndarray, theirs: np.ndarray) -> None:
    slope = np.abs(np.gradient(theirs, axis=(0, 1))).max(axis=0)  # per pixel
    off = np.abs(ours - theirs) > TOLERANCE * (1 + np.abs(theirs)) + 2 * FILTER_WIDTH * slope
    off = off.any(axis=-1)
    assert off.mean() <= MOST_JUMPS, f"{ours[off][0]} where Cycles has {theirs[off][0]}"
