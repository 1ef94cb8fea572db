# SPDX-License-Identifier: GPL-3.0-or-later
"""Made-up scenes: materials, worlds and lamps that artists build from many nodes."""

from __future__ import annotations

import bpy

from tests.instruments.field._stage import (
    add,
    chrome,
    images,
    maps,
    modifier,
    nodes,
    principled,
    room,
    scene,
    sphere,
    spot,
    stage,
    studio,
    sun,
)

WOOD = (
    (0.0, (0.12, 0.05, 0.02, 1.0)),
    (0.55, (0.4, 0.2, 0.08, 1.0)),
    (1.0, (0.6, 0.36, 0.17, 1.0)),
)
RUST = (
    (0.42, (0.5, 0.5, 0.52, 1.0)),
    (0.55, (0.3, 0.1, 0.03, 1.0)),
    (0.8, (0.12, 0.04, 0.02, 1.0)),
)


# ------------------------------------------------------------------------------------------ pieces


def ramp(graph, factor, stops, interpolation="LINEAR"):
    """A Color Ramp; `stops` holds positions and colours of four components."""
    node = graph.add("ShaderNodeValToRGB", {"Fac": factor})
    elements = node.color_ramp.elements
    while len(elements) < len(stops):
        elements.new(0.5)
    for element, (position, color) in zip(elements, stops, strict=True):
        element.position, element.color = position, color
    node.color_ramp.interpolation = interpolation
    return node.outputs["Color"]


def placed(graph, scale=(1.0, 1.0, 1.0), output="Object", rotation=(0.0, 0.0, 0.0)):
    """Texture coordinates through a Mapping."""
    coordinates = graph.add("ShaderNodeTexCoord").outputs[output]
    sockets = {"Vector": coordinates, "Scale": scale, "Rotation": rotation}
    return graph.add("ShaderNodeMapping", sockets).outputs["Vector"]


def math(graph, operation, *values):
    sockets = dict(enumerate(values))
    return graph.add("ShaderNodeMath", sockets, operation=operation).outputs[0]


def bump(graph, height, strength=0.4, distance=0.1):
    sockets = {"Height": height, "Strength": strength, "Distance": distance}
    return graph.add("ShaderNodeBump", sockets).outputs["Normal"]


def noise(graph, vector, scale=5.0, detail=4.0, output="Fac", **sockets):
    values = {"Vector": vector, "Scale": scale, "Detail": detail, **sockets}
    return graph.add("ShaderNodeTexNoise", values).outputs[output]


def shaded(name, build):
    """A material of the Principled BSDF whose sockets are what `build` returns."""
    material, graph = nodes.material(name)
    graph.finish(graph.add("ShaderNodeBsdfPrincipled", build(graph)))
    return material


def mixed(graph, factor, first, second):
    sockets = {0: factor, 1: first.outputs[0], 2: second.outputs[0]}
    return graph.add("ShaderNodeMixShader", sockets)


def head(material, location=(0.0, 0.0, 1.0)):
    obj = add("monkey", material, True, size=2.0, location=location)
    modifier(obj, "SUBSURF", render_levels=2)
    return obj


# --------------------------------------------------------------------------------------- materials


def wood(graph):
    vector = placed(graph, (1.0, 1.0, 0.15), rotation=(0.2, 0.1, 0.0))
    warped = graph.add(
        "ShaderNodeVectorMath",
        {0: vector, 1: noise(graph, vector, 2.0, 3.0, "Color")},
        operation="ADD",
    ).outputs[0]
    sockets = {"Vector": warped, "Scale": 3.0, "Distortion": 4.0, "Detail": 3.0}
    rings = graph.add("ShaderNodeTexWave", sockets, wave_type="RINGS").outputs["Fac"]
    return {
        "Base Color": ramp(graph, rings, WOOD),
        "Roughness": math(graph, "MULTIPLY_ADD", rings, 0.3, 0.25),
        "Normal": bump(graph, rings, 0.2, 0.02),
    }


@scene
def wooden_table_and_ball():
    studio(floor=False)
    add("plane", shaded("Wood floor", wood), size=20.0)
    sphere(shaded("Wood", wood), (0.0, 0.0, 0.9), 0.9)


def rusty(graph):
    vector = placed(graph)
    mask = noise(graph, vector, 2.5, 8.0, Roughness=0.65)
    fine = noise(graph, vector, 30.0, 4.0)
    return {
        "Base Color": ramp(graph, mask, RUST),
        "Metallic": ramp(graph, mask, ((0.45, (1, 1, 1, 1)), (0.55, (0, 0, 0, 1)))),
        "Roughness": math(graph, "MAXIMUM", mask, 0.3),
        "Normal": bump(graph, math(graph, "MULTIPLY", mask, fine), 0.6, 0.05),
    }


@scene
def rusty_metal_head():
    studio()
    head(shaded("Rust", rusty))


def bricks(graph):
    vector = placed(graph, output="UV")
    brick = graph.add(
        "ShaderNodeTexBrick",
        {
            "Vector": vector,
            "Color1": (0.5, 0.13, 0.07, 1.0),
            "Color2": (0.35, 0.09, 0.06, 1.0),
            "Mortar": (0.5, 0.48, 0.45, 1.0),
            "Scale": 4.0,
        },
    )
    spots = noise(graph, vector, 25.0, 6.0)
    color = graph.add(
        "ShaderNodeMixRGB",
        {"Fac": 0.5, "Color1": brick.outputs["Color"], "Color2": spots},
        blend_type="OVERLAY",
    ).outputs[0]
    height = math(graph, "ADD", math(graph, "MULTIPLY", spots, 0.3), brick.outputs["Fac"])
    return {
        "Base Color": color,
        "Roughness": 0.8,
        "Normal": bump(graph, math(graph, "SUBTRACT", 1.0, height), 0.5, 0.03),
    }


@scene
def brick_wall_at_a_low_sun():
    studio(lamp=False)
    sun(rotation=(70.0, 0.0, 30.0))
    wall = add("plane", shaded("Bricks", bricks), size=5.0, location=(0.0, 1.0, 2.0))
    wall.rotation_euler.x = 1.5708


def marble(graph):
    vector = placed(graph)
    veins = noise(graph, vector, 3.0, 10.0, Distortion=1.5)
    edge = math(graph, "ABSOLUTE", math(graph, "SUBTRACT", veins, 0.5))
    stops = ((0.0, (0.05, 0.06, 0.07, 1)), (0.06, (0.7, 0.7, 0.68, 1)), (1.0, (0.9, 0.9, 0.88, 1)))
    return {"Base Color": ramp(graph, edge, stops, "EASE"), "Roughness": 0.08}


@scene
def marble_columns():
    studio()
    for x in (-1.6, 0.0, 1.6):
        add("cylinder", shaded("Marble", marble), True, radius=0.5, depth=2.4, location=(x, 0, 1.2))


def cracked(graph):
    vector = placed(graph)
    cells = graph.add("ShaderNodeTexVoronoi", {"Vector": vector, "Scale": 4.0})
    edges = graph.add(
        "ShaderNodeTexVoronoi", {"Vector": vector, "Scale": 4.0}, feature="DISTANCE_TO_EDGE"
    ).outputs["Distance"]
    tone = graph.add(
        "ShaderNodeHueSaturation",
        {"Hue": 0.55, "Saturation": 0.4, "Color": cells.outputs["Color"]},
    ).outputs[0]
    gaps = ramp(graph, edges, ((0.02, (0, 0, 0, 1)), (0.08, (1, 1, 1, 1))))
    color = graph.add(
        "ShaderNodeMixRGB", {"Fac": 1.0, "Color1": tone, "Color2": gaps}, blend_type="MULTIPLY"
    ).outputs[0]
    return {"Base Color": color, "Roughness": 0.6, "Normal": bump(graph, gaps, 0.8, 0.05)}


@scene
def cracked_earth_balls():
    studio()
    for x in (-1.1, 1.1):
        sphere(shaded("Cracked", cracked), (x, 0.0, 1.0), 0.95)


@scene
def car_paint_by_layer_weight():
    studio()

    def paint(graph):
        facing = graph.add("ShaderNodeLayerWeight", {"Blend": 0.4}).outputs["Facing"]
        stops = ((0.0, (0.02, 0.1, 0.6, 1.0)), (1.0, (0.4, 0.05, 0.5, 1.0)))
        flakes = graph.add("ShaderNodeTexVoronoi", {"Scale": 400.0}).outputs["Color"]
        return {
            "Base Color": ramp(graph, facing, stops),
            "Metallic": 0.8,
            "Roughness": math(graph, "MULTIPLY_ADD", flakes, 0.2, 0.25),
            "Clearcoat": 1.0,
            "Clearcoat Roughness": 0.02,
        }

    head(shaded("Flip paint", paint))


@scene
def plastic_of_diffuse_glossy_and_fresnel():
    """The classic: two closures, mixed by a Fresnel node."""
    studio()
    for x, ior in ((-1.3, 1.3), (1.3, 1.8)):
        material, graph = nodes.material("Classic plastic")
        diffuse = graph.add("ShaderNodeBsdfDiffuse", {"Color": (0.7, 0.1, 0.05, 1.0)})
        glossy = graph.add("ShaderNodeBsdfGlossy", {"Roughness": 0.1})
        factor = graph.add("ShaderNodeFresnel", {"IOR": ior}).outputs[0]
        graph.finish(mixed(graph, factor, diffuse, glossy))
        sphere(material, (x, 0.0, 1.0))


@scene
def leaves_of_translucent_and_diffuse():
    studio(lamp=False)
    sun()
    material, graph = nodes.material("Leaf")
    veins = graph.add("ShaderNodeTexWave", {"Scale": 3.0, "Distortion": 2.0}).outputs["Color"]
    green = ramp(graph, veins, ((0.0, (0.02, 0.2, 0.02, 1.0)), (1.0, (0.2, 0.5, 0.05, 1.0))))
    diffuse = graph.add("ShaderNodeBsdfDiffuse", {"Color": green})
    translucent = graph.add("ShaderNodeBsdfTranslucent", {"Color": green})
    graph.finish(mixed(graph, 0.4, diffuse, translucent))
    for i in range(7):
        angle = 0.5 * (i - 3)
        leaf = add("plane", material, size=1.0, location=(0.7 * (i - 3), 0.2 * (i % 3), 1.0))
        leaf.rotation_euler = (0.9, angle, 0.4 * i)


@scene
def lampshade_seen_by_the_camera_alone():
    """Light Path: the camera sees another colour than the room, a common trick."""
    studio(lamp=False)
    material, graph = nodes.material("Bulb")
    path = graph.add("ShaderNodeLightPath")
    strength = graph.add(
        "ShaderNodeMixRGB",
        {
            "Fac": path.outputs["Is Camera Ray"],
            "Color1": (20, 16, 10, 1),
            "Color2": (1, 0.9, 0.5, 1),
        },
    ).outputs[0]
    graph.finish(graph.add("ShaderNodeEmission", {"Color": strength, "Strength": 1.0}))
    sphere(material, (-1.2, 0.0, 1.6), 0.4)
    sphere(principled("White", Roughness=0.3), (1.0, 0.0, 0.8), 0.8)


@scene
def sky_of_two_colours_by_light_path():
    """A world that lights by one colour and is seen as another."""
    studio(lamp=False, grey=0.0)
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    graph = nodes.Graph(world)
    seen = graph.add("ShaderNodeBackground", {"Color": (0.9, 0.9, 0.95, 1.0)})
    lights = graph.add("ShaderNodeBackground", {"Color": (0.4, 0.5, 0.7, 1.0), "Strength": 0.8})
    path = graph.add("ShaderNodeLightPath").outputs["Is Camera Ray"]
    graph.add("ShaderNodeOutputWorld", {"Surface": mixed(graph, path, lights, seen).outputs[0]})
    sphere(chrome(), (-1.1, 0.0, 1.0))
    sphere(principled("Clay"), (1.1, 0.0, 1.0))


@scene
def fabric_with_sheen_and_weave():
    studio()

    def cloth(graph):
        vector = placed(graph, (60.0, 60.0, 60.0), "UV")
        weave = graph.add("ShaderNodeTexChecker", {"Vector": vector, "Scale": 1.0})
        return {
            "Base Color": ramp(
                graph,
                weave.outputs["Fac"],
                ((0.0, (0.2, 0.02, 0.05, 1)), (1.0, (0.3, 0.05, 0.1, 1))),
            ),
            "Sheen": 1.0,
            "Sheen Tint": 0.5,
            "Roughness": 0.9,
            "Specular": 0.1,
        }

    head(shaded("Cloth", cloth))


@scene
def velvet_cushions():
    studio()
    material, graph = nodes.material("Velvet")
    velvet = graph.add("ShaderNodeBsdfVelvet", {"Color": (0.5, 0.05, 0.2, 1.0), "Sigma": 0.5})
    base = graph.add("ShaderNodeBsdfDiffuse", {"Color": (0.1, 0.01, 0.04, 1.0)})
    graph.finish(graph.add("ShaderNodeAddShader", {0: velvet.outputs[0], 1: base.outputs[0]}))
    for x in (-1.2, 1.2):
        cushion = add("cube", material, True, size=1.6, location=(x, 0.0, 0.6))
        cushion.scale.z = 0.6
        modifier(cushion, "SUBSURF", render_levels=3)


@scene
def candle_of_subsurface_scattering():
    studio()
    material, graph = nodes.material("Wax")
    sockets = {"Color": (0.9, 0.75, 0.5, 1.0), "Radius": (1.0, 0.5, 0.2), "Scale": 0.2}
    graph.finish(graph.add("ShaderNodeSubsurfaceScattering", sockets))
    add("cylinder", material, True, radius=0.5, depth=1.8, location=(0.0, 0.0, 0.9))
    stage.light("Flame", "POINT", 40.0, (0.0, 0.0, 2.1), size=0.05)


@scene
def jade_and_skin():
    studio()

    def skin(graph):
        spots = noise(graph, placed(graph), 20.0)
        stops = ((0.3, (0.5, 0.2, 0.13, 1.0)), (0.7, (0.75, 0.45, 0.33, 1.0)))
        return {
            "Base Color": ramp(graph, spots, stops),
            "Subsurface": 0.3,
            "Subsurface Color": (0.8, 0.3, 0.2, 1.0),
            "Subsurface Radius": (0.3, 0.1, 0.05),
            "Roughness": 0.4,
            "Normal": bump(graph, spots, 0.1, 0.02),
        }

    head(shaded("Skin", skin))


@scene
def brushed_pan_with_anisotropy():
    studio()
    for x, rotation in ((-1.3, 0.0), (1.3, 0.25)):
        material, graph = nodes.material("Turned steel")
        tangent = graph.add("ShaderNodeTangent", direction_type="RADIAL", axis="Z").outputs[0]
        sockets = {"Roughness": 0.3, "Anisotropy": 0.8, "Rotation": rotation, "Tangent": tangent}
        graph.finish(graph.add("ShaderNodeBsdfAnisotropic", sockets))
        add("cylinder", material, True, radius=1.0, depth=0.6, location=(x, 0.0, 0.3))


@scene
def anisotropic_principled_by_uv():
    studio()

    def steel(graph):
        tangent = graph.add("ShaderNodeTangent", direction_type="UV_MAP").outputs[0]
        return {
            "Base Color": (0.8, 0.75, 0.7, 1.0),
            "Metallic": 1.0,
            "Roughness": 0.35,
            "Anisotropic": 0.7,
            "Tangent": tangent,
        }

    sphere(shaded("Steel", steel), (0.0, 0.0, 1.0))


@scene
def planet_of_ramps_and_clouds():
    studio(lamp=False, floor=False, grey=0.0, target=(0.0, 0.0, 0.0))
    sun(3.0, rotation=(80.0, 0.0, 40.0))

    def land(graph):
        vector = placed(graph)
        height = noise(graph, vector, 2.0, 12.0)
        stops = (
            (0.0, (0.01, 0.03, 0.15, 1.0)),
            (0.5, (0.02, 0.1, 0.3, 1.0)),
            (0.52, (0.5, 0.45, 0.25, 1.0)),
            (0.56, (0.08, 0.2, 0.05, 1.0)),
            (0.7, (0.8, 0.8, 0.8, 1.0)),
        )
        sea = math(graph, "LESS_THAN", height, 0.5)
        return {
            "Base Color": ramp(graph, height, stops),
            "Roughness": math(graph, "SUBTRACT", 0.9, math(graph, "MULTIPLY", sea, 0.7)),
            "Normal": bump(graph, height, 0.3, 0.3),
        }

    sphere(shaded("Planet", land), (0.0, 0.0, 0.0), 1.5)
    material, graph = nodes.material("Clouds")
    cover = ramp(
        graph, noise(graph, placed(graph), 3.0, 8.0), ((0.5, (0, 0, 0, 1)), (0.7, (1, 1, 1, 1)))
    )
    white = graph.add("ShaderNodeBsdfDiffuse", {"Color": (0.9, 0.9, 0.9, 1.0)})
    graph.finish(mixed(graph, cover, graph.add("ShaderNodeBsdfTransparent"), white))
    sphere(material, (0.0, 0.0, 0.0), 1.53)


@scene
def terrain_by_displacement():
    studio(lamp=False, floor=False)
    sun(rotation=(60.0, 0.0, 20.0))
    material, graph = nodes.material("Terrain")
    height = noise(graph, placed(graph), 0.8, 8.0)
    color = ramp(graph, height, ((0.3, (0.1, 0.2, 0.05, 1.0)), (0.6, (0.4, 0.35, 0.3, 1.0))))
    surface = graph.add("ShaderNodeBsdfPrincipled", {"Base Color": color, "Roughness": 0.9})
    shift = graph.add("ShaderNodeDisplacement", {"Height": height, "Midlevel": 0.5, "Scale": 1.5})
    graph.add(
        "ShaderNodeOutputMaterial",
        {"Surface": surface.outputs[0], "Displacement": shift.outputs[0]},
    )
    material.cycles.displacement_method = "DISPLACEMENT"
    add("grid", material, True, x_subdivisions=200, y_subdivisions=200, size=10.0)


@scene
def plaster_by_displacement_as_bump():
    """What Blender's default makes of the Displacement socket."""
    studio(floor=False)
    for name, place, size in (("Wall", (0.0, 2.0, 2.0), 8.0), ("Floor", (0.0, 0.0, 0.0), 12.0)):
        material, graph = nodes.material(name)
        height = noise(graph, placed(graph), 6.0, 6.0)
        surface = graph.add("ShaderNodeBsdfDiffuse", {"Color": (0.7, 0.65, 0.55, 1.0)})
        shift = graph.add("ShaderNodeDisplacement", {"Height": height, "Scale": 0.1})
        links = {"Surface": surface.outputs[0], "Displacement": shift.outputs[0]}
        graph.add("ShaderNodeOutputMaterial", links)
        plane = add("plane", material, size=size, location=place)
        plane.rotation_euler.x = 1.5708 if name == "Wall" else 0.0


@scene
def hammered_gold_bowl():
    """A procedural normal that throws a caustic."""
    studio(lamp=False)
    spot(900.0, (0.5, -2.0, 4.0), (0.0, 0.0, 0.3))

    def hammered(graph):
        dents = graph.add(
            "ShaderNodeTexVoronoi", {"Vector": placed(graph), "Scale": 7.0}, feature="SMOOTH_F1"
        ).outputs["Distance"]
        return {
            "Base Color": (1.0, 0.75, 0.3, 1.0),
            "Metallic": 1.0,
            "Roughness": 0.0,
            "Normal": bump(graph, dents, 0.3, 0.05),
        }

    profile = [(1e-4, 0.05), (0.6, 0.1), (1.1, 0.7), (1.15, 0.75), (1.05, 0.72), (0.55, 0.15)]
    profile += [(1e-4, 0.1)]
    material = shaded("Hammered gold", hammered)
    stage.link("Bowl", stage.lathe("Bowl", profile, 64, material))


@scene
def stained_glass_of_voronoi():
    studio(lamp=False)
    sun(rotation=(-60.0, 0.0, 0.0))
    material, graph = nodes.material("Stained glass")
    vector = placed(graph, output="UV")
    cells = graph.add("ShaderNodeTexVoronoi", {"Vector": vector, "Scale": 6.0}).outputs["Color"]
    vivid = graph.add("ShaderNodeGamma", {"Color": cells, "Gamma": 1.8}).outputs[0]
    edge = graph.add(
        "ShaderNodeTexVoronoi", {"Vector": vector, "Scale": 6.0}, feature="DISTANCE_TO_EDGE"
    ).outputs["Distance"]
    lead = graph.add("ShaderNodeBsdfDiffuse", {"Color": (0.02, 0.02, 0.02, 1.0)})
    pane = graph.add("ShaderNodeBsdfTransparent", {"Color": vivid})
    graph.finish(mixed(graph, math(graph, "LESS_THAN", edge, 0.04), pane, lead))
    window = add("plane", material, size=2.5, location=(0.0, 1.0, 1.4))
    window.rotation_euler.x = 1.5708


@scene
def toon_and_holdout():
    studio()
    material, graph = nodes.material("Toon")
    color = {"Color": (0.2, 0.5, 0.9, 1.0), "Size": 0.6, "Smooth": 0.1}
    graph.finish(graph.add("ShaderNodeBsdfToon", color, component="DIFFUSE"))
    sphere(material, (-1.2, 0.0, 1.0))
    hole, graph = nodes.material("Hole")
    graph.finish(graph.add("ShaderNodeHoldout"))
    sphere(hole, (1.2, 0.0, 1.0), 0.8)


@scene
def hot_metal_by_blackbody():
    studio(lamp=False, grey=0.02)
    material, graph = nodes.material("Hot")
    heat = graph.add("ShaderNodeTexCoord").outputs["Generated"]
    z = graph.add("ShaderNodeSeparateXYZ", {"Vector": heat}).outputs["Z"]
    kelvin = graph.add(
        "ShaderNodeMapRange",
        {"Value": z, "From Min": 0.0, "From Max": 1.0, "To Min": 800.0, "To Max": 4000.0},
    ).outputs[0]
    color = graph.add("ShaderNodeBlackbody", {"Temperature": kelvin}).outputs[0]
    graph.finish(graph.add("ShaderNodeEmission", {"Color": color, "Strength": 3.0}))
    add("cylinder", material, True, radius=0.2, depth=2.2, location=(0.0, 0.0, 1.1))


@scene
def random_colours_of_instances():
    """One material, a colour for each object, by Object Info."""
    studio()

    def colours(graph):
        info = graph.add("ShaderNodeObjectInfo").outputs["Random"]
        stops = ((0.0, (0.8, 0.1, 0.1, 1)), (0.5, (0.1, 0.7, 0.2, 1)), (1.0, (0.1, 0.2, 0.8, 1)))
        return {"Base Color": ramp(graph, info, stops, "CONSTANT"), "Roughness": 0.3}

    material = shaded("By object", colours)
    mesh = sphere(material, (-2.0, 0.0, 0.4), 0.4).data
    for i in range(1, 9):
        stage.link(f"Ball {i}", mesh, location=(0.95 * (i % 5 - 2), 1.0 * (i // 5), 0.4))


@scene
def vertex_colours_and_attributes():
    studio()
    obj = add("grid", None, x_subdivisions=40, y_subdivisions=40, size=3.0, location=(0, 0.5, 0.6))
    obj.rotation_euler.x = 0.6
    layer = obj.data.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    for vertex, entry in zip(obj.data.vertices, layer.data, strict=True):
        entry.color = (0.5 + vertex.co.x / 3, 0.5 + vertex.co.y / 3, 0.2, 1.0)
    weight = obj.data.attributes.new("gloss", "FLOAT", "POINT")
    for vertex, entry in zip(obj.data.vertices, weight.data, strict=True):
        entry.value = abs(vertex.co.x) / 1.5

    def painted(graph):
        color = graph.add("ShaderNodeVertexColor", layer_name="Paint").outputs["Color"]
        gloss = graph.add("ShaderNodeAttribute", attribute_name="gloss").outputs["Fac"]
        return {"Base Color": color, "Roughness": gloss}

    obj.data.materials.append(shaded("Painted", painted))


@scene
def box_mapped_stone():
    studio()

    def stone(graph):
        image = images.color_image(
            "stone",
            maps.tiles(256, 4, [(0.5, 0.4, 0.3), (0.3, 0.3, 0.35)], (0.1, 0.1, 0.1), 0.05, 1, 3),
        )
        node = graph.add(
            "ShaderNodeTexImage",
            {"Vector": placed(graph, (0.6, 0.6, 0.6))},
            projection="BOX",
            projection_blend=0.25,
        )
        node.image = image
        return {"Base Color": node.outputs["Color"], "Roughness": 0.7}

    head(shaded("Stone", stone))


@scene
def dirt_of_geometry_and_curves():
    """Snow on what faces up, through curves, maps of range and vector maths."""
    studio()

    def snow(graph):
        normal = graph.add("ShaderNodeNewGeometry").outputs["Normal"]
        up = graph.add(
            "ShaderNodeVectorMath", {0: normal, 1: (0.0, 0.0, 1.0)}, operation="DOT_PRODUCT"
        ).outputs["Value"]
        broken = math(graph, "ADD", up, noise(graph, placed(graph), 6.0))
        mask = graph.add(
            "ShaderNodeMapRange",
            {"Value": broken, "From Min": 0.8, "From Max": 1.1},
            interpolation_type="SMOOTHSTEP",
        ).outputs[0]
        curve = graph.add("ShaderNodeRGBCurve", {"Color": mask})
        curve.mapping.curves[3].points.new(0.3, 0.6)
        curve.mapping.update()
        color = graph.add(
            "ShaderNodeMixRGB",
            {"Fac": curve.outputs[0], "Color1": (0.2, 0.15, 0.1, 1), "Color2": (0.9, 0.9, 0.95, 1)},
        ).outputs[0]
        return {"Base Color": color, "Roughness": 0.8}

    head(shaded("Snowed on", snow))


@scene
def nested_groups():
    """A group in a group, with unlinked Normal and a value that the outside sets."""
    studio()
    inner = bpy.data.node_groups.new("Speckles", "ShaderNodeTree")
    inner.inputs.new("NodeSocketFloat", "Scale")
    inner.outputs.new("NodeSocketColor", "Color")
    entry, leave = (inner.nodes.new(f"NodeGroup{end}") for end in ("Input", "Output"))
    texture = inner.nodes.new("ShaderNodeTexNoise")
    inner.links.new(entry.outputs[0], texture.inputs["Scale"])
    inner.links.new(texture.outputs["Color"], leave.inputs[0])
    outer = bpy.data.node_groups.new("Coating", "ShaderNodeTree")
    outer.inputs.new("NodeSocketFloat", "Gloss")
    outer.inputs.new("NodeSocketVector", "Normal").hide_value = True
    outer.outputs.new("NodeSocketShader", "Surface")
    entry, leave = (outer.nodes.new(f"NodeGroup{end}") for end in ("Input", "Output"))
    speckles = outer.nodes.new("ShaderNodeGroup")
    speckles.node_tree = inner
    speckles.inputs[0].default_value = 9.0
    bsdf = outer.nodes.new("ShaderNodeBsdfPrincipled")
    outer.links.new(speckles.outputs[0], bsdf.inputs["Base Color"])
    outer.links.new(entry.outputs[0], bsdf.inputs["Roughness"])
    outer.links.new(entry.outputs[1], bsdf.inputs["Normal"])
    outer.links.new(bsdf.outputs[0], leave.inputs[0])
    material, graph = nodes.material("Grouped")
    group = graph.tree.nodes.new("ShaderNodeGroup")
    group.node_tree = outer
    group.inputs[0].default_value = 0.25
    graph.finish(group)
    head(material)


# ------------------------------------------------------------------------------------- other things


@scene
def furry_ball():
    studio()
    material = principled("Fur", (0.35, 0.2, 0.1), Roughness=0.5)
    ball = sphere(material, (0.0, 0.0, 1.0), 0.7)
    ball.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = ball.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length = "HAIR", 3000, 0.35
    settings.use_advanced_hair, settings.brownian_factor = True, 0.02


@scene
def grass_of_curves():
    studio(lamp=False, floor=False)
    sun()
    ground = add("grid", principled("Soil", (0.15, 0.1, 0.05)), x_subdivisions=8, size=8.0)
    ground.data.materials.append(principled("Grass", (0.1, 0.35, 0.05), Roughness=0.6))
    ground.modifiers.new("Grass", "PARTICLE_SYSTEM")
    settings = ground.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length = "HAIR", 4000, 0.5
    settings.material, settings.child_type = 2, "NONE"
    settings.root_radius, settings.tip_radius = 0.8, 0.1


@scene
def lamp_with_a_pattern():
    """A gobo: a spot whose nodes vary over its cone."""
    studio(lamp=False, grey=0.01)
    lamp = spot(800.0, (0.0, -2.0, 5.0), (0.0, 0.0, 0.0), degrees=50.0)
    graph = nodes.Graph(lamp.data)
    coordinates = graph.add("ShaderNodeTexCoord").outputs["Normal"]
    cells = graph.add("ShaderNodeTexChecker", {"Vector": coordinates, "Scale": 12.0}).outputs[
        "Color"
    ]
    emission = graph.add("ShaderNodeEmission", {"Color": cells, "Strength": 1.0})
    graph.add("ShaderNodeOutputLight", {"Surface": emission.outputs[0]})
    sphere(principled("White"), (0.0, 0.0, 0.7), 0.7)


@scene
def lamps_of_falloff_and_temperature():
    studio(lamp=False, grey=0.01)
    for x, kind, kelvin in ((-2, "Constant", 2500), (0, "Linear", 5000), (2, "Quadratic", 9000)):
        lamp = stage.light(kind, "POINT", 20.0, (x, 0.0, 1.5), size=0.1)
        graph = nodes.Graph(lamp.data)
        falloff = graph.add("ShaderNodeLightFalloff", {"Strength": 1.0, "Smooth": 0.2})
        color = graph.add("ShaderNodeBlackbody", {"Temperature": kelvin}).outputs[0]
        sockets = {"Color": color, "Strength": falloff.outputs[kind]}
        emission = graph.add("ShaderNodeEmission", sockets)
        graph.add("ShaderNodeOutputLight", {"Surface": emission.outputs[0]})


@scene
def panorama_of_a_room():
    room(window=(-1.0, 1.0, 0.8, 2.0))
    stage.light("Lamp", "AREA", 60.0, (0.0, 0.0, 2.6), (0.0, 0.0, 0.0), 0.8)
    sphere(chrome(), (0.8, 0.8, 0.5), 0.5)
    camera = stage.camera((0.0, -0.5, 1.4), (0.0, 2.0, 1.2), 50.0)
    camera.data.type = "PANO"
    camera.data.cycles.panorama_type = "EQUIRECTANGULAR"
    nodes.world_color((0.5, 0.6, 0.8), 1.0)


@scene
def fisheye_of_a_room():
    room(window=(-1.0, 1.0, 0.8, 2.0))
    stage.light("Lamp", "AREA", 60.0, (0.0, 0.0, 2.6), (0.0, 0.0, 0.0), 0.8)
    sphere(chrome(), (0.8, 0.8, 0.5), 0.5)
    camera = stage.camera((0.0, -1.5, 1.4), (0.0, 2.0, 1.2), 50.0)
    camera.data.type = "PANO"
    camera.data.cycles.panorama_type = "FISHEYE_EQUISOLID"
    nodes.world_color((0.5, 0.6, 0.8), 1.0)


@scene
def shadow_catcher_product():
    studio(lamp=False, floor=False, grey=0.4)
    sun()
    bpy.context.scene.render.film_transparent = True
    catcher = add("plane", principled("Catcher"), size=20.0)
    catcher.is_shadow_catcher = True
    sphere(principled("Product", (0.8, 0.2, 0.1), Roughness=0.2), (0.0, 0.0, 0.8), 0.8)


@scene
def holdout_collection():
    studio()
    bpy.context.scene.render.film_transparent = True
    sphere(principled("Seen", (0.2, 0.7, 0.3)), (0.7, 0.3, 0.9), 0.9)
    cutter = sphere(principled("Cutter"), (-0.6, -0.5, 0.8), 0.7)
    cutter.is_holdout = True
