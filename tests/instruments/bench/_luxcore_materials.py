# SPDX-License-Identifier: GPL-3.0-or-later
"""Material graphs and the world as LuxCore's properties.

Each shader becomes a LuxCore material of its own; what has no equal raises UntranslatedError.
"""

from __future__ import annotations

import math

import numpy as np

from tests.instruments.bench._description import desc
from tests.instruments.bench._luxcore_textures import (
    Inputs,
    Translation,
    UntranslatedError,
    doubled,
    is_constant,
    linear_pixels,
)

# Roughness below which a surface is a mirror to single precision.
SMOOTH = 0.0045
DARK = 1e-9  # emission that is none, W/m^2/sr


class Materials:
    """Translates materials on their first use."""

    def __init__(self, scene, translation: Translation):
        self._scene = scene
        self._translation = translation
        self._names: dict[int, str] = {}

    def name(self, index: int) -> str:
        """LuxCore's name of the scene's material `index`."""
        if index not in self._names:
            self._names[index] = f"material{index}"
            inputs = Inputs(self._scene, index, self._names[index], self._translation)
            source = inputs.linked(0, "Surface")
            if source is None:
                self._set(self._names[index], type="matte", kd=value((0.0, 0.0, 0.0)))
            else:
                self._shader(inputs, source[0], self._names[index])
        return self._names[index]

    def _set(self, name: str, **values) -> None:
        self._translation.set(f"scene.materials.{name}", **values)

    def _shader(self, inputs: Inputs, index: int, name: str) -> None:
        node = inputs.material.nodes[index]
        if node.kind not in SHADERS:
            raise inputs.fail(index, "has no equal in LuxCore")
        self._set(name, **SHADERS[node.kind](self, inputs, index, name))

    # Each returns the properties of the LuxCore material `name` for the node at `index`.

    def _diffuse(self, inputs: Inputs, index: int, name: str) -> dict:
        return {"type": "matte", "kd": value(inputs.color(index, "Color")), **inputs.normal(index)}

    def _glossy(self, inputs: Inputs, index: int, name: str) -> dict:
        color = inputs.color(index, "Color")
        roughness = inputs.scalar(index, "Roughness")
        if roughness < SMOOTH:
            return {"type": "mirror", "kr": value(color), **inputs.normal(index)}
        return {**_metal(inputs, index, color, roughness), **inputs.normal(index)}

    def _glass(self, inputs: Inputs, index: int, name: str) -> dict:
        if inputs.scalar(index, "Roughness") >= SMOOTH:
            raise inputs.fail(index, "rough glass of this distribution has no equal in LuxCore")
        color = value(inputs.color(index, "Color"))
        return {
            "type": "glass",
            "kr": color,
            "kt": color,
            "interiorior": value(inputs.scalar(index, "IOR")),
            "exteriorior": value(1.0),
            **inputs.normal(index),
        }

    def _transparent(self, inputs: Inputs, index: int, name: str) -> dict:
        if inputs.color(index, "Color") != (1.0, 1.0, 1.0):
            raise inputs.fail(index, "only white has an equal in LuxCore")
        return {"type": "null"}

    def _mix(self, inputs: Inputs, index: int, name: str) -> dict:
        names = []
        for number, socket in enumerate(("Shader", "Shader_001"), 1):
            source = inputs.linked(index, socket)
            if source is None:
                raise inputs.fail(index, f"{socket} reads nothing")
            names.append(f"{name}_{number}")
            self._shader(inputs, source[0], names[-1])
        return {
            "type": "mix",
            "material1": names[0],
            "material2": names[1],
            "amount": value(inputs.scalar(index, "Fac")),
        }

    def _principled(self, inputs: Inputs, index: int, name: str) -> dict:
        self._check_principled(inputs, index)
        color = inputs.color(index, "Base Color")
        roughness = inputs.scalar(index, "Roughness")
        metallic = inputs.scalar(index, "Metallic")
        normal = inputs.normal(index)
        if metallic == 1.0:
            if roughness < SMOOTH:
                # Without Schlick's rise to white, which counts at grazing angles alone.
                return {"type": "mirror", "kr": value(color), **normal}
            return {**_metal(inputs, index, color, roughness), **normal}
        if metallic != 0.0 or roughness < SMOOTH:
            raise inputs.fail(index, "a smooth or partly metallic coat has no equal in LuxCore")
        ior = inputs.scalar(index, "IOR")
        level = inputs.scalar(index, "Specular IOR Level")
        f0 = 2.0 * level * ((ior - 1.0) / (ior + 1.0)) ** 2
        return {
            "type": "glossy2",
            "kd": value(color),
            "ks": value((f0, f0, f0)),
            "index": value(0.0),
            "uroughness": value(roughness**2),
            "vroughness": value(roughness**2),
            "multibounce": False,
            **normal,
        }

    def _check_principled(self, inputs: Inputs, index: int) -> None:
        for socket, neutral in (("Alpha", 1.0), ("Transmission Weight", 0.0), ("Coat Weight", 0.0)):
            if inputs.scalar(index, socket) != neutral:
                raise inputs.fail(index, f"{socket} is not translated")
        if inputs.color(index, "Specular Tint") != (1.0, 1.0, 1.0):
            raise inputs.fail(index, "Specular Tint is not translated")
        strength = inputs.scalar(index, "Emission Strength")
        emission = inputs.color(index, "Emission Color")
        if strength and (not is_constant(emission) or max(emission) * strength > DARK):
            raise inputs.fail(index, "LuxCore's emitters shine from one side only")


# Not among them: emission, which LuxCore's surfaces give from one side only.
SHADERS = {
    "bsdf_diffuse": Materials._diffuse,
    "bsdf_glossy": Materials._glossy,
    "bsdf_glass": Materials._glass,
    "bsdf_transparent": Materials._transparent,
    "bsdf_principled": Materials._principled,
    "mix_shader": Materials._mix,
}


def _metal(inputs: Inputs, index: int, color, roughness: float) -> dict:
    """Facets of the same distribution, shadowed by Schlick's approximation, a conductor's
    reflectance: within some percent of Blender's. (LuxCore's "disney" is closer on paper, but in
    version 2.11 its value has one cosine more than what it samples.)"""
    if not is_constant(color):
        raise inputs.fail(index, "rough metal with a texture as its colour is not translated")
    return {
        "type": "metal2",
        # Of all n and k with the colour at normal incidence, ((n-1)^2 + k^2) / ((n+1)^2 + k^2), a
        # pair that stays close to it at other angles.
        "n": value((1.0, 1.0, 1.0)),
        "k": value([2.0 * math.sqrt(c / max(1.0 - c, 1e-3)) for c in color]),
        "uroughness": value(roughness**2),
        "vroughness": value(roughness**2),
    }


def value(constant) -> str:
    """A number, some numbers or a texture's name where LuxCore reads a texture: it takes constants
    there as decimal text alone."""
    if not is_constant(constant):
        return constant
    return " ".join(f"{float(number):.9g}" for number in np.atleast_1d(constant))


def add_world(scene, translation: Translation) -> None:
    """The environment: one colour, or an equirectangular image around the vertical axis."""
    environment = scene.environment
    if environment is None:
        return
    if environment.visibility != desc.Visibility.ALL:
        raise UntranslatedError(f"world: ray visibility {environment.visibility!r} has no equal")
    inputs = Inputs(scene, environment.material, "world", translation)
    material = inputs.material
    source = inputs.linked(0, "Surface")
    if source is None:
        return
    if material.nodes[source[0]].kind != "background":
        raise inputs.fail(source[0], "only a background is translated")
    strength = inputs.scalar(source[0], "Strength")
    texture = inputs.linked(source[0], "Color")
    if texture is None:
        _add_constant(translation, np.multiply(inputs.color(source[0], "Color"), strength))
    elif material.nodes[texture[0]].kind == "environment_texture":
        _add_image(inputs, texture[0], strength, translation)
    else:
        raise inputs.fail(texture[0], "has no equal in LuxCore's environments")


def _add_constant(translation: Translation, radiance) -> None:
    if np.any(radiance):
        translation.set(
            "scene.lights.world",
            type="constantinfinite",
            color=[float(channel) for channel in radiance],
        )


def _add_image(inputs: Inputs, index: int, strength: float, translation: Translation) -> None:
    node = inputs.material.nodes[index]
    if node.options != {"projection": "EQUIRECTANGULAR", "interpolation": "Linear"}:
        raise inputs.fail(index, f"{node.options} is not translated")
    _check_direction(inputs, index)
    translation.images["sky"] = doubled(linear_pixels(inputs.images[node.image]))
    translation.set(
        "scene.lights.world",
        type="infinite",
        file="sky",
        gamma=1.0,
        storage="float",
        gain=[strength] * 3,
        transformation=ENVIRONMENT_TRANSFORM,
    )


def _check_direction(inputs: Inputs, index: int) -> None:
    """The image must be read by the direction as it is."""
    source = inputs.linked(index, "Vector")
    if source is not None and inputs.material.nodes[source[0]].kind == "mapping":
        location, rotation, scale = (
            inputs.color(source[0], socket) for socket in ("Location", "Rotation", "Scale")
        )
        if any(location) or any(rotation) or scale != (1.0, 1.0, 1.0):
            raise inputs.fail(source[0], "a turned environment is not translated")
        source = inputs.linked(source[0], "Vector")
    if source is not None and (inputs.material.nodes[source[0]].kind, source[1]) != (
        "texture_coordinate",
        "Generated",
    ):
        raise inputs.fail(source[0], f"{source[1]} as a direction is not translated")


# Column by column: LuxCore's image runs around Z the other way round, as seen from inside.
ENVIRONMENT_TRANSFORM = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
