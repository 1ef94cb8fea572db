# SPDX-License-Identifier: GPL-3.0-or-later
"""MikkTSpace tangents, as Blender computes them for normal maps."""

from __future__ import annotations

import numpy as np

from . import compat

MAX_CORNERS = 4  # Blender's MikkTSpace refuses a mesh with a larger face


def corner_tangents(obj, uv_name: str, corners: np.ndarray) -> np.ndarray:
    """Tangents of evaluated object `obj` for a UV layer at triangle corners: (T, 3, 4) float32.

    xyz is the tangent in object space, w the bitangent's sign. `corners` (T, 3) holds the loops of
    `obj.data.loop_triangles`.
    """
    mesh = obj.data
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    if sizes.max() <= MAX_CORNERS:
        return _loop_tangents(mesh, uv_name)[corners]
    copy = _triangle_copy(obj, uv_name, corners)
    try:
        return _loop_tangents(copy, uv_name).reshape(-1, 3, 4)
    finally:
        obj.to_mesh_clear()


def _loop_tangents(mesh, uv_name: str) -> np.ndarray:
    """(L, 4) float32 for every loop of a mesh without large faces."""
    tangents = np.empty((len(mesh.loops), 3), np.float32)
    signs = np.empty((len(mesh.loops), 1), np.float32)
    mesh.calc_tangents(uvmap=uv_name)
    mesh.loops.foreach_get("tangent", tangents.ravel())
    mesh.loops.foreach_get("bitangent_sign", signs.ravel())
    mesh.free_tangents()
    return np.concatenate((tangents, signs), axis=1)


def _triangle_copy(obj, uv_name: str, corners: np.ndarray):
    """A mesh of the loop triangles with the same corner normals and UVs; its loops are `corners`.

    The object owns it until `obj.to_mesh_clear()`.
    """
    source = obj.data
    normals = compat.corner_normals(source)[corners].reshape(-1, 3)
    uv = np.empty((len(source.loops), 2), np.float32)
    source.uv_layers[uv_name].data.foreach_get("uv", uv.ravel())
    positions = np.empty((len(source.vertices), 3), np.float32)
    source.vertices.foreach_get("co", positions.ravel())
    vertices = np.empty(len(source.loops), np.int32)
    source.loops.foreach_get("vertex_index", vertices)

    count = len(corners)
    mesh = obj.to_mesh()
    mesh.clear_geometry()
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", vertices[corners].ravel())
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    compat.finish_triangles(mesh)
    layer = mesh.uv_layers.new(name=uv_name)
    layer.data.foreach_set("uv", uv[corners].ravel())
    compat.set_corner_normals(mesh, normals)
    return mesh
