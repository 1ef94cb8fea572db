# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of the suite's scenes: a floor that a camera looks at, casters above it, lights that only
they show."""

from __future__ import annotations

import math

import numpy as np

from specula.export import desc

SIDE = 48  # pixels
FLOOR_ALBEDO = 0.8
EYE = (0.0, -3.0, 2.0)
VIEW = 0.25  # half width of the view at distance 1

# Of lights that the floor sees in casters alone: the picture is the caustics.
NOT_DIRECTLY = desc.Visibility.GLOSSY | desc.Visibility.TRANSMISSION | desc.Visibility.SHADOW


# ---- placement


def rotation_x(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def rotation_z(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def placed(p=(0.0, 0.0, 0.0), turn: np.ndarray | None = None, scale=(1.0, 1.0, 1.0)) -> np.ndarray:
    """(3, 4): scaled, then turned, then moved."""
    linear = (np.eye(3) if turn is None else turn) @ np.diag(scale)
    return np.column_stack([linear, p]).astype(np.float32)


# ---- materials


def shader(kind: str, **inputs) -> desc.MaterialDesc:
    """One node; input `Base_Color` names the socket `Base Color`."""
    values = {
        name.replace("_", " "): tuple(value) if np.ndim(value) else (value, 0.0, 0.0, 0.0)
        for name, value in inputs.items()
    }
    output = {"emission": "Emission", "background": "Background"}.get(kind, "BSDF")
    return desc.MaterialDesc(
        kind,
        [desc.NodeDesc("Output", "output"), desc.NodeDesc("Shader", kind, inputs=values)],
        [desc.LinkDesc(1, output, 0, "Surface")],
    )


def diffuse(albedo: float = FLOOR_ALBEDO):
    return shader("bsdf_diffuse", Color=(albedo, albedo, albedo, 1.0))


def mirror():
    return shader("bsdf_glossy", Color=(1.0, 1.0, 1.0, 1.0), Roughness=0.0)


def glass(ior: float = 1.5):
    return shader("bsdf_glass", Color=(1.0, 1.0, 1.0, 1.0), Roughness=0.0, IOR=ior)


def roughened(material: desc.MaterialDesc, roughness: float) -> desc.MaterialDesc:
    """Of one shader, as `shader` makes it."""
    material.nodes[1].inputs["Roughness"] = (roughness, 0.0, 0.0, 0.0)
    return material


def mapped(material: desc.MaterialDesc, image: int) -> desc.MaterialDesc:
    """With a normal map on the active UV layer."""
    material.nodes += [
        desc.NodeDesc("Map", "normal_map", inputs={"Strength": (1.0, 0.0, 0.0, 0.0)}),
        desc.NodeDesc("Image", "image_texture", image=image),
    ]
    material.links += [
        desc.LinkDesc(3, "Color", 2, "Color"),
        desc.LinkDesc(2, "Normal", 1, "Normal"),
    ]
    return material


def waves(amplitude: float, texels: int = 32) -> desc.ImageDesc:
    """A normal map of smooth waves with slopes up to `amplitude`, seeded."""
    rng = np.random.default_rng(7)
    at = 2.0 * math.pi * np.arange(texels) / texels
    slope = np.zeros((2, texels, texels))
    for _ in range(4):
        k, phase = rng.integers(1, 4, 2), rng.uniform(0.0, 2.0 * math.pi)
        wave = np.cos(k[0] * at[None, :] + k[1] * at[:, None] + phase)
        slope += amplitude / 4 * (k / np.linalg.norm(k))[:, None, None] * wave
    normal = np.stack([-slope[0], -slope[1], np.ones((texels, texels))], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    pixels = np.ascontiguousarray(0.5 * normal + 0.5, np.float32)
    return desc.ImageDesc("waves", pixels=pixels, color_space=desc.ColorSpace.DATA)


# ---- meshes


def mesh(name, positions, triangles, normals=None, uv=None) -> desc.MeshDesc:
    """`normals` and `uv` at vertices; without normals every face is flat."""
    triangles = np.asarray(triangles, np.uint32)
    at_corners = lambda values: np.ascontiguousarray(np.asarray(values, np.float32)[triangles])  # noqa: E731
    return desc.MeshDesc(
        name,
        np.ascontiguousarray(positions, np.float32),
        triangles,
        normals=None if normals is None else at_corners(normals),
        attributes=[] if uv is None else [desc.uv_layer("UV", at_corners(uv))],
    )


def grid(name, n: int, position, normal=None, uv: bool = False) -> desc.MeshDesc:
    """n x n quads over [0, 1]^2; `position` and `normal` map (..., 2) to (..., 3)."""
    axis = np.linspace(0.0, 1.0, n + 1)
    at = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)[None, :]).ravel()
    triangles = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + n + 2], axis=-1),
            np.stack([corner, corner + n + 2, corner + n + 1], axis=-1),
        ]
    )
    return mesh(
        name, position(at), triangles, None if normal is None else normal(at), at if uv else None
    )


def square(half: float, uv: bool = False) -> desc.MeshDesc:
    """In the plane z = 0, facing up."""
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * half
    coordinates = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    return mesh("square", corners, [(0, 1, 2), (0, 2, 3)], uv=coordinates if uv else None)


def directions(at: np.ndarray) -> np.ndarray:
    """Unit vectors by longitude and latitude, (0, 0) .. (1, 1)."""
    azimuth, polar = 2.0 * math.pi * at[..., 0], math.pi * (1.0 - at[..., 1])
    return np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1
    )


def sphere(radius: float, n: int = 24, smooth: bool = True) -> desc.MeshDesc:
    return grid("sphere", n, lambda at: radius * directions(at), directions if smooth else None)


def slab(half: float, thickness: float) -> desc.MeshDesc:
    """A box, flat, with its middle in the origin."""
    signs = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return mesh("slab", signs * np.array([half, half, thickness / 2]), triangles)


def brilliant(radius: float, sides: int = 8) -> desc.MeshDesc:
    """A cut stone: a table above, its point below, flat triangles between them; the girdle's plane
    goes through the origin."""

    def ring(r: float, z: float, shift: float) -> np.ndarray:
        angle = 2.0 * math.pi * (np.arange(sides) + shift) / sides
        return np.c_[r * np.cos(angle), r * np.sin(angle), np.full(sides, z)]

    positions = np.concatenate(
        [ring(0.55, 0.35, 0.0), ring(1.0, 0.0, 0.5), [(0.0, 0.0, -0.55)]], dtype=np.float64
    )
    triangles = [(0, i, i + 1) for i in range(1, sides - 1)]  # the table
    for i in range(sides):
        after, below = (i + 1) % sides, sides + i
        triangles += [(i, below, after), (after, below, sides + after)]
        triangles.append((below, 2 * sides, sides + after))
    return mesh("brilliant", radius * positions, triangles)


def joined(name: str, *parts: desc.MeshDesc) -> desc.MeshDesc:
    """One mesh of several that have normals or are flat."""
    starts = np.cumsum([0, *(len(part.positions) for part in parts)])
    normals = [face_normals(part) if part.normals is None else part.normals for part in parts]
    return desc.MeshDesc(
        name,
        np.concatenate([part.positions for part in parts]),
        np.concatenate(
            [p.triangles + np.uint32(n) for p, n in zip(parts, starts[:-1], strict=True)]
        ),
        normals=np.concatenate(normals),
    )


def face_normals(shape: desc.MeshDesc) -> np.ndarray:
    """(T, 3, 3): at the corners of each face its own."""
    a, b, c = shape.positions[shape.triangles].swapaxes(0, 1)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.ascontiguousarray(np.repeat(normal[:, None, :], 3, axis=1), np.float32)


def displaced_slab(half: float, thickness: float, depth: float, n: int = 32) -> desc.MeshDesc:
    """A slab whose upper and lower sides are smooth waves that rise by up to `depth`.

    The waves end at the edges, where the flat sides begin.
    """

    def side(up: float, k: tuple[int, int]):
        turns = math.pi * np.array(k)

        def position(at):
            height = depth * np.sin(turns * at).prod(axis=-1) + up * thickness / 2.0
            # From below, x is mirrored: the corners run counter-clockwise as seen from outside.
            return np.c_[half * up * (2.0 * at[:, 0] - 1.0), half * (2.0 * at[:, 1] - 1.0), height]

        def normal(at):
            sine, cosine = np.sin(turns * at), np.cos(turns * at)
            slope = depth * turns * cosine * sine[:, ::-1] / (2.0 * half)
            n = np.c_[-slope[:, 0], -up * slope[:, 1], np.full(len(at), up)]
            return n / np.linalg.norm(n, axis=-1, keepdims=True)

        return grid("side", n, position, normal)

    box = slab(half, thickness)
    box.triangles = box.triangles[4:]  # the first four are the upper and lower sides
    return joined("displaced slab", side(1.0, (4, 3)), side(-1.0, (3, 5)), box)


# ---- scenes


class Maker:
    """Collects a description; the floor is there from the start."""

    def __init__(self, floor: bool = True):
        self.scene = desc.SceneDesc(camera=camera())
        if floor:
            self.add(square(4.0), diffuse(), placed(), desc.CausticsRole.RECEIVER)

    def add(self, shape, material, transform, role=desc.CausticsRole.CASTER, **fields) -> Maker:
        s = self.scene
        s.meshes.append(shape)
        s.materials.append(material)
        s.instances.append(
            desc.InstanceDesc(
                f"{shape.name} {len(s.instances)}",
                len(s.meshes) - 1,
                transform,
                [len(s.materials) - 1],
                caustics_role=role,
                **fields,
            )
        )
        return self

    def image(self, image: desc.ImageDesc) -> int:
        self.scene.images.append(image)
        return len(self.scene.images) - 1

    def bulb(self, p=(0.4, 0.3, 2.0), radius: float = 0.3, power: float = 100.0) -> Maker:
        self.scene.lights.append(
            desc.LightDesc(
                f"bulb {len(self.scene.lights)}",
                desc.LightType.POINT,
                placed(p),
                (power, power, power),
                radius=radius,
                visibility=NOT_DIRECTLY,
            )
        )
        return self

    def sun(self, angle: float, tilt: float = 0.3, strength: float = 3.0) -> Maker:
        """`tilt` from the zenith towards the south, rad."""
        self.scene.lights.append(
            desc.LightDesc(
                "sun",
                desc.LightType.SUN,
                placed(turn=rotation_x(tilt)),
                (strength, strength, strength),
                sun_angle=angle,
                visibility=NOT_DIRECTLY,
            )
        )
        return self

    def sky(self, radiance: float = 1.0) -> Maker:
        self.scene.materials.append(
            shader("background", Color=(radiance, radiance, radiance, 1.0), Strength=1.0)
        )
        self.scene.environment = desc.EnvironmentDesc(len(self.scene.materials) - 1)
        return self

    def panorama(self, image: desc.ImageDesc) -> Maker:
        """A sky from a latitude-longitude image, which the floor sees in casters alone."""
        sky = shader("background", Strength=1.0)
        sky.nodes.append(desc.NodeDesc("Panorama", "environment_texture", image=self.image(image)))
        sky.links.append(desc.LinkDesc(2, "Color", 1, "Color"))
        self.scene.materials.append(sky)
        self.scene.environment = desc.EnvironmentDesc(
            len(self.scene.materials) - 1, visibility=NOT_DIRECTLY
        )
        return self


def camera(eye=EYE, view: float = VIEW) -> desc.CameraDesc:
    """Looks from the south at the origin."""
    turn = rotation_x(math.atan2(-eye[1], eye[2]))
    return desc.CameraDesc(
        placed(eye, turn), SIDE, SIDE, (0, 0, SIDE, SIDE), (-view, view, -view, view), 1e-6
    )


def floor_points(eye=EYE, view: float = VIEW, subpixels: int = 4) -> np.ndarray:
    """(SIDE, SIDE, subpixels^2, 3): what pixels see of the plane z = 0, bottom row first."""
    n = SIDE * subpixels
    at = ((np.arange(n) + 0.5) / n * 2.0 - 1.0) * view
    x, y = np.meshgrid(at, at)
    d = np.stack([x, y, -np.ones_like(x)], axis=-1) @ rotation_x(math.atan2(-eye[1], eye[2])).T
    p = np.array(eye) - d * (eye[2] / d[..., 2:])
    blocks = p.reshape(SIDE, subpixels, SIDE, subpixels, 3).swapaxes(1, 2)
    return blocks.reshape(SIDE, SIDE, -1, 3)


def moved_and_scaled(scene: desc.SceneDesc, scale: float, offset=(0.0, 0.0, 0.0)):
    """The same picture, of a scene of another size or in another place; `scene` is changed."""
    offset = np.asarray(offset, np.float64)
    for item in (*scene.instances, *scene.lights, scene.camera):
        transform = item.transform.astype(np.float64)
        transform[:, 3] = transform[:, 3] * scale + offset
        item.transform = transform.astype(np.float32)
    for instance in scene.instances:
        instance.transform[:, :3] *= np.float32(scale)
    for light in scene.lights:
        light.radius *= scale
        if light.type is not desc.LightType.SUN:
            light.power = tuple(p * scale**2 for p in light.power)
    return scene
