# SPDX-License-Identifier: GPL-3.0-or-later
"""A kettle of brushed steel in a dark room with a few small, bright lamps."""

import numpy as np

from . import images, maps, nodes, stage

RESOLUTION = (540, 540)

MAP_SIZE = 512
SCRATCH_LENGTH, SCRATCH_WIDTH = 96.0 / MAP_SIZE, 2.5 / MAP_SIZE
RMS_SLOPE = 0.14
REPEAT = (6.0, 4.0)  # of the map, around and along the profile
# Towards each lamp, and its colour.
LAMPS = (
    ((-0.7, -0.8, 0.55), (1.0, 0.80, 0.55)),
    ((-0.2, -1.0, 0.95), (1.0, 0.90, 0.75)),
    ((0.8, -0.7, 0.45), (0.60, 0.78, 1.0)),
    ((0.9, 0.2, 0.60), (1.0, 0.85, 0.65)),
    ((-1.0, 0.3, 0.40), (0.75, 0.85, 1.0)),
)
LAMP_DIAMETER, LAMP_RADIANCE = np.radians(2.0), 900.0


def build():
    """Build the scene in an empty file."""
    stage.reset("kettle", RESOLUTION)
    lamps = [
        (towards, LAMP_DIAMETER, LAMP_RADIANCE * np.asarray(color)) for towards, color in LAMPS
    ]
    room = maps.dark_room(256, ((0.030, 0.026, 0.022), (0.10, 0.11, 0.13)), lamps)
    nodes.world_environment(images.radiance_image("room", room))

    table = nodes.diffuse("Table", (0.20, 0.17, 0.15))
    corners = [(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)]
    stage.link("Table", stage.rectangle("Table", corners, table))

    slopes = maps.spectral_slopes(
        maps.brushed_height(MAP_SIZE, SCRATCH_LENGTH, SCRATCH_WIDTH, RMS_SLOPE, 29)
    )
    normals = images.normal_image("brushed_normals", maps.normal_map(*slopes), bits=8)
    steel = nodes.principled("Brushed steel", (0.72, 0.70, 0.68), 0.18, 1.0, (normals, REPEAT))
    stage.link("Body", stage.lathe("Body", profile(), 96, steel, closed=False))

    black = nodes.principled("Black plastic", (0.02, 0.02, 0.02), 0.5)
    angle = np.radians(np.linspace(-8.0, 188.0, 33))
    handle = [(0.085 * np.cos(a), 0.0, 0.155 + 0.105 * np.sin(a)) for a in angle]
    stage.link("Handle", stage.tube("Handle", handle, 0.009, 16, black))
    knob = stage.uv_sphere("Knob", 0.014, 24, black)
    stage.link("Knob", knob, None, (0.0, 0.0, 0.193))
    t = np.linspace(0.0, 1.0, 13)
    spout = np.stack([-0.095 - 0.075 * t, np.zeros_like(t), 0.085 + 0.085 * t**1.4], axis=1)
    stage.link("Spout", stage.tube("Spout", spout, 0.016, 24, steel))
    stage.camera((0.10, -0.75, 0.36), (-0.015, 0.0, 0.115), 55.0)


def profile():
    """(radius, z) in m from the foot to the middle of the lid."""
    body = np.radians(np.linspace(-62.0, 78.0, 48))
    side = np.stack([0.112 * np.cos(body) ** 0.75, 0.088 + 0.095 * np.sin(body)], axis=1)
    lid = np.linspace(side[-1, 0], 0.001, 8)[1:]
    dome = np.stack([lid, side[-1, 1] + 0.006 * (1.0 - (lid / side[-1, 0]) ** 2)], axis=1)
    foot = [(0.001, 0.002), (side[0, 0], 0.002)]
    return np.concatenate([foot, side, dome])
