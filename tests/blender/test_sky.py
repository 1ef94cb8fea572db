# SPDX-License-Identifier: GPL-3.0-or-later
"""What a world with a Sky Texture becomes: an environment image and, where it can, a sun light."""

import math

import numpy as np
import pytest
from scenes import add_node, export, new_world, surface

from specula.abi import LightType
from specula.export import compat
from specula.export.sky import HEIGHT, WIDTH, Sky, add_sun, sun_irradiance


def add_sky(strength=1.0):
    world = new_world()
    background = add_node(world, "ShaderNodeBackground", surface(world))
    background.inputs["Strength"].default_value = strength
    sky = add_node(world, "ShaderNodeTexSky", background.inputs["Color"])
    known = [item.identifier for item in sky.bl_rna.properties["sky_type"].enum_items]
    sky.sky_type = "NISHITA" if "NISHITA" in known else "SINGLE_SCATTERING"
    sky.sun_elevation, sky.sun_rotation = 0.5, 0.3
    return world, background, sky


def test_a_plain_sky_gives_its_sun_as_a_light():
    _, _, sky = add_sky(strength=0.25)
    scene, _ = export()
    (light,) = scene.lights
    assert light.type == LightType.SUN
    assert light.sun_angle == pytest.approx(sky.sun_size)
    up = (math.cos(0.5) * math.sin(0.3), math.cos(0.5) * math.cos(0.3), math.sin(0.5))
    np.testing.assert_allclose(light.transform[:, 2], up, atol=1e-6)
    np.testing.assert_allclose(np.linalg.det(light.transform[:, :3]), 1, atol=1e-6)
    np.testing.assert_allclose(light.power, 0.25 * sun_irradiance(compat.sky(sky)), rtol=1e-6)
    assert scene.images[0].pixels.shape == (HEIGHT, WIDTH, 3)


def test_a_sky_that_is_changed_keeps_its_sun():
    world, background, sky = add_sky()
    plain = export()[0].images[0].pixels
    gamma = add_node(world, "ShaderNodeGamma", background.inputs["Color"])
    world.node_tree.links.new(sky.outputs["Color"], gamma.inputs["Color"])
    scene, _ = export()
    assert scene.lights == []
    assert scene.images[0].pixels.max() > 100 * plain.max()


def test_a_sky_without_a_disc_has_no_sun():
    _, _, sky = add_sky()
    sky.sun_disc = False
    assert export()[0].lights == []


def test_a_sun_in_an_image_keeps_its_irradiance():
    sky = Sky("SINGLE_SCATTERING", (0.6, 0.0, 0.8), sun_size=0.02)
    image = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    add_sun(image, sky)
    elevations = ((np.arange(HEIGHT) + 0.5) / HEIGHT - 0.5) * math.pi
    areas = np.cos(elevations)[:, None, None] * (math.pi / HEIGHT) * (2 * math.pi / WIDTH)
    np.testing.assert_allclose((image * areas).sum(axis=(0, 1)), sun_irradiance(sky), rtol=1e-3)


def test_a_sun_sets():
    def irradiance(elevation):
        sun = (math.cos(elevation), 0.0, math.sin(elevation))
        return sun_irradiance(Sky("SINGLE_SCATTERING", sun, sun_size=0.01))

    assert irradiance(-0.006) is None
    red = [irradiance(elevation)[0] for elevation in (-0.004, 0.0, 0.004, 0.1)]
    assert red[0] > 0.0 and red == sorted(red)
