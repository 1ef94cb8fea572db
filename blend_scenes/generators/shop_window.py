# SPDX-License-Identifier: GPL-3.0-or-later
"""A shop window at night: glittering goods on pedestals of gold and glass, and a mirror.

No caustics flags are set: Cycles then traces all paths, and Specula finds the casters by itself.
"""

import numpy as np

from . import images, maps, nodes, shoes, stage

RESOLUTION = (720, 540)

WALL_Y, WALL_HEIGHT, HALF_WIDTH = 0.95, 2.4, 2.2
GOLD = (1.0, 0.74, 0.34)
IOR = 1.5
LAMP_RADIUS = 0.008

# Foot of each pedestal on the floor, and its turn in degrees.
COLUMN_AT, COLUMN_TURN = (-0.60, 0.10), 24.0
COLUMN_SIDE, COLUMN_HEIGHT = 0.36, 0.40
WAISTED_AT, WAISTED_HEIGHT = (0.60, 0.16), 0.52
DRUM_AT, DRUM_TOP = (0.0, -0.38), 0.25
DRUM_RADIUS, DRUM_EDGE = 0.14, 0.012
LIFT = 0.002  # metres between the drum and the floor


def build():
    """Build the scene in an empty file."""
    stage.reset("shop_window", RESOLUTION)
    street = images.radiance_image("street", maps.night_street(48, 61))
    nodes.world_environment(street, 1.0)
    room()
    pedestals()
    glitter = goods_glitter()
    shoe_pair(glitter)
    bag_and_handle(glitter)
    balls(glitter)
    mirror()
    lights()
    stage.camera((0.05, -2.9, 1.08), (0.0, 0.3, 0.46), 51.0)


def room():
    """Floor, wall, and a curtain on either side."""
    floor_map = images.color_image(
        "floor_planks", maps.planks(256, 6, (0.74, 0.64, 0.55), 0.02, 41)
    )
    w, y, h = HALF_WIDTH, WALL_Y, WALL_HEIGHT
    floor = nodes.diffuse_texture("Floor planks", floor_map, (3.0, 3.0))
    corners = [(-w, -2.4, 0), (w, -2.4, 0), (w, y, 0), (-w, y, 0)]
    stage.link("Floor", stage.rectangle("Floor", corners, floor))
    plaster = nodes.diffuse("Plaster", (0.40, 0.42, 0.46))
    corners = [(-w, y, 0), (w, y, 0), (w, y, h), (-w, y, h)]
    stage.link("Wall", stage.rectangle("Wall", corners, plaster))
    velvet = nodes.diffuse("Velvet", (0.26, 0.03, 0.06))
    for side, x in (("left", -1.36), ("right", 1.36)):
        stage.link(f"Curtain, {side}", curtain(f"Curtain, {side}", velvet), None, (x, 0.78, 0.0))


def curtain(name, material):
    """A hanging cloth, 0.9 m wide, in folds that open towards the floor."""
    u, z = np.meshgrid(np.linspace(-0.45, 0.45, 121), np.linspace(WALL_HEIGHT, 0.005, 14))
    depth = 0.035 + 0.02 * (1.0 - z / WALL_HEIGHT)
    y = depth * np.sin(2.0 * np.pi * u / 0.13 + 0.8 * np.sin(5.0 * u))
    return stage.grid(name, np.stack([u, y, z], axis=-1), material, uv=False)


def pedestals():
    """A hammered column and a waisted, brushed one of gold, and a drum of glass."""
    slopes = maps.spectral_slopes(maps.gaussian_height(192, 0.28, 0.03, 43))
    hammered = images.normal_image("hammered_normals", maps.normal_map(*slopes))
    gold = nodes.principled("Hammered gold", GOLD, 0.0, 1.0, (hammered, (1.0, 1.0)))
    stage.link("Column", column(gold), None, (*COLUMN_AT, 0.0), (0.0, 0.0, COLUMN_TURN))

    slopes = maps.spectral_slopes(maps.brushed_height(192, 0.6, 0.15, 0.03, 47))
    brushed = images.normal_image("brushed_normals", maps.normal_map(*slopes))
    gold = nodes.principled("Brushed gold", GOLD, 0.0, 1.0, (brushed, (2.0, 1.0)))
    waisted = stage.lathe("Waisted column", waisted_profile(), 128, gold, closed=False)
    stage.link("Waisted column", waisted, None, (*WAISTED_AT, 0.0))

    glass = nodes.glass("Glass", IOR)
    drum = stage.lathe("Drum", drum_profile(), 128, glass, closed=False)
    stage.link("Drum", drum, None, (*DRUM_AT, LIFT))


def column(material):
    """An upright box without a bottom; the map lies once on each face."""
    s, h = 0.5 * COLUMN_SIDE, COLUMN_HEIGHT
    corners = [(-s, -s), (s, -s), (s, s), (-s, s)]
    around = [(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    faces = [[(*a, 0.0), (*b, 0.0), (*b, h), (*a, h)] for a, b in around]
    faces.append([(x, y, h) for x, y in corners])
    return stage.quads("Column", faces, material, uv_scale=1.0 / COLUMN_SIDE)


def waisted_profile():
    """(radius, z) from the foot to the middle of the top."""
    t = np.linspace(0.0, 1.0, 49)
    radius = 0.12 + 0.07 * np.abs(2.0 * t - 1.0) ** 2.2
    side = np.stack([radius, (WAISTED_HEIGHT - 0.004) * t], axis=1)
    top = [(side[-1, 0] - 0.004, WAISTED_HEIGHT), (0.001, WAISTED_HEIGHT)]
    return np.concatenate([side, top])


def drum_profile():
    """(radius, z) from the middle of the bottom to the middle of the top, edges rounded."""
    points = [(0.001, 0.0)]
    r, h, e = DRUM_RADIUS, DRUM_TOP - LIFT, DRUM_EDGE
    for z, start in ((e, -90.0), (h - e, 0.0)):
        angles = np.radians(start + np.linspace(0.0, 90.0, 7))
        points += [(r - e + e * np.cos(a), z + e * np.sin(a)) for a in angles]
    return [*points, (0.001, h)]


def goods_glitter():
    """The normal map of all that glitters, finer than a pixel."""
    slopes = maps.spectral_slopes(maps.gaussian_height(256, 5.0 / 256, 0.35, 53))
    return images.normal_image("glitter_normals", maps.normal_map(*slopes), bits=8)


def shoe_pair(glitter):
    """Two shoes with high heels on the hammered column."""
    red = nodes.principled("Red glitter", (0.92, 0.09, 0.16), 0.12, 1.0, (glitter, (1.8, 2.3)))
    lining = nodes.diffuse("Lining", (0.06, 0.03, 0.03))
    points = shoes.shoe_points(64, 64)
    points[..., 2] += heel_lift(points[..., 1])
    shoe = stage.grid("Shoe", points, red, wrap_u=True)
    inside = stage.uv_sphere("Opening", 1.0, 32, lining)
    y = 0.42 * shoes.LENGTH
    heel = stage.lathe(
        "Heel", [(0.006, 0.0), (0.006, 0.03), (0.02, heel_lift(y) + 0.02)], 24, red, closed=False
    )
    for side, at, turn in (("left", (-0.55, 0.17), -68.0), ("right", (-0.635, 0.04), -52.0)):
        parent = stage.link(f"Shoe, {side}", shoe, None, (*at, COLUMN_HEIGHT), (0.0, 0.0, turn))
        parts = (
            stage.link(f"Heel, {side}", heel, None, (0.0, y, 0.0)),
            stage.link(f"Opening, {side}", inside, None, (0.0, 0.062, 0.113), (22.0, 0.0, 0.0)),
        )
        parts[1].scale = (0.026, 0.060, 0.020)
        for part in parts:
            part.parent = parent


def heel_lift(y):
    """How high the sole is above the ground, from the toe at -y to the heel."""
    t = np.clip((y / shoes.LENGTH + 0.22) / 0.62, 0.0, 1.0)
    return 0.075 * t * t * (3.0 - 2.0 * t)


def bag_and_handle(glitter):
    """A bag on the waisted column."""
    teal = nodes.principled("Teal glitter", (0.10, 0.62, 0.62), 0.12, 1.0, (glitter, (5.0, 2.4)))
    place, rotation = (*WAISTED_AT, WAISTED_HEIGHT), (0.0, 0.0, -18.0)
    stage.link("Bag", bag(teal), None, place, rotation)
    angle = np.radians(np.linspace(0.0, 180.0, 25))
    handle = [(0.075 * np.cos(a), 0.0, 0.165 + 0.11 * np.sin(a)) for a in angle]
    leather = nodes.principled("Leather", (0.16, 0.08, 0.045), 0.45)
    stage.link("Handle", stage.tube("Handle", handle, 0.007, 12, leather), None, place, rotation)


def bag(material):
    """A rounded bag, 26 cm wide, narrower at the top."""

    def power(x, exponent):
        return np.sign(x) * np.abs(x) ** exponent

    v = np.linspace(0.0, 1.0, 33)[:, None]
    latitude, angle = np.pi * (v - 0.5), 2.0 * np.pi * np.arange(72)[None, :] / 72
    radius = power(np.cos(latitude), 0.35) * (1.0 - 0.25 * v)
    x = 0.13 * radius * power(np.cos(angle), 0.6)
    y = 0.055 * radius * power(np.sin(angle), 0.6)
    z = np.broadcast_to(0.09 * (1.0 + power(np.sin(latitude), 0.5)), x.shape)
    return stage.grid("Bag", np.stack([x, y, z], axis=-1), material, wrap_u=True)


def balls(glitter):
    """Three balls on the drum."""
    silver = nodes.principled(
        "Silver glitter", (0.86, 0.86, 0.90), 0.12, 1.0, (glitter, (3.4, 1.7))
    )
    ball = stage.uv_sphere("Ball", 1.0, 48, silver)
    places = (
        ("large", (-0.04, 0.02), 0.070),
        ("middle", (0.070, 0.025), 0.045),
        ("small", (0.035, -0.065), 0.034),
    )
    for name, (x, y), radius in places:
        place = (DRUM_AT[0] + x, DRUM_AT[1] + y, DRUM_TOP + radius)
        obj = stage.link(f"Ball, {name}", ball, None, place)
        obj.scale = (radius, radius, radius)


def mirror():
    """A mirror on the wall that looks down on the floor, in a dark frame."""
    silvered = nodes.glossy("Silvered", (0.92, 0.93, 0.94), 0.0)
    w, h = 0.36, 0.62
    rotation, place = (101.0, 0.0, 0.0), (0.0, WALL_Y - 0.05, 0.42)
    pane = stage.rectangle("Mirror", [(-w, 0, 0), (w, 0, 0), (w, h, 0), (-w, h, 0)], silvered)
    stage.link("Mirror", pane, None, place, rotation)
    wood = nodes.principled("Frame wood", (0.05, 0.03, 0.02), 0.5)
    frame = stage.box("Frame", (-w - 0.035, -0.035, -0.03), (w + 0.035, h + 0.035, -0.005), wood)
    stage.link("Frame", frame, None, place, rotation)


def lights():
    """Four small spot lights."""
    warm, cool = (1.0, 0.86, 0.66), (0.86, 0.93, 1.0)
    spots = (
        ("Spot, left", 420.0, (-1.0, -1.6, 1.5), (-0.60, 0.10, 0.38), 28.0, warm),
        ("Spot, right", 420.0, (1.05, -1.55, 1.6), (0.60, 0.16, 0.45), 28.0, warm),
        ("Spot, front", 160.0, (0.35, -1.5, 1.9), (0.0, -0.37, 0.30), 13.0, cool),
        ("Spot, back", 420.0, (-1.6, 0.62, 1.35), (0.0, -0.38, 0.14), 18.0, cool),
    )
    for name, power, place, target, degrees, color in spots:
        light = stage.light(name, "SPOT", power, place, target, LAMP_RADIUS, color, caustics=False)
        light.data.spot_size, light.data.spot_blend = np.radians(degrees), 0.5
