# SPDX-License-Identifier: GPL-3.0-or-later
"""A pair of glittering shoes in the sun."""

import numpy as np

from . import images, maps, nodes, stage

RESOLUTION = (540, 540)

LENGTH, WIDTH, HEIGHT = 0.27, 0.085, 0.095  # m, of one shoe
MAP_SIZE = 512
MAP_TILE = 0.08  # metres covered by one repeat of the normal map
WAVELENGTH = 5.0 / MAP_SIZE
RMS_SLOPE = 0.3
SUN_DIRECTION = (-0.45, -0.55, 0.85)


def build():
    """Build the scene in an empty file."""
    stage.reset("shoes", RESOLUTION)
    sky = maps.clear_sky(
        64, SUN_DIRECTION, 0.2, (0, 0, 0), (0.10, 0.20, 0.42), (0.45, 0.52, 0.60), (0.2, 0.18, 0.15)
    )
    nodes.world_environment(images.radiance_image("sky", sky), 0.7)
    sun = stage.light("Sun", "SUN", 4.0, SUN_DIRECTION, (0, 0, 0), 0.0, (1.0, 0.93, 0.82))
    sun.data.angle = np.radians(0.53)

    floor_map = images.color_image("floor_planks", maps.planks(256, 4, (0.52, 0.40, 0.28), 0.02, 9))
    floor = nodes.diffuse_texture("Floor planks", floor_map, (3.0, 3.0))
    corners = [(-1.5, -1.5, 0), (1.5, -1.5, 0), (1.5, 1.5, 0), (-1.5, 1.5, 0)]
    stage.link("Floor", stage.rectangle("Floor", corners, floor))

    slopes = maps.spectral_slopes(maps.gaussian_height(MAP_SIZE, WAVELENGTH, RMS_SLOPE, 23))
    normals = images.normal_image("glitter_normals", maps.normal_map(*slopes), bits=8)
    repeat = (2.2 * WIDTH / MAP_TILE, LENGTH / MAP_TILE)
    glitter = nodes.principled("Glitter", (0.85, 0.16, 0.22), 0.12, 1.0, (normals, repeat))
    shoe = stage.grid("Shoe", shoe_points(64, 96), glitter, wrap_u=True)
    lining = nodes.diffuse("Lining", (0.05, 0.03, 0.03))
    inside = stage.uv_sphere("Opening", 1.0, 32, lining)
    for side, x, y, turn in (("left", -0.062, 0.0, 10.0), ("right", 0.068, 0.03, -16.0)):
        stage.link(f"Shoe, {side}", shoe, None, (x, y, 0.0), (0.0, 0.0, turn))
        c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
        place = (x - 0.062 * s, y + 0.062 * c, 0.060)
        opening = stage.link(f"Opening, {side}", inside, None, place, (0.0, 0.0, turn))
        opening.scale = (0.026, 0.056, 0.02)
    stage.camera((0.14, -0.52, 0.40), (0.003, 0.0, 0.03), 62.0)


def shoe_points(rows, columns):
    """Points (rows, columns, 3) of a closed slipper around the y axis, the toe at -y."""
    t = np.linspace(0.0, 1.0, rows)[:, None]  # from the toe to the heel
    angle = 2.0 * np.pi * np.arange(columns)[None, :] / columns
    bulge = np.sqrt(np.clip(np.sin(np.pi * np.clip(t, 1e-3, 1.0 - 1e-3)), 0.0, 1.0))
    width = 0.5 * WIDTH * bulge * (1.0 - 0.22 * np.sin(np.pi * np.clip(2.0 * t - 0.7, 0.0, 1.0)))
    height = HEIGHT * bulge * (0.42 + 0.58 / (1.0 + np.exp(-9.0 * (t - 0.52))))
    x = width * np.cos(angle)
    up = np.sin(angle)
    # Flat below, round above.
    seam = 0.18 * HEIGHT
    above = seam + (height - seam * bulge) * up
    z = np.where(up > 0.0, above, seam * (1.0 - bulge * np.sqrt(np.abs(up))))
    y = np.broadcast_to(LENGTH * (t - 0.5), x.shape)
    return np.stack([x, y, z], axis=-1)
