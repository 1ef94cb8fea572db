# SPDX-License-Identifier: GPL-3.0-or-later
"""A slab of wavy glass over a floor: light is refracted twice on its way."""

from . import images, maps, nodes, stage

RESOLUTION = (540, 540)

IOR = 1.5
SIDE, THICKNESS, HEIGHT = 1.6, 0.12, 0.62  # metres; height of the lower side above the floor
MAP_SIZE = 384
WAVELENGTH = 0.14  # of a side
RMS_SLOPE = 0.045


def build():
    """Build the scene in an empty file."""
    stage.reset("slab", RESOLUTION)
    nodes.world_color((0.55, 0.62, 0.75), 0.06)
    floor_map = images.color_image(
        "floor_tiles",
        maps.tiles(
            256, 4, [(0.78, 0.76, 0.72), (0.73, 0.71, 0.68)], (0.45, 0.43, 0.4), 0.03, 0.04, 7
        ),
    )
    floor = nodes.diffuse_texture("Floor tiles", floor_map, (6.0, 6.0))
    corners = [(-6, -6, 0), (6, -6, 0), (6, 6, 0), (-6, 6, 0)]
    stage.link("Floor", stage.rectangle("Floor", corners, floor), "RECEIVER")

    slopes = maps.spectral_slopes(maps.gaussian_height(MAP_SIZE, WAVELENGTH, RMS_SLOPE, 13))
    normals = images.normal_image("slab_normals", maps.normal_map(*slopes))
    wavy = nodes.glass("Wavy glass", IOR, normals)
    plain = nodes.glass("Plain glass", IOR)
    stage.link("Slab", slab([wavy, plain]), "CASTER", (0.0, 0.0, HEIGHT), (0.0, 0.0, 12.0))

    stage.light("Lamp", "AREA", 120.0, (-0.9, 0.9, 2.9), (0.0, 0.0, 0.0), 0.05, (1.0, 0.96, 0.9))
    stage.camera((0.9, -3.4, 1.9), (0.1, -0.05, 0.2), 52.0)


def slab(materials):
    """A closed box, the first material above and below, where the same map lies once as it is and
    once mirrored; the second around."""
    s, t = 0.5 * SIDE, THICKNESS
    vertices = [(x, y, z) for z in (0.0, t) for x, y in ((-s, -s), (s, -s), (s, s), (-s, s))]
    faces = [(4, 5, 6, 7), (0, 3, 2, 1)]
    faces += [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    uvs = [(0, 0), (1, 0), (1, 1), (0, 1)] * len(faces)
    return stage.mesh("Slab", vertices, faces, materials, uvs, material_index=[0, 0, 1, 1, 1, 1])
