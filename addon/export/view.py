# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D view shows -> `CameraDesc`, and which objects it shows."""

from __future__ import annotations

import numpy as np

from .camera import aperture, viewplane
from .desc import CameraDesc, Projection
from .visibility import instancer


def export_view(context, depsgraph) -> CameraDesc:
    """The camera of the 3D view of `context`, whose pixels are those of its region.

    Its crop is the view's render region, or the camera's where the view looks through it.
    """
    region, space, view = context.region, context.space_data, context.region_data
    width, height = region.width, region.height
    transform = np.array(view.view_matrix.inverted(), np.float32)[:3]
    near, far = space.clip_start, space.clip_end
    lens = {}
    camera = None
    if view.view_perspective == "CAMERA":
        camera = space.camera if space.use_local_camera else context.scene.camera
    if camera is not None and camera.type == "CAMERA":
        camera = camera.evaluated_get(depsgraph)
        near, far = camera.data.clip_start, camera.data.clip_end
        lens = aperture(camera, depsgraph)
    elif not view.is_perspective:
        # The view has no beginning: it shows as much behind its plane as before it.
        transform[:, 3] += far * transform[:, 2]
        near, far = 0.0, 2.0 * far
    return CameraDesc(
        transform=transform,
        width=width,
        height=height,
        crop=render_region(context, camera, width, height),
        viewplane=viewplane(view.window_matrix),
        clip_near=near,
        clip_far=far,
        projection=Projection.PERSPECTIVE if view.is_perspective else Projection.ORTHOGRAPHIC,
        **lens,
    )


def render_region(context, camera, width: int, height: int) -> tuple[int, int, int, int]:
    """x0, y0, width, height of what is rendered of the region, pixels from the bottom left."""
    space, render = context.space_data, context.scene.render
    if camera is None:
        used, border, prefix = space.use_render_border, space, "render_border_"
        frame = np.array([[0.0, 0.0], [1.0, 1.0]])
    else:
        used, border, prefix = render.use_border, render, "border_"
        frame = camera_frame(context.region_data, context.scene, camera)
    if not used:
        return 0, 0, width, height
    part = np.array(
        [[getattr(border, f"{prefix}{end}_{axis}") for axis in "xy"] for end in ("min", "max")]
    )
    low, high = frame
    edges = np.clip(low + part * (high - low), 0.0, 1.0) * (width, height)
    (x0, y0), (x1, y1) = edges.astype(int)
    if x1 <= x0 or y1 <= y0:
        return 0, 0, width, height
    return int(x0), int(y0), int(x1 - x0), int(y1 - y0)


def camera_frame(view, scene, camera) -> np.ndarray:
    """Lower left and upper right corner of the camera's frame, as shares of the region of the
    RegionView3D `view`, which looks through it: (2, 2)."""
    projection = np.array(view.window_matrix)
    corners = np.array(camera.data.view_frame(scene=scene))
    clip = np.column_stack([corners, np.ones(len(corners))]) @ projection.T
    shares = 0.5 + 0.5 * clip[:, :2] / clip[:, 3:]
    return np.array([shares.min(axis=0), shares.max(axis=0)])


def shows_particles(instance, space) -> bool:
    """Whether a depsgraph instance shows its particles; see is_shown()."""
    if not instance.show_particles or instance.object.type != "MESH":
        return False
    return space is None or instancer(instance).visible_in_viewport_get(space)


def is_shown(instance, space) -> bool:
    """Whether a depsgraph instance shows itself, in the 3D view `space` if that is not None: there
    local view and hidden collections count."""
    if not instance.show_self:
        return False
    return space is None or instancer(instance).visible_in_viewport_get(space)
