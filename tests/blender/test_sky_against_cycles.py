# SPDX-License-Identifier: GPL-3.0-or-later
"""The image and the sun that a Sky Texture becomes are what Cycles shows, in this Blender."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector
from scenes import add_camera, add_node, new_world, surface

from specula.export import compat
from specula.export.sky import HEIGHT, WIDTH, sky_image, sun_irradiance

BLOCK = 4  # pixels of the sky's image along a side of one of Cycles'
FIELD = math.radians(1.2)  # of view, around the sun
TOLERANCE = 0.015  # root mean square
MEAN_TOLERANCE = 0.003
SUN_TOLERANCE = 0.01


def radiance(engine: str, tmp_path, width: int, height: int) -> np.ndarray:
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(tmp_path / "sky.exr")
    scene.cycles.samples = scene.specula.samples = BLOCK**2
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1.0
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.array(image.pixels[:]).reshape(height, width, 4)[..., :3]
    bpy.data.images.remove(image)
    return pixels


@pytest.fixture
def sky():
    """The node of a world that shows one, over a camera without anything to see."""
    bpy.ops.wm.read_homefile(use_empty=True)
    world = new_world()
    background = add_node(world, "ShaderNodeBackground", surface(world))
    add_camera((0, 0, 0))
    return add_node(world, "ShaderNodeTexSky", background.inputs["Color"])


def set_model(sky, *names: str) -> None:
    """The first of the names that this Blender knows."""
    known = [item.identifier for item in sky.bl_rna.properties["sky_type"].enum_items]
    name = next((name for name in names if name in known), None)
    if name is None:
        pytest.skip("not in this Blender")
    sky.sky_type = name
    if name == "PREETHAM":
        sky.turbidity, sky.sun_direction = 3.1, (0.5, 0.7, 0.35)
    else:
        sky.sun_elevation, sky.sun_rotation, sky.altitude = 0.3, 0.7, 800.0


MODELS = [("PREETHAM",), ("SINGLE_SCATTERING", "NISHITA"), ("MULTIPLE_SCATTERING",)]


@pytest.mark.parametrize("names", MODELS)
def test_sky(sky, names, tmp_path):
    set_model(sky, *names)
    sky.sun_disc = False
    camera = bpy.context.scene.camera
    camera.data.type = "PANO"
    owner = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    owner.panorama_type = "EQUIRECTANGULAR"
    camera.rotation_euler = (math.pi / 2, 0, -math.pi / 2)  # its middle at +X
    width, height = WIDTH // BLOCK, HEIGHT // BLOCK
    theirs = radiance("CYCLES", tmp_path, width, height)
    image = sky_image(compat.sky(sky)).reshape(height, BLOCK, width, BLOCK, 3).mean(axis=(1, 3))
    areas = np.cos(((np.arange(height) + 0.5) / height - 0.5) * math.pi)[:, None, None]
    for ours in (image, radiance("SPECULA", tmp_path, width, height)):
        error = np.sqrt((areas * (ours - theirs) ** 2).sum() / (areas * theirs**2).sum())
        assert error < TOLERANCE
        sums = [(areas * sky).sum(axis=(0, 1)) for sky in (ours, theirs)]
        np.testing.assert_allclose(*sums, rtol=MEAN_TOLERANCE)


@pytest.mark.parametrize("names", MODELS[1:])
def test_sun(sky, names, tmp_path):
    set_model(sky, *names)
    setting = compat.sky(sky)
    camera = bpy.context.scene.camera
    camera.data.sensor_fit, camera.data.angle = "HORIZONTAL", FIELD
    camera.rotation_mode = "QUATERNION"
    camera.rotation_quaternion = Vector(setting.sun).to_track_quat("-Z", "Y")
    pixels = 96
    seen = radiance("CYCLES", tmp_path, pixels, pixels)
    pixel = (2 * math.tan(FIELD / 2) / pixels) ** 2
    around = np.median(seen[0], axis=0)
    np.testing.assert_allclose(
        sun_irradiance(setting), (seen - around).sum(axis=(0, 1)) * pixel, rtol=SUN_TOLERANCE
    )
