# SPDX-License-Identifier: GPL-3.0-or-later
"""A tiled swimming pool under sun and sky, lit by one environment map.

The caustics are seen through the water that casts them.
"""

import numpy as np

from . import images, maps, nodes, stage

RESOLUTION = (960, 540)

# Half width (x), half length (y), depth; the deck is z = 0.
X, Y, DEPTH = 4.0, 2.6, 1.5
WATER = -0.16
WATER_IOR = 1.33
COPING = 0.32
MAP_SIZE = 512
MAP_TILE = 4.0  # metres covered by one repeat of the waves
WAVELENGTHS = (1.3 / MAP_TILE, 0.30 / MAP_TILE)
RMS_SLOPE = 0.075

SUN_DIRECTION = (-0.55, 0.42, 1.0)
SUN_DIAMETER = np.radians(1.0)
SUN_IRRADIANCE = (5.2, 4.8, 4.1)


def build():
    """Build the scene in an empty file."""
    scene = stage.reset("swimming_pool", RESOLUTION, "Filmic")
    scene.view_settings.look = "Medium High Contrast"
    sky = maps.clear_sky(
        512,
        SUN_DIRECTION,
        SUN_DIAMETER,
        SUN_IRRADIANCE,
        (0.14, 0.30, 0.66),
        (0.62, 0.74, 0.88),
        (0.30, 0.27, 0.23),
    )
    world = nodes.world_environment(images.radiance_image("sky", sky))
    world.cycles.is_caustics_light = True
    world.cycles.sampling_method = "AUTOMATIC"

    build_basin()
    build_water()
    build_deck()
    build_ladder()
    build_toys()
    stage.camera((-3.7, -6.3, 4.1), (0.25, -0.25, -0.75), 30.0)


def build_basin():
    """Floor and walls, one object, open at the top."""
    mosaic = images.color_image(
        "pool_mosaic",
        maps.tiles(
            512,
            16,
            [(0.60, 0.83, 0.87), (0.50, 0.77, 0.84), (0.70, 0.88, 0.90)],
            (0.78, 0.82, 0.82),
            0.10,
            0.04,
            31,
        ),
    )
    tiles = nodes.diffuse_texture("Pool mosaic", mosaic, (1.0 / 1.6, 1.0 / 1.6))
    line = nodes.diffuse("Lane line", (0.03, 0.10, 0.28))
    b = -DEPTH
    # The lane line is a strip of the floor itself.
    lane = (-0.15, 0.15)
    floor = [
        [(-X, y0, b), (X, y0, b), (X, y1, b), (-X, y1, b)]
        for y0, y1 in ((-Y, lane[0]), lane, (lane[1], Y))
    ]
    walls = [
        [(-X, Y, b), (X, Y, b), (X, Y, 0), (-X, Y, 0)],
        [(X, -Y, b), (-X, -Y, b), (-X, -Y, 0), (X, -Y, 0)],
        [(-X, -Y, b), (-X, Y, b), (-X, Y, 0), (-X, -Y, 0)],
        [(X, Y, b), (X, -Y, b), (X, -Y, 0), (X, Y, 0)],
    ]
    basin = stage.quads("Basin", floor + walls, [tiles, line], [0, 1, 0, 0, 0, 0, 0])
    stage.link("Basin", basin, "RECEIVER")


def build_water():
    """A flat surface from wall to wall; the waves are in its normal map."""
    slopes = maps.spectral_slopes(
        maps.ocean_height(MAP_SIZE, WAVELENGTHS, np.radians(35.0), 0.35, RMS_SLOPE, 17)
    )
    normals = images.normal_image("water_normals", maps.normal_map(*slopes))
    water = nodes.glass("Water", WATER_IOR, normals, scale=(2.0 * X / MAP_TILE, 2.0 * Y / MAP_TILE))
    corners = [(-X, -Y, WATER), (X, -Y, WATER), (X, Y, WATER), (-X, Y, WATER)]
    stage.link("Water", stage.rectangle("Water", corners, water), "CASTER")


def build_deck():
    """Coping, pavers and a garden wall."""
    stone = nodes.diffuse("Coping stone", (0.68, 0.66, 0.61))
    top, low = 0.04, 0.0
    x0, x1, y0, y1 = X, X + COPING, Y, Y + COPING
    for name, a, b in (
        ("Coping front", (-x1, -y1, low), (x1, -y0, top)),
        ("Coping back", (-x1, y0, low), (x1, y1, top)),
        ("Coping left", (-x1, -y0, low), (-x0, y0, top)),
        ("Coping right", (x0, -y0, low), (x1, y0, top)),
    ):
        stage.link(name, stage.box(name, a, b, stone))

    paver_map = images.color_image(
        "pavers",
        maps.tiles(
            256, 4, [(0.72, 0.62, 0.52), (0.66, 0.57, 0.49)], (0.45, 0.40, 0.35), 0.03, 0.05, 41
        ),
    )
    pavers = nodes.diffuse_texture("Pavers", paver_map, (1.0 / 2.4, 1.0 / 2.4))
    far = 14.0
    deck = [
        [(-far, -far, 0), (far, -far, 0), (far, -y1, 0), (-far, -y1, 0)],
        [(-far, y1, 0), (far, y1, 0), (far, far, 0), (-far, far, 0)],
        [(-far, -y1, 0), (-x1, -y1, 0), (-x1, y1, 0), (-far, y1, 0)],
        [(x1, -y1, 0), (far, -y1, 0), (far, y1, 0), (x1, y1, 0)],
    ]
    stage.link("Deck", stage.quads("Deck", deck, pavers))

    plaster = nodes.diffuse("Garden wall", (0.74, 0.70, 0.63))
    stage.link("Garden wall", stage.box("Garden wall", (-far, 5.6, 0.0), (far, 5.9, 2.4), plaster))


def build_ladder():
    """Two bent rails of brushed steel with three treads, at the right wall."""
    steel = nodes.principled("Brushed steel", (0.60, 0.61, 0.62), 0.55, 1.0)
    inside, outside, height, bottom = X - 0.22, X + 0.42, 0.75, -1.05
    radius = 0.5 * (outside - inside)
    angle = np.radians(np.linspace(0.0, 180.0, 25))
    for side, y in (("left", 0.85), ("right", 1.40)):
        arch = [
            (inside + radius - radius * np.cos(a), y, height - radius + radius * np.sin(a))
            for a in angle
        ]
        down = [(inside, y, z) for z in np.linspace(bottom, height - radius, 12)[:-1]]
        up = [(outside, y, z) for z in np.linspace(height - radius, 0.0, 8)[1:]]
        rail = stage.tube(f"Rail {side}", down + arch + up, 0.022, 16, steel)
        stage.link(f"Rail {side}", rail)
    for number, z in enumerate((-0.35, -0.65, -0.95)):
        tread = stage.box(
            "Tread", (inside - 0.05, 0.85, z - 0.015), (inside + 0.05, 1.40, z + 0.015), steel
        )
        stage.link(f"Tread {number + 1}", tread)


def build_toys():
    """A beach ball and a swimming ring afloat, a towel on the deck."""
    white = nodes.principled("White vinyl", (0.82, 0.82, 0.80), 0.6)
    red = nodes.principled("Red vinyl", (0.72, 0.05, 0.04), 0.6)
    yellow = nodes.principled("Yellow vinyl", (0.85, 0.52, 0.04), 0.6)
    blue = nodes.principled("Blue vinyl", (0.04, 0.16, 0.55), 0.6)

    panels = [1, 0, 2, 0, 3, 0]
    ball = stage.uv_sphere(
        "Beach ball", 0.26, 48, [white, red, yellow, blue], lambda j, i: panels[i // 8]
    )
    stage.link("Beach ball", ball, None, (1.75, -1.35, WATER + 0.19), (28.0, -24.0, 10.0))

    angle = np.radians(np.arange(0.0, 360.0, 15.0))
    section = np.stack([0.42 + 0.13 * np.cos(angle), 0.13 * np.sin(angle)], axis=1)
    ring = stage.lathe("Swim ring", section, 64, [white, red], material_of=lambda j, i: i // 8 % 2)
    stage.link("Swim ring", ring, None, (-1.45, 0.95, WATER + 0.045), (1.5, -2.0, 12.0))

    cloth_map = images.color_image(
        "towel", maps.stripes(64, [(0.93, 0.92, 0.88), (0.15, 0.42, 0.60)] * 4)
    )
    cloth = nodes.diffuse_texture("Towel", cloth_map)
    towel = stage.rectangle(
        "Towel", [(-0.9, -0.45, 0), (0.9, -0.45, 0), (0.9, 0.45, 0), (-0.9, 0.45, 0)], cloth
    )
    stage.link("Towel", towel, None, (0.9, 3.75, 0.006), (0.0, 0.0, 8.0))
