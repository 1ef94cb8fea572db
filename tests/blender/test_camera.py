# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from scenes import add_camera, export, link

from specula.export import compat
from specula.export.camera import PANORAMAS
from specula.export.desc import ExportError, Projection

POINTS = [(0.3, 0.2, 0), (-1, 0.5, 1), (1.5, -2, -1)]


def project(camera, point):
    """Frame coordinates in [0, 1] from the bottom left, by the exported description alone."""
    to_world = np.vstack((camera.transform, (0, 0, 0, 1))).astype(float)
    x, y, z, _ = np.linalg.inv(to_world) @ (*point, 1)
    left, right, bottom, top = camera.viewplane
    if camera.projection == Projection.ORTHOGRAPHIC:
        z = -1
    return (x / -z - left) / (right - left), (y / -z - bottom) / (top - bottom)


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("fit", ["AUTO", "HORIZONTAL", "VERTICAL"])
@pytest.mark.parametrize("size", [(64, 32), (32, 64)])
@pytest.mark.parametrize("aspect", [(1, 1), (2, 1), (1, 1.5)])
def test_projection_agrees_with_blender(kind, fit, size, aspect):
    obj = add_camera((1, -2, 5))
    obj.rotation_euler = (0.3, 0.2, 0.1)
    data = obj.data
    data.type, data.ortho_scale = kind, 2.5
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


def panoramas() -> list[str]:
    owner = bpy.types.Camera.bl_rna.properties
    if "panorama_type" not in owner:
        owner = bpy.data.cameras.new("Camera").cycles.bl_rna.properties
    return [item.identifier for item in owner["panorama_type"].enum_items]


@pytest.mark.parametrize("kind", panoramas())
def test_a_panorama_is_what_its_numbers_say(kind):
    data = add_camera().data
    data.type, data.shift_x = "PANO", 0.25
    settings = compat.panorama_settings(data)
    settings.panorama_type = kind
    projection, names = PANORAMAS[kind]
    camera = export()[0].camera
    assert camera.projection == projection
    assert camera.viewplane == (0.25, 1.25, 0, 1)
    np.testing.assert_allclose(
        camera.panorama[: len(names)], [getattr(settings, name) for name in names]
    )


def test_a_fisheye_covers_its_sensor():
    data = add_camera().data
    data.type, data.sensor_width = "PANO", 30.0
    settings = compat.panorama_settings(data)
    settings.panorama_type, settings.fisheye_lens = "FISHEYE_EQUISOLID", 12.0
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = 300, 100
    camera = export()[0].camera
    np.testing.assert_allclose(camera.panorama[1:4], (12, 30, 10))


def other_types() -> list[str]:
    known = ("PERSP", "ORTHO", "PANO")
    items = bpy.types.Camera.bl_rna.properties["type"].enum_items
    return [item.identifier for item in items if item.identifier not in known]


@pytest.mark.parametrize("kind", other_types())
def test_other_cameras_are_refused_by_name(kind):
    obj = add_camera()
    obj.name = "Wide"
    obj.data.type = kind
    with pytest.raises(ExportError, match=f"camera Wide: type {kind}"):
        export()


def test_all_is_in_focus_without_depth_of_field():
    dof = add_camera().data.dof
    dof.use_dof, dof.aperture_fstop = False, 0.5
    description, warnings = export()
    assert description.camera.aperture_radius == 0
    assert not warnings


@pytest.mark.parametrize(("kind", "radius"), [("PERSP", 0.08 / 4), ("ORTHO", 1 / 4)])
def test_aperture(kind, radius):
    data = add_camera().data
    data.type, data.lens = kind, 80
    dof = data.dof
    dof.use_dof, dof.aperture_fstop, dof.focus_distance = True, 2.0, 3.5
    dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio = 5, 0.25, 1.5
    description, warnings = export()
    camera = description.camera
    assert camera.aperture_radius == pytest.approx(radius)
    assert camera.focus_distance == 3.5
    assert (camera.aperture_blades, camera.aperture_rotation) == (5, 0.25)
    assert camera.aperture_ratio == 1.5
    assert not warnings


def test_extremes_of_depth_of_field_stay_finite():
    dof = add_camera().data.dof
    dof.use_dof, dof.aperture_fstop, dof.focus_distance = True, 0.0, 0.0
    camera = export()[0].camera
    assert np.isfinite(camera.aperture_radius)
    assert camera.focus_distance > 0


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
def test_focus_object_is_measured_along_the_axis(kind):
    obj = add_camera((1, 0, 5))
    obj.data.type = kind
    obj.scale = (2, 2, 2)
    obj.rotation_euler = (0, np.radians(90), 0)  # looks along -X
    parent, target = link("Parent", None), link("Target", None)
    parent.location, target.location = (-6, 3, 4), (0, 0, 1)
    target.parent = parent
    obj.data.dof.use_dof, obj.data.dof.focus_object = True, target
    assert export()[0].camera.focus_distance == pytest.approx(7)


def test_focus_bone():
    obj = add_camera((0, 0, 5))
    rig = link("Rig", bpy.data.armatures.new("Rig"))
    rig.location = (0, 0, 1)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("Eye")
    bone.head, bone.tail = (0, 0, 0.5), (0, 0, 1.5)
    bpy.ops.object.mode_set(mode="OBJECT")
    dof = obj.data.dof
    dof.use_dof, dof.focus_object, dof.focus_subtarget = True, rig, "Eye"
    assert export()[0].camera.focus_distance == pytest.approx(3.5)
    dof.focus_subtarget = "Ear"
    assert export()[0].camera.focus_distance == pytest.approx(4)
