# SPDX-License-Identifier: GPL-3.0-or-later
"""Made-up scenes: glass, metal, water and jewellery as artists shade them."""

from __future__ import annotations

import bpy
import numpy as np

from tests.instruments.field._stage import (
    absorbing,
    add,
    chrome,
    clear,
    emission,
    gold,
    images,
    mapped,
    maps,
    modifier,
    nodes,
    normal_image,
    principled,
    scene,
    shader,
    sphere,
    spot,
    stage,
    studio,
    sun,
    textured,
)

# ------------------------------------------------------------------------------------------ glass


def tumbler(material, radius=0.6, height=1.6, wall=0.06):
    """A glass with an inside, by lathe."""
    profile = [(1e-4, 0.02), (radius, 0.02), (radius, height), (radius - wall, height)]
    profile += [(radius - wall, 0.15), (1e-4, 0.15)]
    return stage.link("Tumbler", stage.lathe("Tumbler", profile, 48, material))


def filling(material, radius, height):
    """What is in a tumbler."""
    profile = [(1e-4, 0.15), (radius, 0.15), (radius, height), (1e-4, height)]
    return stage.link("Filling", stage.lathe("Filling", profile, 48, material))


@scene
def water_that_overlaps_its_glass():
    studio()
    tumbler(clear())
    filling(clear("Water", IOR=1.33), 0.57, 1.1)
    add("cube", clear("Ice", IOR=1.31), size=0.4, location=(0.1, 0.0, 1.05), rotation=(0.4, 0.3, 0))


@scene
def water_that_touches_its_glass():
    studio()
    tumbler(clear())
    filling(clear("Water", IOR=1.33), 0.54, 1.1)


@scene
def water_with_a_gap():
    studio()
    tumbler(clear())
    filling(clear("Water", IOR=1.33), 0.535, 1.1)


@scene
def red_wine():
    studio()
    profile = [(1e-4, 0.02), (0.5, 0.02), (0.06, 0.1), (0.06, 0.8), (0.55, 1.2), (0.45, 1.9)]
    profile += [(0.42, 1.9), (0.51, 1.2), (1e-4, 0.9)]
    glass = nodes.glass("Glass", 1.5)
    stage.link("Goblet", stage.lathe("Goblet", profile, 64, glass))
    wine = absorbing(nodes.glass("Wine", 1.34), (0.6, 0.02, 0.05), 8.0)
    inside = [(1e-4, 0.92), (0.5, 1.21), (0.49, 1.5), (1e-4, 1.5)]
    stage.link("Wine", stage.lathe("Wine", inside, 64, wine))


@scene
def nested_glass_balls():
    studio()
    for radius, color in ((1.0, (1.0, 1.0, 1.0)), (0.7, (0.7, 0.9, 1.0)), (0.4, (1.0, 0.6, 0.5))):
        sphere(clear("Shell", color), (0.0, 0.0, 1.02), radius)


@scene
def coloured_solid_glass():
    studio()
    for x, color in ((-1.2, (0.1, 0.3, 0.9)), (1.2, (0.9, 0.5, 0.1))):
        sphere(absorbing(nodes.glass("Solid", 1.5), color, 1.5), (x, 0.0, 1.0), 0.9)


@scene
def frosted_and_polished_glass():
    studio()
    for x, roughness in ((-1.8, 0.0), (0.0, 0.15), (1.8, 0.4)):
        sphere(clear("Frosted", Roughness=roughness), (x, 0.0, 0.9), 0.8)


@scene
def tinted_transmission_and_alpha():
    studio()
    sphere(clear("Half", (0.9, 0.4, 0.2), Transmission=0.5, Roughness=0.1), (-1.1, 0.0, 1.0), 0.9)
    sphere(principled("Half there", (0.2, 0.4, 0.9), Alpha=0.5), (1.1, 0.0, 1.0), 0.9)


@scene
def window_glass_trick():
    """Glass that is transparent to shadow rays, as architects mix it."""
    studio(lamp=False)
    sun()
    material, graph = nodes.material("Architect's glass")
    glass = graph.add("ShaderNodeBsdfGlass", {"Roughness": 0.0, "IOR": 1.45})
    transparent = graph.add("ShaderNodeBsdfTransparent")
    path = graph.add("ShaderNodeLightPath")
    sockets = {0: path.outputs["Is Shadow Ray"], 1: glass.outputs[0], 2: transparent.outputs[0]}
    graph.finish(graph.add("ShaderNodeMixShader", sockets))
    add("cube", material, size=1.4, location=(0.0, 0.0, 0.75))


@scene
def glass_pane_with_fine_normals():
    studio(lamp=False)
    spot(600.0, (0.0, 2.0, 4.0), (0.0, 0.0, 0.5))
    normals = normal_image("ripples", 512, 0.02, 0.2, 5)
    pane = add("plane", mapped(clear("Rippled"), normals, 2.0), size=3.0, location=(0.0, 0.0, 1.2))
    pane.rotation_euler = (0.3, 0.0, 0.0)
    modifier(pane, "SOLIDIFY", thickness=0.05)


@scene
def glass_ball_with_fine_normals():
    studio()
    normals = normal_image("pitted", 1024, 0.01, 0.15, 6)
    sphere(mapped(clear("Pitted"), normals), (0.0, 0.0, 1.0))


@scene
def water_with_a_bump():
    studio(lamp=False, floor=False)
    sun()
    add("plane", principled("Tiles", (0.3, 0.6, 0.7)), size=8.0, location=(0.0, 0.0, -1.0))
    spectrum = maps.ocean_height(256, (0.5, 0.04), 0.6, 0.4, 0.15, 9)
    heights = np.fft.ifft2(spectrum).real
    grey = (heights - heights.min()) / (heights.max() - heights.min())
    image = images.normal_image("heights", np.repeat(grey[..., None], 3, axis=2))
    water = mapped(clear("Water", IOR=1.33), image, 2.0, 0.3, bump=True)
    add("plane", water, size=8.0, location=(0.0, 0.0, 0.0))


@scene
def glass_with_a_procedural_bump():
    studio()
    material = clear("Hammered")
    tree = material.node_tree
    bump = tree.nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value = 0.3
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 12.0
    tree.links.new(noise.outputs["Fac"], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], shader(material).inputs["Normal"])
    sphere(material)


# ------------------------------------------------------------------------------------------ metal


@scene
def brushed_steel_pot():
    studio()
    height = maps.brushed_height(512, 0.3, 0.004, 0.15, 11)
    normals = images.normal_image("brushed", maps.normal_map(*maps.spectral_slopes(height)))
    steel = mapped(chrome("Brushed steel", (0.6, 0.6, 0.62), 0.15), normals, 2.0)
    add("cylinder", steel, True, radius=0.9, depth=1.4, location=(0.0, 0.0, 0.72))


@scene
def glitter_ball():
    studio(lamp=False)
    spot(800.0, (2.0, -3.0, 4.0), (0.0, 0.0, 1.0))
    flakes = normal_image("flakes", 1024, 0.004, 0.3, 12)
    sphere(mapped(chrome("Flakes", (0.8, 0.7, 0.9), 0.1), flakes, 2.0))


@scene
def car_paint():
    studio()
    paint = principled("Car paint", (0.5, 0.02, 0.02), Metallic=0.4, Roughness=0.4, Clearcoat=1.0)
    head = add("monkey", paint, True, size=2.0, location=(0.0, 0.0, 1.0))
    modifier(head, "SUBSURF", render_levels=2)


@scene
def metals_by_roughness():
    studio()
    for i in range(5):
        sphere(chrome(f"Metal {i}", (0.95, 0.8, 0.6), 0.15 * i), (1.1 * (i - 2), 0.0, 0.5), 0.5)


@scene
def gold_ring_on_velvet():
    studio()
    ring = add(
        "torus", gold(0.02), True, major_radius=0.9, minor_radius=0.12, location=(0, 0, 0.15)
    )
    modifier(ring, "SUBSURF", render_levels=1)
    sphere(clear("Ruby", (0.9, 0.05, 0.1), IOR=1.77), (0.9, 0.0, 0.4), 0.25)


@scene
def concave_mirror():
    studio()
    dish = add("grid", chrome(), True, x_subdivisions=48, y_subdivisions=48, size=2.0)
    for vertex in dish.data.vertices:
        vertex.co.z = 0.3 * (vertex.co.x**2 + vertex.co.y**2)
    dish.location, dish.rotation_euler = (0.0, 0.8, 1.2), (1.1, 0.0, 0.0)


# --------------------------------------------------------------------------------- other materials


@scene
def plastic_and_rubber():
    studio()
    for i, roughness in enumerate((0.05, 0.3, 0.6, 1.0)):
        color = (0.1 + 0.2 * i, 0.3, 0.8 - 0.2 * i)
        sphere(
            principled(f"Plastic {i}", color, Roughness=roughness), (1.3 * (i - 1.5), 0, 0.6), 0.6
        )


@scene
def skin_and_wax():
    studio()
    wax = principled("Wax", (0.9, 0.7, 0.5), Subsurface=0.5, Roughness=0.4)
    head = add("monkey", wax, True, size=2.0, location=(0.0, 0.0, 1.0))
    modifier(head, "SUBSURF", render_levels=2)


@scene
def cloth_lampshade():
    studio(lamp=False)
    material, graph = nodes.material("Cloth")
    graph.finish(graph.add("ShaderNodeBsdfTranslucent", {"Color": (0.9, 0.8, 0.6, 1.0)}))
    shade = add(
        "cone", material, True, radius1=0.9, radius2=0.5, depth=1.0, end_fill_type="NOTHING"
    )
    shade.location.z = 1.3
    stage.light("Bulb", "POINT", 60.0, (0.0, 0.0, 1.3), size=0.05)


@scene
def checkered_floor_and_marble():
    studio(floor=False)
    floor = textured(principled("Checker", Roughness=0.2), "Checker", Scale=8.0)
    add("plane", floor, size=20.0)
    marble = textured(principled("Marble", Roughness=0.1), "Noise", Scale=4.0, Detail=6.0)
    sphere(marble, (-1.1, 0.0, 1.0), 0.9)
    sphere(chrome(), (1.1, 0.0, 1.0), 0.9)


@scene
def leaves_with_alpha():
    studio(lamp=False)
    sun()
    tree_image = images.color_image(
        "leaf", maps.tiles(128, 4, [(1, 1, 1), (0, 0, 0)], (0, 0, 0), 0, 0, 3)
    )
    material = principled("Leaf", (0.1, 0.5, 0.1))
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = tree_image
    material.node_tree.links.new(texture.outputs["Color"], shader(material).inputs["Alpha"])
    for i in range(4):
        leaf = add("plane", material, size=1.5, location=(0.8 * (i - 1.5), 0.1 * i, 1.0 + 0.2 * i))
        leaf.rotation_euler = (0.5, 0.2 * i, 0.3 * i)


@scene
def neon_sign():
    studio(lamp=False, grey=0.01)
    for x, color in ((-0.8, (1.0, 0.1, 0.3)), (0.8, (0.1, 0.6, 1.0))):
        ring = add(
            "torus", emission("Neon", color, 15.0), True, major_radius=0.6, minor_radius=0.04
        )
        ring.location, ring.rotation_euler = (x, 0.5, 1.1), (1.5, 0.0, 0.0)
    sphere(clear(), (0.0, -0.6, 0.5), 0.5)


@scene
def smoke_in_a_jar():
    studio()
    tumbler(clear())
    material = bpy.data.materials.new("Smoke")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    smoke = tree.nodes.new("ShaderNodeVolumePrincipled")
    smoke.inputs["Density"].default_value = 2.0
    tree.links.new(smoke.outputs[0], output.inputs["Volume"])
    add("uv_sphere", material, radius=0.45, location=(0.0, 0.0, 0.8))
