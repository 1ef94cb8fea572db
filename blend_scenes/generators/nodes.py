# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials and worlds, from the shader nodes that Specula supports."""

import bpy


class Graph:
    """A thin layer over a node tree: `add` makes a node, sets its properties, fills its sockets."""

    def __init__(self, owner):
        owner.use_nodes = True
        self.tree = owner.node_tree
        self.tree.nodes.clear()

    def add(self, kind, sockets=None, column=0, row=0, **properties):
        """Add a node; `sockets` maps an input's name or index to a value or to an output socket."""
        node = self.tree.nodes.new(kind)
        node.location = (260.0 * column, -320.0 * row)
        for name, value in properties.items():
            setattr(node, name, value)
        for name, value in (sockets or {}).items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[name])
            else:
                node.inputs[name].default_value = value
        return node

    def image(self, image, vector=None, column=-2, row=0):
        """Colour output of an Image Texture: linear interpolation, repeated."""
        sockets = {} if vector is None else {"Vector": vector}
        node = self.add("ShaderNodeTexImage", sockets, column, row, extension="REPEAT")
        node.image = image
        return node.outputs["Color"]

    def uv(self, column=-4, row=0):
        """The mesh's UV map, through a UV Map node."""
        return self.add("ShaderNodeUVMap", None, column, row, uv_map="UVMap").outputs["UV"]

    def scaled_uv(self, scale, row=0):
        """The mesh's UV map, `scale` = (x, y) times, by Texture Coordinate and Mapping nodes."""
        uv = self.add("ShaderNodeTexCoord", None, -4, row).outputs["UV"]
        sockets = {"Vector": uv, "Scale": (scale[0], scale[1], 1.0)}
        return self.add("ShaderNodeMapping", sockets, -3, row).outputs["Vector"]

    def normal_map(self, image, vector, row=1):
        """Normal output of a tangent-space Normal Map node of strength 1."""
        color = self.image(image, vector, -2, row)
        sockets = {"Color": color, "Strength": 1.0}
        node = self.add("ShaderNodeNormalMap", sockets, -1, row, space="TANGENT", uv_map="UVMap")
        return node.outputs["Normal"]

    def finish(self, node, column=1):
        """Link a closure node to the material's output."""
        self.add("ShaderNodeOutputMaterial", {"Surface": node.outputs[0]}, column)


def material(name):
    """A new material and its empty graph."""
    data = bpy.data.materials.new(name)
    return data, Graph(data)


def rgba(color):
    """A colour socket's value from three linear components."""
    return (*color, 1.0)


def diffuse(name, color):
    """Diffuse BSDF; `color` is three linear components."""
    data, graph = material(name)
    graph.finish(graph.add("ShaderNodeBsdfDiffuse", {"Color": rgba(color), "Roughness": 0.0}))
    data.diffuse_color = rgba(color)
    return data


def diffuse_texture(name, image, scale=(1.0, 1.0)):
    """Diffuse BSDF with an image, repeated `scale` times over the UV map."""
    data, graph = material(name)
    color = graph.image(image, graph.scaled_uv(scale), -1)
    graph.finish(graph.add("ShaderNodeBsdfDiffuse", {"Color": color, "Roughness": 0.0}))
    return data


def principled(name, color, roughness, metallic=0.0, normal=None, specular=0.5):
    """Principled BSDF with its colour, roughness and metal only.

    `normal` is a pair (normal-map image, scale) or None.
    """
    data, graph = material(name)
    sockets = {
        "Base Color": rgba(color),
        "Metallic": metallic,
        "Roughness": roughness,
        "Specular": specular,
        "Sheen Tint": 0.0,
        "Clearcoat Roughness": 0.0,
    }
    if normal is not None:
        image, scale = normal
        sockets["Normal"] = graph.normal_map(image, graph.scaled_uv(scale, 1))
    node = graph.add("ShaderNodeBsdfPrincipled", sockets, distribution="GGX")
    graph.finish(node)
    data.diffuse_color = rgba(color)
    data.metallic, data.roughness = metallic, roughness
    return data


def glossy(name, color, roughness, distribution="GGX"):
    """Glossy BSDF."""
    data, graph = material(name)
    sockets = {"Color": rgba(color), "Roughness": roughness}
    graph.finish(graph.add("ShaderNodeBsdfGlossy", sockets, distribution=distribution))
    data.diffuse_color, data.metallic, data.roughness = rgba(color), 1.0, roughness
    return data


def glass(name, ior, normal=None, color=(1.0, 1.0, 1.0), scale=None):
    """Smooth Glass BSDF.

    `normal` is a normal-map image or None, repeated `scale` times (None: once, by a UV Map node).
    """
    data, graph = material(name)
    sockets = {"Color": rgba(color), "Roughness": 0.0, "IOR": ior}
    if normal is not None:
        vector = graph.uv(-3, 1) if scale is None else graph.scaled_uv(scale, 1)
        sockets["Normal"] = graph.normal_map(normal, vector)
    # 3.4 also has a 'SHARP' distribution; GGX at roughness 0 is the same in every version.
    graph.finish(graph.add("ShaderNodeBsdfGlass", sockets, distribution="GGX"))
    return data


def world_color(color, strength):
    """A world of one colour."""
    world, graph = _world()
    node = graph.add("ShaderNodeBackground", {"Color": rgba(color), "Strength": strength})
    graph.add("ShaderNodeOutputWorld", {"Surface": node.outputs[0]}, 1)
    return world


def world_environment(image, strength=1.0):
    """A world lit by an equirectangular environment map, through a Mapping node."""
    world, graph = _world()
    coordinates = graph.add("ShaderNodeTexCoord", None, -3).outputs["Generated"]
    vector = graph.add("ShaderNodeMapping", {"Vector": coordinates}, -2).outputs["Vector"]
    texture = graph.add("ShaderNodeTexEnvironment", {"Vector": vector}, -1)
    texture.image = image
    sockets = {"Color": texture.outputs["Color"], "Strength": strength}
    node = graph.add("ShaderNodeBackground", sockets)
    graph.add("ShaderNodeOutputWorld", {"Surface": node.outputs[0]}, 1)
    return world


def _world():
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    return world, Graph(world)
