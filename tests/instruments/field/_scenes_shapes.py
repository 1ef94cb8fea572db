# SPDX-License-Identifier: GPL-3.0-or-later
"""Made-up scenes: primitives, modifiers, instances, other kinds of objects, odd sizes."""

from __future__ import annotations

import math

import bpy

from tests.instruments.field._stage import (
    add,
    chrome,
    clear,
    dressed,
    gold,
    hdri,
    modifier,
    nodes,
    principled,
    scene,
    sphere,
    spot,
    stage,
    studio,
    sun,
    view,
)

# -------------------------------------------------------------------------------------- modifiers


@scene
def solidify_bowl():
    studio()
    bowl = sphere(clear())
    half = bpy.data.meshes.new("Half")
    kept = [p for p in bowl.data.polygons if p.center.z < 0.0]
    half.from_pydata([v.co for v in bowl.data.vertices], [], [list(p.vertices) for p in kept])
    half.materials.append(bowl.data.materials[0])
    bowl.data = half
    dressed(bowl, None, smooth=True)
    modifier(bowl, "SOLIDIFY", thickness=0.08)


@scene
def bevelled_glass_cube():
    studio()
    cube = add("cube", clear(), size=1.5, location=(0.0, 0.0, 0.8), rotation=(0.0, 0.0, 0.5))
    modifier(cube, "BEVEL", width=0.12, segments=4)


@scene
def subdivided_glass_head():
    studio()
    head = add("monkey", clear(), True, size=2.0, location=(0.0, 0.0, 1.0))
    modifier(head, "SUBSURF", levels=1, render_levels=2)


@scene
def array_of_tumblers():
    studio()
    tumbler = add("cylinder", clear(), True, radius=0.3, depth=1.0, location=(-1.5, 0.0, 0.52))
    modifier(tumbler, "ARRAY", count=5, relative_offset_displace=(1.25, 0.0, 0.0))
    modifier(tumbler, "ARRAY", count=3, relative_offset_displace=(0.0, 1.5, 0.0))


@scene
def mirrored_chrome_wings():
    studio()
    wing = add("torus", chrome(), True, major_radius=0.8, minor_radius=0.2, location=(1.2, 0, 0.9))
    wing.rotation_euler = (0.5, 0.3, 0.0)
    centre = bpy.data.objects.new("Centre", None)
    bpy.context.scene.collection.objects.link(centre)
    modifier(wing, "MIRROR", mirror_object=centre)


@scene
def screw_vase():
    studio()
    profile = [
        (0.0, 0.0, 0.02),
        (0.5, 0.0, 0.02),
        (0.7, 0.0, 0.6),
        (0.3, 0.0, 1.2),
        (0.5, 0.0, 1.7),
    ]
    mesh = bpy.data.meshes.new("Profile")
    mesh.from_pydata(profile, [(i, i + 1) for i in range(len(profile) - 1)], [])
    vase = dressed(stage.link("Vase", mesh), clear("Green glass", (0.6, 0.9, 0.7)))
    modifier(vase, "SCREW", steps=32, render_steps=48, use_merge_vertices=True)
    modifier(vase, "SOLIDIFY", thickness=0.05)
    modifier(vase, "SUBSURF", render_levels=2)


@scene
def boolean_dice():
    studio()
    dice = add("cube", clear("Acrylic", (0.9, 0.1, 0.1)), size=1.4, location=(0.0, 0.0, 0.75))
    for x, y, z in ((0.0, 0.0, 1.45), (0.4, -0.7, 1.1), (-0.4, -0.7, 0.4), (0.7, 0.0, 0.75)):
        hole = add("uv_sphere", radius=0.16, location=(x, y, z))
        hole.hide_render = True
        hole.display_type = "WIRE"
        modifier(dice, "BOOLEAN", object=hole, operation="DIFFERENCE")
    modifier(dice, "BEVEL", width=0.04, segments=3)


@scene
def displaced_gold_ball():
    studio()
    ball = sphere(gold(), segments=96)
    clouds = bpy.data.textures.new("Clouds", "CLOUDS")
    clouds.noise_scale = 0.35
    modifier(ball, "DISPLACE", texture=clouds, strength=0.25)


@scene
def wave_modifier_pool():
    studio(lamp=False)
    sun()
    water = add(
        "grid", clear("Water", IOR=1.33), True, x_subdivisions=96, y_subdivisions=96, size=6.0
    )
    water.location.z = 1.0
    modifier(water, "WAVE", height=0.15, width=0.8, narrowness=2.0, time_offset=-60.0)


@scene
def ocean_modifier_sea():
    studio(lamp=False, floor=False)
    hdri()
    floor = add("plane", principled("Sand", (0.7, 0.6, 0.4)), size=60.0, location=(0.0, 0.0, -3.0))
    floor.name = "Sand"
    sea = add("plane", clear("Sea", IOR=1.33), size=2.0)
    modifier(sea, "OCEAN", resolution=8, spatial_size=30, wave_scale=0.6, random_seed=3)


@scene
def remeshed_metal_head():
    studio()
    head = add("monkey", chrome("Copper", (0.95, 0.6, 0.45), 0.15), size=2.0, location=(0, 0, 1))
    modifier(head, "REMESH", mode="VOXEL", voxel_size=0.06, use_smooth_shade=True)


@scene
def decimated_crystal():
    studio()
    stone = add("ico_sphere", clear(IOR=1.6), subdivisions=4, radius=1.0, location=(0.0, 0.0, 1.0))
    modifier(stone, "DECIMATE", ratio=0.06)


# -------------------------------------------------------------------------- broken and odd meshes


@scene
def flipped_normals_glass():
    studio()
    for x, flip in ((-1.2, False), (1.2, True)):
        ball = sphere(clear(), (x, 0.0, 1.0), 0.9)
        if flip:
            ball.data.flip_normals()


@scene
def open_and_doubled_faces():
    studio()
    box = add("cube", clear(), size=1.4, location=(-1.0, 0.0, 0.75))
    faces = [list(p.vertices) for p in box.data.polygons]
    corners = [v.co.copy() for v in box.data.vertices]
    mesh = bpy.data.meshes.new("Open and doubled")
    mesh.from_pydata(corners, [], [*faces[1:], faces[2]])  # one is missing, one is there twice
    mesh.materials.append(box.data.materials[0])
    box.data = mesh
    for material in (principled("Brick"), chrome()):  # in one place
        add("cube", material, size=1.2, location=(1.2, 0.0, 0.6))


@scene
def smooth_shaded_cubes():
    studio()
    add("cube", clear(), True, size=1.2, location=(-1.1, 0.0, 0.65))
    add("cylinder", chrome(), True, vertices=8, radius=0.6, depth=1.4, location=(1.1, 0.0, 0.7))


@scene
def thin_plane_glass():
    studio(lamp=False)
    sun()
    pane = add("plane", clear(), size=3.0, location=(0.0, 0.0, 1.0))
    pane.rotation_euler = (0.4, 0.0, 0.0)


# -------------------------------------------------------------------------------------- instances


@scene
def scaled_collection_instances():
    studio()
    group = bpy.data.collections.new("Ornament")
    for obj in (sphere(clear(), (0, 0, 0), 0.5), add("torus", gold(), True, major_radius=0.6)):
        bpy.context.scene.collection.objects.unlink(obj)
        group.objects.link(obj)
    scales = ((1, 1, 1), (0.3, 0.3, 1.5), (-1, 1, 1), (1.2, 0.4, 0.7), (0.01, 0.01, 0.01))
    for i, scale in enumerate(scales):
        instance = bpy.data.objects.new(f"Instance {i}", None)
        instance.instance_type, instance.instance_collection = "COLLECTION", group
        instance.location, instance.scale = (1.4 * (i - 2), 0.0, 1.0), scale
        bpy.context.scene.collection.objects.link(instance)


@scene
def particle_beads():
    studio()
    bead = sphere(clear(), (0.0, 0.0, -5.0), 0.5, 24)
    ground = add("grid", principled("Velvet", (0.3, 0.02, 0.05)), size=4.0, location=(0, 0, 0.05))
    modifier(ground, "PARTICLE_SYSTEM")
    system = ground.particle_systems[0]
    system.seed = 7
    settings = system.settings
    settings.type, settings.render_type = "HAIR", "OBJECT"
    settings.instance_object = bead
    settings.count, settings.hair_length = 80, 1.0
    settings.particle_size, settings.size_random = 0.25, 0.6


@scene
def geometry_nodes_pebbles():
    studio()
    ground = add("grid", size=4.0, location=(0.0, 0.0, 0.05))
    tree = bpy.data.node_groups.new("Pebbles", "GeometryNodeTree")
    tree.inputs.new("NodeSocketGeometry", "Geometry")
    tree.outputs.new("NodeSocketGeometry", "Geometry")
    kinds = (
        "NodeGroupInput",
        "GeometryNodeDistributePointsOnFaces",
        "GeometryNodeInstanceOnPoints",
    )
    start, points, instances = (tree.nodes.new(kind) for kind in kinds)
    ball, material = (
        tree.nodes.new(f"GeometryNode{kind}") for kind in ("MeshIcoSphere", "SetMaterial")
    )
    end = tree.nodes.new("NodeGroupOutput")
    ball.inputs["Radius"].default_value, ball.inputs["Subdivisions"].default_value = 0.18, 3
    points.inputs["Density"].default_value = 6.0
    material.inputs["Material"].default_value = clear()
    for source, target in (
        (start.outputs[0], points.inputs["Mesh"]),
        (points.outputs["Points"], instances.inputs["Points"]),
        (ball.outputs["Mesh"], material.inputs["Geometry"]),
        (material.outputs[0], instances.inputs["Instance"]),
        (instances.outputs[0], end.inputs[0]),
    ):
        tree.links.new(source, target)
    modifier(ground, "NODES", node_group=tree)


@scene
def instances_on_vertices():
    studio()
    frame = add("ico_sphere", subdivisions=2, radius=1.2, location=(0.0, 0.0, 1.4))
    bead = sphere(chrome(), (0.0, 0.0, 0.0), 0.15, 24)
    bead.parent = frame
    frame.instance_type = "VERTS"


# ----------------------------------------------------------------------------------- other geometry


@scene
def glass_text():
    studio()
    bpy.ops.object.text_add(location=(-1.5, 0.0, 0.05), rotation=(math.radians(75.0), 0.0, 0.0))
    text = dressed(bpy.context.object, clear())
    text.data.body = "Glass"
    text.data.size, text.data.extrude, text.data.bevel_depth = 1.3, 0.15, 0.02


@scene
def chrome_wire():
    studio()
    for turn in (0.0, 1.0, 2.1):
        bpy.ops.curve.primitive_bezier_circle_add(radius=1.0, location=(0.0, 0.0, 1.1))
        wire = dressed(bpy.context.object, chrome())
        wire.rotation_euler = (1.2, 0.2, turn)
        wire.data.bevel_depth, wire.data.bevel_resolution = 0.08, 6


@scene
def glass_metaballs():
    studio()
    for location in ((0.0, 0.0, 0.9), (0.9, 0.2, 1.1), (-0.7, -0.2, 1.5)):
        bpy.ops.object.metaball_add(type="BALL", radius=0.9, location=location)
        bpy.context.object.data.render_resolution = 0.12
        if not bpy.context.object.data.materials:
            dressed(bpy.context.object, clear())


@scene
def nurbs_ring():
    studio()
    bpy.ops.surface.primitive_nurbs_surface_torus_add(radius=1.0, location=(0.0, 0.0, 0.6))
    dressed(bpy.context.object, gold(0.1))


# ------------------------------------------------------------------------------------ odd measures


def jewel(scale):
    """A ring with a stone; `scale` in units per centimetre or so."""
    studio(scale)
    add(
        "torus",
        gold(),
        True,
        major_radius=scale,
        minor_radius=0.12 * scale,
        location=(0.0, 0.0, 1.1 * scale),
        rotation=(math.pi / 2.0, 0.0, 0.4),
    )
    stone = clear("Diamond", IOR=2.42)
    top = (0.0, 0.0, 2.45 * scale)
    add("cone", stone, vertices=12, radius1=0.5 * scale, radius2=0.25 * scale, depth=0.2 * scale)
    bpy.context.object.location = (top[0], top[1], top[2] + 0.1 * scale)
    add("cone", stone, vertices=12, radius1=0.0, radius2=0.5 * scale, depth=0.45 * scale)
    bpy.context.object.location = (top[0], top[1], top[2] - 0.225 * scale)


@scene
def jewel_in_metres():
    jewel(0.01)


@scene
def jewel_in_millimetres():
    units = bpy.context.scene.unit_settings
    units.system, units.length_unit, units.scale_length = "METRIC", "MILLIMETERS", 0.001
    jewel(10.0)


@scene
def lake_in_kilometres():
    hdri()
    sun(3.0)
    valley = add("grid", principled("Rock"), x_subdivisions=64, y_subdivisions=64, size=4000.0)
    clouds = bpy.data.textures.new("Hills", "CLOUDS")
    clouds.noise_scale = 1.2
    modifier(valley, "DISPLACE", texture=clouds, strength=600.0, mid_level=0.45)
    add("plane", clear("Lake", IOR=1.33), size=4000.0, location=(0.0, 0.0, 30.0))
    view((0.0, -2600.0, 1400.0), (0.0, 0.0, 0.0))


@scene
def far_from_the_origin():
    studio()
    sphere(clear(), (0.9, 0.0, 1.0), 0.8)
    sphere(chrome(), (-0.9, 0.0, 1.0), 0.8)
    for obj in bpy.context.scene.objects:
        obj.location.x += 20000.0
        obj.location.y -= 8000.0


@scene
def orthographic_product():
    studio(floor=False)
    backdrop = add("plane", principled("Paper", (0.9, 0.9, 0.9)), size=12.0)
    backdrop.name = "Backdrop"
    bottle = add("cylinder", clear("Bottle", (0.5, 0.8, 0.5)), True, radius=0.4, depth=1.8)
    bottle.location.z = 0.95
    modifier(bottle, "BEVEL", width=0.1, segments=4)
    camera = bpy.context.scene.camera.data
    camera.type, camera.ortho_scale = "ORTHO", 4.0


@scene
def bokeh_of_chrome_beads():
    studio()
    for i in range(30):
        angle = 2.4 * i
        radius = 0.25 * math.sqrt(i)
        place = (radius * math.cos(angle), radius * math.sin(angle), 0.15)
        sphere(chrome("Bead", (0.9, 0.7 + 0.01 * i, 0.5)), place, 0.15, 24)
    camera = bpy.context.scene.camera.data
    camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = True, 6.0, 0.3
    spot(300.0, (1.0, 1.5, 4.0), (0.0, 0.0, 0.0))


@scene
def no_light_but_the_world():
    studio(lamp=False, grey=0.8)
    sphere(clear(), (-1.0, 0.0, 1.0), 0.9)
    sphere(nodes.glossy("Glossy", (0.8, 0.8, 0.8), 0.2), (1.0, 0.0, 1.0), 0.9)
