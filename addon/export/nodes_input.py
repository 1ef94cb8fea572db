# SPDX-License-Identifier: GPL-3.0-or-later
"""What a node tells of a point, its object, or the ray: a row for each node."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .node_kind import ANY, SWITCH, NodeKind


def _output_value(converter, node, desc) -> None:
    """RGB and Value keep their value in their output socket."""
    socket = node.outputs[0]
    value = socket.default_value
    desc.inputs[socket.identifier] = (
        tuple(value) if socket.type == "RGBA" else (value,) * 3 + (1.0,)
    )


def _material_index(converter, node, desc) -> None:
    """Object Info tells the pass index of the material, too."""
    desc.inputs["Material Index"] = (float(converter.material_index),) * 3 + (1.0,)


def _object_space(converter, node, desc) -> None:
    """The coordinates may be those of another object."""
    if node.object is not None:
        inverse = np.linalg.inv(np.array(node.object.matrix_world, np.float64))
        desc.arrays["Object"] = inverse[:3].astype(np.float32)


def _stand_in(message: str) -> Callable:
    """Says what is done in place of a node's work."""
    return lambda converter, node, desc: converter.warn(node, message)


INPUT_NODES = {
    "ShaderNodeUVMap": NodeKind(
        "uv_map",
        (),
        ("UV",),
        options={"uv_map": ANY, "from_instancer": SWITCH},
    ),
    "ShaderNodeTexCoord": NodeKind(
        "texture_coordinate",
        (),
        ("Generated", "Normal", "UV", "Object", "Camera", "Window", "Reflection"),
        options={"from_instancer": SWITCH},
        adjust=_object_space,
    ),
    "ShaderNodeFresnel": NodeKind("fresnel", ("IOR", "Normal"), ("Fac",)),
    "ShaderNodeLayerWeight": NodeKind("layer_weight", ("Blend", "Normal"), ("Fresnel", "Facing")),
    "ShaderNodeNewGeometry": NodeKind(
        "geometry",
        (),
        (
            "Position",
            "Normal",
            "Tangent",
            "True Normal",
            "Incoming",
            "Parametric",
            "Backfacing",
            "Pointiness",
            "Random Per Island",
        ),
    ),
    "ShaderNodeTangent": NodeKind(
        "tangent",
        (),
        ("Tangent",),
        options={"direction_type": ("RADIAL", "UV_MAP"), "axis": ("Z", "X", "Y"), "uv_map": ANY},
    ),
    "ShaderNodeCameraData": NodeKind(
        "camera_data", (), ("View Vector", "View Z Depth", "View Distance")
    ),
    "ShaderNodeWireframe": NodeKind(
        "wireframe", ("Size",), ("Fac",), options={"use_pixel_size": SWITCH}
    ),
    "ShaderNodeBevel": NodeKind(
        "bevel",
        ("Radius", "Normal"),
        ("Normal",),
        adjust=_stand_in("edges are not rounded, the normal stays"),
    ),
    "ShaderNodeAmbientOcclusion": NodeKind(
        "ambient_occlusion",
        ("Color",),
        ("Color", "AO"),
        adjust=_stand_in("occlusion is not looked for, everything counts as open"),
    ),
    "ShaderNodeHairInfo": NodeKind(
        "hair_info",
        (),
        ("Is Strand", "Intercept", "Length", "Thickness", "Tangent Normal", "Random"),
    ),
    "ShaderNodePointInfo": NodeKind("point_info", (), ("Position", "Radius", "Random")),
    "ShaderNodeVolumeInfo": NodeKind(
        "volume_info", (), ("Color", "Density", "Flame", "Temperature")
    ),
    "ShaderNodeLightPath": NodeKind(
        "light_path",
        (),
        (
            "Is Camera Ray",
            "Is Shadow Ray",
            "Is Diffuse Ray",
            "Is Glossy Ray",
            "Is Singular Ray",
            "Is Reflection Ray",
            "Is Transmission Ray",
            "Is Volume Scatter Ray",
            "Ray Length",
            "Ray Depth",
            "Diffuse Depth",
            "Glossy Depth",
            "Transparent Depth",
            "Transmission Depth",
            "Portal Depth",
        ),
    ),
    "ShaderNodeLightFalloff": NodeKind(
        "light_falloff", ("Strength", "Smooth"), ("Quadratic", "Linear", "Constant")
    ),
    "ShaderNodeAttribute": NodeKind(
        "attribute",
        (),
        ("Color", "Vector", "Fac", "Alpha"),
        options={
            "attribute_type": ("GEOMETRY", "OBJECT", "INSTANCER", "VIEW_LAYER"),
            "attribute_name": ANY,
        },
    ),
    "ShaderNodeVertexColor": NodeKind(
        "vertex_color", (), ("Color", "Alpha"), options={"layer_name": ANY}
    ),
    "ShaderNodeObjectInfo": NodeKind(
        "object_info",
        (),
        ("Location", "Color", "Alpha", "Object Index", "Material Index", "Random"),
        adjust=_material_index,
    ),
    "ShaderNodeParticleInfo": NodeKind(
        "particle_info",
        (),
        (
            "Index",
            "Random",
            "Age",
            "Lifetime",
            "Location",
            "Size",
            "Velocity",
            "Angular Velocity",
        ),
    ),
    "ShaderNodeRGB": NodeKind("rgb", (), ("Color",), adjust=_output_value),
    "ShaderNodeValue": NodeKind("value", (), ("Value",), adjust=_output_value),
}
