# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader nodes that Specula knows: one row each, under the names that the core uses.

Names of sockets and options are Blender 5.0's; `compat` finds them in an older Blender.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from . import compat

WHITE = (1.0, 1.0, 1.0, 1.0)
ANY = ()  # an option that takes any text
DISTRIBUTIONS = ("GGX", "BECKMANN", "MULTI_GGX")
INTERPOLATIONS = ("Linear", "Closest", "Cubic", "Smart")


@dataclass(frozen=True)
class NodeKind:
    """How a Blender node becomes a node of the core."""

    kind: str
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    # Option of the core = property of the node -> values the core knows; the first is the fallback.
    options: dict[str, tuple[str, ...]] = field(default_factory=dict)
    # What Specula does not model, and the value at which that makes no difference.
    neutral_inputs: dict[str, float] = field(default_factory=dict)
    neutral_properties: dict[str, object] = field(default_factory=dict)
    # Changes the finished node: adjust(converter, blender_node, node_desc).
    adjust: Callable | None = None


def _sharp(converter, node, desc) -> None:
    """The distribution Sharp of older Blenders is any other one without roughness."""
    if compat.is_sharp(node):
        desc.options["distribution"] = "GGX"
        converter.set_constant(desc, "Roughness", (0.0, 0.0, 0.0, 1.0))


def _output_value(converter, node, desc) -> None:
    """RGB and Value keep their value in their output socket."""
    socket = node.outputs[0]
    value = socket.default_value
    desc.inputs[socket.identifier] = (
        tuple(value) if socket.type == "RGBA" else (value,) * 3 + (1.0,)
    )


def _scalar_tint(converter, node, desc) -> None:
    """Until 3.6 Specular Tint was a factor between white and the base colour.

    As Blender's own conversion to a colour: white at 0, the base colour at 1, else their mix.
    """
    socket = compat.find_input(node, "Specular Tint")
    if socket.type == "RGBA":
        return
    converter.set_constant(desc, "Specular Tint", WHITE)
    base = desc.inputs.get("Base Color")
    if socket.is_linked or (socket.default_value and base is None):
        converter.warn(node, "a textured Specular Tint is not supported, white is used")
    elif socket.default_value:
        factor = socket.default_value
        tint = tuple(1.0 + factor * (channel - 1.0) for channel in base[:3])
        converter.set_constant(desc, "Specular Tint", (*tint, 1.0))


def _clearcoat(converter, node, desc) -> None:
    """Until 3.6 the coat was a Clearcoat, which reflected a quarter at an IOR of 1.5.

    As Blender's own conversion: a quarter of the weight, or an IOR of 1.2 where the weight varies.
    """
    if compat.find_input(node, "Coat IOR"):
        return
    weight = compat.find_input(node, "Coat Weight")
    if weight.is_linked:
        converter.set_constant(desc, "Coat IOR", (1.2, 1.2, 1.2, 1.0))
    else:
        converter.set_constant(desc, "Coat Weight", (*[0.25 * weight.default_value] * 3, 1.0))


def _old_principled(converter, node, desc) -> None:
    """Converts what the Principled BSDF called and meant otherwise until 3.6."""
    _scalar_tint(converter, node, desc)
    _clearcoat(converter, node, desc)


def _image(converter, node, desc) -> None:
    """Exports the node's image."""
    desc.image = converter.images.add(node.image, node.image_user, converter.label(node))


_GLOSSY = NodeKind(
    "bsdf_glossy",
    ("Color", "Roughness", "Normal"),
    ("BSDF",),
    options={"distribution": DISTRIBUTIONS},
    neutral_inputs={"Anisotropy": 0.0},
    adjust=_sharp,
)

NODES = {
    "ShaderNodeBsdfDiffuse": NodeKind("bsdf_diffuse", ("Color", "Roughness", "Normal"), ("BSDF",)),
    "ShaderNodeBsdfGlossy": _GLOSSY,
    "ShaderNodeBsdfAnisotropic": _GLOSSY,
    "ShaderNodeBsdfGlass": NodeKind(
        "bsdf_glass",
        ("Color", "Roughness", "IOR", "Normal"),
        ("BSDF",),
        options={"distribution": DISTRIBUTIONS},
        neutral_inputs={"Thin Film Thickness": 0.0},
        adjust=_sharp,
    ),
    "ShaderNodeBsdfRefraction": NodeKind(
        "bsdf_refraction",
        ("Color", "Roughness", "IOR", "Normal"),
        ("BSDF",),
        options={"distribution": ("GGX", "BECKMANN")},
        adjust=_sharp,
    ),
    "ShaderNodeBsdfTransparent": NodeKind("bsdf_transparent", ("Color",), ("BSDF",)),
    "ShaderNodeEmission": NodeKind("emission", ("Color", "Strength"), ("Emission",)),
    "ShaderNodeBackground": NodeKind("background", ("Color", "Strength"), ("Background",)),
    "ShaderNodeMixShader": NodeKind("mix_shader", ("Fac", "Shader", "Shader_001"), ("Shader",)),
    "ShaderNodeAddShader": NodeKind("add_shader", ("Shader", "Shader_001"), ("Shader",)),
    "ShaderNodeBsdfPrincipled": NodeKind(
        "bsdf_principled",
        (
            "Base Color",
            "Metallic",
            "Roughness",
            "IOR",
            "Alpha",
            "Normal",
            "Specular IOR Level",
            "Specular Tint",
            "Transmission Weight",
            "Emission Color",
            "Emission Strength",
            "Coat Weight",
            "Coat Roughness",
            "Coat IOR",
            "Coat Tint",
            "Coat Normal",
        ),
        ("BSDF",),
        options={"distribution": ("GGX", "MULTI_GGX")},
        neutral_inputs={
            "Diffuse Roughness": 0.0,
            "Subsurface Weight": 0.0,
            "Anisotropic": 0.0,
            "Sheen Weight": 0.0,
            "Thin Film Thickness": 0.0,
        },
        adjust=_old_principled,
    ),
    "ShaderNodeVolumeAbsorption": NodeKind("volume_absorption", ("Color", "Density"), ("Volume",)),
    "ShaderNodeVolumePrincipled": NodeKind(
        "volume_principled",
        ("Color", "Density", "Absorption Color"),
        ("Volume",),
        neutral_inputs={"Emission Strength": 0.0, "Blackbody Intensity": 0.0},
    ),
    "ShaderNodeTexImage": NodeKind(
        "image_texture",
        ("Vector",),
        ("Color", "Alpha"),
        options={
            "interpolation": INTERPOLATIONS,
            "extension": ("REPEAT", "EXTEND", "CLIP", "MIRROR"),
        },
        neutral_properties={"projection": "FLAT"},
        adjust=_image,
    ),
    "ShaderNodeTexEnvironment": NodeKind(
        "environment_texture",
        ("Vector",),
        ("Color",),
        options={
            "projection": ("EQUIRECTANGULAR", "MIRROR_BALL"),
            "interpolation": INTERPOLATIONS,
        },
        adjust=_image,
    ),
    "ShaderNodeNormalMap": NodeKind(
        "normal_map",
        ("Strength", "Color"),
        ("Normal",),
        options={"space": ("TANGENT", "OBJECT", "WORLD"), "uv_map": ANY},
    ),
    "ShaderNodeBump": NodeKind(
        "bump",
        ("Strength", "Distance", "Height", "Normal"),
        ("Normal",),
        options={"invert": ("False", "True")},
    ),
    "ShaderNodeUVMap": NodeKind(
        "uv_map",
        (),
        ("UV",),
        options={"uv_map": ANY},
        neutral_properties={"from_instancer": False},
    ),
    "ShaderNodeTexCoord": NodeKind(
        "texture_coordinate",
        (),
        ("Generated", "Normal", "UV", "Object"),
        neutral_properties={"from_instancer": False, "object": None},
    ),
    "ShaderNodeMapping": NodeKind(
        "mapping",
        ("Vector", "Location", "Rotation", "Scale"),
        ("Vector",),
        options={"vector_type": ("POINT", "TEXTURE", "VECTOR", "NORMAL")},
    ),
    "ShaderNodeRGB": NodeKind("rgb", (), ("Color",), adjust=_output_value),
    "ShaderNodeValue": NodeKind("value", (), ("Value",), adjust=_output_value),
}
