# SPDX-License-Identifier: GPL-3.0-or-later
"""A hammered glass sphere half sunk into a tiled floor, which goes on inside it."""

from . import images, maps, nodes, stage

RESOLUTION = (540, 540)

RADIUS = 1.0
IOR = 1.5
MAP_HEIGHT = 320  # texels from pole to pole
WAVELENGTH = 0.22  # radians: 22 texels
RMS_SLOPE = 0.085


def build():
    """Build the scene in an empty file."""
    stage.reset("refractive_sphere", RESOLUTION)
    nodes.world_color((0.55, 0.62, 0.75), 0.12)

    floor_map = images.color_image(
        "floor_tiles",
        maps.tiles(
            512,
            8,
            [(0.70, 0.67, 0.62), (0.30, 0.42, 0.46)],
            (0.30, 0.29, 0.28),
            0.035,
            0.05,
            5,
            (0.8, 0.2),
        ),
    )
    floor = nodes.diffuse_texture("Floor tiles", floor_map, (8.0, 8.0))
    corners = [(-8, -8, 0), (8, -8, 0), (8, 8, 0), (-8, 8, 0)]
    stage.link("Floor", stage.rectangle("Floor", corners, floor), "RECEIVER")

    slopes = maps.sphere_slopes(MAP_HEIGHT, WAVELENGTH, RMS_SLOPE, 11)
    normals = images.normal_image("sphere_normals", maps.normal_map(*slopes))
    glass = nodes.glass("Hammered glass", IOR, normals)
    # The poles lie in the floor, away from the light and from the viewer.
    sphere = stage.uv_sphere("Sphere", RADIUS, 128, glass)
    stage.link("Sphere", sphere, "CASTER", rotation=(0.0, 90.0, 25.0))

    stage.light("Lamp", "AREA", 190.0, (1.9, 1.6, 3.4), (0.0, 0.0, 0.3), 0.1, (1.0, 0.96, 0.90))
    stage.camera((0.25, -3.9, 3.1), (-0.05, -0.05, 0.22), 60.0)
