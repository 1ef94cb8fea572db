# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated mesh -> `MeshDesc`. Bulk reads only; nothing here loops over elements.

Curves, surfaces, text, metaballs and what geometry nodes make reach the export as meshes: the
dependency graph yields each of them as an instance with an evaluated mesh.
"""

from __future__ import annotations

import numpy as np

from . import compat
from .arrays import read
from .attributes import mesh_attributes
from .desc import AttributeNeed, MeshDesc


def export_mesh(obj, needs: frozenset[AttributeNeed], slot_count: int) -> MeshDesc | None:
    """Triangles of evaluated object `obj` in object space; None if it has no faces.

    positions (V, 3) float32 m; triangles (T, 3) uint32; normals (T, 3, 3) float32 at corners, None
    if every face is flat; material_slots (T,) uint32, None if there is one slot; attributes as
    `needs` names them. One that the mesh lacks is left out.
    """
    mesh = obj.data
    if not mesh.polygons:
        return None
    mesh.calc_loop_triangles()
    corners = read(mesh.loop_triangles, "loops", (3,), np.int32)
    vertices = read(mesh.loop_triangles, "vertices", (3,), np.int32)
    attributes = mesh_attributes(obj, corners, needs)
    return MeshDesc(
        name=obj.name,
        positions=read(mesh.vertices, "co", (3,), np.float32),
        triangles=vertices.view(np.uint32),
        normals=None if compat.is_flat(mesh) else compat.corner_normals(mesh)[corners],
        flat_faces=_flat_faces(mesh),
        material_slots=_material_slots(mesh, slot_count),
        slot_count=slot_count,
        attributes=attributes,
    )


def _flat_faces(mesh) -> np.ndarray | None:
    """(T,) uint32, 1 for triangles without smooth normals; None where all are of one kind."""
    smooth = read(mesh.polygons, "use_smooth", (), bool)
    if smooth.all() or not smooth.any():
        return None
    return (~smooth)[read(mesh.loop_triangles, "polygon_index", (), np.int32)].astype(np.uint32)


def _material_slots(mesh, slot_count: int) -> np.ndarray | None:
    """(T,) slot of each triangle. Blender draws an index beyond the last slot with the last."""
    if slot_count == 1:
        return None
    polygon_slots = read(mesh.polygons, "material_index", (), np.int32)
    polygons = read(mesh.loop_triangles, "polygon_index", (), np.int32)
    return np.clip(polygon_slots, 0, slot_count - 1)[polygons].astype(np.uint32)
