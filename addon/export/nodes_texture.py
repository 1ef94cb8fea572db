# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures: a row for each node."""

from __future__ import annotations

import numpy as np

from . import compat, ies, sky
from .node_kind import ANY, SWITCH, NodeKind

INTERPOLATIONS = ("Linear", "Closest", "Cubic", "Smart")
_DIMENSIONS = ("3D", "1D", "2D", "4D")
_FRACTALS = (
    "FBM",
    "MULTIFRACTAL",
    "HYBRID_MULTIFRACTAL",
    "RIDGED_MULTIFRACTAL",
    "HETERO_TERRAIN",
)


def _voronoi_hash(converter, node, desc) -> None:
    """Cells have got other numbers with 5.0."""
    desc.options["hash"] = compat.voronoi_hash()


def _brick_rows(node) -> np.ndarray:
    """How rows of bricks are moved and squeezed, with every how many of them are: (2, 2)."""
    rows = ((node.offset, node.offset_frequency), (node.squash, node.squash_frequency))
    return np.array(rows, np.float32)


def _read_ies(node) -> tuple[np.ndarray, str]:
    """The table of a text or file, and what is wrong with that."""
    try:
        return ies.profile(compat.ies_text(node)), ""
    except (OSError, ies.IesError) as error:
        return ies.constant_profile(), str(error)


def _ies_profile(node) -> np.ndarray:
    return _read_ies(node)[0]


def _ies(converter, node, desc) -> None:
    """Tells of a table that cannot be read."""
    _, problem = _read_ies(node)
    if problem:
        converter.warn(node, f"cannot be read ({problem}), shines evenly by {ies.NOT_READ:g}")


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


def _sky(converter, node, desc) -> None:
    """An environment of the sky without its sun, which `Converter.skies` keeps."""
    if node.sky_type == "HOSEK_WILKIE":
        converter.warn(node, "Hosek-Wilkie's sky is not supported, Preetham's is used")
    setting = compat.sky(node)
    desc.image = converter.images.add_pixels(node.name, sky.sky_image(setting))
    converter.skies.append((desc, setting))


TEXTURE_NODES = {
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
            "normalize": SWITCH,
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
    "ShaderNodeTexIES": NodeKind(
        "ies_texture",
        ("Vector", "Strength"),
        ("Fac",),
        arrays={"Profile": _ies_profile},
        adjust=_ies,
    ),
}
