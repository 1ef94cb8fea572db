# SPDX-License-Identifier: GPL-3.0-or-later
"""What computes colours, values and vectors, also normals: a row for each node."""

from __future__ import annotations

import numpy as np

from . import spectrum
from .node_kind import ANY, SWITCH, NodeKind

_BLENDS = (
    "MIX",
    "DARKEN",
    "MULTIPLY",
    "BURN",
    "LIGHTEN",
    "SCREEN",
    "DODGE",
    "ADD",
    "OVERLAY",
    "SOFT_LIGHT",
    "LINEAR_LIGHT",
    "DIFFERENCE",
    "EXCLUSION",
    "SUBTRACT",
    "DIVIDE",
    "HUE",
    "SATURATION",
    "COLOR",
    "VALUE",
)
_CHANNELS = ("Red", "Green", "Blue")
_EXTEND = {"mapping.extend": ("EXTRAPOLATED", "HORIZONTAL")}


def _ramp(node) -> np.ndarray:
    """The colours (256, 4) of a ramp that Cycles, too, looks up."""
    ramp = node.color_ramp
    return np.array([ramp.evaluate(i / 255) for i in range(256)], np.float32)


def _curves(node) -> np.ndarray:
    """Rows (256, 1 + curves) of a place and what Cycles, too, looks up there.

    Of colours the fourth curve, of all channels, comes before those of each.
    """
    mapping = node.mapping
    mapping.initialize()
    ends = [(curve.points[0].location.x, curve.points[-1].location.x) for curve in mapping.curves]
    places = np.linspace(min(low for low, _ in ends), max(high for _, high in ends), 256)
    *own, last = mapping.curves
    if len(own) == 3:
        inner = [mapping.evaluate(last, place) for place in places]
    else:
        own, inner = list(mapping.curves), places
    columns = [[mapping.evaluate(curve, place) for place in inner] for curve in own]
    return np.array([places, *columns], np.float32).T


def _direction(converter, node, desc) -> None:
    """A Normal node keeps its direction in its output socket."""
    desc.inputs["Direction"] = (*node.outputs["Normal"].default_value, 1.0)


def _separate(**columns) -> NodeKind:
    return NodeKind("separate_color", ("Color",), _CHANNELS, **columns)


def _combine(**columns) -> NodeKind:
    return NodeKind("combine_color", _CHANNELS, ("Color",), **columns)


CONVERTER_NODES = {
    "ShaderNodeNormalMap": NodeKind(
        "normal_map",
        ("Strength", "Color"),
        ("Normal",),
        options={
            "space": ("TANGENT", "OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD"),
            "uv_map": ANY,
        },
    ),
    "ShaderNodeBump": NodeKind(
        "bump",
        ("Strength", "Distance", "Height", "Normal"),
        ("Normal",),
        options={"invert": ("False", "True")},
    ),
    "ShaderNodeDisplacement": NodeKind(
        "displacement",
        ("Height", "Midlevel", "Scale", "Normal"),
        ("Displacement",),
        options={"space": ("OBJECT", "WORLD")},
    ),
    "ShaderNodeVectorDisplacement": NodeKind(
        "vector_displacement",
        ("Vector", "Midlevel", "Scale"),
        ("Displacement",),
        options={"space": ("TANGENT", "OBJECT", "WORLD")},
    ),
    "ShaderNodeMapping": NodeKind(
        "mapping",
        ("Vector", "Location", "Rotation", "Scale"),
        ("Vector",),
        options={"vector_type": ("POINT", "TEXTURE", "VECTOR", "NORMAL")},
    ),
    "ShaderNodeMath": NodeKind(
        "math",
        ("Value", "Value_001", "Value_002"),
        ("Value",),
        options={"operation": ANY, "use_clamp": SWITCH},
    ),
    "ShaderNodeVectorMath": NodeKind(
        "vector_math",
        ("Vector", "Vector_001", "Vector_002", "Scale"),
        ("Vector", "Value"),
        options={"operation": ANY},
    ),
    "ShaderNodeMix": NodeKind(
        "mix",
        (
            "Factor_Float",
            "Factor_Vector",
            "A_Float",
            "B_Float",
            "A_Vector",
            "B_Vector",
            "A_Color",
            "B_Color",
        ),
        ("Result_Float", "Result_Vector", "Result_Color"),
        options={
            "factor_mode": ("UNIFORM", "NON_UNIFORM"),
            "blend_type": _BLENDS,
            "clamp_factor": SWITCH,
            "clamp_result": SWITCH,
        },
    ),
    "ShaderNodeMixRGB": NodeKind(
        "mix_rgb",
        ("Fac", "Color1", "Color2"),
        ("Color",),
        options={"blend_type": _BLENDS, "use_clamp": SWITCH},
    ),
    "ShaderNodeMapRange": NodeKind(
        "map_range",
        (
            "Value",
            "From Min",
            "From Max",
            "To Min",
            "To Max",
            "Steps",
            "Vector",
            "From_Min_FLOAT3",
            "From_Max_FLOAT3",
            "To_Min_FLOAT3",
            "To_Max_FLOAT3",
            "Steps_FLOAT3",
        ),
        ("Result", "Vector"),
        options={
            "interpolation_type": ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP"),
            "clamp": SWITCH,
        },
    ),
    "ShaderNodeClamp": NodeKind(
        "clamp", ("Value", "Min", "Max"), ("Result",), options={"clamp_type": ("MINMAX", "RANGE")}
    ),
    "ShaderNodeSeparateXYZ": NodeKind("separate_xyz", ("Vector",), ("X", "Y", "Z")),
    "ShaderNodeCombineXYZ": NodeKind("combine_xyz", ("X", "Y", "Z"), ("Vector",)),
    "ShaderNodeSeparateRGB": _separate(fixed_options={"mode": "RGB"}),
    "ShaderNodeSeparateHSV": _separate(fixed_options={"mode": "HSV"}),
    "ShaderNodeSeparateColor": _separate(options={"mode": ("RGB", "HSV", "HSL")}),
    "ShaderNodeCombineRGB": _combine(fixed_options={"mode": "RGB"}),
    "ShaderNodeCombineHSV": _combine(fixed_options={"mode": "HSV"}),
    "ShaderNodeCombineColor": _combine(options={"mode": ("RGB", "HSV", "HSL")}),
    "ShaderNodeVectorRotate": NodeKind(
        "vector_rotate",
        ("Vector", "Center", "Axis", "Angle", "Rotation"),
        ("Vector",),
        options={
            "rotation_type": ("AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS", "EULER_XYZ"),
            "invert": SWITCH,
        },
    ),
    "ShaderNodeRGBToBW": NodeKind("rgb_to_bw", ("Color",), ("Val",)),
    "ShaderNodeInvert": NodeKind("invert", ("Fac", "Color"), ("Color",)),
    "ShaderNodeGamma": NodeKind("gamma", ("Color", "Gamma"), ("Color",)),
    "ShaderNodeBrightContrast": NodeKind(
        "bright_contrast", ("Color", "Bright", "Contrast"), ("Color",)
    ),
    "ShaderNodeHueSaturation": NodeKind(
        "hue_saturation", ("Hue", "Saturation", "Value", "Fac", "Color"), ("Color",)
    ),
    "ShaderNodeRGBCurve": NodeKind(
        "rgb_curves", ("Fac", "Color"), ("Color",), options=_EXTEND, arrays={"Table": _curves}
    ),
    "ShaderNodeVectorCurve": NodeKind(
        "vector_curves", ("Fac", "Vector"), ("Vector",), options=_EXTEND, arrays={"Table": _curves}
    ),
    "ShaderNodeFloatCurve": NodeKind(
        "float_curve", ("Factor", "Value"), ("Value",), options=_EXTEND, arrays={"Table": _curves}
    ),
    "ShaderNodeNormal": NodeKind("normal", ("Normal",), ("Normal", "Dot"), adjust=_direction),
    "ShaderNodeVectorTransform": NodeKind(
        "vector_transform",
        ("Vector",),
        ("Vector",),
        options={
            "vector_type": ("VECTOR", "POINT", "NORMAL"),
            "convert_from": ("WORLD", "OBJECT", "CAMERA"),
            "convert_to": ("OBJECT", "WORLD", "CAMERA"),
        },
    ),
    "ShaderNodeBlackbody": NodeKind(
        "blackbody",
        ("Temperature",),
        ("Color",),
        arrays={"Table": lambda node: spectrum.blackbodies()},
    ),
    "ShaderNodeWavelength": NodeKind(
        "wavelength",
        ("Wavelength",),
        ("Color",),
        arrays={"Table": lambda node: spectrum.wavelengths()},
    ),
    "ShaderNodeValToRGB": NodeKind(
        "color_ramp",
        ("Fac",),
        ("Color", "Alpha"),
        options={
            "color_ramp.interpolation": ("LINEAR", "EASE", "B_SPLINE", "CARDINAL", "CONSTANT")
        },
        arrays={"Table": _ramp},
    ),
}
