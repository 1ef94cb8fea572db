# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that compute values give what they give in Cycles, in this Blender.

Each case is a glowing tile that shows what one node makes of coordinates that vary over the tile.
"""

import bpy
import pytest
import tiles
from scenes import add_mesh, add_node, new_material

from specula.export.nodes import NODES

COLUMNS = 12
MATH = ("x", "y", 0.4)
UNARY = [
    "SQRT",
    "INVERSE_SQRT",
    "ABSOLUTE",
    "EXPONENT",
    "SIGN",
    "ROUND",
    "FLOOR",
    "CEIL",
    "TRUNC",
    "FRACT",
    "SINE",
    "COSINE",
    "TANGENT",
    "ARCSINE",
    "ARCCOSINE",
    "ARCTANGENT",
    "SINH",
    "COSH",
    "TANH",
    "RADIANS",
    "DEGREES",
]
BINARY = [
    "ADD",
    "SUBTRACT",
    "MULTIPLY",
    "DIVIDE",
    "POWER",
    "LOGARITHM",
    "MINIMUM",
    "MAXIMUM",
    "LESS_THAN",
    "GREATER_THAN",
    "MODULO",
    "FLOORED_MODULO",
    "SNAP",
    "PINGPONG",
    "ARCTAN2",
]
TERNARY = ["MULTIPLY_ADD", "COMPARE", "SMOOTH_MIN", "SMOOTH_MAX", "WRAP"]
VECTOR = [
    "ADD",
    "SUBTRACT",
    "MULTIPLY",
    "DIVIDE",
    "CROSS_PRODUCT",
    "PROJECT",
    "REFLECT",
    "NORMALIZE",
    "ABSOLUTE",
    "MINIMUM",
    "MAXIMUM",
    "FLOOR",
    "CEIL",
    "FRACTION",
    "MODULO",
    "SNAP",
    "SINE",
    "COSINE",
    "TANGENT",
    "MULTIPLY_ADD",
    "FACEFORWARD",
    "WRAP",
    "SCALE",
    "REFRACT",
]
GRADIENTS = NODES["ShaderNodeTexGradient"].options["gradient_type"]
DIMENSIONS = NODES["ShaderNodeTexNoise"].options["noise_dimensions"]
FRACTALS = NODES["ShaderNodeTexNoise"].options["noise_type"]
FEATURES = NODES["ShaderNodeTexVoronoi"].options["feature"]
METRICS = NODES["ShaderNodeTexVoronoi"].options["distance"]
VORONOI_POSITIONS = {
    "1D": ("W",),
    "2D": ("Position",),
    "3D": ("Position",),
    "4D": ("Position", "W"),
}
BLENDS = NODES["ShaderNodeMixRGB"].options["blend_type"]


def cases():
    """Name -> node type, properties, inputs by identifier, identifier of the output."""
    found = {}

    def add(name, kind, output, inputs, **properties):
        found[name] = (f"ShaderNode{kind}", properties, inputs, output)

    for operation in UNARY + BINARY + TERNARY:
        inputs = dict(zip(("Value", "Value_001", "Value_002"), MATH, strict=True))
        add(f"math {operation}", "Math", "Value", inputs, operation=operation)
    add("math clamped", "Math", "Value", {"Value": "x", "Value_001": 0.3}, use_clamp=True)
    vectors = {
        "Vector": "color",
        "Vector_001": "other",
        "Vector_002": (0.3, -0.2, 0.4),
        "Scale": 0.7,
    }
    for operation in VECTOR:
        add(f"vector {operation}", "VectorMath", "Vector", vectors, operation=operation)
    for operation in ("DOT_PRODUCT", "DISTANCE", "LENGTH"):
        add(f"vector {operation}", "VectorMath", "Value", vectors, operation=operation)
    for blend in BLENDS:
        old = {"Fac": 0.7, "Color1": "color", "Color2": "other"}
        add(f"old {blend}", "MixRGB", "Color", old, blend_type=blend)
        new = {"Factor_Float": "x", "A_Color": "color", "B_Color": "other"}
        for clamps in (False, True):
            add(
                f"mix {blend} {clamps}",
                "Mix",
                "Result_Color",
                new,
                data_type="RGBA",
                blend_type=blend,
                clamp_factor=not clamps,
                clamp_result=clamps,
            )
    add("mix float", "Mix", "Result_Float", {"Factor_Float": "x", "A_Float": "y", "B_Float": 0.3})
    add(
        "mix vector",
        "Mix",
        "Result_Vector",
        {"Factor_Vector": "color", "A_Vector": "other", "B_Vector": (0.1, 0.7, 0.3)},
        data_type="VECTOR",
        factor_mode="NON_UNIFORM",
    )
    ranges = {"Value": "x", "From Min": -0.8, "From Max": 0.9, "To Min": 1.2, "To Max": 0.1}
    boxes = {"Vector": "color", "From_Min_FLOAT3": (0.1, 0.3, 0.9), "To_Max_FLOAT3": "other"}
    for interpolation in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP"):
        for clamp in (False, True):
            properties = {"interpolation_type": interpolation, "clamp": clamp}
            name = f"range {interpolation} {clamp}"
            add(name, "MapRange", "Result", ranges, **properties)
            add(
                f"vector {name}",
                "MapRange",
                "Vector",
                boxes,
                data_type="FLOAT_VECTOR",
                **properties,
            )
    add("range of one value", "MapRange", "Result", {"Value": "x", "From Min": 1.0, "To Min": 0.4})
    for type in ("MINMAX", "RANGE"):
        add(
            f"clamp {type}",
            "Clamp",
            "Result",
            {"Value": "x", "Min": 0.5, "Max": "y"},
            clamp_type=type,
        )
    for mode in ("RGB", "HSV", "HSL"):
        for channel in ("Red", "Green", "Blue"):
            add(f"{channel} of {mode}", "SeparateColor", channel, {"Color": "color"}, mode=mode)
        parts = {"Red": "x", "Green": "y", "Blue": 0.4}
        add(f"from {mode}", "CombineColor", "Color", parts, mode=mode)
    for axis in "XYZ":
        add(f"{axis} of a vector", "SeparateXYZ", axis, {"Vector": "color"})
    add("combined", "CombineXYZ", "Vector", {"X": "x", "Y": "y", "Z": 0.3})
    turn = {"Vector": "color", "Center": (0.2, 0.1, 0), "Axis": "other", "Angle": "x"}
    for type in ("AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS"):
        add(f"turned {type}", "VectorRotate", "Vector", turn, rotation_type=type)
        add(f"turned back {type}", "VectorRotate", "Vector", turn, rotation_type=type, invert=True)
    euler = {"Vector": "color", "Rotation": "other"}
    for invert in (False, True):
        add(
            f"turned EULER {invert}",
            "VectorRotate",
            "Vector",
            euler,
            rotation_type="EULER_XYZ",
            invert=invert,
        )
    add("grey", "RGBToBW", "Val", {"Color": "color"})
    add("inverted", "Invert", "Color", {"Fac": 0.7, "Color": "color"})
    add("gamma", "Gamma", "Color", {"Color": "color", "Gamma": 2.2})
    add("no gamma", "Gamma", "Color", {"Color": "color", "Gamma": 0.0})
    contrast = {"Color": "color", "Bright": "x", "Contrast": 0.6}
    add("contrast", "BrightContrast", "Color", contrast)
    hue = {"Hue": 0.8, "Saturation": 1.4, "Value": 0.9, "Fac": 0.8, "Color": "color"}
    add("hue", "HueSaturation", "Color", hue)
    for normal in ("bent", None):
        inputs = {"Normal": normal} if normal else {}
        add(f"fresnel {normal}", "Fresnel", "Fac", {"IOR": 1.4, **inputs})
        for output in ("Fresnel", "Facing"):
            for blend in (0.2, 0.8):
                name = f"{output} {blend} {normal}"
                add(name, "LayerWeight", output, {"Blend": blend, **inputs})
    for output in ("Position", "Normal", "True Normal", "Incoming", "Backfacing"):
        add(f"geometry {output}", "NewGeometry", output, {})
    for interpolation in ("LINEAR", "EASE", "B_SPLINE", "CARDINAL", "CONSTANT"):
        add(f"ramp {interpolation}", "ValToRGB", "Color", {"Fac": "x"}, ramp=interpolation)
    for extend in ("HORIZONTAL", "EXTRAPOLATED"):
        color, vector = {"Fac": 0.8, "Color": "color"}, {"Fac": 0.8, "Vector": "color"}
        add(f"rgb curves {extend}", "RGBCurve", "Color", color, curves=extend)
        add(f"vector curves {extend}", "VectorCurve", "Vector", vector, curves=extend)
        value = {"Factor": 0.8, "Value": "x"}
        add(f"float curve {extend}", "FloatCurve", "Value", value, curves=extend)
    for output in ("Normal", "Dot"):
        add(f"normal node {output}", "Normal", output, {"Normal": "other"}, direction=(0.6, 0, 0.8))
    add("ramp's alpha", "ValToRGB", "Alpha", {"Fac": "x"}, ramp="LINEAR")
    add("ramp through hues", "ValToRGB", "Color", {"Fac": "x"}, ramp="HSV")
    for kind, channels in (("RGB", "RGB"), ("HSV", "HSV")):
        source = {"Image" if kind == "RGB" else "Color": "color"}
        for channel in channels:
            add(f"old {channel} of {kind}", f"Separate{kind}", channel, source)
        parts = dict(zip(channels, ("x", "y", 0.5), strict=True))
        add(f"old from {kind}", f"Combine{kind}", "Image" if kind == "RGB" else "Color", parts)
    add_textures(add)
    return found


def add_textures(add):
    """Of the procedural textures all types, features and metrics, and all dimensions of each."""
    colors = {"Color1": (0.9, 0.2, 0.1), "Color2": (0.2, 0.4, 0.9)}
    at = {"Vector": "place"}
    for output in ("Color", "Fac"):
        add(f"checker {output}", "TexChecker", output, {**at, **colors, "Scale": 1.7})
    for type in GRADIENTS:
        add(f"gradient {type}", "TexGradient", "Fac", {"Vector": "place"}, gradient_type=type)
    for dimensions in DIMENSIONS:
        whole = {"Vector": "cells", "W": "cell"}
        for output in ("Value", "Color"):
            name = f"white noise {dimensions} {output}"
            add(name, "TexWhiteNoise", output, whole, noise_dimensions=dimensions)
        space = {"Vector": "place", "W": "x", "Scale": 1.3}
        noise = {**space, "Detail": 1.6, "Roughness": 0.6}
        add(f"noise {dimensions}", "TexNoise", "Fac", noise, noise_dimensions=dimensions)
        bent = {**noise, "Distortion": 0.7}
        name = f"noise {dimensions} bent"
        add(name, "TexNoise", "Color", bent, noise_dimensions=dimensions)
        for type in FRACTALS:
            fractal = {**noise, "Lacunarity": 2.2, "Offset": 0.6, "Gain": 1.2}
            properties = {"noise_dimensions": dimensions, "noise_type": type, "normalize": False}
            add(f"noise {dimensions} {type}", "TexNoise", "Fac", fractal, **properties)
            old = {**space, "Detail": 2.6, "Dimension": 0.9, "Offset": 0.6, "Gain": 1.2}
            properties = {"musgrave_dimensions": dimensions, "musgrave_type": type}
            add(f"musgrave {dimensions} {type}", "TexMusgrave", "Fac", old, **properties)
        for feature in FEATURES:
            sphere = feature == "N_SPHERE_RADIUS"
            metrics = ("EUCLIDEAN",) if sphere or feature == "DISTANCE_TO_EDGE" else METRICS
            for metric in metrics:
                outputs = ("Radius",) if sphere else ("Distance",)
                if metric == "EUCLIDEAN" and len(metrics) > 1:
                    outputs = ("Distance", "Color", *VORONOI_POSITIONS[dimensions])
                for output in outputs:
                    add(
                        f"voronoi {dimensions} {feature} {metric} {output}",
                        "TexVoronoi",
                        output,
                        {**space, "Smoothness": 0.6, "Exponent": 1.4, "Randomness": 0.8},
                        voronoi_dimensions=dimensions,
                        feature=feature,
                        distance=metric,
                    )
            if not sphere:
                octaves = {**space, "Detail": 1.4, "Roughness": 0.6, "Randomness": 0.8}
                add(
                    f"voronoi {dimensions} {feature} of octaves",
                    "TexVoronoi",
                    "Distance",
                    octaves,
                    voronoi_dimensions=dimensions,
                    feature=feature,
                    normalize=True,
                )
    old = {"Vector": "place", "Detail": 0.4, "Dimension": 0.9}
    add("musgrave of less than an octave", "TexMusgrave", "Fac", old, musgrave_type="FBM")
    bands = {"Vector": "place", "Scale": 0.3, "Distortion": 1.2, "Detail": 1.5, "Phase Offset": 0.4}
    for profile in ("SIN", "SAW", "TRI"):
        for direction in ("X", "Y", "Z", "DIAGONAL"):
            properties = {"wave_profile": profile, "bands_direction": direction}
            add(f"bands {profile} {direction}", "TexWave", "Fac", bands, **properties)
        for direction in ("X", "Y", "Z", "SPHERICAL"):
            properties = {"wave_profile": profile, "rings_direction": direction}
            name = f"rings {profile} {direction}"
            add(name, "TexWave", "Color", bands, wave_type="RINGS", **properties)
    swirl = {"Vector": "place", "Scale": 0.4, "Distortion": 1.3}
    for depth in range(11):
        add(f"magic {depth}", "TexMagic", "Color", swirl, turbulence_depth=depth)
    add("magic Fac", "TexMagic", "Fac", swirl)
    wall = {"Vector": "place", **colors, "Scale": 0.8, "Mortar Size": 0.06, "Mortar Smooth": 0.6}
    for output in ("Color", "Fac"):
        add(f"bricks {output}", "TexBrick", output, wall)
    shifted = {"offset": 0.3, "offset_frequency": 3, "squash": 1.4, "squash_frequency": 2}
    add("shifted bricks", "TexBrick", "Color", {**wall, "Bias": -0.2}, **shifted)


def sources(material) -> dict:
    """What varies over a tile: x from -1.5 to 1.5, y from -1.3 to 1.3, two colours, a normal."""

    def node(kind, operation=None, **inputs):
        new = add_node(material, f"ShaderNode{kind}")
        if operation:
            new.operation = operation
        for name, value in inputs.items():
            if isinstance(value, bpy.types.NodeSocket):
                material.node_tree.links.new(value, new.inputs[int(name[1:])])
            else:
                new.inputs[int(name[1:])].default_value = value
        return new

    at = node("TexCoord").outputs["Object"]
    wide = node("VectorMath", "MULTIPLY", _0=at, _1=(1.5, 1.3, 1.0)).outputs[0]
    split = node("SeparateXYZ", _0=wide)
    color = node("VectorMath", "MULTIPLY_ADD", _0=at, _1=(0.45, 0.4, 0), _2=(0.5, 0.45, 0.6))
    other = node("VectorMath", "MULTIPLY_ADD", _0=at, _1=(-0.3, 0.45, 0), _2=(0.35, 0.5, 0.2))
    bent = node("VectorMath", "MULTIPLY_ADD", _0=at, _1=(0.7, 0.7, 0), _2=(0, 0, 1))
    place = node("VectorMath", "MULTIPLY_ADD", _0=at, _1=(1.7, 1.5, 0), _2=(0.31, 0.17, 0.4))
    # Whole numbers, so that a hash of all their bits is the same in two renderers.
    cells = node(
        "VectorMath", "FLOOR", _0=node("VectorMath", "MULTIPLY", _0=at, _1=(3, 3, 3)).outputs[0]
    )
    return {
        "place": place.outputs[0],
        "cells": cells.outputs[0],
        "cell": node("SeparateXYZ", _0=cells.outputs[0]).outputs[0],
        "x": split.outputs[0],
        "y": split.outputs[1],
        "color": color.outputs[0],
        "other": other.outputs[0],
        "bent": node("VectorMath", "NORMALIZE", _0=bent.outputs[0]).outputs[0],
    }


def set_ramp(node, interpolation):
    ramp = node.color_ramp
    ramp.elements[0].color = (0.9, 0.2, 0.1, 0.3)
    ramp.elements[0].position = 0.15
    ramp.elements.new(0.6).color = (0.1, 0.8, 0.4, 0.9)
    if interpolation == "HSV":
        ramp.color_mode, ramp.hue_interpolation = "HSV", "FAR"
    else:
        ramp.interpolation = interpolation


def set_curves(node, extend):
    mapping = node.mapping
    mapping.extend = extend
    for k, curve in enumerate(mapping.curves):
        curve.points[0].location = (0.1, 0.05 * k)
        curve.points[-1].location = (0.9, 0.8 - 0.1 * k)
        curve.points.new(0.4, 0.2 + 0.15 * k)
    mapping.update()


SETTERS = {
    "ramp": set_ramp,
    "curves": set_curves,
    "direction": lambda node, value: setattr(node.outputs["Normal"], "default_value", value),
}


def find_socket(sockets, name):
    names = (name, "Factor") if name == "Fac" else (name,)
    return next(socket for socket in sockets if socket.identifier in names)


def add_tile(index, case):
    """A tile of the picture; False where this Blender has no such node or property."""
    kind, properties, inputs, output = case
    if not hasattr(bpy.types, kind):
        return False
    material = new_material()
    node = add_node(material, kind)
    try:
        for name, value in properties.items():
            if name in SETTERS:
                SETTERS[name](node, value)
            else:
                setattr(node, name, value)
    except (AttributeError, TypeError):  # no such property or choice
        return False
    links, varying = material.node_tree.links, sources(material)
    for name, value in inputs.items():
        socket = find_socket(node.inputs, name)
        if isinstance(value, str):
            links.new(varying[value], socket)
        else:
            value = (*value, 1) if socket.type == "RGBA" and not isinstance(value, float) else value
            socket.default_value = value
    result = find_socket(node.outputs, output)
    tiles.show(material, result)
    tiles.place(add_mesh(f"Tile {index}", material=material), index, COLUMNS)
    return True


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    bpy.ops.wm.read_homefile(use_empty=True)
    placed = []
    for name, case in cases().items():
        if add_tile(len(placed), case):
            placed.append(name)
    return tiles.pictures(placed, COLUMNS, tmp_path_factory.mktemp("tiles"))


@pytest.mark.parametrize("name", cases())
def test_node(pictures, name):
    if name not in pictures:
        pytest.skip("not in this Blender")
    tiles.assert_same(*pictures[name])
