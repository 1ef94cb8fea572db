# SPDX-License-Identifier: GPL-3.0-or-later
"""A material's inputs, image textures and normal maps as LuxCore's properties."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from tests.instruments.bench._description import desc

# A socket without link and constant has Blender's default; those that are read here.
DEFAULTS = {
    ("bsdf_diffuse", "Color"): (0.8, 0.8, 0.8),
    ("bsdf_diffuse", "Roughness"): 0.0,
    ("bsdf_glossy", "Color"): (0.8, 0.8, 0.8),
    ("bsdf_glossy", "Roughness"): 0.5,
    ("bsdf_glass", "Color"): (1.0, 1.0, 1.0),
    ("bsdf_glass", "Roughness"): 0.0,
    ("bsdf_glass", "IOR"): 1.5,
    ("bsdf_transparent", "Color"): (1.0, 1.0, 1.0),
    ("bsdf_principled", "Base Color"): (0.8, 0.8, 0.8),
    ("bsdf_principled", "Metallic"): 0.0,
    ("bsdf_principled", "Roughness"): 0.5,
    ("bsdf_principled", "IOR"): 1.5,
    ("bsdf_principled", "Alpha"): 1.0,
    ("bsdf_principled", "Specular IOR Level"): 0.5,
    ("bsdf_principled", "Specular Tint"): (1.0, 1.0, 1.0),
    ("bsdf_principled", "Transmission Weight"): 0.0,
    ("bsdf_principled", "Emission Color"): (1.0, 1.0, 1.0),
    ("bsdf_principled", "Emission Strength"): 0.0,
    ("bsdf_principled", "Coat Weight"): 0.0,
    ("background", "Color"): (0.8, 0.8, 0.8),
    ("background", "Strength"): 1.0,
    ("mix_shader", "Fac"): 0.5,
    ("normal_map", "Strength"): 1.0,
    ("mapping", "Location"): (0.0, 0.0, 0.0),
    ("mapping", "Rotation"): (0.0, 0.0, 0.0),
    ("mapping", "Scale"): (1.0, 1.0, 1.0),
}
WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "black"}


class UntranslatedError(Exception):
    """LuxCore has no equal for something in the scene; the message names it."""


@dataclass
class Translation:
    """A scene as LuxCore takes it; nothing here needs LuxCore."""

    properties: dict[str, object] = field(default_factory=dict)
    # Name -> (positions, triangles, normals or None, uvs or None), world or object space.
    meshes: dict[str, tuple] = field(default_factory=dict)
    images: dict[str, np.ndarray] = field(default_factory=dict)  # (H, W, 3) float32, linear

    def set(self, prefix: str, **values) -> None:
        """Sets prefix.key for each keyword; "__" in a keyword is a dot."""
        for key, value in values.items():
            self.properties[f"{prefix}.{key.replace('__', '.')}"] = value


def is_constant(value) -> bool:
    """False for the name of a texture."""
    return not isinstance(value, str)


def linear_pixels(image) -> np.ndarray:
    """(H, W, 3) float32, linear Rec.709, top row first as LuxCore takes images.

    Specula decodes 8-bit sRGB after filtering instead: a difference between texels that differ.
    """
    if image.pixels is None:
        raise UntranslatedError(f"image {image.name}: is not decoded")
    pixels = np.asarray(image.pixels, np.float32)
    if image.pixels.dtype == np.uint8:
        pixels /= 255.0
    color = np.repeat(pixels, 3, axis=2) if pixels.shape[2] == 1 else pixels[:, :, :3]
    if pixels.shape[2] == 4 and not (pixels[:, :, 3] == 1.0).all():
        raise UntranslatedError(f"image {image.name}: has an alpha channel")
    if image.color_space == desc.ColorSpace.SRGB:
        color = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)
    return np.ascontiguousarray(color[::-1], np.float32)


def doubled(pixels: np.ndarray) -> np.ndarray:
    """An equirectangular image at twice the resolution, filtered as both renderers filter it.

    LuxCore samples an environment by whole texels but filters what it finds there: light that
    bleeds out of a small sun is then found by chance alone. Smaller texels bleed less.
    """
    height, width, _ = pixels.shape
    rows = np.pad(pixels, ((1, 1), (0, 0), (0, 0)), "edge")
    pixels = np.stack(
        [0.25 * rows[:-2] + 0.75 * rows[1:-1], 0.75 * rows[1:-1] + 0.25 * rows[2:]], axis=1
    ).reshape(2 * height, width, 3)
    columns = np.pad(pixels, ((0, 0), (1, 1), (0, 0)), "wrap")
    return np.stack(
        [
            0.25 * columns[:, :-2] + 0.75 * columns[:, 1:-1],
            0.75 * columns[:, 1:-1] + 0.25 * columns[:, 2:],
        ],
        axis=2,
    ).reshape(2 * height, 2 * width, 3)


class Inputs:
    """What the sockets of one material's nodes read."""

    def __init__(self, scene, material: int, name: str, translation: Translation):
        self.images = scene.images
        self.material = scene.materials[material]
        self.name = name
        self.translation = translation
        self._links = {(link.to_node, link.to_socket): link for link in self.material.links}

    def fail(self, index: int, message: str) -> UntranslatedError:
        node = self.material.nodes[index]
        return UntranslatedError(
            f"material {self.material.name}, node {node.name} ({node.kind}): {message}"
        )

    def linked(self, index: int, socket: str) -> tuple[int, str] | None:
        """Node and socket that feed an input."""
        link = self._links.get((index, socket))
        return (link.from_node, link.from_socket) if link else None

    def color(self, index: int, socket: str):
        """Three constants, or the name of a texture."""
        source = self.linked(index, socket)
        if source is None:
            return self._constant(index, socket)[:3]
        kind = self.material.nodes[source[0]].kind
        if kind == "rgb":
            return tuple(self.material.nodes[source[0]].inputs["Color"][:3])
        if kind == "image_texture" and source[1] == "Color":
            return self.image(source[0])
        raise self.fail(source[0], f"as {socket} it has no equal in LuxCore")

    def scalar(self, index: int, socket: str) -> float:
        """A constant; a texture is refused."""
        source = self.linked(index, socket)
        if source is None:
            return self._constant(index, socket)[0]
        node = self.material.nodes[source[0]]
        if node.kind == "value":
            return node.inputs["Value"][0]
        raise self.fail(index, f"{socket} that varies is not translated")

    def _constant(self, index: int, socket: str) -> tuple[float, ...]:
        node = self.material.nodes[index]
        if socket in node.inputs:
            return tuple(float(value) for value in node.inputs[socket])
        default = DEFAULTS[node.kind, socket]
        return default if isinstance(default, tuple) else (default,) * 3

    def image(self, index: int) -> str:
        """Name of the texture of an image_texture node."""
        node = self.material.nodes[index]
        if node.options["interpolation"] != "Linear":
            raise self.fail(index, f"interpolation {node.options['interpolation']}")
        if node.options["extension"] not in WRAPS:
            raise self.fail(index, f"extension {node.options['extension']}")
        scale, offset = self._mapping(index)
        name = f"{self.name}_texture{index}"
        file = f"image{node.image}"
        if file not in self.translation.images:
            self.translation.images[file] = linear_pixels(self.images[node.image])
        self.translation.set(
            f"scene.textures.{name}",
            type="imagemap",
            file=file,
            gamma=1.0,
            storage="float",
            wrap=WRAPS[node.options["extension"]],
            mapping__type="uvmapping2d",
            # LuxCore's images hang from the top.
            mapping__uvscale=[scale[0], -scale[1]],
            mapping__uvdelta=[offset[0], 1.0 - offset[1]],
        )
        return name

    def _mapping(self, index: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Scale and offset of the UV map that a texture node reads."""
        source = self.linked(index, "Vector")
        if source is None:
            return (1.0, 1.0), (0.0, 0.0)
        mapping, name = source
        node = self.material.nodes[mapping]
        if node.kind != "mapping":
            self._check_uv(mapping, name)
            return (1.0, 1.0), (0.0, 0.0)
        before = self.linked(mapping, "Vector")
        if before is None or node.options["vector_type"] != "POINT":
            raise self.fail(mapping, "only UV maps as points are translated")
        self._check_uv(*before)
        location, rotation, scale = (
            self.color(mapping, socket) for socket in ("Location", "Rotation", "Scale")
        )
        if not all(is_constant(value) for value in (location, rotation, scale)) or any(rotation):
            raise self.fail(mapping, "rotation is not translated")
        return scale[:2], location[:2]

    def _check_uv(self, index: int, socket: str) -> None:
        """Meshes are translated with one UV map, so its name does not matter."""
        if (self.material.nodes[index].kind, socket) not in (
            ("uv_map", "UV"),
            ("texture_coordinate", "UV"),
        ):
            raise self.fail(index, f"{socket} as a texture's coordinate is not translated")

    def normal(self, index: int) -> dict[str, str]:
        """Property of a material whose node has a normal map; none where it has not."""
        source = self.linked(index, "Normal")
        if source is None:
            return {}
        node = self.material.nodes[source[0]]
        if node.kind != "normal_map" or node.options["space"] != "TANGENT":
            raise self.fail(source[0], "only normal maps in tangent space are translated")
        # LuxCore scales x and y; Blender also draws z to 1, which is the same for a strength of 1.
        if not math.isclose(self.scalar(source[0], "Strength"), 1.0):
            raise self.fail(source[0], "LuxCore has another strength")
        color = self.color(source[0], "Color")
        if is_constant(color):
            return {}
        name = f"{self.name}_normal{source[0]}"
        self.translation.set(f"scene.textures.{name}", type="normalmap", texture=color, scale=1.0)
        return {"bumptex": name}
