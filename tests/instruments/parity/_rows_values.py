# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of nodes that make values: inputs, converters, colours, vectors, normals."""

from __future__ import annotations

from functools import partial

from tests.instruments.parity._nodes import (
    CENTRED,
    COLORS,
    HUES,
    NORMAL,
    OBJECT,
    UV,
    N,
    Row,
    halved,
    lit,
    modes,
    shown,
)

MATH_OF_ONE = "SQRT INVERSE_SQRT ABSOLUTE EXPONENT SIGN ROUND FLOOR CEIL TRUNC FRACT SINE COSINE"
MATH_OF_ONE += " TANGENT ARCSINE ARCCOSINE ARCTANGENT SINH COSH TANH RADIANS DEGREES"
MATH_OF_TWO = "ADD SUBTRACT MULTIPLY DIVIDE POWER LOGARITHM MINIMUM MAXIMUM LESS_THAN GREATER_THAN"
MATH_OF_TWO += " MODULO FLOORED_MODULO SNAP PINGPONG ARCTAN2"
MATH_OF_THREE = "MULTIPLY_ADD COMPARE SMOOTH_MIN SMOOTH_MAX WRAP"
VECTORS = (
    "ADD SUBTRACT MULTIPLY DIVIDE MULTIPLY_ADD CROSS_PRODUCT PROJECT REFLECT REFRACT FACEFORWARD"
)
VECTORS += (
    " SCALE NORMALIZE WRAP SNAP FLOOR CEIL MODULO FRACTION ABSOLUTE POWER SIGN MINIMUM MAXIMUM"
)
VECTORS += " SINE COSINE TANGENT"
SCALARS_OF_VECTORS = "DOT_PRODUCT DISTANCE LENGTH"
BLENDS = "MIX DARKEN MULTIPLY BURN LIGHTEN SCREEN DODGE ADD OVERLAY SOFT_LIGHT LINEAR_LIGHT"
BLENDS += " DIFFERENCE EXCLUSION SUBTRACT DIVIDE HUE SATURATION COLOR VALUE"


def _inputs():
    for output in ("Generated", "UV"):
        yield shown(f"input/texture_coordinate/{output}", N("TexCoord", output=output))
    for output in ("Normal", "Object", "Camera", "Window", "Reflection"):
        node = halved(N("TexCoord", output=output))
        yield shown(f"input/texture_coordinate/{output}", node)
    for output in ("Position", "Normal", "Tangent", "True Normal", "Incoming"):
        yield shown(f"input/geometry/{output}", halved(N("NewGeometry", output=output)))
    for output in ("Parametric", "Backfacing", "Pointiness", "Random Per Island"):
        yield shown(f"input/geometry/{output}", N("NewGeometry", output=output))
    for output in ("Location", "Color", "Alpha", "Object Index", "Material Index", "Random"):
        yield shown(f"input/object_info/{output}", N("ObjectInfo", output=output))
    attribute = partial(N, "Attribute")
    yield shown("input/attribute/vertex_color", attribute(attribute_name="Tint", output="Color"))
    yield shown("input/attribute/float", attribute(attribute_name="weight", output="Fac"))
    yield shown("input/attribute/uv", attribute(attribute_name="UVMap", output="Vector"))
    yield shown(
        "input/attribute/object",
        attribute(attribute_name='["shade"]', attribute_type="OBJECT", output="Fac"),
    )
    yield shown(
        "input/attribute/view_layer",
        attribute(attribute_name='["shade"]', attribute_type="VIEW_LAYER", output="Fac"),
    )
    yield shown("input/color_attribute", N("VertexColor", layer_name="Tint"))
    yield shown("input/uv_map", N("UVMap", uv_map="UVMap"))
    yield shown("input/rgb", N("RGB", value=(0.2, 0.5, 0.7, 1.0)))
    yield shown("input/value", N("Value", value=0.4))
    yield from modes(
        "input/tangent",
        lambda name, axis: shown(name, halved(N("Tangent", direction_type="RADIAL", axis=axis))),
        {"axis": "XYZ"},
    )
    yield shown("input/tangent/uv", halved(N("Tangent", direction_type="UV_MAP", uv_map="UVMap")))
    for output in ("Fresnel", "Facing"):
        yield shown(f"input/layer_weight/{output}", N("LayerWeight", {0: 0.4}, output))
    yield shown("input/fresnel", N("Fresnel", {"IOR": 1.6}))
    yield shown("input/camera_data/view_vector", halved(N("CameraData", output=0)))
    for output in (1, 2):
        depth = N("Mapping", {"Vector": N("CameraData", output=output), "Scale": (0.1, 0.1, 0.1)})
        yield shown(f"input/camera_data/{('z_depth', 'distance')[output - 1]}", depth)
    yield shown("input/wireframe", N("Wireframe", {"Size": 0.05}))
    yield shown("input/wireframe/pixels", N("Wireframe", {"Size": 2.0}, use_pixel_size=True))
    yield shown("input/ambient_occlusion", N("AmbientOcclusion", {"Distance": 2.0}))
    yield shown("input/ambient_occlusion/inside", N("AmbientOcclusion", inside=True))
    yield lit("input/bevel", N("BsdfDiffuse", {"Normal": N("Bevel", {"Radius": 0.2})}))


def _light_path():
    """What camera rays see, and what a mirror does."""
    for output in (
        "Is Camera Ray",
        "Is Shadow Ray",
        "Is Diffuse Ray",
        "Is Glossy Ray",
        "Is Singular Ray",
        "Is Reflection Ray",
        "Is Transmission Ray",
        "Ray Length",
        "Ray Depth",
        "Diffuse Depth",
        "Glossy Depth",
        "Transparent Depth",
        "Transmission Depth",
    ):
        strength = N("LightPath", output=output)
        shader = N("Emission", {"Color": HUES, "Strength": strength})
        label = output.lower().replace(" ", "_")
        yield Row(
            f"input/light_path/{label}",
            lambda stage, shader=shader: stage.show(shader, floor=N("BsdfGlossy", {1: 0.2})),
        )


def _converters():
    for operation in MATH_OF_ONE.split():
        yield shown(f"math/{operation.lower()}", N("Math", {0: HUES}, operation=operation))
    for operation in MATH_OF_TWO.split():
        node = N("Math", {0: HUES, 1: COLORS}, operation=operation)
        yield shown(f"math/{operation.lower()}", node)
    for operation in MATH_OF_THREE.split():
        node = N("Math", {0: HUES, 1: COLORS, 2: 0.2}, operation=operation)
        yield shown(f"math/{operation.lower()}", node)
    yield shown("math/clamped", N("Math", {0: HUES, 1: 0.4}, use_clamp=True))
    for operation in VECTORS.split():
        inputs = {0: CENTRED, 1: NORMAL, 2: (0.3, 0.2, 0.1), "Scale": 0.7}
        node = N("VectorMath", inputs, 0, operation=operation)
        yield shown(f"vector_math/{operation.lower()}", halved(node))
    for operation in SCALARS_OF_VECTORS.split():
        node = N("VectorMath", {0: HUES, 1: COLORS}, "Value", operation=operation)
        yield shown(f"vector_math/{operation.lower()}", node)
    yield shown("clamp/minmax", N("Clamp", {"Value": HUES, "Min": 0.3, "Max": 0.6}))
    range_ = N("Clamp", {"Value": HUES, "Min": 0.6, "Max": 0.3}, clamp_type="RANGE")
    yield shown("clamp/range", range_)
    for kind in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP"):
        inputs = {0: HUES, 1: 0.2, 2: 0.7, 3: 0.9, 4: 0.1, 5: 3.0}
        node = N("MapRange", inputs, 0, interpolation_type=kind)
        yield shown(f"map_range/{kind.lower()}", node)
        vector = {"Vector": HUES, "From_Min_FLOAT3": (0.2, 0.1, 0.0)}
        node = N("MapRange", vector, "Vector", data_type="FLOAT_VECTOR", interpolation_type=kind)
        yield shown(f"map_range/vector_{kind.lower()}", node)
    unclamped = N("MapRange", {0: HUES, 1: 0.4, 2: 0.6, 3: 0.4, 4: 0.6}, clamp=False)
    yield shown("map_range/unclamped", unclamped)
    for kind in ("EASE", "CARDINAL", "LINEAR", "B_SPLINE", "CONSTANT"):
        node = N("ValToRGB", {0: HUES}, 0, ramp=kind)
        yield shown(f"color_ramp/{kind.lower()}", node)
    for mode in ("HSV", "HSL"):
        for direction in ("NEAR", "FAR", "CW", "CCW"):
            node = N("ValToRGB", {0: HUES}, 0, ramp=(mode, direction))
            yield shown(f"color_ramp/{mode.lower()}_{direction.lower()}", node)
    yield shown("color_ramp/alpha", N("ValToRGB", {0: HUES}, 1, ramp="LINEAR"))
    curve = ((0.0, 0.1), (0.4, 0.7), (1.0, 0.3))
    yield shown("curves/float", N("FloatCurve", {"Value": HUES}, curve=curve))
    yield shown("curves/rgb", N("RGBCurve", {"Color": HUES}, curve=curve))
    yield shown("curves/vector", N("VectorCurve", {"Vector": HUES}, curve=curve))


def _mixes():
    factor = N("TexImage", {"Vector": UV}, image="ramp")
    for blend in BLENDS.split():
        inputs = {"Factor_Float": 0.7, "A_Color": HUES, "B_Color": COLORS}
        node = N("Mix", inputs, "Result_Color", data_type="RGBA", blend_type=blend)
        yield shown(f"mix/color_{blend.lower()}", node)
    inputs = {"Factor_Float": factor, "A_Color": HUES, "B_Color": COLORS}
    yield shown("mix/color_factor", N("Mix", inputs, "Result_Color", data_type="RGBA"))
    clamped = {"Factor_Float": 1.5, "A_Color": HUES, "B_Color": COLORS}
    for switch in ("clamp_factor", "clamp_result"):
        options = {"clamp_factor": False, "clamp_result": False} | {switch: True}
        node = N("Mix", clamped, "Result_Color", data_type="RGBA", blend_type="ADD", **options)
        yield shown(f"mix/color_{switch}", node)
    scalars = {"Factor_Float": factor, "A_Float": HUES, "B_Float": 0.3}
    yield shown("mix/float", N("Mix", scalars, "Result_Float", data_type="FLOAT"))
    vectors = {"Factor_Float": factor, "A_Vector": HUES, "B_Vector": COLORS}
    yield shown("mix/vector", N("Mix", vectors, "Result_Vector", data_type="VECTOR"))
    apart = {"Factor_Vector": COLORS, "A_Vector": HUES, "B_Vector": COLORS}
    node = N("Mix", apart, "Result_Vector", data_type="VECTOR", factor_mode="NON_UNIFORM")
    yield shown("mix/vector_non_uniform", node)
    old = N("MixRGB", {0: factor, 1: HUES, 2: COLORS}, blend_type="MULTIPLY", use_clamp=True)
    yield shown("mix/legacy", old)


def _colors():
    for mode in ("RGB", "HSV", "HSL"):
        for index in range(3):
            node = N("SeparateColor", {"Color": HUES}, index, mode=mode)
            yield shown(f"separate_color/{mode.lower()}_{index}", node)
        channels = {0: HUES, 1: COLORS, 2: 0.6}
        yield shown(f"combine_color/{mode.lower()}", N("CombineColor", channels, mode=mode))
    for index in range(3):
        node = N("SeparateXYZ", {"Vector": HUES}, index)
        yield shown(f"separate_xyz/{'xyz'[index]}", node)
    yield shown("combine_xyz", N("CombineXYZ", {0: HUES, 1: 0.3, 2: COLORS}))
    hsv = {"Hue": 0.3, "Saturation": 1.4, "Value": 0.8, "Fac": 0.9, "Color": HUES}
    yield shown("hue_saturation", N("HueSaturation", hsv))
    yield shown("bright_contrast", N("BrightContrast", {"Color": HUES, 1: 0.1, 2: 0.4}))
    yield shown("gamma", N("Gamma", {"Color": HUES, "Gamma": 2.2}))
    yield shown("invert", N("Invert", {"Fac": 0.8, "Color": HUES}))
    yield shown("rgb_to_bw", N("RGBToBW", {"Color": HUES}))
    kelvin = N("Mapping", {"Vector": HUES, "Scale": (9e3, 9e3, 9e3), "Location": (800, 800, 800)})
    yield shown("blackbody", N("Blackbody", {0: kelvin}))
    nanometres = N("Mapping", {"Vector": UV, "Scale": (400,) * 3, "Location": (380,) * 3})
    yield shown("wavelength", N("Wavelength", {0: nanometres}))


def _vectors():
    for kind in ("POINT", "TEXTURE", "VECTOR", "NORMAL"):
        inputs = {"Vector": OBJECT, "Rotation": (0.3, 0.5, 0.8), "Scale": (0.9, 1.4, 0.6)}
        inputs |= {} if kind in ("VECTOR", "NORMAL") else {"Location": (0.2, 0.1, 0.3)}
        yield shown(f"mapping/{kind.lower()}", halved(N("Mapping", inputs, vector_type=kind)))
    for kind in ("AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS", "EULER_XYZ"):
        inputs = {"Vector": OBJECT, "Center": (0.1, 0.2, 0.3)}
        inputs |= {"Rotation": (0.3, 0.5, 0.8)} if kind == "EULER_XYZ" else {"Angle": 0.7}
        node = N("VectorRotate", inputs, rotation_type=kind)
        yield shown(f"vector_rotate/{kind.lower()}", halved(node))
    for kind in ("POINT", "VECTOR", "NORMAL"):
        for source, target in (("OBJECT", "WORLD"), ("WORLD", "CAMERA"), ("CAMERA", "OBJECT")):
            space = {"convert_from": source, "convert_to": target}
            node = N("VectorTransform", {"Vector": CENTRED}, vector_type=kind, **space)
            name = f"vector_transform/{kind}_{source}_to_{target}"
            yield shown(name.lower(), halved(node))
    yield shown("normal/dot", N("Normal", {"Normal": NORMAL}, "Dot"))
    yield shown("normal/normal", halved(N("Normal", {"Normal": NORMAL}, "Normal")))


def _normals():
    bumps = N("TexImage", {"Vector": UV}, image="bumps")
    tilts = N("TexImage", {"Vector": UV}, image="tilts")
    for space in ("TANGENT", "OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD"):
        normal = N("NormalMap", {"Color": tilts, "Strength": 0.8}, space=space)
        yield lit(f"normal_map/{space.lower()}", N("BsdfDiffuse", {"Normal": normal}))
    for strength in (0.5, 1.0, 1.6):
        normal = N("NormalMap", {"Color": tilts, "Strength": strength}, uv_map="UVMap")
        yield lit(f"normal_map/strength={strength}", N("BsdfDiffuse", {"Normal": normal}))
    for invert in (False, True):
        normal = N("Bump", {"Height": bumps, "Distance": 0.1}, invert=invert)
        yield lit(f"bump/invert={invert}", N("BsdfDiffuse", {"Normal": normal}))
    normal = N("Bump", {"Height": COLORS, "Distance": 0.1})
    yield lit("bump/object_coordinates", N("BsdfDiffuse", {"Normal": normal}))
    normal = N("Bump", {"Height": bumps, "Distance": 0.1, "Strength": 0.4})
    glossy = N("BsdfGlossy", {"Roughness": 0.3, "Normal": normal})
    yield lit("bump/glossy", glossy)
    above = N("Bump", {"Height": COLORS, "Distance": 0.1, "Normal": normal})
    yield lit("bump/on_bump", N("BsdfDiffuse", {"Normal": above}))
    mapped = N("NormalMap", {"Color": tilts})
    above = N("Bump", {"Height": bumps, "Distance": 0.1, "Normal": mapped})
    yield lit("bump/on_normal_map", N("BsdfDiffuse", {"Normal": above}))
    grey = N("BsdfDiffuse")
    noise = N("TexNoise", {"Vector": OBJECT, "Scale": 2.0})
    for height, label in ((bumps, "image"), (noise, "noise")):
        up = N("Displacement", {"Height": height, "Scale": 0.2})
        for method in ("BUMP", "DISPLACEMENT", "BOTH"):
            yield lit(f"displacement/{label}/{method.lower()}", grey, method, Displacement=up)
    for space in ("TANGENT", "OBJECT"):
        shift = N("VectorDisplacement", {"Vector": tilts, "Scale": 0.1}, space=space)
        yield lit(f"displacement/vector_{space.lower()}", grey, "BOTH", Displacement=shift)
    yield lit("bump/noise", N("BsdfDiffuse", {"Normal": N("Bump", {"Height": noise})}))


def rows():
    yield from _inputs()
    yield from _light_path()
    yield from _converters()
    yield from _mixes()
    yield from _colors()
    yield from _vectors()
    yield from _normals()
