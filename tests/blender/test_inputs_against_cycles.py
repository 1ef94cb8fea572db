# SPDX-License-Identifier: GPL-3.0-or-later
"""What nodes read of a mesh, an object and a ray is what they read in Cycles, in this Blender."""

import math

import bpy
import numpy as np
import pytest
import tiles
from scenes import add_mesh, add_node, new_material

from specula.export.nodes_input import INPUT_NODES

COLUMNS = 14
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
    for layer, (a, b, c, d) in {
        "first": (0.3, 0.2, -0.1, 0.4),
        "second": (0.5, 0, 0.1, 0.4),
    }.items():
        uv = mesh.uv_layers.new(name=layer)
        for loop in mesh.loops:
            x, y, _ = mesh.vertices[loop.vertex_index].co
            uv.data[loop.index].uv = (0.5 + a * x + b * y, 0.5 + c * x + d * y)
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


def outputs_of(kind: str) -> tuple[str, ...]:
    """All that Specula has of an input node."""
    return INPUT_NODES[f"ShaderNode{kind}"].outputs


# What a mesh has nothing of.
ABSENT = {
    "HairInfo": ("Is Strand", "Intercept", "Length", "Thickness", "Random"),
    "PointInfo": ("Radius", "Random"),
    "VolumeInfo": outputs_of("VolumeInfo"),
}


def cases():
    """Name -> node type, properties, inputs, identifier of the output."""
    found = {}

    def add(name, kind, output, inputs=None, **properties):
        found[name] = (f"ShaderNode{kind}", properties, inputs or {}, output)

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
    for output in outputs_of("ObjectInfo"):
        add(f"object {output}", "ObjectInfo", output)
    for output in ("Object", "Camera", "Window", "Reflection", "Normal"):
        add(f"coordinate {output}", "TexCoord", output)
    add("coordinate of another", "TexCoord", "Object", object="Other")
    for output in outputs_of("CameraData"):
        add(f"camera {output}", "CameraData", output)
    for output in ("Tangent", "Parametric", "Position", "Normal", "True Normal", "Incoming"):
        add(f"geometry {output}", "NewGeometry", output)
    for axis in "XYZ":
        add(f"tangent {axis}", "Tangent", "Tangent", axis=axis)
    for layer in ("", "first"):
        along = {"direction_type": "UV_MAP", "uv_map": layer}
        add(f"tangent of {layer}", "Tangent", "Tangent", **along)
    for meaning in ("VECTOR", "POINT", "NORMAL"):
        for one in ("WORLD", "OBJECT", "CAMERA"):
            for other in ("WORLD", "OBJECT", "CAMERA"):
                spaces = {"vector_type": meaning, "convert_from": one, "convert_to": other}
                add(f"transform {meaning} {one} {other}", "VectorTransform", "Vector", **spaces)
    for size in (0.02, 0.2):
        add(f"wireframe {size}", "Wireframe", "Fac", inputs={"Size": size})
    for temperature in (500, 800, 900, 1200, 1700, 2500, 5000, 6500, 9000, 13000):
        add(f"{temperature} K", "Blackbody", "Color", inputs={"Temperature": temperature})
    for wavelength in (370, 380, 433, 501, 550, 580, 612, 650, 700, 790):
        add(f"{wavelength} nm", "Wavelength", "Color", inputs={"Wavelength": wavelength})
    for output in outputs_of("LightPath"):
        add(f"ray {output}", "LightPath", output)
    for output in outputs_of("LightFalloff"):
        for smooth in (0.0, 2.0):
            strength = {"Strength": 0.3, "Smooth": smooth}
            add(f"falloff {output} {smooth}", "LightFalloff", output, inputs=strength)
    for kind, outputs in ABSENT.items():
        for output in outputs:
            add(f"{kind} {output}", kind, output)
    for projection in ("FLAT", "BOX", "SPHERE", "TUBE"):
        for output in ("Color", "Alpha"):
            picture = {
                "projection": projection,
                "image": "Picture" if output == "Color" else "Clear",
            }
            add(f"{projection} {output}", "TexImage", output, **picture)
    for blend in (0.2, 1.0):
        box = {"projection": "BOX", "projection_blend": blend, "image": "Picture"}
        add(f"box {blend}", "TexImage", "Color", **box)
    for output in ("Color", "Alpha"):
        add(f"tiles {output}", "TexImage", output, image="Tiles", inputs={"Vector": "wide"})
    for space in ("OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD", "TANGENT"):
        color = {"Color": (0.7, 0.3, 0.8, 1.0), "Strength": 0.7}
        add(f"normal map {space}", "NormalMap", "Normal", space=space, inputs=color)
    add("checker unlinked", "TexChecker", "Color")
    add("noise unlinked", "TexNoise", "Color")
    return found


def find_socket(sockets, name):
    names = (name, "Factor") if name == "Fac" else (name,)
    return next((socket for socket in sockets if socket.identifier in names), None)


def add_tile(index, case):
    """A tile of the picture; False where this Blender has no such node, property or output."""
    kind, properties, inputs, output = case
    if not hasattr(bpy.types, kind):
        return False
    material = new_material()
    material.pass_index = 3
    node = add_node(material, kind)
    if any(not hasattr(node, name) for name in properties) or not find_socket(node.outputs, output):
        return False
    for name, value in properties.items():
        if name == "object":
            value = bpy.data.objects[value]
        elif name == "image":
            value = bpy.data.images[value]
        setattr(node, name, value)
    for name, value in inputs.items():
        if value == "wide":  # x and y from 0 to 3
            at = add_node(material, "ShaderNodeVectorMath", operation="MULTIPLY_ADD")
            at.inputs[1].default_value, at.inputs[2].default_value = (1.5, 1.5, 0), (1.5, 1.5, 0)
            coordinates = add_node(material, "ShaderNodeTexCoord")
            material.node_tree.links.new(coordinates.outputs["Object"], at.inputs[0])
            material.node_tree.links.new(at.outputs[0], find_socket(node.inputs, name))
        else:
            find_socket(node.inputs, name).default_value = value
    tiles.show(material, find_socket(node.outputs, output))
    tiles.place(furnished(f"Tile {index}", material), index, COLUMNS)
    return True


def save_picture(path, seed: int, opaque: bool = True) -> None:
    """A file of 4 x 4 random colours, and alphas."""
    image = bpy.data.images.new("Saved", 4, 4, alpha=True, float_buffer=True)
    pixels = np.random.default_rng(seed).random((16, 4)).astype(np.float32)
    if opaque:
        pixels[:, 3] = 1.0
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = str(path), "OPEN_EXR"
    image.save()
    bpy.data.images.remove(image)


def load_pictures(folder) -> None:
    """'Picture', 'Clear', and 'Tiles' with three of the nine that the tile `wide` shows."""
    for name in ("Picture", "Clear"):
        save_picture(folder / f"{name}.exr", 1, opaque=name == "Picture")
        image = bpy.data.images.load(str(folder / f"{name}.exr"))
        image.name, image.colorspace_settings.name = name, "Non-Color"
    for seed, number in enumerate((1001, 1003, 1012)):
        save_picture(folder / f"tiles.{number}.exr", seed)
    tiled = bpy.data.images.load(str(folder / "tiles.1001.exr"))
    tiled.name, tiled.source = "Tiles", "TILED"
    tiled.colorspace_settings.name = "Non-Color"
    tiled.filepath = str(folder / "tiles.<UDIM>.exr")
    for number in (1003, 1012):
        if tiled.tiles.get(number) is None:
            tiled.tiles.new(number)


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    bpy.ops.wm.read_homefile(use_empty=True)
    load_pictures(tmp_path_factory.mktemp("pictures"))
    other = bpy.data.objects.new("Other", None)
    bpy.context.scene.collection.objects.link(other)
    other.location, other.rotation_euler, other.scale = (1, 2, 3), (0.3, 0.7, 1.1), (2, 1, 0.5)
    bpy.context.view_layer.update()
    placed = []
    for name, case in cases().items():
        if add_tile(len(placed), case):
            placed.append(name)
    bpy.context.scene["scene"], bpy.context.view_layer["layer"] = (0.3, 0.7), 0.8
    return tiles.pictures(placed, COLUMNS, tmp_path_factory.mktemp("tiles"))


# What is not yet as in Cycles (docs/limits.md).
FAILING_IN_3_4 = {f"attribute group {output}" for output in ("Color", "Vector", "Fac")} | {
    f"transform NORMAL {space} {space}" for space in ("WORLD", "OBJECT", "CAMERA")
}


@pytest.mark.parametrize("name", cases())
def test_input(pictures, name):
    if name not in pictures:
        pytest.skip("not in this Blender")
    if bpy.app.version < (4, 0) and name in FAILING_IN_3_4:
        with pytest.raises(AssertionError):
            tiles.assert_same(*pictures[name])
        pytest.xfail("listed as failing")
    tiles.assert_same(*pictures[name])
