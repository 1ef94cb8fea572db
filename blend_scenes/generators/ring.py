# SPDX-License-Identifier: GPL-3.0-or-later
"""A polished golden ring on a wooden table: the caustic of a circular mirror, a nephroid's half."""

import numpy as np

from . import images, maps, nodes, stage

RESOLUTION = (540, 540)

INNER_RADIUS, OUTER_RADIUS, HEIGHT = 0.080, 0.088, 0.036
EDGE = 0.0035  # metres, radius of the rounded edges
SEGMENTS = 256


def profile():
    """Counter-clockwise cross-section (radius, z): two upright walls joined by rounded edges."""
    points = []
    corners = (
        (OUTER_RADIUS - EDGE, EDGE, -90.0),
        (OUTER_RADIUS - EDGE, HEIGHT - EDGE, 0.0),
        (INNER_RADIUS + EDGE, HEIGHT - EDGE, 90.0),
        (INNER_RADIUS + EDGE, EDGE, 180.0),
    )
    for r, z, start in corners:
        angles = np.radians(start + np.linspace(0.0, 90.0, 9))
        points += [(r + EDGE * np.cos(a), z + EDGE * np.sin(a)) for a in angles]
    return points


def build():
    """Build the scene in an empty file."""
    stage.reset("ring", RESOLUTION)
    nodes.world_color((0.60, 0.68, 0.80), 0.12)

    wood_map = images.color_image("table_wood", maps.planks(512, 6, (0.84, 0.73, 0.60), 0.02, 21))
    wood = nodes.diffuse_texture("Table wood", wood_map, (3.0, 3.0))
    corners = [(-0.9, -0.9, 0), (0.9, -0.9, 0), (0.9, 0.9, 0), (-0.9, 0.9, 0)]
    stage.link("Table", stage.rectangle("Table", corners, wood), "RECEIVER")

    gold = nodes.glossy("Polished gold", (1.0, 0.76, 0.40), 0.0)
    ring = stage.lathe("Ring", profile(), SEGMENTS, gold)
    stage.link("Ring", ring, "CASTER", (0.0, 0.0, 0.0005))

    stage.light("Lamp", "POINT", 30.0, (-0.45, -0.58, 0.33), size=0.006, color=(1.0, 0.93, 0.82))
    stage.camera((0.04, -0.33, 0.36), (0.0, -0.005, 0.005), 58.0)
