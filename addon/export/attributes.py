# SPDX-License-Identifier: GPL-3.0-or-later
"""What materials read of a mesh -> `AttributeDesc`. Bulk reads, but for islands."""

from __future__ import annotations

import numpy as np

from . import compat
from .arrays import read
from .desc import AttributeDesc, AttributeDomain, AttributeKind, AttributeNeed, uv_layer
from .hashes import hash_to_unit
from .tangents import corner_tangents

# Type of Blender's attributes -> property of an element, its number of components and their type.
_TYPES = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),  # linear, as RNA gives it
}
_BY_NAME = (AttributeKind.NAMED, AttributeKind.UV, AttributeKind.COLOR)


def mesh_attributes(obj, corners: np.ndarray, needs: frozenset[AttributeNeed]):
    """The attributes of evaluated mesh object `obj` that `needs` names, but those it lacks.

    `corners` (T, 3) holds the loops of `obj.data.loop_triangles`.
    """
    reader = _Reader(obj, corners)
    wanted = {}  # what Blender calls it, and its kind -> whether tangents are read
    for need in sorted(needs):
        key = reader.key(need)
        if key is not None:
            wanted[key] = wanted.get(key, False) or need.tangents
    found = [reader.read(kind, name, tangents) for (kind, name), tangents in wanted.items()]
    return [attribute for attribute in found if attribute is not None]


class _Reader:
    def __init__(self, obj, corners: np.ndarray):
        self.obj = obj
        self.mesh = obj.data
        self.corners = corners

    def key(self, need: AttributeNeed) -> tuple[AttributeKind, str] | None:
        """Kind and name of the attribute that is meant; two needs may mean the same."""
        if need.kind not in _BY_NAME:
            return None if need.kind >= AttributeKind.OBJECT else (need.kind, "")
        active = {
            AttributeKind.UV: compat.active_uv(self.mesh),
            AttributeKind.COLOR: compat.active_color(self.mesh),
        }
        name = need.name or active.get(need.kind)
        kinds = (kind for kind, own in active.items() if own == name)
        return (next(kinds, AttributeKind.NAMED), name) if name else None

    def read(self, kind: AttributeKind, name: str, tangents: bool) -> AttributeDesc | None:
        if kind == AttributeKind.GENERATED:
            return AttributeDesc("", kind, AttributeDomain.VERTEX, generated(self.mesh))
        if kind == AttributeKind.POINTINESS:
            return AttributeDesc("", kind, AttributeDomain.VERTEX, pointiness(self.mesh))
        if kind == AttributeKind.ISLAND:
            values = islands(self.mesh)[self._polygons()]
            return AttributeDesc("", kind, AttributeDomain.TRIANGLE, values)
        if name in self.mesh.uv_layers:
            return self._uv_layer(kind, name, tangents)
        return self._named(kind, name)

    def _polygons(self) -> np.ndarray:
        return read(self.mesh.loop_triangles, "polygon_index", (), np.int32)

    def _uv_layer(self, kind: AttributeKind, name: str, tangents: bool) -> AttributeDesc:
        # Found by name each time: tangents are computed into the mesh, which moves its layers.
        uv = read(self.mesh.uv_layers[name].data, "uv", (2,), np.float32)[self.corners]
        along = corner_tangents(self.obj, name, self.corners) if tangents else None
        return uv_layer(name, uv, along, active=kind == AttributeKind.UV)

    def _named(self, kind: AttributeKind, name: str) -> AttributeDesc | None:
        attribute = self.mesh.attributes.get(name)
        if attribute is None:
            return self._vertex_group(kind, name)
        if attribute.data_type not in _TYPES:
            return None
        field, components, dtype = _TYPES[attribute.data_type]
        values = read(attribute.data, field, (components,) if components > 1 else (), dtype)
        values = values.reshape(-1, components).astype(np.float32)
        domain = AttributeDomain.VERTEX
        if attribute.domain == "CORNER":
            domain, values = AttributeDomain.CORNER, values[self.corners.ravel()]
        elif attribute.domain == "FACE":
            domain, values = AttributeDomain.TRIANGLE, values[self._polygons()]
        elif attribute.domain == "EDGE":
            values = _edges_to_vertices(self.mesh, values)
        return AttributeDesc(name, kind, domain, values)

    def _vertex_group(self, kind: AttributeKind, name: str) -> AttributeDesc | None:
        """Weights of a vertex group, which Cycles, too, reads as an attribute."""
        group = self.obj.vertex_groups.get(name)
        if group is None:
            return None
        values = np.zeros((len(self.mesh.vertices), 1), np.float32)
        for vertex in self.mesh.vertices:
            for element in vertex.groups:
                if element.group == group.index:
                    values[vertex.index] = element.weight
        return AttributeDesc(name, kind, AttributeDomain.VERTEX, values)


def generated(mesh) -> np.ndarray:
    """(V, 3): where each vertex lay in the texture space before it was deformed."""
    undeformed = read(mesh.vertices, "undeformed_co", (3,), np.float32)
    size = np.array(mesh.texspace_size, np.float32)
    scale = np.divide(0.5, size, out=np.zeros_like(size), where=size != 0)
    return (undeformed - np.array(mesh.texspace_location, np.float32)) * scale + np.float32(0.5)


def _edges(mesh) -> np.ndarray:
    return read(mesh.edges, "vertices", (2,), np.int32)


def _edges_to_vertices(mesh, values: np.ndarray) -> np.ndarray:
    """(V, C) means over the edges of each vertex."""
    count = len(mesh.vertices)
    edges = _edges(mesh)
    sums = np.zeros((count, values.shape[1]), np.float32)
    for end in (0, 1):
        np.add.at(sums, edges[:, end], values)
    uses = np.bincount(edges.ravel(), minlength=count)
    return (sums / np.maximum(uses, 1)[:, None]).astype(np.float32)


def pointiness(mesh) -> np.ndarray:
    """(V, 1): the angle between a vertex's normal and the mean of its edges, in units of pi,
    averaged with its neighbours. Vertices in one place count as one.
    """
    positions = read(mesh.vertices, "co", (3,), np.float32)
    _, first, same = np.unique(positions, axis=0, return_index=True, return_inverse=True)
    same = same.ravel()
    count = len(first)
    normals = np.zeros((count, 3), np.float32)
    np.add.at(normals, same, read(mesh.vertices, "normal", (3,), np.float32))
    normals = _unit(normals)
    edges = np.unique(np.sort(same[_edges(mesh)], axis=1), axis=0)
    along = _unit(positions[first][edges[:, 1]] - positions[first][edges[:, 0]])
    sums = np.zeros((count, 3), np.float32)
    np.add.at(sums, edges[:, 0], along)
    np.add.at(sums, edges[:, 1], -along)
    uses = np.bincount(edges.ravel(), minlength=count)
    means = sums / np.maximum(uses, 1)[:, None]
    angles = np.arccos(np.clip((normals * means).sum(1), -1.0, 1.0)) / np.pi
    angles[uses == 0] = 0.0
    blurred = angles.copy()
    np.add.at(blurred, edges[:, 0], angles[edges[:, 1]])
    np.add.at(blurred, edges[:, 1], angles[edges[:, 0]])
    return (blurred / (uses + 1))[same].astype(np.float32)[:, None]


def _unit(vectors: np.ndarray) -> np.ndarray:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)


def islands(mesh) -> np.ndarray:
    """(P, 1): a random number of each face's connected part, the one that Cycles draws.

    That hashes the vertex which stands for the part in a forest of unions by rank, edge by edge.
    """
    parents, ranks = list(range(len(mesh.vertices))), [0] * len(mesh.vertices)

    def find(vertex: int) -> int:
        root = vertex
        while parents[root] != root:
            root = parents[root]
        while parents[vertex] != root:
            parents[vertex], vertex = root, parents[vertex]
        return root

    for a, b in _edges(mesh).tolist():
        a, b = find(a), find(b)
        if a == b:
            continue
        if ranks[a] < ranks[b]:
            a, b = b, a
        parents[b] = a
        ranks[a] += ranks[a] == ranks[b]
    starts = read(mesh.polygons, "loop_start", (), np.int32)
    vertices = read(mesh.loops, "vertex_index", (), np.int32)[starts]
    roots = np.array([find(vertex) for vertex in vertices.tolist()], np.uint32)
    return hash_to_unit(roots).astype(np.float32)[:, None]
