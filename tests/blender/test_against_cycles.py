# SPDX-License-Identifier: GPL-3.0-or-later
"""Units: the same scene in Cycles and in Specula has the same mean colour.

Each factor of light and each conversion of a material meets Cycles itself. Clamping and glossy
filter are off in Cycles, as Specula has neither. Means over the frame: the noise that is left is
below a fifth of TOLERANCE.
"""

import math

import bpy
import numpy as np
import pytest
from scenes import add_camera, add_light, add_mesh, add_node, new_material, new_world, surface

from specula.export import compat

SIZE = 32
SAMPLES = 128
TOLERANCE = 0.01  # of the mean
# Today's closures are the model: until 4.0 Cycles' Principled and Oren-Nayar were others.
TOLERANCE_CLOSURES = TOLERANCE if bpy.app.version >= (4, 3, 0) else 0.03
PLANE = [(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)]
WHITE = (0.8, 0.8, 0.8, 1)

LIGHTS = {
    "point": ("POINT", {"energy": 500, "shadow_soft_size": 0}),
    "small sphere": ("POINT", {"energy": 500, "shadow_soft_size": 0.1}),
    "spot": ("SPOT", {"energy": 900, "spot_size": 1.0, "spot_blend": 0.3, "shadow_soft_size": 0}),
    "sun": ("SUN", {"energy": 3, "angle": 0.1}),
    "square": ("AREA", {"energy": 500, "shape": "SQUARE", "size": 1.5}),
    "rectangle": ("AREA", {"energy": 500, "shape": "RECTANGLE", "size": 1, "size_y": 2}),
    "disk": ("AREA", {"energy": 500, "shape": "DISK", "size": 1}),
    "ellipse": ("AREA", {"energy": 500, "shape": "ELLIPSE", "size": 1, "size_y": 2}),
}

COPPER = (0.8, 0.4, 0.2, 1)
MATERIALS = {
    "rough diffuse": ("ShaderNodeBsdfDiffuse", None, {"Color": COPPER, "Roughness": 0.5}),
    "glossy": ("ShaderNodeBsdfGlossy", "GGX", {"Color": COPPER, "Roughness": 0.5}),
    "glass": ("ShaderNodeBsdfGlass", "GGX", {"Roughness": 0.4, "IOR": 1.4}),
    "emission": ("ShaderNodeEmission", None, {"Color": COPPER, "Strength": 2.0}),
    "plastic": ("ShaderNodeBsdfPrincipled", "GGX", {"Base Color": COPPER, "Roughness": 0.4}),
    "metal": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Roughness": 0.5, "Metallic": 1.0},
    ),
    "emitting": (
        "ShaderNodeBsdfPrincipled",
        "GGX",
        {"Base Color": COPPER, "Emission Color": COPPER, "Emission Strength": 2.0},
    ),
}


@pytest.fixture
def stage(tmp_path):
    """A plane with a cube on it; returns compare()."""
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.specula.samples = SAMPLES
    for name, value in {
        "samples": SAMPLES,
        "use_denoising": False,
        "use_adaptive_sampling": False,
        "sample_clamp_direct": 0,
        "sample_clamp_indirect": 0,
        "blur_glossy": 0,
    }.items():
        setattr(scene.cycles, name, value)
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    add_mesh("Plane", PLANE, material=diffuse(WHITE))
    camera = add_camera((0, -8, 5))
    camera.rotation_euler = (math.radians(60), 0, 0)

    def mean(engine: str) -> np.ndarray:
        scene.render.engine = engine
        scene.render.filepath = str(tmp_path / f"{engine}.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        image.colorspace_settings.name = "Non-Color"
        pixels = np.array(image.pixels[:]).reshape(-1, 4)
        bpy.data.images.remove(image)
        return pixels.mean(axis=0)

    def compare(tolerance=TOLERANCE) -> None:
        np.testing.assert_allclose(mean("SPECULA"), mean("CYCLES"), rtol=tolerance)

    return compare


def diffuse(color):
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    shader.inputs["Color"].default_value = color
    return material


def place(light) -> None:
    light.location = (2, -2, 5)
    light.rotation_euler = (0.5, 0.3, 0)


def add_sky(strength=0.5) -> None:
    world = new_world()
    background = add_node(world, "ShaderNodeBackground", surface(world))
    background.inputs["Color"].default_value = (0.3, 0.5, 0.8, 1)
    background.inputs["Strength"].default_value = strength


@pytest.mark.parametrize("name", LIGHTS)
def test_light(stage, name):
    kind, properties = LIGHTS[name]
    if kind == "SPOT" and bpy.app.version < (4, 0, 0):
        pytest.skip("the edge of Cycles' spots had another profile")
    light = add_light(kind, color=(1, 0.5, 0.25), **properties)
    place(light)
    if kind == "AREA":
        light.scale = (1, 1.5, 1)
    stage()


def test_world(stage):
    add_sky()
    stage()


@pytest.mark.parametrize("name", MATERIALS)
def test_material(stage, name):
    bl_idname, distribution, inputs = MATERIALS[name]
    add_sky()
    place(add_light("AREA", energy=300, size=1.0))
    material = new_material()
    shader = add_node(material, bl_idname, surface(material))
    if distribution:
        shader.distribution = distribution
    for socket, value in inputs.items():
        compat.find_input(shader, socket).default_value = value
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.2, location=(0, 0, 1.3))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material)
    stage(TOLERANCE_CLOSURES)
