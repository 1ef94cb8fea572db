# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene contains, as plain values: two builds of a scene must agree in it."""

import bpy
import numpy as np

# Absolute and relative: NumPy's transforms may differ in their last bits between machines.
TOLERANCE = 1e-4
SKIPPED = {"denoiser", "preview_denoiser"}  # their choices depend on how Blender was built


def describe():
    """A dictionary from path ('objects/Panel/...') to a number, a string or an array."""
    out = {}
    scene = bpy.context.scene
    for owner, prefix in (
        (scene.render, "render"),
        (scene.cycles, "cycles"),
        (scene.view_settings, "view_settings"),
    ):
        _properties(out, prefix, owner)
    for obj in bpy.data.objects:
        prefix = f"objects/{obj.name}"
        out[prefix + "/matrix"] = np.array(obj.matrix_world)
        out[prefix + "/data"] = obj.data.name
        _properties(out, prefix + "/cycles", obj.cycles)
        for modifier in obj.modifiers:
            _properties(out, f"{prefix}/modifiers/{modifier.name}", modifier)
    for mesh in bpy.data.meshes:
        _mesh(out, f"meshes/{mesh.name}", mesh)
    for light in bpy.data.lights:
        _properties(out, f"lights/{light.name}", light)
        _properties(out, f"lights/{light.name}/cycles", light.cycles)
    for camera in bpy.data.cameras:
        _properties(out, f"cameras/{camera.name}", camera)
    for image in bpy.data.images:
        if image.packed_file:
            prefix = f"images/{image.name}"
            out[prefix + "/colorspace"] = image.colorspace_settings.name
            out[prefix + "/float"] = image.is_float
            pixels = np.empty(len(image.pixels), np.float32)
            image.pixels.foreach_get(pixels)
            out[prefix + "/pixels"] = pixels
    for owner in (*bpy.data.materials, *bpy.data.worlds):
        _node_tree(out, f"nodes/{owner.name}", owner.node_tree)
    return out


def compare(a, b):
    """Differences of two descriptions, one line each."""
    lines = [f"only in one of them: {key}" for key in sorted(set(a) ^ set(b))]
    for key in sorted(set(a) & set(b)):
        if not _same(a[key], b[key]):
            lines.append(f"{key}: {_short(a[key])} against {_short(b[key])}")
    return lines


def missing_data():
    """Problems of the open file: images not packed or not loading, libraries, absolute paths."""
    lines = [f"linked library: {library.filepath}" for library in bpy.data.libraries]
    for image in bpy.data.images:
        if image.source != "FILE":
            continue
        if not image.packed_file:
            lines.append(f"image not packed: {image.name}")
        if image.size[0] == 0:
            lines.append(f"image does not load: {image.name}")
        if not image.filepath_raw.startswith("//"):
            lines.append(f"absolute path: {image.filepath_raw}")
    return lines


def _properties(out, prefix, owner):
    for prop in owner.bl_rna.properties:
        if prop.is_readonly or prop.type not in {"BOOLEAN", "INT", "FLOAT", "ENUM", "STRING"}:
            continue
        if prop.identifier in SKIPPED:
            continue
        value = getattr(owner, prop.identifier)
        if prop.type == "STRING" or isinstance(value, (str, set)):
            out[f"{prefix}/{prop.identifier}"] = str(value)
        else:
            out[f"{prefix}/{prop.identifier}"] = np.array(value, dtype=float)


def _mesh(out, prefix, mesh):
    def read(collection, name, width, dtype):
        values = np.empty(len(collection) * width, dtype)
        collection.foreach_get(name, values)
        return values

    out[prefix + "/co"] = read(mesh.vertices, "co", 3, np.float32)
    out[prefix + "/loops"] = read(mesh.loops, "vertex_index", 1, np.int32)
    out[prefix + "/material_index"] = read(mesh.polygons, "material_index", 1, np.int32)
    out[prefix + "/smooth"] = read(mesh.polygons, "use_smooth", 1, np.int32)
    out[prefix + "/materials"] = str([m.name for m in mesh.materials])
    for layer in mesh.uv_layers:
        out[f"{prefix}/uv/{layer.name}"] = read(layer.data, "uv", 2, np.float32)


def _node_tree(out, prefix, tree):
    for node in tree.nodes:
        path = f"{prefix}/{node.name}"
        _properties(out, path, node)
        if getattr(node, "image", None):
            out[path + "/image"] = node.image.name
        for index, socket in enumerate(node.inputs):
            if hasattr(socket, "default_value"):
                out[f"{path}/inputs/{index}"] = np.array(socket.default_value, dtype=float)
    links = [
        (k.from_node.name, k.from_socket.name, k.to_node.name, k.to_socket.name) for k in tree.links
    ]
    out[prefix + "/links"] = str(sorted(links))


def _same(a, b):
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.shape == b.shape and np.allclose(
            a, b, rtol=TOLERANCE, atol=TOLERANCE, equal_nan=True
        )
    return a == b


def _short(value):
    text = str(value).replace("\n", " ")
    return text if len(text) < 60 else text[:57] + "..."
