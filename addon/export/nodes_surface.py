# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders of surfaces and volumes: a row for each node."""

from __future__ import annotations

from . import compat
from .node_kind import NodeKind

WHITE = (1.0, 1.0, 1.0, 1.0)
DISTRIBUTIONS = ("GGX", "BECKMANN", "MULTI_GGX")
SUBSURFACE_METHODS = (
    "RANDOM_WALK",
    "RANDOM_WALK_SKIN",
    "RANDOM_WALK_FIXED_RADIUS",
    "RANDOM_WALK_DIPOLE",
    "BURLEY",
)


def _sharp(converter, node, desc) -> None:
    """The distribution Sharp of older Blenders is any other one without roughness."""
    if compat.is_sharp(node):
        desc.options["distribution"] = "GGX"
        converter.set_constant(desc, "Roughness", (0.0, 0.0, 0.0, 1.0))


def _diffuse_exchanges(converter, node, desc) -> None:
    """Until 4.2 light that facets exchange was lost."""
    desc.options["multiple_scattering"] = str(compat.diffuse_exchanges())


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


def _principled_model(converter, node, desc) -> None:
    """Until 3.6 base and sheen were Burley's, and nothing took light from what lies below."""
    new = compat.find_input(node, "Sheen Roughness")
    desc.options["model"] = "LAYERED" if new else "BURLEY"


def _subsurface_method(converter, node, desc) -> None:
    """Until 3.6 a Random Walk was another one."""
    for name in ("falloff", "subsurface_method"):
        if name in desc.options:
            desc.options[name] = compat.subsurface_method(desc.options[name])


def _subsurface(converter, node, desc) -> None:
    """Until 3.6 Subsurface was how far light comes, and mixed a colour into that of the base."""
    color = compat.find_input(node, "Subsurface Color")
    if color is None:
        return
    amount = compat.find_input(node, "Subsurface Weight")
    if amount.is_linked:
        return converter.warn(node, "a textured Subsurface weighs what goes on below")
    scale = amount.default_value
    converter.set_constant(desc, "Subsurface Weight", (*[float(scale > 0.0)] * 3, 1.0))
    converter.set_constant(desc, "Subsurface Scale", (*[scale] * 3, 1.0))
    base = desc.inputs.get("Base Color")
    if scale > 0.0 and base is not None and not color.is_linked:
        mixed = [b + scale * (c - b) for b, c in zip(base, color.default_value, strict=False)]
        converter.set_constant(desc, "Base Color", tuple(mixed))
    elif scale > 0.0:
        converter.warn(node, "Subsurface Color has no effect beside textures")


def _principled(converter, node, desc) -> None:
    """Converts what the Principled BSDF called and meant otherwise in older Blenders."""
    desc.options["film_on_metal"] = str(compat.film_on_metal())
    _scalar_tint(converter, node, desc)
    _clearcoat(converter, node, desc)
    _principled_model(converter, node, desc)
    _subsurface(converter, node, desc)
    _subsurface_method(converter, node, desc)


_GLOSSY = NodeKind(
    "bsdf_glossy",
    ("Color", "Roughness", "Normal", "Anisotropy", "Rotation", "Tangent"),
    ("BSDF",),
    options={"distribution": (*DISTRIBUTIONS, "ASHIKHMIN_SHIRLEY")},
    adjust=_sharp,
)


SURFACE_NODES = {
    "ShaderNodeBsdfDiffuse": NodeKind(
        "bsdf_diffuse",
        ("Color", "Roughness", "Normal"),
        ("BSDF",),
        fixed_options={"multiple_scattering": "True"},
        adjust=_diffuse_exchanges,
    ),
    "ShaderNodeBsdfTranslucent": NodeKind("bsdf_translucent", ("Color", "Normal"), ("BSDF",)),
    "ShaderNodeBsdfSheen": NodeKind(
        "bsdf_sheen",
        ("Color", "Roughness", "Normal"),
        ("BSDF",),
        options={"distribution": ("MICROFIBER", "ASHIKHMIN")},
    ),
    "ShaderNodeBsdfVelvet": NodeKind(
        "bsdf_sheen",
        ("Color", "Roughness", "Normal"),
        ("BSDF",),
        fixed_options={"distribution": "ASHIKHMIN"},
    ),
    "ShaderNodeBsdfToon": NodeKind(
        "bsdf_toon",
        ("Color", "Size", "Smooth", "Normal"),
        ("BSDF",),
        options={"component": ("DIFFUSE", "GLOSSY")},
    ),
    "ShaderNodeHoldout": NodeKind("holdout", (), ("Holdout",)),
    "ShaderNodeBsdfGlossy": _GLOSSY,
    "ShaderNodeBsdfAnisotropic": _GLOSSY,
    "ShaderNodeBsdfMetallic": NodeKind(
        "bsdf_metallic",
        (
            "Base Color",
            "Edge Tint",
            "IOR",
            "Extinction",
            "Roughness",
            "Anisotropy",
            "Rotation",
            "Normal",
            "Tangent",
            "Thin Film Thickness",
            "Thin Film IOR",
        ),
        ("BSDF",),
        options={
            "distribution": DISTRIBUTIONS,
            "fresnel_type": ("F82", "PHYSICAL_CONDUCTOR"),
        },
    ),
    "ShaderNodeBsdfGlass": NodeKind(
        "bsdf_glass",
        ("Color", "Roughness", "IOR", "Normal", "Thin Film Thickness", "Thin Film IOR"),
        ("BSDF",),
        options={"distribution": DISTRIBUTIONS},
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
            "Diffuse Roughness",
            "Sheen Weight",
            "Sheen Roughness",
            "Sheen Tint",
            "Anisotropic",
            "Anisotropic Rotation",
            "Tangent",
            "Subsurface Weight",
            "Subsurface Radius",
            "Subsurface Scale",
            "Subsurface IOR",
            "Subsurface Anisotropy",
            "Thin Film Thickness",
            "Thin Film IOR",
        ),
        ("BSDF",),
        options={
            "distribution": ("GGX", "MULTI_GGX"),
            "subsurface_method": SUBSURFACE_METHODS,
        },
        fixed_options={"model": "LAYERED", "film_on_metal": "True"},
        adjust=_principled,
    ),
    "ShaderNodeSubsurfaceScattering": NodeKind(
        "subsurface_scattering",
        ("Color", "Scale", "Radius", "IOR", "Roughness", "Anisotropy", "Normal"),
        ("BSSRDF",),
        options={"falloff": SUBSURFACE_METHODS},
        adjust=_subsurface_method,
    ),
    "ShaderNodeBsdfHair": NodeKind(
        "bsdf_hair",
        ("Color", "Offset", "RoughnessU", "RoughnessV"),
        ("BSDF",),
        options={"component": ("Reflection", "Transmission")},
    ),
    "ShaderNodeBsdfHairPrincipled": NodeKind(
        "bsdf_hair_principled",
        (
            "Color",
            "Melanin",
            "Melanin Redness",
            "Tint",
            "Absorption Coefficient",
            "Roughness",
            "Radial Roughness",
            "Coat",
            "IOR",
            "Offset",
            "Random Color",
            "Random Roughness",
            "Random",
        ),
        ("BSDF",),
        options={
            "parametrization": ("COLOR", "MELANIN", "ABSORPTION"),
            "model": ("CHIANG", "HUANG"),
        },
    ),
    "ShaderNodeBsdfRayPortal": NodeKind("bsdf_ray_portal", ("Color",), ("BSDF",)),
    "ShaderNodeVolumeAbsorption": NodeKind("volume_absorption", ("Color", "Density"), ("Volume",)),
    "ShaderNodeVolumePrincipled": NodeKind(
        "volume_principled",
        ("Color", "Density", "Absorption Color"),
        ("Volume",),
        neutral_inputs={"Emission Strength": 0.0, "Blackbody Intensity": 0.0},
    ),
}
