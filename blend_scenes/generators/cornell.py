# SPDX-License-Identifier: GPL-3.0-or-later
"""The Cornell box, in metres, with one box of rough metal: no caustics."""

from . import nodes, stage

RESOLUTION = (512, 512)

# https://www.graphics.cornell.edu/online/box/data.html, with y into the box, z up, 100 units = 1 m.
# The published x points to the left: `block` mirrors it.
WIDTH, DEPTH, HEIGHT = 5.528, 5.592, 5.488
SHORT_BASE = [(1.30, 0.65), (0.82, 2.25), (2.40, 2.72), (2.90, 1.14)]
TALL_BASE = [(4.23, 2.47), (2.65, 2.96), (3.14, 4.56), (4.72, 4.06)]
SHORT_HEIGHT, TALL_HEIGHT = 1.65, 3.30


def block(name, base, height, material):
    """An upright box over a published base: clockwise there, counter-clockwise when mirrored."""
    low = [(WIDTH - x, y, 0.0) for x, y in base]
    high = [(x, y, height) for x, y, _ in low]
    faces = [(0, 3, 2, 1), (4, 5, 6, 7)]
    faces += [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    return stage.mesh(name, low + high, faces, material)


def build():
    """Build the scene in an empty file."""
    stage.reset("cornell", RESOLUTION)
    nodes.world_color((0.0, 0.0, 0.0), 0.0)
    white = nodes.diffuse("White", (0.73, 0.73, 0.73))
    red = nodes.diffuse("Red", (0.61, 0.06, 0.06))
    green = nodes.diffuse("Green", (0.12, 0.45, 0.11))
    metal = nodes.glossy("Rough metal", (0.85, 0.80, 0.72), 0.55)

    w, d, h = WIDTH, DEPTH, HEIGHT
    walls = {
        "Floor": ([(0, 0, 0), (w, 0, 0), (w, d, 0), (0, d, 0)], white),
        "Ceiling": ([(0, 0, h), (0, d, h), (w, d, h), (w, 0, h)], white),
        "Back wall": ([(0, d, 0), (w, d, 0), (w, d, h), (0, d, h)], white),
        "Left wall": ([(0, 0, 0), (0, d, 0), (0, d, h), (0, 0, h)], red),
        "Right wall": ([(w, 0, 0), (w, 0, h), (w, d, h), (w, d, 0)], green),
    }
    for name, (corners, paint) in walls.items():
        stage.link(name, stage.rectangle(name, corners, paint))
    stage.link("Short box", block("Short box", SHORT_BASE, SHORT_HEIGHT, white))
    stage.link("Tall box", block("Tall box", TALL_BASE, TALL_HEIGHT, metal))

    # The original lamp measures 1.30 by 1.05; it hangs a millimetre below the ceiling.
    lamp = (0.5 * WIDTH, 2.795, HEIGHT - 0.001)
    stage.light(
        "Lamp", "AREA", 250.0, lamp, size=(1.30, 1.05), color=(1.0, 0.82, 0.58), caustics=False
    )
    stage.camera((0.5 * WIDTH, -8.0, 0.5 * HEIGHT), (0.5 * WIDTH, 0.0, 0.5 * HEIGHT), 50.4)
