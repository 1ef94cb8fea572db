# SPDX-License-Identifier: GPL-3.0-or-later
"""An empty scene with the settings that all scenes share, and its objects, lights and camera."""

import math

import bpy
import numpy as np
from mathutils import Vector


def reset(name, resolution, view_transform="Standard"):
    """Start from an empty file; settings are Cycles' own, which Specula reads too."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.name = name
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = resolution
    render.resolution_percentage = 100
    render.filepath = "//" + name + "_"
    render.image_settings.file_format = "PNG"
    render.use_stamp_hostname = False
    scene.frame_start = scene.frame_end = 1

    cycles = scene.cycles
    cycles.samples = cycles.preview_samples = 64
    cycles.seed = 0
    cycles.use_adaptive_sampling = cycles.use_preview_adaptive_sampling = False
    cycles.use_denoising = cycles.use_preview_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.blur_glossy = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.max_bounces = cycles.transparent_max_bounces = 12
    cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 12
    cycles.volume_bounces = 0
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = 1.5

    scene.view_settings.view_transform = view_transform
    scene.view_settings.look = "None"
    scene.view_settings.exposure = 0.0
    scene.view_settings.gamma = 1.0
    return scene


def link(name, data, role=None, location=(0.0, 0.0, 0.0), rotation=(0.0, 0.0, 0.0)):
    """Link an object; rotation in degrees.

    `role` is 'CASTER', 'RECEIVER' or None and sets Cycles' flags of the object.
    """
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    obj.location = location
    obj.rotation_euler = [math.radians(a) for a in rotation]
    obj.cycles.is_caustics_caster = role == "CASTER"
    obj.cycles.is_caustics_receiver = role == "RECEIVER"
    return obj


def look_at(obj, target):
    """Turn an object so that its -Z axis points at `target` and +Y up."""
    obj.rotation_euler = (Vector(target) - obj.location).to_track_quat("-Z", "Y").to_euler()


def camera(location, target, lens):
    """The scene's camera; `lens` in millimetres over a 36 mm sensor."""
    data = bpy.data.cameras.new("Camera")
    data.lens, data.sensor_width = lens, 36.0
    data.clip_start, data.clip_end = 0.01, 200.0
    obj = link("Camera", data, location=location)
    look_at(obj, target)
    bpy.context.scene.camera = obj
    return obj


def light(
    name, kind, power, location, target=None, size=None, color=(1.0, 1.0, 1.0), caustics=True
):
    """A light of `power` watts.

    `size` in metres: the side, or both sides, of an area light; the radius of a point light.
    """
    data = bpy.data.lights.new(name, kind)
    data.energy, data.color = power, color
    if kind == "AREA":
        data.shape = "RECTANGLE" if isinstance(size, tuple) else "SQUARE"
        data.size, data.size_y = size if isinstance(size, tuple) else (size, size)
    else:
        data.shadow_soft_size = size
    data.cycles.use_multiple_importance_sampling = True
    data.cycles.is_caustics_light = caustics
    obj = link(name, data, location=location)
    if target is not None:
        look_at(obj, target)
    return obj


def mesh(name, vertices, faces, materials, uvs=None, smooth=False, material_index=None):
    """A mesh from vertices (n, 3) and faces (index lists).

    `uvs` holds one (u, v) per corner, in face order.
    """
    data = bpy.data.meshes.new(name)
    data.from_pydata(
        [tuple(map(float, v)) for v in vertices], [], [tuple(map(int, f)) for f in faces]
    )
    for item in materials if isinstance(materials, (list, tuple)) else [materials]:
        data.materials.append(item)
    if uvs is not None:
        layer = data.uv_layers.new(name="UVMap")
        layer.data.foreach_set("uv", np.asarray(uvs, np.float32).ravel())
    data.polygons.foreach_set("use_smooth", [smooth] * len(data.polygons))
    if material_index is not None:
        data.polygons.foreach_set("material_index", material_index)
    data.validate()
    data.update()
    return data


def rectangle(name, corners, materials, uv_size=(1.0, 1.0)):
    """One quad; UVs run from (0, 0) at the first corner to `uv_size` at the third.

    It is shaded smooth, which changes nothing on a flat quad: Cycles' manifold next event
    estimation passes over flat-shaded casters.
    """
    u, v = uv_size
    uvs = [(0, 0), (u, 0), (u, v), (0, v)]
    return mesh(name, corners, [(0, 1, 2, 3)], materials, uvs, smooth=True)


def quads(name, corner_lists, materials, material_index=None, uv_scale=1.0):
    """Loose quads; UVs are the lengths of each quad's first and last edge times `uv_scale`."""
    vertices, faces, uvs = [], [], []
    for corners in corner_lists:
        a, b, _, d = (np.asarray(c, dtype=float) for c in corners)
        u, v = np.linalg.norm(b - a) * uv_scale, np.linalg.norm(d - a) * uv_scale
        faces.append(range(len(vertices), len(vertices) + 4))
        vertices.extend(corners)
        uvs.extend([(0, 0), (u, 0), (u, v), (0, v)])
    return mesh(name, vertices, faces, materials, uvs, material_index=material_index)


def box(name, low, high, material):
    """An axis-aligned box from corner `low` to corner `high`, normals outward."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    vertices = [
        (x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0),
        (x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1),
    ]  # fmt: skip
    faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    return mesh(name, vertices, faces, material)


def grid(name, points, materials, wrap_u=False, wrap_v=False, material_of=None, uv=True):
    """A smooth quad mesh over points (rows, columns, 3); u runs along columns, v along rows.

    `wrap_u` and `wrap_v` join the last column or row to the first. Normals are d/du x d/dv.
    `material_of(row, column)` gives a face's material slot.
    """
    points = np.asarray(points, dtype=float)
    rows, columns, _ = points.shape
    face_rows, face_columns = rows - (not wrap_v), columns - (not wrap_u)
    faces, uvs, index = [], [], []
    for j in range(face_rows):
        for i in range(face_columns):
            j1, i1 = (j + 1) % rows, (i + 1) % columns
            faces.append((j * columns + i, j * columns + i1, j1 * columns + i1, j1 * columns + i))
            u0, u1 = i / face_columns, (i + 1) / face_columns
            v0, v1 = j / face_rows, (j + 1) / face_rows
            uvs.extend([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])
            index.append(material_of(j, i) if material_of else 0)
    return mesh(name, points.reshape(-1, 3), faces, materials, uvs if uv else None, True, index)


def lathe(name, profile, segments, materials, closed=True, material_of=None):
    """A smooth surface of revolution around Z; counter-clockwise profile (n, 2) of (radius, z)."""
    profile = np.asarray(profile, dtype=float)
    angle = 2.0 * np.pi * np.arange(segments) / segments
    radius, z = profile[:, 0], profile[:, 1]
    points = np.empty((len(profile), segments, 3))
    points[..., 0] = radius[:, None] * np.cos(angle)
    points[..., 1] = radius[:, None] * np.sin(angle)
    points[..., 2] = z[:, None]
    return grid(name, points, materials, wrap_u=True, wrap_v=closed, material_of=material_of)


def uv_sphere(name, radius, segments, materials, material_of=None):
    """A smooth sphere with latitude-longitude UVs: v = 0 at -Z, u = longitude / 2 pi.

    It has `segments` faces around and half as many rings.
    """
    rings = segments // 2
    vertices, faces, uvs, index = [(0.0, 0.0, -radius)], [], [], []
    for j in range(1, rings):
        theta = np.pi * j / rings
        for i in range(segments):
            phi = 2.0 * np.pi * i / segments
            s = radius * np.sin(theta)
            vertices.append((s * np.cos(phi), s * np.sin(phi), -radius * np.cos(theta)))
    vertices.append((0.0, 0.0, radius))

    def at(j, i):
        return 1 + (j - 1) * segments + i % segments

    for j in range(rings):
        for i in range(segments):
            u0, u1, v0, v1 = i / segments, (i + 1) / segments, j / rings, (j + 1) / rings
            if j == 0:
                faces.append((0, at(1, i + 1), at(1, i)))
                uvs.extend([(0.5 * (u0 + u1), 0.0), (u1, v1), (u0, v1)])
            elif j == rings - 1:
                faces.append((at(j, i), at(j, i + 1), len(vertices) - 1))
                uvs.extend([(u0, v0), (u1, v0), (0.5 * (u0 + u1), 1.0)])
            else:
                faces.append((at(j, i), at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)))
                uvs.extend([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])
            index.append(material_of(j, i) if material_of else 0)
    return mesh(name, vertices, faces, materials, uvs, True, index)


def tube(name, path, radius, sides, material):
    """A smooth open tube of `sides` facets along a path (n, 3)."""
    path = np.asarray(path, dtype=float)
    tangent = np.gradient(path, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    normal = np.cross(tangent[0], (0.31, 0.77, 0.56))
    points = np.empty((len(path), sides, 3))
    angle = 2.0 * np.pi * np.arange(sides) / sides
    for j, (p, t) in enumerate(zip(path, tangent, strict=True)):
        normal = normal - t * np.dot(normal, t)
        normal /= np.linalg.norm(normal)
        side = np.cross(t, normal)
        points[j] = p + radius * (np.cos(angle)[:, None] * normal + np.sin(angle)[:, None] * side)
    return grid(name, points, material, wrap_u=True)


def tidy_screens():
    """3D views open on the camera; file browsers forget the generating user's home folder."""
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.region_3d.view_perspective = "CAMERA"
            for space in area.spaces:
                if space.type == "FILE_BROWSER" and space.params:
                    space.params.directory = b"//"
