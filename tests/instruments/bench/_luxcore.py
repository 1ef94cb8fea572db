# SPDX-License-Identifier: GPL-3.0-or-later
"""A `SceneDesc` as LuxCore takes it: camera, meshes, lights; nothing here needs LuxCore.

Pixels and units (metres, W/m^2/sr) are the same in both.
"""

from __future__ import annotations

import math

import numpy as np

from tests.instruments.bench._description import desc
from tests.instruments.bench._luxcore_materials import Materials, add_world, value
from tests.instruments.bench._luxcore_textures import Translation, UntranslatedError

# Scenes of blend_scenes/ in which LuxCore, fully converged, differs from Specula in more than
# noise, and why.
DIFFERENT_MODELS = {
    "refractive_sphere": "where a mapped normal sends light through the geometric surface, LuxCore"
    " lets it pass and Specula stops it: the rim of the glass sphere is 10 to 50% brighter in"
    " LuxCore, the whole picture 1 to 2%",
    "cornell": "LuxCore's rough metal shadows its facets by Schlick's approximation and draws them"
    " from a density without their cosine: the metal box is up to about 12% darker in LuxCore, the"
    " whole picture 2 to 3%",
}

SPECULAR = ("mirror", "glass")  # LuxCore's materials

LAMP_SIDES = 64  # of the polygon for a round area light
# Of the icosahedron for a point light: 80 triangles. In LuxCore 2.11 a mesh of 320 lights nothing.
LAMP_SUBDIVISIONS = 1


def translate(scene) -> Translation:
    """The whole scene. Raises UntranslatedError naming what LuxCore has no equal for."""
    translation = Translation()
    add_camera(scene.camera, translation)
    add_world(scene, translation)
    add_instances(scene, translation)
    for index, light in enumerate(scene.lights):
        add_light(light, f"lamp{index}", translation)
    return translation


def add_camera(camera, translation: Translation) -> None:
    """The crop becomes the whole frame of a camera with a narrower screen."""
    if camera.projection != desc.Projection.PERSPECTIVE:
        raise UntranslatedError("camera: an orthographic projection is not translated")
    if camera.aperture_radius > 0.0:
        raise UntranslatedError("camera: depth of field is not translated")
    axes = camera.transform[:, :3].astype(np.float64)
    axes /= np.linalg.norm(axes, axis=0)
    origin = camera.transform[:, 3].astype(np.float64)
    left, right, bottom, top = camera.viewplane
    x0, y0, width, height = camera.crop
    across, up = (right - left) / camera.width, (top - bottom) / camera.height
    translation.set(
        "scene.camera",
        type="perspective",
        lookat__orig=origin.tolist(),
        lookat__target=(origin - axes[:, 2]).tolist(),
        up=axes[:, 1].tolist(),
        # At 90 degrees the screen is measured at distance 1.
        fieldofview=90.0,
        # LuxCore's rows look one pixel too high (rasterToCamera at height - y - 1).
        screenwindow=[
            left + across * x0,
            left + across * (x0 + width),
            bottom + up * (y0 - 1),
            bottom + up * (y0 + height - 1),
        ],
        cliphither=camera.clip_near,
        clipyon=camera.clip_far,
        lensradius=0.0,
        autofocus__enable=False,
    )


def casters(scene, translation: Translation) -> list:
    """The instances that cast caustics: those marked, and those that are mirrors or glass and left
    to their materials."""
    marked = (desc.CausticsRole.CASTER, desc.CausticsRole.BOTH)
    return [
        instance
        for instance in scene.instances
        if instance.caustics_role in marked
        or (
            instance.caustics_role == desc.CausticsRole.AUTO
            and any(_is_specular(translation, index) for index in instance.materials)
        )
    ]


def _is_specular(translation: Translation, material: int) -> bool:
    """Whether a translated material, or a part of its mixture, is a mirror or glass."""
    name = f"scene.materials.material{material}"
    return any(
        key.startswith((f"{name}.", f"{name}_")) and key.endswith(".type") and kind in SPECULAR
        for key, kind in translation.properties.items()
    )


def view_width(scene, translation: Translation) -> float:
    """How wide the picture is at the casters (of a scene without any: at all objects), metres."""
    middles = []
    for instance in casters(scene, translation) or scene.instances:
        positions = scene.meshes[instance.mesh].positions
        middle = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
        middles.append(instance.transform[:, :3] @ middle + instance.transform[:, 3])
    view = scene.camera.transform
    distance = abs((np.mean(middles, axis=0) - view[:, 3]) @ view[:, 2])
    left, right, _, _ = scene.camera.viewplane
    return float(distance * (right - left) * scene.camera.crop[2] / scene.camera.width)


# ------------------------------------------------------------------------------------------- meshes


def add_instances(scene, translation: Translation) -> None:
    """Objects, one for each material of an instance; a mesh with one instance is baked."""
    materials = Materials(scene, translation)
    users = [
        sum(other.mesh == index for other in scene.instances) for index in range(len(scene.meshes))
    ]
    for number, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        check_visibility(f"object {instance.name}", instance.visibility)
        # LuxCore does not turn a mirrored instance's triangles round.
        mirrored = np.linalg.det(instance.transform[:, :3].astype(np.float64)) < 0.0
        baked = users[instance.mesh] == 1 or mirrored
        for slot in range(mesh.slot_count):
            if instance.materials[slot] == desc.NONE:
                continue
            shape = f"instance{number}_{slot}" if baked else f"mesh{instance.mesh}_{slot}"
            if shape not in translation.meshes:
                arrays = slot_arrays(mesh, slot)
                translation.meshes[shape] = bake(arrays, instance.transform) if baked else arrays
            if len(translation.meshes[shape][1]) == 0:
                del translation.meshes[shape]
                continue
            prefix = f"scene.objects.object{number}_{slot}"
            translation.set(
                prefix,
                shape=shape,
                material=materials.name(instance.materials[slot]),
                camerainvisible=not instance.visibility & desc.Visibility.CAMERA,
            )
            if not baked:
                translation.set(prefix, transformation=columns(instance.transform))


def check_visibility(owner: str, visibility) -> None:
    """LuxCore can hide things from the camera alone."""
    if visibility | desc.Visibility.CAMERA != desc.Visibility.ALL:
        raise UntranslatedError(f"{owner}: ray visibility {visibility!r} has no equal in LuxCore")


def columns(transform: np.ndarray) -> list[float]:
    """A 3 x 4 transform as LuxCore takes matrices: 16 numbers, column by column."""
    matrix = np.vstack([transform.astype(np.float64), (0.0, 0.0, 0.0, 1.0)])
    return matrix.T.ravel().tolist()


def slot_arrays(mesh, slot: int) -> tuple:
    """Positions (3T, 3), triangles (T, 3), normals (3T, 3) or None, uvs (3T, 2) or None of the
    triangles of one material slot: LuxCore has normals and UVs at vertices, not at corners."""
    if any(attribute.kind != desc.AttributeKind.UV for attribute in mesh.attributes):
        raise UntranslatedError(f"mesh {mesh.name}: only one UV map is translated")
    chosen = slice(None) if mesh.material_slots is None else mesh.material_slots == slot
    triangles = mesh.triangles[chosen]
    return (
        mesh.positions[triangles].reshape(-1, 3),
        np.arange(3 * len(triangles), dtype=np.uint32).reshape(-1, 3),
        None if mesh.normals is None else mesh.normals[chosen].reshape(-1, 3),
        mesh.attributes[0].values.reshape(-1, 3, 2)[chosen].reshape(-1, 2)
        if mesh.attributes
        else None,
    )


def bake(arrays: tuple, transform: np.ndarray) -> tuple:
    """The same mesh in world space; triangles of a mirrored one are turned round."""
    positions, triangles, normals, uvs = arrays
    matrix = transform[:, :3].astype(np.float64)
    if np.linalg.det(matrix) < 0.0:
        triangles = triangles[:, ::-1]
    if normals is not None:
        normals = normals @ np.linalg.inv(matrix)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return positions @ matrix.T + transform[:, 3], triangles, normals, uvs


# ------------------------------------------------------------------------------------------- lights


def add_light(light, name: str, translation: Translation) -> None:
    """Lamps are glowing meshes, so that every method of LuxCore finds them. Their back lets light
    through, as Blender's lamps do on both sides: seen from the front they hide what is behind."""
    check_visibility(f"light {light.name}", light.visibility)
    if light.type == desc.LightType.AREA and light.spread >= math.pi:
        _add_emitter(translation, light, name, *area_mesh(light))
    elif light.type == desc.LightType.POINT and light.radius > 0.0:
        _add_emitter(translation, light, name, *sphere_mesh(light))
    else:
        raise UntranslatedError(f"light {light.name}: {NO_EQUAL[light.type]}")


NO_EQUAL = {
    desc.LightType.POINT: "a point without size is seen by no path of LuxCore's from the camera",
    desc.LightType.SUN: "LuxCore's distant disc is not seen in mirrors",
    desc.LightType.SPOT: "LuxCore's spot has another falloff and no size",
    desc.LightType.AREA: "LuxCore's glowing meshes have no spread",
}


def _add_emitter(translation: Translation, light, name: str, positions, triangles) -> None:
    """A black mesh with the radiance that gives the light's power: P / (pi area)."""
    corners = positions[triangles].astype(np.float64)
    edges = corners[:, 1:] - corners[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum()
    translation.meshes[name] = (positions, triangles, None, None)
    translation.set(
        f"scene.materials.{name}",
        type="matte",
        kd=value((0.0, 0.0, 0.0)),
        transparency__front=value(1.0),
        transparency__back=value(0.0),
        emission=value([channel / (math.pi * area) for channel in light.power]),
    )
    translation.set(
        f"scene.objects.{name}",
        shape=name,
        material=name,
        camerainvisible=not light.visibility & desc.Visibility.CAMERA,
    )


def area_mesh(light) -> tuple[np.ndarray, np.ndarray]:
    """Positions in the world and triangles of an area light, seen from the side that shines."""
    if light.shape == desc.AreaShape.RECTANGLE:
        outline = np.array([(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)])
    else:
        angles = -2.0 * np.pi * np.arange(LAMP_SIDES) / LAMP_SIDES
        outline = 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    flat = np.zeros((len(outline), 3))
    flat[:, :2] = outline * light.size
    transform = light.transform.astype(np.float64)
    fan = [(0, i, i + 1) for i in range(1, len(outline) - 1)]
    if np.linalg.det(transform[:, :3]) < 0.0:
        fan = [corners[::-1] for corners in fan]
    return flat @ transform[:, :3].T + transform[:, 3], np.array(fan, np.uint32)


def sphere_mesh(light) -> tuple[np.ndarray, np.ndarray]:
    """An icosahedron, divided, around a point light, with the area of the light's sphere: a convex
    body's silhouette is on average a quarter of its surface."""
    golden = (1.0 + math.sqrt(5.0)) / 2.0
    points = [
        (-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0),
        (0, -1, golden), (0, 1, golden), (0, -1, -golden), (0, 1, -golden),
        (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1),
    ]  # fmt: skip
    faces = [
        (0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
        (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
        (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1),
    ]  # fmt: skip
    corners = np.array(points, np.float64)[np.array(faces)]  # (T, 3, 3)
    for _ in range(LAMP_SUBDIVISIONS):
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
        quarters = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        corners = np.concatenate([np.stack(quarter, axis=1) for quarter in quarters])
    corners /= np.linalg.norm(corners, axis=2, keepdims=True)
    edges = corners[:, 1:] - corners[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum()
    corners *= light.radius * math.sqrt(4.0 * math.pi / area)
    positions = corners.reshape(-1, 3) + light.transform[:, 3]
    return positions, np.arange(len(positions), dtype=np.uint32).reshape(-1, 3)
