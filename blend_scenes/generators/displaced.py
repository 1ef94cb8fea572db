# SPDX-License-Identifier: GPL-3.0-or-later
"""One relief twice: a golden panel that is displaced, and beside it a flat one with a normal map.

Both stand in the sun and throw the same caustic onto the floor before them.
"""

import numpy as np

from . import images, maps, nodes, stage

RESOLUTION = (640, 360)

SIDE = 1.2  # metres, of a panel
TILT = 11.0  # degrees forward from upright
GAP = 0.3
CONTROLS = 64  # heights along a side; the surface is a cubic spline of them
WAVELENGTH = 0.22  # of a side
RMS_SLOPE = 0.02
TEXELS = 8  # for each height, along a side
SUBDIVISIONS = 2  # 135 200 triangles
SUN_DIRECTION = (-0.1, -1.0, 0.42)


def build():
    """Build the scene in an empty file."""
    stage.reset("displaced", RESOLUTION)
    nodes.world_color((0.55, 0.62, 0.75), 0.05)
    floor = nodes.diffuse("Plaster floor", (0.72, 0.70, 0.66))
    corners = [(-6, -6, 0), (6, -6, 0), (6, 5, 0), (-6, 5, 0)]
    stage.link("Floor", stage.rectangle("Floor", corners, floor), "RECEIVER")

    spectrum = maps.gaussian_height(CONTROLS, WAVELENGTH, RMS_SLOPE, 5)
    heights = SIDE * np.fft.ifft2(spectrum).real
    slopes = maps.spline_slopes(heights, SIDE, TEXELS)
    normals = images.normal_image("panel_normals", maps.normal_map(*slopes))
    gold = (1.0, 0.76, 0.36)
    mapped = nodes.principled("Gold, normal map", gold, 0.0, 1.0, (normals, (1.0, 1.0)))
    middle, rotation = 0.5 * (SIDE + GAP), (90.0 + TILT, 0.0, 0.0)
    displaced = displaced_panel(heights, nodes.principled("Gold", gold, 0.0, 1.0))
    left = stage.link("Displaced panel", displaced, "CASTER", (-middle, 0.6, 0.05), rotation)
    smooth = left.modifiers.new("Spline", "SUBSURF")
    smooth.levels, smooth.render_levels = SUBDIVISIONS, SUBDIVISIONS
    s = 0.5 * SIDE
    flat = [(-s, 0, 0), (s, 0, 0), (s, SIDE, 0), (-s, SIDE, 0)]
    right = stage.rectangle("Mapped panel", flat, mapped)
    stage.link("Mapped panel", right, "CASTER", (middle, 0.6, 0.05), rotation)

    wood = nodes.principled("Frame wood", (0.035, 0.022, 0.016), 0.6)
    back = stage.box("Frame", (-s - 0.04, -0.05, -0.10), (s + 0.04, SIDE + 0.04, -0.05), wood)
    for name, x in (("Left frame", -middle), ("Right frame", middle)):
        stage.link(name, back, None, (x, 0.6, 0.05), rotation)
    sun = stage.light("Sun", "SUN", 3.0, SUN_DIRECTION, (0, 0, 0), 0.0, (1.0, 0.95, 0.88))
    sun.data.angle = np.radians(0.53)
    stage.camera((0.05, -4.6, 2.5), (0.05, -0.2, 0.36), 42.0)


def displaced_panel(heights, material):
    """Control points of a panel as large as the mapped one, local x right, y up.

    Catmull-Clark subdivision makes of a regular grid the uniform cubic B-spline of its heights.
    A row and a column more on each side, filled by the relief's period: what the subdivision does
    differently at the border is then left to a strip of half a cell.
    """
    index = np.arange(-1, CONTROLS + 1)
    place = (index + 0.5) / CONTROLS * SIDE
    x, y = np.meshgrid(place - 0.5 * SIDE, place)
    z = np.pad(heights, 1, mode="wrap")
    return stage.grid("Displaced panel", np.stack([x, y, z], axis=-1), material)
