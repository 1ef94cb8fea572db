# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's camera and frame -> `CameraDesc`."""

from __future__ import annotations

import numpy as np

from . import compat
from .desc import CameraDesc, ExportError, Projection

PROJECTIONS = {"PERSP": Projection.PERSPECTIVE, "ORTHO": Projection.ORTHOGRAPHIC}
# Type of a panoramic camera -> its projection and the properties that hold the numbers of it.
PANORAMAS = {
    "EQUIRECTANGULAR": (
        Projection.EQUIRECTANGULAR,
        ("longitude_min", "longitude_max", "latitude_min", "latitude_max"),
    ),
    "FISHEYE_EQUIDISTANT": (Projection.FISHEYE_EQUIDISTANT, ("fisheye_fov",)),
    "FISHEYE_EQUISOLID": (Projection.FISHEYE_EQUISOLID, ("fisheye_fov", "fisheye_lens")),
    "FISHEYE_LENS_POLYNOMIAL": (
        Projection.FISHEYE_POLYNOMIAL,
        ("fisheye_fov", *(f"fisheye_polynomial_k{i}" for i in range(5))),
    ),
    "MIRRORBALL": (Projection.MIRROR_BALL, ()),
    "EQUIANGULAR_CUBEMAP_FACE": (Projection.EQUIANGULAR_CUBEMAP_FACE, ()),
    "CENTRAL_CYLINDRICAL": (
        Projection.CENTRAL_CYLINDRICAL,
        tuple(f"central_cylindrical_range_{end}" for end in ("u_min", "u_max", "v_min", "v_max")),
    ),
}
OF_A_SENSOR = {Projection.FISHEYE_EQUISOLID, Projection.FISHEYE_POLYNOMIAL}

# The least that Cycles takes, where Blender allows 0.
LEAST_FSTOP = 1e-5
LEAST_FOCUS_DISTANCE = 1e-5  # m


def frame_size(render) -> tuple[int, int]:
    """Width and height of the full frame, pixels, as Blender rounds them."""
    scale = render.resolution_percentage
    return (
        max(1, render.resolution_x * scale // 100),
        max(1, render.resolution_y * scale // 100),
    )


def crop(render) -> tuple[int, int, int, int]:
    """The rendered part of the frame: x0, y0, width, height from the bottom left, pixels."""
    width, height = frame_size(render)
    if not render.use_border:
        return 0, 0, width, height
    # Blender multiplies in single precision and truncates.
    borders = (render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y)
    edges = np.array(borders, np.float32) * np.array((width, height) * 2, np.float32)
    x0, y0, x1, y1 = (int(edge) for edge in edges)
    return x0, y0, x1 - x0, y1 - y0


def viewplane(projection) -> tuple[float, float, float, float]:
    """left, right, bottom, top of a projection matrix: at distance 1 if it is perspective, which
    shifts by the third column, in m if it is orthographic, which shifts by the fourth."""
    (sx, _, cx, tx), (_, sy, cy, ty) = projection[0], projection[1]
    cx, cy = cx - tx, cy - ty
    return (cx - 1) / sx, (cx + 1) / sx, (cy - 1) / sy, (cy + 1) / sy


def focus_distance(obj, depsgraph) -> float:
    """Along the viewing axis, m: to the focus object, or its bone, if there is one."""
    dof = obj.data.dof
    if dof.focus_object is None:
        return dof.focus_distance
    target = dof.focus_object.evaluated_get(depsgraph)
    matrix = target.matrix_world
    bone = target.pose and target.pose.bones.get(dof.focus_subtarget)
    if bone:
        matrix = matrix @ bone.matrix
    axis = obj.matrix_world.col[2].xyz.normalized()
    return abs(axis.dot(obj.matrix_world.translation - matrix.translation))


def aperture(obj, depsgraph) -> dict[str, float]:
    """What `CameraDesc` has of depth of field; nothing without it."""
    data, dof = obj.data, obj.data.dof
    if not dof.use_dof:
        return {}
    # An orthographic camera has no focal length: Cycles takes one of a metre.
    focal_length = data.lens * 1e-3 if data.type != "ORTHO" else 1.0  # m
    return {
        "aperture_radius": focal_length / (2 * max(dof.aperture_fstop, LEAST_FSTOP)),
        "focus_distance": max(focus_distance(obj, depsgraph), LEAST_FOCUS_DISTANCE),
        "aperture_blades": dof.aperture_blades,  # Blender has no 1 and 2
        "aperture_rotation": dof.aperture_rotation,
        "aperture_ratio": dof.aperture_ratio,
    }


def export_camera(depsgraph) -> CameraDesc:
    """Raises ExportError if there is no camera, or one that Specula does not have."""
    scene = depsgraph.scene_eval
    obj = scene.camera
    if obj is None or obj.type != "CAMERA":
        raise ExportError(f"scene {scene.name} has no camera")
    obj = obj.evaluated_get(depsgraph)
    render = scene.render
    if obj.data.type == "PANO":
        return _panoramic(obj, render, depsgraph)
    if obj.data.type not in PROJECTIONS:
        raise ExportError(f"camera {obj.name}: type {obj.data.type} is not supported")
    width, height = frame_size(render)
    projection = obj.calc_matrix_camera(
        depsgraph,
        x=width,
        y=height,
        scale_x=render.pixel_aspect_x,
        scale_y=render.pixel_aspect_y,
    )
    return CameraDesc(
        transform=np.array(obj.matrix_world, np.float32)[:3],
        width=width,
        height=height,
        crop=crop(render),
        viewplane=viewplane(projection),
        clip_near=obj.data.clip_start,
        clip_far=obj.data.clip_end,
        projection=PROJECTIONS[obj.data.type],
        **aperture(obj, depsgraph),
    )


def sensor_size(data, render) -> tuple[float, float]:
    """Width and height of the part of the sensor that the frame covers, mm."""
    width, height = frame_size(render)
    x, y = width * render.pixel_aspect_x, height * render.pixel_aspect_y
    horizontal = x > y if data.sensor_fit == "AUTO" else data.sensor_fit == "HORIZONTAL"
    size = data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width
    return (size, size * y / x) if horizontal else (size * x / y, size)


def _panoramic(obj, render, depsgraph) -> CameraDesc:
    data = obj.data
    settings = compat.panorama_settings(data)
    kind = settings.panorama_type
    if kind not in PANORAMAS:
        raise ExportError(f"camera {obj.name}: panorama {kind} is not supported")
    projection, names = PANORAMAS[kind]
    numbers = [getattr(settings, name) for name in names]
    if projection == Projection.CENTRAL_CYLINDRICAL:
        numbers[2:] = [height / settings.central_cylindrical_radius for height in numbers[2:]]
    if projection in OF_A_SENSOR:
        numbers += sensor_size(data, render)
    width, height = frame_size(render)
    return CameraDesc(
        transform=np.array(obj.matrix_world, np.float32)[:3],
        width=width,
        height=height,
        crop=crop(render),
        viewplane=(data.shift_x, 1.0 + data.shift_x, data.shift_y, 1.0 + data.shift_y),
        clip_near=data.clip_start,
        clip_far=data.clip_end,
        projection=projection,
        panorama=(*numbers, *(0.0,) * (8 - len(numbers))),
        **aperture(obj, depsgraph),
    )
