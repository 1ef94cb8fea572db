# SPDX-License-Identifier: GPL-3.0-or-later
"""A wavy golden panel leans over a tiled floor and throws a caustic onto it."""

from . import images, maps, nodes, stage

RESOLUTION = (540, 540)

PANEL_WIDTH, PANEL_HEIGHT = 3.6, 2.4
PANEL_BASE = (0.0, 1.0, 0.12)
PANEL_TILT = 30.0  # degrees forward from upright
MAP_SIZE = 512
MAP_TILE = 2.4  # metres covered by one repeat of the normal map
WAVELENGTH = 36.0 / MAP_SIZE
RMS_SLOPE = 0.016


def build():
    """Build the scene in an empty file."""
    stage.reset("reflective_plane", RESOLUTION)
    nodes.world_color((0.55, 0.62, 0.75), 0.04)

    floor_map = images.color_image(
        "floor_tiles",
        maps.tiles(
            512, 6, [(0.80, 0.77, 0.72), (0.74, 0.71, 0.67)], (0.42, 0.40, 0.38), 0.03, 0.04, 7
        ),
    )
    floor = nodes.diffuse_texture("Floor tiles", floor_map, (6.0, 6.0))
    corners = [(-6, -7, 0), (6, -7, 0), (6, 5, 0), (-6, 5, 0)]
    stage.link("Floor", stage.rectangle("Floor", corners, floor), "RECEIVER")

    slopes = maps.spectral_slopes(maps.gaussian_height(MAP_SIZE, WAVELENGTH, RMS_SLOPE, 3))
    normals = images.normal_image("panel_normals", maps.normal_map(*slopes))
    repeat = (PANEL_WIDTH / MAP_TILE, PANEL_HEIGHT / MAP_TILE)
    gold = nodes.principled("Gold", (1.0, 0.76, 0.36), 0.0, 1.0, (normals, repeat))

    # The panel stands on its lower edge (local x right, y up) and leans towards the viewer.
    w, h = 0.5 * PANEL_WIDTH, PANEL_HEIGHT
    rotation = (90.0 + PANEL_TILT, 0.0, 0.0)
    panel = stage.rectangle("Panel", [(-w, 0, 0), (w, 0, 0), (w, h, 0), (-w, h, 0)], gold)
    stage.link("Panel", panel, "CASTER", PANEL_BASE, rotation)

    wood = nodes.principled("Frame wood", (0.035, 0.022, 0.016), 0.6)
    back = stage.box("Frame", (-w - 0.1, -0.1, -0.12), (w + 0.1, h + 0.1, -0.02), wood)
    stage.link("Frame", back, None, PANEL_BASE, rotation)
    stage.light("Lamp", "AREA", 340.0, (-2.7, -3.5, 0.35), (0.0, 1.0, 4.2), 0.04, (1.0, 0.95, 0.88))
    stage.camera((0.5, -5.3, 2.5), (0.05, 0.0, 0.75), 38.0)
