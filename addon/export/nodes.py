# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader nodes that Specula knows: one row each, under the names that the core uses.

Names of sockets and options are Blender 5.0's; `compat` finds them in an older Blender.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from . import compat, sky, spectrum

WHITE = (1.0, 1.0, 1.0, 1.0)
ANY = ()  # an option that takes any text
DISTRIBUTIONS = ("GGX", "BECKMANN", "MULTI_GGX")
SUBSURFACE_METHODS = (
    "RANDOM_WALK",
    "RANDOM_WALK_SKIN",
    "RANDOM_WALK_FIXED_RADIUS",
    "RANDOM_WALK_DIPOLE",
    "BURLEY",
)
INTERPOLATIONS = ("Linear", "Closest", "Cubic", "Smart")


@dataclass(frozen=True)
class NodeKind:
    """How a Blender node becomes a node of the core."""

    kind: str
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    # Property of the node, or of what it holds -> values that the core knows, of which the first is
    # the fallback. The core's option is called as the property.
    options: dict[str, tuple[str, ...]] = field(default_factory=dict)
    # What Specula does not model, and the value at which that makes no difference.
    neutral_inputs: dict[str, float] = field(default_factory=dict)
    neutral_properties: dict[str, object] = field(default_factory=dict)
    # Options of the core that the type of the node decides.
    fixed_options: dict[str, str] = field(default_factory=dict)
    # Array of the core -> its (rows, columns) numbers from the node.
    arrays: dict[str, Callable] = field(default_factory=dict)
    # Changes the finished node: adjust(converter, blender_node, node_desc).
    adjust: Callable | None = None


def _sharp(converter, node, desc) -> None:
    """The distribution Sharp of older Blenders is any other one without roughness."""
    if compat.is_sharp(node):
        desc.options["distribution"] = "GGX"
        converter.set_constant(desc, "Roughness", (0.0, 0.0, 0.0, 1.0))


def _diffuse_exchanges(converter, node, desc) -> None:
    """Until 4.2 light that facets exchange was lost."""
    desc.options["multiple_scattering"] = str(compat.diffuse_exchanges())


def _voronoi_hash(converter, node, desc) -> None:
    """Cells have got other numbers with 5.0."""
    desc.options["hash"] = compat.voronoi_hash()


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


def _old_principled(converter, node, desc) -> None:
    """Converts what the Principled BSDF called and meant otherwise until 3.6."""
    _scalar_tint(converter, node, desc)
    _clearcoat(converter, node, desc)
    _principled_model(converter, node, desc)
    _subsurface(converter, node, desc)
    _subsurface_method(converter, node, desc)


def _ramp(node) -> np.ndarray:
    """The colours (256, 4) of a ramp that Cycles, too, looks up."""
    ramp = node.color_ramp
    return np.array([ramp.evaluate(i / 255) for i in range(256)], np.float32)


def _brick_rows(node) -> np.ndarray:
    """How rows of bricks are moved and squeezed, with every how many of them are: (2, 2)."""
    rows = ((node.offset, node.offset_frequency), (node.squash, node.squash_frequency))
    return np.array(rows, np.float32)


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


def _material_index(converter, node, desc) -> None:
    """Object Info tells the pass index of the material, too."""
    desc.inputs["Material Index"] = (float(converter.material_index),) * 3 + (1.0,)


def _image(converter, node, desc) -> None:
    """Exports the node's image."""
    desc.image = converter.images.add(node.image, node.image_user, converter.label(node))


def _image_texture(converter, node, desc) -> None:
    """Exports the node's image, or the images of its tiles, and how it is thrown on a box."""
    _image(converter, node, desc)
    tiles = converter.images.tiles(node.image)
    if tiles:
        desc.arrays["Tiles"] = np.array(tiles, np.float32)
    if node.projection == "BOX":
        desc.inputs["Blend"] = (node.projection_blend,) * 3 + (1.0,)


def _object_space(converter, node, desc) -> None:
    """The coordinates may be those of another object."""
    if node.object is not None:
        inverse = np.linalg.inv(np.array(node.object.matrix_world, np.float64))
        desc.arrays["Object"] = inverse[:3].astype(np.float32)


def _stand_in(message: str) -> Callable:
    """Says what is done in place of a node's work."""
    return lambda converter, node, desc: converter.warn(node, message)


def _sky(converter, node, desc) -> None:
    """An environment of the sky without its sun, which `Converter.skies` keeps."""
    if node.sky_type == "HOSEK_WILKIE":
        converter.warn(node, "Hosek-Wilkie's sky is not supported, Preetham's is used")
    setting = compat.sky(node)
    desc.image = converter.images.add_pixels(node.name, sky.sky_image(setting))
    converter.skies.append((desc, setting))


_GLOSSY = NodeKind(
    "bsdf_glossy",
    ("Color", "Roughness", "Normal", "Anisotropy", "Rotation", "Tangent"),
    ("BSDF",),
    options={"distribution": (*DISTRIBUTIONS, "ASHIKHMIN_SHIRLEY")},
    adjust=_sharp,
)

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
_DIMENSIONS = ("3D", "1D", "2D", "4D")
_FRACTALS = (
    "FBM",
    "MULTIFRACTAL",
    "HYBRID_MULTIFRACTAL",
    "RIDGED_MULTIFRACTAL",
    "HETERO_TERRAIN",
)
_CHANNELS = ("Red", "Green", "Blue")
_SWITCH = ("False", "True")


_EXTEND = {"mapping.extend": ("EXTRAPOLATED", "HORIZONTAL")}


def _separate(**columns) -> NodeKind:
    return NodeKind("separate_color", ("Color",), _CHANNELS, **columns)


def _combine(**columns) -> NodeKind:
    return NodeKind("combine_color", _CHANNELS, ("Color",), **columns)


NODES = {
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
        ),
        ("BSDF",),
        options={
            "distribution": DISTRIBUTIONS,
            "fresnel_type": ("F82", "PHYSICAL_CONDUCTOR"),
        },
        neutral_inputs={"Thin Film Thickness": 0.0},
    ),
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
        ),
        ("BSDF",),
        options={
            "distribution": ("GGX", "MULTI_GGX"),
            "subsurface_method": SUBSURFACE_METHODS,
        },
        fixed_options={"model": "LAYERED"},
        neutral_inputs={
            "Thin Film Thickness": 0.0,
        },
        adjust=_old_principled,
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
            "Radial Roughness",
        ),
        ("BSDF",),
        options={"parametrization": ("COLOR", "MELANIN", "ABSORPTION")},
    ),
    "ShaderNodeBsdfRayPortal": NodeKind("bsdf_ray_portal", ("Color",), ("BSDF",)),
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
            "projection": ("FLAT", "BOX", "SPHERE", "TUBE"),
        },
        adjust=_image_texture,
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
    "ShaderNodeTexSky": NodeKind(
        "environment_texture",
        ("Vector",),
        ("Color",),
        fixed_options={"projection": "EQUIRECTANGULAR", "interpolation": "Linear"},
        adjust=_sky,
    ),
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
    "ShaderNodeUVMap": NodeKind(
        "uv_map",
        (),
        ("UV",),
        options={"uv_map": ANY, "from_instancer": _SWITCH},
    ),
    "ShaderNodeTexCoord": NodeKind(
        "texture_coordinate",
        (),
        ("Generated", "Normal", "UV", "Object", "Camera", "Window", "Reflection"),
        options={"from_instancer": _SWITCH},
        adjust=_object_space,
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
        options={"operation": ANY, "use_clamp": _SWITCH},
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
            "clamp_factor": _SWITCH,
            "clamp_result": _SWITCH,
        },
    ),
    "ShaderNodeMixRGB": NodeKind(
        "mix_rgb",
        ("Fac", "Color1", "Color2"),
        ("Color",),
        options={"blend_type": _BLENDS, "use_clamp": _SWITCH},
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
            "clamp": _SWITCH,
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
            "invert": _SWITCH,
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
    "ShaderNodeWireframe": NodeKind(
        "wireframe", ("Size",), ("Fac",), options={"use_pixel_size": _SWITCH}
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
    "ShaderNodeValToRGB": NodeKind(
        "color_ramp",
        ("Fac",),
        ("Color", "Alpha"),
        options={
            "color_ramp.interpolation": ("LINEAR", "EASE", "B_SPLINE", "CARDINAL", "CONSTANT")
        },
        arrays={"Table": _ramp},
    ),
    "ShaderNodeTexChecker": NodeKind(
        "checker_texture", ("Vector", "Color1", "Color2", "Scale"), ("Color", "Fac")
    ),
    "ShaderNodeTexGradient": NodeKind(
        "gradient_texture",
        ("Vector",),
        ("Color", "Fac"),
        options={
            "gradient_type": (
                "LINEAR",
                "QUADRATIC",
                "EASING",
                "DIAGONAL",
                "SPHERICAL",
                "QUADRATIC_SPHERE",
                "RADIAL",
            )
        },
    ),
    "ShaderNodeTexWhiteNoise": NodeKind(
        "white_noise_texture",
        ("Vector", "W"),
        ("Value", "Color"),
        options={"noise_dimensions": _DIMENSIONS},
    ),
    "ShaderNodeTexNoise": NodeKind(
        "noise_texture",
        (
            "Vector",
            "W",
            "Scale",
            "Detail",
            "Roughness",
            "Lacunarity",
            "Offset",
            "Gain",
            "Distortion",
        ),
        ("Fac", "Color"),
        options={
            "noise_dimensions": _DIMENSIONS,
            "noise_type": _FRACTALS,
            "normalize": ("True", "False"),
        },
    ),
    "ShaderNodeTexMusgrave": NodeKind(
        "musgrave_texture",
        ("Vector", "W", "Scale", "Detail", "Dimension", "Lacunarity", "Offset", "Gain"),
        ("Fac",),
        options={"musgrave_dimensions": _DIMENSIONS, "musgrave_type": _FRACTALS},
    ),
    "ShaderNodeTexVoronoi": NodeKind(
        "voronoi_texture",
        (
            "Vector",
            "W",
            "Scale",
            "Detail",
            "Roughness",
            "Lacunarity",
            "Smoothness",
            "Exponent",
            "Randomness",
        ),
        ("Distance", "Color", "Position", "W", "Radius"),
        options={
            "voronoi_dimensions": _DIMENSIONS,
            "feature": ("F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS"),
            "distance": ("EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI"),
            "normalize": _SWITCH,
        },
        fixed_options={"hash": "LOOKUP3"},
        adjust=_voronoi_hash,
    ),
    "ShaderNodeTexWave": NodeKind(
        "wave_texture",
        (
            "Vector",
            "Scale",
            "Distortion",
            "Detail",
            "Detail Scale",
            "Detail Roughness",
            "Phase Offset",
        ),
        ("Color", "Fac"),
        options={
            "wave_type": ("BANDS", "RINGS"),
            "bands_direction": ("X", "Y", "Z", "DIAGONAL"),
            "rings_direction": ("X", "Y", "Z", "SPHERICAL"),
            "wave_profile": ("SIN", "SAW", "TRI"),
        },
    ),
    "ShaderNodeTexMagic": NodeKind(
        "magic_texture",
        ("Vector", "Scale", "Distortion"),
        ("Color", "Fac"),
        options={"turbulence_depth": ANY},
    ),
    "ShaderNodeTexBrick": NodeKind(
        "brick_texture",
        (
            "Vector",
            "Color1",
            "Color2",
            "Mortar",
            "Scale",
            "Mortar Size",
            "Mortar Smooth",
            "Bias",
            "Brick Width",
            "Row Height",
        ),
        ("Color", "Fac"),
        arrays={"Rows": _brick_rows},
    ),
    "ShaderNodeRGB": NodeKind("rgb", (), ("Color",), adjust=_output_value),
    "ShaderNodeValue": NodeKind("value", (), ("Value",), adjust=_output_value),
}
