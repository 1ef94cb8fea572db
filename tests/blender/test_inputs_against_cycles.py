# SPDX-License-Identifier: GPL-3.0-or-later
"""What nodes read of a mesh, an object and a ray is what they read in Cycles, in this Blender."""

import math

import bpy
import numpy as np
import pytest
import tiles
from scenes import add_mesh, add_node, new_material

COLUMNS = 8
# Faces of 4 x 4 on either side of a gap, bent, so that there are two islands and no vertex is flat.
SIDES = ((-0.95, -0.05), (0.05, 0.95))
STEPS = 5


def patches():
    """Vertices and faces of the two sides."""
    vertices, faces = [], []
    for low, high in SIDES:
        first = len(vertices)
        for y in np.linspace(-0.95, 0.95, STEPS):
            for x in np.linspace(low, high, STEPS):
                vertices.append((x, y, 0.2 * math.sin(3 * x + 1) * math.cos(2.3 * y)))
        for j in range(STEPS - 1):
            for i in range(STEPS - 1):
                corner = first + STEPS * j + i
                faces.append((corner, corner + 1, corner + STEPS + 1, corner + STEPS))
    return vertices, faces


# Name -> type, domain, property of an element, number of components.
ATTRIBUTES = {
    "bytes": ("BYTE_COLOR", "CORNER", "color", 4),
    "floats": ("FLOAT_COLOR", "POINT", "color", 4),
    "height": ("FLOAT", "POINT", "value", 1),
    "number": ("INT", "FACE", "value", 1),
    "flag": ("BOOLEAN", "FACE", "value", 1),
    "arrow": ("FLOAT_VECTOR", "CORNER", "vector", 3),
    "pair": ("FLOAT2", "CORNER", "vector", 2),
    "edge": ("FLOAT", "EDGE", "value", 1),
}


def furnished(name, material):
    """A mesh object with two UV layers, the attributes, a vertex group and a deforming modifier."""
    obj = add_mesh(name, *patches(), material=material)
    mesh, dice = obj.data, np.random.default_rng(5)
    for layer in ("first", "second"):
        uv = mesh.uv_layers.new(name=layer)
        uv.data.foreach_set("uv", dice.random(2 * len(mesh.loops)).astype(np.float32))
    mesh.uv_layers["second"].active_render = True
    for key, (kind, domain, field, components) in ATTRIBUTES.items():
        made = mesh.attributes.new(key, kind, domain)
        values = dice.random(components * len(made.data))
        dtype = {"INT": np.int32, "BOOLEAN": bool}.get(kind, np.float32)
        if dtype != np.float32:
            values = 7 * (values > 0.5)
        made.data.foreach_set(field, values.astype(dtype))
    mesh.color_attributes.render_color_index = mesh.color_attributes.find("floats")
    group = obj.vertex_groups.new(name="group")
    for vertex in mesh.vertices:
        group.add([vertex.index], vertex.co.x * 0.4 + 0.5, "REPLACE")
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    twist = obj.modifiers.new("Twist", "SIMPLE_DEFORM")
    twist.deform_method, twist.angle = "BEND", 0.4
    obj.color, obj.pass_index = (0.9, 0.4, 0.2, 0.7), 5
    obj["weight"], obj["arrow"] = 0.6, (0.1, 0.5, 0.9)
    mesh["of the mesh"] = 4
    return obj


def cases():
    """Name -> node type, properties, identifier of the output."""
    found = {}

    def add(name, kind, output, **properties):
        found[name] = (f"ShaderNode{kind}", properties, output)

    for key in (*ATTRIBUTES, "second", "first", "group", "nowhere", ""):
        # Of two numbers Cycles' Fac is the first one, ours the mean of three.
        factor = () if key in ("pair", "first", "second") else ("Fac",)
        for output in ("Color", "Vector", *factor, "Alpha"):
            add(f"attribute {key} {output}", "Attribute", output, attribute_name=key)
    for key in ("weight", "arrow", "of the mesh", "pass_index", "color", "nowhere"):
        for domain in ("OBJECT", "INSTANCER"):
            add(
                f"attribute {domain} {key}",
                "Attribute",
                "Color",
                attribute_name=key,
                attribute_type=domain,
            )
    for key in ("layer", "scene", "nowhere"):
        add(
            f"view layer {key}",
            "Attribute",
            "Color",
            attribute_name=key,
            attribute_type="VIEW_LAYER",
        )
    for layer in ("", "bytes", "floats"):
        for output in ("Color", "Alpha"):
            add(f"color {layer} {output}", "VertexColor", output, layer_name=layer)
    for layer in ("", "first"):
        add(f"uv {layer}", "UVMap", "UV", uv_map=layer)
    for output in ("Generated", "UV"):
        for instancer in (False, True):
            add(f"{output} {instancer}", "TexCoord", output, from_instancer=instancer)
    for output in ("Pointiness", "Random Per Island"):
        add(output, "NewGeometry", output)
    for output in ("Location", "Color", "Alpha", "Object Index", "Material Index", "Random"):
        add(f"object {output}", "ObjectInfo", output)
    add("checker unlinked", "TexChecker", "Color")
    add("noise unlinked", "TexNoise", "Color")
    return found


def find_socket(sockets, name):
    names = (name, "Factor") if name == "Fac" else (name,)
    return next((socket for socket in sockets if socket.identifier in names), None)


def add_tile(index, case):
    """A tile of the picture; False where this Blender has no such node, property or output."""
    kind, properties, output = case
    if not hasattr(bpy.types, kind):
        return False
    material = new_material()
    material.pass_index = 3
    node = add_node(material, kind)
    if any(not hasattr(node, name) for name in properties) or not find_socket(node.outputs, output):
        return False
    for name, value in properties.items():
        setattr(node, name, value)
    tiles.show(material, find_socket(node.outputs, output))
    tiles.place(furnished(f"Tile {index}", material), index, COLUMNS)
    return True


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    bpy.ops.wm.read_homefile(use_empty=True)
    placed = []
    for name, case in cases().items():
        if add_tile(len(placed), case):
            placed.append(name)
    bpy.context.scene["scene"], bpy.context.view_layer["layer"] = (0.3, 0.7), 0.8
    return tiles.pictures(placed, COLUMNS, tmp_path_factory.mktemp("tiles"))


@pytest.mark.parametrize("name", cases())
def test_input(pictures, name):
    if name not in pictures:
        pytest.skip("not in this Blender")
    tiles.assert_same(*pictures[name])
