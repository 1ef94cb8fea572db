# SPDX-License-Identifier: GPL-3.0-or-later
"""Made-up scenes: every kind of light, worlds, interiors, and what throws caustics in them."""

from __future__ import annotations

import math

import bpy
import numpy as np

from tests.instruments.field._stage import (
    add,
    chrome,
    clear,
    emission,
    gold,
    hdri,
    images,
    mapped,
    maps,
    modifier,
    nodes,
    normal_image,
    principled,
    room,
    scene,
    sphere,
    spot,
    stage,
    studio,
    sun,
    view,
)

# ----------------------------------------------------------------------------------------- lights


@scene
def spot_through_a_lens():
    studio(lamp=False)
    lens = sphere(clear(IOR=1.5), (0.0, 0.0, 1.6), 0.8)
    lens.scale.z = 0.25
    spot(500.0, (0.0, 0.3, 4.5), (0.0, 0.0, 0.0), 25.0, 0.0)


@scene
def point_without_radius_and_glass():
    studio(lamp=False)
    stage.light("Point", "POINT", 300.0, (1.5, 1.0, 3.5), size=0.0)
    sphere(clear())


@scene
def area_lights_of_all_shapes():
    studio(lamp=False)
    sphere(clear(), (0.0, 0.0, 0.8), 0.7)
    for i, shape in enumerate(("SQUARE", "RECTANGLE", "DISK", "ELLIPSE")):
        place = (1.5 * (i - 1.5), 1.5, 2.5)
        lamp = stage.light(shape, "AREA", 60.0, place, (0.0, 0.0, 0.5), (0.8, 0.3))
        lamp.data.shape = shape
        lamp.data.spread = math.radians(180.0 - 40.0 * i)


@scene
def many_coloured_points():
    studio(lamp=False, grey=0.0)
    rng = np.random.default_rng(1)
    for i in range(40):
        place = (*rng.uniform(-3.0, 3.0, 2), rng.uniform(0.3, 3.0))
        color = tuple(rng.uniform(0.1, 1.0, 3))
        stage.light(f"Point {i}", "POINT", 15.0, place, size=0.05, color=color)
    sphere(chrome(), (-0.9, 0.0, 0.9), 0.8)
    sphere(clear(), (0.9, 0.0, 0.9), 0.8)


@scene
def lamp_in_a_glass_shade():
    studio(lamp=False, grey=0.01)
    shade = sphere(clear("Shade", (1.0, 0.9, 0.7)), (0.0, 0.0, 1.2), 0.8)
    modifier(shade, "SOLIDIFY", thickness=0.05)
    stage.light("Bulb", "POINT", 80.0, (0.0, 0.0, 1.2), size=0.1)


@scene
def filament_in_a_bulb():
    studio(lamp=False, grey=0.01)
    sphere(clear(), (0.0, 0.0, 1.2), 0.6)
    sphere(nodes.glass("Inside", 1.0 / 1.45), (0.0, 0.0, 1.2), 0.56)
    add(
        "torus",
        emission("Filament", (1.0, 0.7, 0.4), 200.0),
        True,
        major_radius=0.2,
        minor_radius=0.01,
        location=(0.0, 0.0, 1.2),
    )


@scene
def lamp_close_to_a_wall():
    studio(lamp=False)
    add(
        "plane",
        principled("Wall"),
        size=6.0,
        location=(0.0, 1.0, 2.0),
        rotation=(math.pi / 2, 0, 0),
    )
    stage.light("Sconce", "POINT", 30.0, (0.0, 0.85, 1.6), size=0.12)


@scene
def lamps_with_nodes():
    studio(lamp=False)
    sphere(clear())
    lamp = stage.light("Blackbody", "AREA", 300.0, (2.0, -2.0, 4.0), (0.0, 0.0, 0.0), 1.0).data
    lamp.use_nodes = True
    body = lamp.node_tree.nodes.new("ShaderNodeBlackbody")
    body.inputs["Temperature"].default_value = 3000.0
    shader = lamp.node_tree.nodes["Emission"]
    lamp.node_tree.links.new(body.outputs[0], shader.inputs["Color"])


@scene
def emissive_panel_and_mirror():
    studio(lamp=False, grey=0.0)
    panel = add("plane", emission("Panel", (1.0, 1.0, 0.9), 12.0), size=1.5, location=(-2, 0, 2))
    panel.rotation_euler = (0.0, 1.2, 0.0)
    mirror = add("plane", chrome(), size=2.0, location=(1.6, 0.5, 1.1))
    mirror.rotation_euler = (0.0, -1.3, 0.3)
    sphere(clear(), (0.0, -0.3, 0.6), 0.6)


@scene
def lamp_that_casts_no_shadow():
    studio(lamp=False)
    sphere(clear(), (-0.9, 0.0, 0.9), 0.8)
    sphere(principled("Clay"), (0.9, 0.0, 0.9), 0.8)
    lamp = stage.light("Fill", "AREA", 200.0, (2.0, -2.0, 4.0), (0.0, 0.0, 0.0), 0.5).data
    lamp.use_shadow = lamp.cycles.cast_shadow = False


# ----------------------------------------------------------------------------------------- worlds


@scene
def hdri_with_a_sun():
    studio(lamp=False, grey=0.0)
    hdri()
    sphere(clear(), (-1.0, 0.0, 1.0), 0.9)
    sphere(gold(), (1.0, 0.0, 1.0), 0.9)


@scene
def nishita_sky():
    studio(lamp=False, grey=0.0)
    world = bpy.data.worlds.new("Sky")
    bpy.context.scene.world = world
    graph = nodes.Graph(world)
    sky = graph.add("ShaderNodeTexSky", sky_type="NISHITA", sun_elevation=0.6, sun_rotation=2.0)
    back = graph.add("ShaderNodeBackground", {"Color": sky.outputs[0], "Strength": 0.2})
    graph.add("ShaderNodeOutputWorld", {"Surface": back.outputs[0]})
    sphere(clear(), (0.0, 0.0, 1.0), 0.9)


@scene
def sun_and_sky():
    studio(lamp=False, grey=0.4)
    sun(3.0)
    tumbler = add("cylinder", clear(), True, radius=0.5, depth=1.4, location=(-0.9, 0.0, 0.72))
    modifier(tumbler, "BEVEL", width=0.05, segments=3)
    sphere(clear("Blue", (0.5, 0.7, 1.0)), (0.9, 0.0, 0.7), 0.65)


@scene
def transparent_film_product():
    studio(floor=False)
    bpy.context.scene.render.film_transparent = True
    sphere(clear(), (0.0, 0.0, 1.0), 0.9)
    add("torus", gold(), True, major_radius=1.3, minor_radius=0.1, location=(0.0, 0.0, 1.0))


# -------------------------------------------------------------------------------------- interiors


@scene
def bathroom():
    room(window=(-0.6, 0.6, 1.2, 2.1))
    hdri(direction=(0.3, 0.8, 0.6))
    stage.light("Ceiling", "AREA", 60.0, (0.0, 0.0, 2.6), (0.0, 0.0, 0.0), 0.6)
    add("cube", principled("Tub", (0.9, 0.9, 0.9)), size=1.0, location=(1.2, 1.0, 0.3))
    bpy.context.object.scale = (0.7, 1.4, 0.6)
    normals = normal_image("bath water", 256, 0.1, 0.1, 21)
    water = mapped(clear("Bath water", IOR=1.33), normals)
    surface = add("plane", water, size=1.0, location=(1.2, 1.0, 0.65))
    surface.scale = (0.6, 1.2, 1.0)
    shower = add("cube", clear("Shower"), size=1.0, location=(-1.2, 0.8, 1.0))
    shower.scale = (0.02, 1.5, 2.0)
    mirror = add("plane", chrome("Mirror"), size=1.2, location=(-1.98, -0.6, 1.5))
    mirror.rotation_euler = (0.0, math.pi / 2.0, 0.0)
    view((0.3, -2.4, 1.6), (0.0, 1.0, 1.0), 24.0)


@scene
def kitchen_table_by_the_window():
    room(window=(-1.2, 1.2, 0.9, 2.2))
    sun(5.0, rotation=(-55.0, 8.0, 0.0))
    pane = add("cube", clear("Pane"), size=1.0, location=(0.0, 2.5, 1.55))
    pane.scale = (2.4, 0.01, 1.3)
    table = add("cube", principled("Oak", (0.5, 0.3, 0.15), Roughness=0.3), size=1.0)
    table.location, table.scale = (0.0, 0.8, 0.75), (1.6, 0.9, 0.06)
    for i, color in enumerate(((1, 1, 1), (0.6, 0.9, 0.7), (0.9, 0.7, 0.5))):
        glass = add("cylinder", clear("Glass", color), True, radius=0.08, depth=0.22)
        glass.location = (0.35 * (i - 1), 0.75, 0.895)
    nodes.world_color((0.5, 0.6, 0.8), 1.0)
    view((0.2, -1.6, 1.5), (0.0, 1.0, 0.9), 30.0)


@scene
def aquarium():
    studio(lamp=False)
    spot(400.0, (0.5, 0.3, 4.0), (0.0, 0.0, 0.5), 50.0)
    tank = add("cube", clear("Tank", IOR=1.5), size=1.0, location=(0.0, 0.0, 0.75))
    tank.scale = (2.4, 1.2, 1.4)
    modifier(tank, "SOLIDIFY", thickness=0.04)
    water = add("cube", clear("Water", (0.8, 0.95, 1.0), IOR=1.33), size=1.0, location=(0, 0, 0.65))
    water.scale = (2.3, 1.1, 1.1)
    for x in (-0.6, 0.1, 0.7):
        sphere(principled("Fish", (0.9, 0.4, 0.1)), (x, 0.0, 0.6 + 0.2 * x), 0.15, 24)


@scene
def pool_with_displaced_water():
    room(6.0, 6.0, 3.0)
    sun(5.0, rotation=(25.0, 10.0, 0.0))
    bpy.data.objects["Room"].visible_shadow = False
    water = add(
        "grid", clear("Water", IOR=1.33), True, x_subdivisions=128, y_subdivisions=128, size=5.9
    )
    water.location.z = 1.0
    texture = bpy.data.textures.new("Waves", "CLOUDS")
    texture.noise_scale = 0.5
    modifier(water, "DISPLACE", texture=texture, strength=0.12)
    view((0.0, -2.8, 2.6), (0.0, 0.8, 0.6), 24.0)


@scene
def chandelier():
    room(5.0, 5.0, 3.5)
    stage.light("Bulb", "POINT", 150.0, (0.0, 0.5, 2.4), size=0.04)
    crystal = clear("Crystal", IOR=1.6)
    first = add("cone", crystal, vertices=8, radius1=0.06, depth=0.16, location=(0.0, 0.0, -3.0))
    for ring, count in enumerate((10, 18, 26)):
        for i in range(count):
            angle = 2.0 * math.pi * i / count
            radius = 0.25 + 0.2 * ring
            copy = bpy.data.objects.new(f"Crystal {ring} {i}", first.data)
            copy.location = (
                radius * math.cos(angle),
                0.5 + radius * math.sin(angle),
                2.5 - 0.15 * ring,
            )
            copy.rotation_euler = (math.pi, 0.1 * i, angle)
            bpy.context.scene.collection.objects.link(copy)
    view((0.0, -2.3, 1.4), (0.0, 0.8, 1.9), 24.0)


@scene
def magnifier_in_the_sun():
    studio(lamp=False)
    sun(6.0, rotation=(15.0, 0.0, 0.0))
    lens = sphere(clear(IOR=1.52), (0.0, 0.0, 1.0), 0.7, 64)
    lens.scale.z = 0.2
    add("torus", principled("Rim", (0.02, 0.02, 0.02)), True, major_radius=0.72, minor_radius=0.05)
    bpy.context.object.location.z = 1.0
    paper = images.color_image(
        "letters", maps.tiles(256, 12, [(0.9,) * 3, (0.1,) * 3], (0.9,) * 3, 0.3, 0.0, 8)
    )
    add("plane", nodes.diffuse_texture("Page", paper), size=3.0, location=(0.0, 0.0, 0.01))


@scene
def disco_ball():
    room(5.0, 5.0, 3.0)
    ball = add(
        "uv_sphere", chrome(), segments=28, ring_count=14, radius=0.5, location=(0.0, 0.6, 2.0)
    )
    ball.name = "Mirrors"
    for x, color in ((-1.5, (1.0, 0.3, 0.3)), (1.5, (0.3, 0.5, 1.0))):
        lamp = spot(400.0, (x, -1.5, 2.4), ball.location, 22.0)
        lamp.data.color = color
    nodes.world_color((0.02, 0.02, 0.02), 1.0)
    view((0.0, -2.3, 1.2), (0.0, 1.0, 1.6), 24.0)


@scene
def prism_on_a_table():
    studio(lamp=False)
    prism = add("cylinder", clear("Prism", IOR=1.7), vertices=3, radius=0.6, depth=1.6)
    prism.location, prism.rotation_euler = (0.0, 0.0, 0.4), (math.pi / 2.0, 0.2, 0.0)
    spot(600.0, (-3.0, 0.5, 1.2), (0.0, 0.0, 0.5), 12.0)


@scene
def hall_of_mirrors():
    room(3.0, 4.0, 2.6, material=chrome("Mirrors", (0.85, 0.9, 0.88)))
    stage.light("Lamp", "AREA", 40.0, (0.0, 0.5, 2.5), (0.0, 0.5, 0.0), 0.4)
    sphere(principled("Red", (0.8, 0.1, 0.1)), (-0.5, 0.6, 0.5), 0.5)
    sphere(clear(), (0.6, 0.9, 0.5), 0.45)
    view((0.0, -1.8, 1.4), (0.0, 0.8, 0.8), 24.0)


@scene
def night_street_of_bottles():
    studio(lamp=False, grey=0.0)
    nodes.world_environment(images.radiance_image("street", maps.night_street(128, 4)))
    for i, color in enumerate(((0.3, 0.7, 0.3), (0.8, 0.5, 0.2), (1.0, 1.0, 1.0), (0.4, 0.5, 0.9))):
        profile = [(1e-4, 0.02), (0.3, 0.02), (0.3, 1.0), (0.1, 1.3), (0.1, 1.7), (0.07, 1.7)]
        profile += [(0.07, 1.3), (0.27, 0.98), (0.27, 0.08), (1e-4, 0.08)]
        mesh = stage.lathe("Bottle", profile, 40, clear("Bottle", color))
        stage.link("Bottle", mesh, location=(0.9 * (i - 1.5), 0.0, 0.0))
