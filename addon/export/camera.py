# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's camera and frame -> `CameraDesc`."""

from __future__ import annotations

import numpy as np

from .desc import CameraDesc, ExportError
from .log import ExportLog


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
    """left, right, bottom, top at distance 1 of a perspective projection matrix."""
    (sx, _, cx, _), (_, sy, cy, _) = projection[0], projection[1]
    return (cx - 1) / sx, (cx + 1) / sx, (cy - 1) / sy, (cy + 1) / sy


def export_camera(depsgraph, log: ExportLog) -> CameraDesc:
    """Raises ExportError if there is no camera, or one that Specula does not have."""
    scene = depsgraph.scene_eval
    obj = scene.camera
    if obj is None or obj.type != "CAMERA":
        raise ExportError(f"scene {scene.name} has no camera")
    obj = obj.evaluated_get(depsgraph)
    if obj.data.type != "PERSP":
        raise ExportError(
            f"camera {obj.name}: type {obj.data.type} is not supported, only PERSP is"
        )
    if obj.data.dof.use_dof:
        log.warn(f"camera {obj.name}", "depth of field is not supported, everything is in focus")
    render = scene.render
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
    )
