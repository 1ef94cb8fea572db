# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair, curves and points -> `MeshDesc`: strands become tubes, points become balls.

Cycles has primitives of their own for them, whose outline is round at any distance.
"""

from __future__ import annotations

import math

import numpy as np

from .desc import (
    AttributeDesc,
    AttributeDomain,
    AttributeKind,
    AttributeNeed,
    MeshDesc,
    uv_layer,
)
from .hashes import hash_with_to_unit

SIDES = 4  # of a tube
# A tube of so many sides is as wide, on average over the directions that it is seen from.
WIDENING = math.pi / (SIDES * math.sin(math.pi / SIDES))
CURVE_RADIUS = 0.005  # m, of curves without one
POINT_RADIUS = 0.01
BALL_SUBDIVISIONS = 3  # of an octahedron
# Attributes by which the core knows strands (nodes_hair.cpp): (V, 3) along them, unit, and (V, 4)
# how far along of the length, length and thickness (m), and a random number for each strand.
TANGENT, INFO = ".strand_tangent", ".strand"


def tubes(
    name: str,
    points: np.ndarray,
    radii: np.ndarray,
    counts: np.ndarray,
    uv: dict[str, np.ndarray] | None = None,
    needs: frozenset[AttributeNeed] = frozenset(),
) -> MeshDesc | None:
    """Tubes with smooth normals along strands; None if no strand has two points.

    `points` (P, 3) and `radii` (P,), strand after strand; `counts` (S,): points of each; `uv`: by
    layer (S, 2), one for all of a strand; the first is the active one. TANGENT and INFO are
    made if they are among `needs`.
    """
    first = np.cumsum(counts) - counts
    parts, owners, offset = [], [], 0
    makers = {TANGENT: lambda strands, index: _ahead(points[index]), INFO: _info(points, radii)}
    own = {need.name: [] for need in sorted(needs) if need.name in makers}
    for count in np.unique(counts[counts > 1]):
        strands = np.flatnonzero(counts == count)
        index = first[strands][:, None] + np.arange(count)
        around = _directions(points[index])
        faces = _faces(len(strands), count)
        positions = points[index][:, :, None] + around * (WIDENING * radii[index])[..., None, None]
        parts.append((positions.reshape(-1, 3), faces + offset, around.reshape(-1, 3)[faces]))
        for named, values in own.items():
            at = makers[named](strands, index)
            values.append(np.repeat(at, SIDES, axis=1).reshape(-1, at.shape[2]))
        owners.append(np.repeat(strands, (count - 1) * SIDES * 2))
        offset += positions.size // 3
    if not parts:
        return None
    positions, triangles, normals = (np.concatenate(part) for part in zip(*parts, strict=True))
    of_strand = np.concatenate(owners)
    return MeshDesc(
        name=name,
        positions=positions.astype(np.float32),
        triangles=triangles.astype(np.uint32),
        normals=normals.astype(np.float32),
        attributes=[
            uv_layer(
                layer,
                np.repeat(at[of_strand][:, None], 3, axis=1).astype(np.float32),
                active=number == 0,
            )
            for number, (layer, at) in enumerate((uv or {}).items())
        ]
        + [
            AttributeDesc(
                named,
                AttributeKind.NAMED,
                AttributeDomain.VERTEX,
                np.concatenate(values).astype(np.float32),
            )
            for named, values in own.items()
        ],
    )


def _ahead(points: np.ndarray) -> np.ndarray:
    """Along strands (S, P, 3), unit."""
    return _unit(np.gradient(points, axis=1))


def _info(points: np.ndarray, radii: np.ndarray):
    """What makes INFO of strands of numbers (S,) and the indices (S, P) of their points."""

    def info(strands: np.ndarray, index: np.ndarray) -> np.ndarray:
        so_far = _so_far(points[index])
        lengths = np.broadcast_to(so_far[:, -1:], so_far.shape)
        random = hash_with_to_unit(strands.astype(np.uint32), 0)
        columns = (
            so_far / np.maximum(lengths, 1e-30),
            lengths,
            2.0 * radii[index],
            np.broadcast_to(random[:, None], so_far.shape),
        )
        return np.stack(columns, axis=-1)

    return info


def _so_far(points: np.ndarray) -> np.ndarray:
    """Lengths (S, P) of strands (S, P, 3) up to each point."""
    steps = np.linalg.norm(np.diff(points, axis=1), axis=2)
    return np.pad(np.cumsum(steps, axis=1), ((0, 0), (1, 0)))


def _directions(points: np.ndarray) -> np.ndarray:
    """From the middle of strands (S, P, 3) to their sides (S, P, SIDES, 3), without twist, unit."""
    ahead = _ahead(points)
    side = np.zeros_like(points[:, 0])
    side[np.arange(len(side)), np.abs(ahead[:, 0]).argmin(axis=1)] = 1.0
    sides = np.empty_like(points)
    for i in range(points.shape[1]):
        along = ahead[:, i]
        side = _unit(side - along * (side * along).sum(axis=1, keepdims=True))
        sides[:, i] = side
    others = np.cross(ahead, sides)
    angles = 2.0 * np.pi / SIDES * np.arange(SIDES)
    return (
        np.cos(angles)[:, None] * sides[:, :, None] + np.sin(angles)[:, None] * others[:, :, None]
    )


def _faces(strands: int, count: int) -> np.ndarray:
    """(T, 3) triangles between neighbouring rings, counter-clockwise from outside."""
    ring, side = np.meshgrid(np.arange(count - 1), np.arange(SIDES), indexing="ij")
    a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
    quads = np.stack([a, b, b + SIDES, a, b + SIDES, a + SIDES], axis=-1).reshape(-1, 3)
    starts = count * SIDES * np.arange(strands)
    return (starts[:, None, None] + quads).reshape(-1, 3)


def _unit(vectors: np.ndarray) -> np.ndarray:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(lengths > 0.0, lengths, 1.0)


def particle_hair(obj, system, needs: frozenset[AttributeNeed], is_render: bool) -> MeshDesc | None:
    """The strands of a particle system of the evaluated object `obj`, in object space.

    Of what their material `needs`, they have the UV layers of their emitter and what tubes have.
    """
    named = (AttributeKind.UV, AttributeKind.NAMED)
    layers = frozenset(need.name for need in needs if need.kind in named)
    settings = system.settings
    parents, children = len(system.particles), len(system.child_particles)
    numbers = range(parents if children else 0, parents + children)
    step = settings.render_step if is_render else settings.display_step
    keys = np.array(
        [
            [system.co_hair(obj, particle_no=number, step=i) for i in range((1 << step) + 1)]
            for number in numbers
        ],
        np.float64,
    ).reshape(len(numbers), -1, 3)
    to_object = np.linalg.inv(np.array(obj.matrix_world, np.float64))
    keys = keys @ to_object[:3, :3].T + to_object[:3, 3]
    counts = np.full(len(keys), keys.shape[1])
    radii = _hair_radii(settings, keys)
    uv = _emitter_uv(obj, system, numbers, layers)
    name = f"{obj.name}: {system.name}"
    return tubes(name, keys.reshape(-1, 3), radii.ravel(), counts, uv, needs)


def _hair_radii(settings, keys: np.ndarray) -> np.ndarray:
    """(S, P) from root to tip, as the particle settings shape them."""
    along = _so_far(keys)
    along /= np.maximum(along[:, -1:], 1e-30)
    shape = settings.shape
    power = 1.0 + shape if shape < 0.0 else 1.0 / max(1.0 - shape, 1e-6)
    thickness = (1.0 - along) ** power
    root, tip = settings.root_radius, settings.tip_radius
    radii = 0.5 * settings.radius_scale * (thickness * (root - tip) + tip)
    if settings.use_close_tip:
        radii[:, -1] = 0.0
    return radii


def _emitter_uv(obj, system, numbers, layers: frozenset[str]) -> dict[str, np.ndarray]:
    mesh_layers = list(getattr(obj.data, "uv_layers", ()))
    modifier = next(
        (m for m in obj.modifiers if getattr(m, "particle_system", None) == system), None
    )
    if modifier is None or not len(system.particles):
        return {}
    particle, uv = system.particles[0], {}
    active_first = sorted(enumerate(mesh_layers), key=lambda entry: not entry[1].active_render)
    for number, layer in active_first:
        if layer.name not in layers and not ("" in layers and layer.active_render):
            continue
        at = [
            system.uv_on_emitter(
                modifier,
                particle=system.particles[n] if n < len(system.particles) else particle,
                particle_no=n,
                uv_no=number,
            )
            for n in numbers
        ]
        uv[layer.name] = np.array(at, np.float32).reshape(-1, 2)
    return uv


def curves(obj, needs: frozenset[AttributeNeed]) -> MeshDesc | None:
    """The strands of an evaluated Curves object, in object space."""
    data = obj.data
    counts = np.empty(len(data.curves), np.int32)
    data.curves.foreach_get("points_length", counts)
    points = np.empty((len(data.points), 3), np.float32)
    data.points.foreach_get("position", points.ravel())
    radii = _values(data, "radius", "value", (len(points),), CURVE_RADIUS)
    surface_uv = _values(data, "surface_uv_coordinate", "vector", (len(counts), 2), None)
    uv = {} if surface_uv is None else {data.surface_uv_map or "UVMap": surface_uv}
    return tubes(obj.name, points.astype(np.float64), radii, counts, uv, needs)


def points(obj) -> tuple[np.ndarray, np.ndarray]:
    """Positions (P, 3) and radii (P,) of an evaluated point cloud, in object space."""
    data = obj.data
    positions = np.empty((len(data.points), 3), np.float32)
    data.points.foreach_get("co", positions.ravel())
    return positions, _values(data, "radius", "value", (len(positions),), POINT_RADIUS)


def _values(data, name: str, member: str, shape: tuple[int, ...], default: float | None):
    """A named attribute of `shape`; where there is none `default` for all, None if that is None."""
    attribute = data.attributes.get(name)
    if attribute is None or len(attribute.data) != shape[0]:
        return None if default is None else np.full(shape, default)
    values = np.empty(shape, np.float32)
    attribute.data.foreach_get(member, values.ravel())
    return values.astype(np.float64)


def ball() -> MeshDesc:
    """A ball of radius 1 with smooth normals."""
    corners = np.array([(1, 0, 0), (0, 1, 0), (0, 0, 1)], np.float64)
    octant = corners[None]
    for _ in range(BALL_SUBDIVISIONS):
        a, b, c = octant[:, 0], octant[:, 1], octant[:, 2]
        ab, bc, ca = _unit(a + b), _unit(b + c), _unit(c + a)
        octant = np.concatenate(
            [np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
    signs = np.array([(x, y, z) for x in (1, -1) for y in (1, -1) for z in (1, -1)])
    faces = octant[None] * signs[:, None, None]
    mirrored = signs.prod(axis=1) < 0
    faces[mirrored] = faces[mirrored][:, :, ::-1]
    corners = faces.reshape(-1, 3)
    positions, index = np.unique(corners.round(6) + 0.0, axis=0, return_inverse=True)
    return MeshDesc(
        name="ball",
        positions=positions.astype(np.float32),
        triangles=index.reshape(-1, 3).astype(np.uint32),
        normals=corners.reshape(-1, 3, 3).astype(np.float32),
    )
