# SPDX-License-Identifier: GPL-3.0-or-later
"""What the made-up scenes are put together from, the way artists do it: Blender's own operators,
modifiers and default settings. For Blender 3.4, so that every later version opens the files."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "blend_scenes"))

from generators import images, maps, nodes, stage

RESOLUTION = 512
SCENES: dict[str, Callable[[], None]] = {}


def scene(build: Callable[[], None]) -> Callable[[], None]:
    """Decorator: the function's name is the file's."""
    SCENES[build.__name__] = build
    return build


def fresh(name: str) -> None:
    """An empty file with Blender's default settings, for Cycles."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    new = bpy.context.scene
    new.name = name
    new.render.engine = "CYCLES"
    new.render.resolution_x = new.render.resolution_y = RESOLUTION
    new.cycles.use_denoising = False


# ------------------------------------------------------------------------------------------ parts


def studio(scale=1.0, lamp=True, floor=True, grey=0.05, target=(0.0, 0.0, 0.8)) -> None:
    """A floor, a camera, a large lamp at the side, and a dim grey world; `scale` in units."""
    if floor:
        add("plane", floor_material(), size=20.0 * scale)
    view((0.0, -6.0 * scale, 3.5 * scale), [scale * value for value in target])
    if lamp:
        position = (3.0 * scale, -2.0 * scale, 4.0 * scale)
        stage.light("Key", "AREA", 400.0 * scale**2, position, (0.0, 0.0, 0.0), scale)
    if grey:
        nodes.world_color((grey, grey, grey), 1.0)


def view(location, target, lens=50.0) -> None:
    """The camera, far enough to see and near enough not to clip."""
    camera = stage.camera(location, target, lens)
    distance = (camera.location - Vector(target)).length
    camera.data.clip_start, camera.data.clip_end = distance * 1e-3, distance * 1e3


def floor_material():
    return principled("Floor", (0.6, 0.55, 0.5), Roughness=0.7)


def add(primitive: str, material=None, smooth=False, **arguments):
    """One of Blender's mesh primitives, by its operator."""
    getattr(bpy.ops.mesh, f"primitive_{primitive}_add")(**arguments)
    return dressed(bpy.context.object, material, smooth)


def dressed(obj, material, smooth=False):
    if material:
        obj.data.materials.append(material)
    if smooth:
        for polygon in obj.data.polygons:
            polygon.use_smooth = True
    return obj


def sphere(material, location=(0.0, 0.0, 1.0), radius=1.0, segments=48):
    return add(
        "uv_sphere",
        material,
        True,
        segments=segments,
        ring_count=segments // 2,
        radius=radius,
        location=location,
    )


def modifier(obj, kind: str, **properties):
    new = obj.modifiers.new(kind.title(), kind)
    for name, value in properties.items():
        setattr(new, name, value)
    return new


# -------------------------------------------------------------------------------------- materials


def principled(name, color=(0.8, 0.8, 0.8), **sockets):
    """Blender's default material; `Base_Color` names the socket `Base Color`."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    node = material.node_tree.nodes["Principled BSDF"]
    node.inputs["Base Color"].default_value = (*color, 1.0)
    for socket, value in sockets.items():
        node.inputs[socket.replace("_", " ")].default_value = value
    return material


def clear(name="Clear", color=(1.0, 1.0, 1.0), **sockets):
    """Principled glass, as most artists make it."""
    return principled(
        name, color, **({"Transmission": 1.0, "Roughness": 0.0, "IOR": 1.45} | sockets)
    )


def chrome(name="Chrome", color=(0.9, 0.9, 0.9), roughness=0.0):
    return principled(name, color, Metallic=1.0, Roughness=roughness)


def gold(roughness=0.05):
    return chrome("Gold", (1.0, 0.77, 0.34), roughness)


def mapped(material, image, scale=1.0, strength=1.0, bump=False):
    """A normal map, or a height map, of an image on the mesh's UV map."""
    tree = material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Scale"].default_value = (scale, scale, scale)
    tree.links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    node = tree.nodes.new("ShaderNodeBump" if bump else "ShaderNodeNormalMap")
    node.inputs["Strength"].default_value = strength
    tree.links.new(texture.outputs["Color"], node.inputs["Height" if bump else "Color"])
    tree.links.new(node.outputs["Normal"], shader(material).inputs["Normal"])
    return material


def shader(material):
    """The node that the surface is linked to."""
    output = next(n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL")
    return output.inputs["Surface"].links[0].from_node


def absorbing(material, color, density):
    """Adds a volume that absorbs."""
    tree = material.node_tree
    volume = tree.nodes.new("ShaderNodeVolumeAbsorption")
    volume.inputs["Color"].default_value = (*color, 1.0)
    volume.inputs["Density"].default_value = density
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    tree.links.new(volume.outputs[0], output.inputs["Volume"])
    return material


def emission(name, color, strength):
    material, graph = nodes.material(name)
    graph.finish(graph.add("ShaderNodeEmission", {"Color": (*color, 1.0), "Strength": strength}))
    return material


def textured(material, kind: str, socket="Base Color", output="Color", **inputs):
    """Links a procedural texture to a socket of the shader."""
    tree = material.node_tree
    node = tree.nodes.new(f"ShaderNodeTex{kind}")
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    tree.links.new(node.outputs[output], shader(material).inputs[socket])
    return material


def normal_image(name, texels, wavelength, slope, seed):
    """Gaussian bumps; `wavelength` as a share of the image."""
    height = maps.gaussian_height(texels, wavelength, slope, seed)
    return images.normal_image(name, maps.normal_map(*maps.spectral_slopes(height)))


# ----------------------------------------------------------------------------------- lights, worlds


def sun(strength=4.0, angle_degrees=0.526, rotation=(40.0, 10.0, 30.0)):
    """Blender's sun; the rotation in degrees, straight down if all are 0."""
    data = bpy.data.lights.new("Sun", "SUN")
    data.energy, data.angle = strength, math.radians(angle_degrees)
    return stage.link("Sun", data, rotation=rotation)


def spot(power, location, target, degrees=40.0, radius=0.02, blend=0.15):
    obj = stage.light("Spot", "SPOT", power, location, target, radius)
    obj.data.spot_size, obj.data.spot_blend = math.radians(degrees), blend
    return obj


def hdri(sun_irradiance=3.0, height=256, direction=(0.4, -0.5, 0.7)):
    """A sky with a sun disc, as downloaded environments have it."""
    radiance = maps.clear_sky(
        height,
        direction,
        math.radians(2.0),
        np.full(3, sun_irradiance),
        (0.25, 0.45, 0.9),
        (0.8, 0.85, 0.9),
        (0.2, 0.18, 0.15),
    )
    return nodes.world_environment(images.radiance_image("sky", radiance))


def room(width=4.0, depth=5.0, height=2.7, window=None, material=None):
    """Walls that face inwards, open to the camera's side; `window` (x0, x1, z0, z1) of the back."""
    w, d, h = width / 2.0, depth / 2.0, height
    sides = [
        [(-w, -d, 0), (w, -d, 0), (w, d, 0), (-w, d, 0)],
        [(-w, -d, h), (-w, d, h), (w, d, h), (w, -d, h)],
        [(-w, -d, 0), (-w, d, 0), (-w, d, h), (-w, -d, h)],
        [(w, -d, 0), (w, -d, h), (w, d, h), (w, d, 0)],
        [(-w, -d, 0), (-w, -d, h), (w, -d, h), (w, -d, 0)],
    ]
    if window:
        x0, x1, z0, z1 = window
        strips = ((-w, x0, 0, h), (x1, w, 0, h), (x0, x1, 0, z0), (x0, x1, z1, h))
    else:
        strips = ((-w, w, 0, h),)
    sides += [[(a, d, low), (b, d, low), (b, d, up), (a, d, up)] for a, b, low, up in strips]
    paint = material or principled("Paint", (0.75, 0.73, 0.7), Roughness=0.6)
    return stage.link("Room", stage.quads("Room", sides, paint))
