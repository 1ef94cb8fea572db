# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from scenes import add_camera, export

from specula.export.desc import ExportError

POINTS = [(0.3, 0.2, 0), (-1, 0.5, 1), (1.5, -2, -1)]


def project(camera, point):
    """Frame coordinates in [0, 1] from the bottom left, by the exported description alone."""
    to_world = np.vstack((camera.transform, (0, 0, 0, 1))).astype(float)
    x, y, z, _ = np.linalg.inv(to_world) @ (*point, 1)
    left, right, bottom, top = camera.viewplane
    return (x / -z - left) / (right - left), (y / -z - bottom) / (top - bottom)


@pytest.mark.parametrize("fit", ["AUTO", "HORIZONTAL", "VERTICAL"])
@pytest.mark.parametrize("size", [(64, 32), (32, 64)])
@pytest.mark.parametrize("aspect", [(1, 1), (2, 1), (1, 1.5)])
def test_projection_agrees_with_blender(fit, size, aspect):
    obj = add_camera((1, -2, 5))
    obj.rotation_euler = (0.3, 0.2, 0.1)
    data = obj.data
    data.sensor_fit, data.lens, data.sensor_width, data.sensor_height = fit, 35, 30, 20
    data.shift_x, data.shift_y = 0.2, -0.1
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = size
    render.pixel_aspect_x, render.pixel_aspect_y = aspect
    camera = export()[0].camera
    assert (camera.width, camera.height) == size
    for point in POINTS:
        expected = world_to_camera_view(bpy.context.scene, obj, Vector(point))
        assert project(camera, point) == pytest.approx(tuple(expected)[:2], abs=1e-4)


def test_clipping_and_percentage():
    obj = add_camera()
    obj.data.clip_start, obj.data.clip_end = 0.5, 50
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 101, 51, 50
    camera = export()[0].camera
    assert (camera.clip_near, camera.clip_far) == (0.5, 50)
    assert (camera.width, camera.height) == (50, 25)
    assert camera.crop == (0, 0, 50, 25)


def test_border_crops():
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = 100, 50
    render.use_border = True
    render.border_min_x, render.border_max_x = 0.3, 0.7
    render.border_min_y, render.border_max_y = 0.1, 0.77
    assert export()[0].camera.crop == (30, 5, 40, 33)


@pytest.mark.parametrize("kind", ["ORTHO", "PANO"])
def test_other_cameras_are_refused_by_name(kind):
    obj = add_camera()
    obj.name = "Wide"
    obj.data.type = kind
    with pytest.raises(ExportError, match=f"camera Wide: type {kind}"):
        export()


def test_depth_of_field_is_named():
    obj = add_camera()
    obj.data.dof.use_dof = True
    _, warnings = export()
    assert len(warnings) == 1
    assert "camera Camera: depth of field" in warnings[0]
