# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes, and what the export makes of them."""

from __future__ import annotations

import bpy
import numpy as np

from specula.export.log import ExportLog
from specula.export.scene import export_scene

QUAD = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]


class Exporter(bpy.types.RenderEngine):
    """Exports what a final render would see, in Blender's own render call, and renders nothing."""

    bl_idname = "SPECULA_EXPORT_TEST"
    bl_label = "Specula export test"
    result = None
    error = None

    def render(self, depsgraph):
        log = ExportLog()
        try:
            Exporter.result = export_scene(depsgraph, log), log.warnings
        except Exception as error:
            Exporter.error = error


def export():
    """(SceneDesc, warnings) of the open file. Raises what the export raises."""
    scene = bpy.context.scene
    if scene.camera is None:
        add_camera()
    engine = scene.render.engine
    bpy.utils.register_class(Exporter)
    Exporter.result = Exporter.error = None
    scene.render.engine = Exporter.bl_idname
    try:
        bpy.ops.render.render()
    finally:
        scene.render.engine = engine
        bpy.utils.unregister_class(Exporter)
    if Exporter.error:
        raise Exporter.error
    return Exporter.result


def link(name: str, data):
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def add_camera(location=(0, 0, 5)):
    obj = link("Camera", bpy.data.cameras.new("Camera"))
    obj.location = location
    bpy.context.scene.camera = obj
    return obj


def add_mesh(name="Mesh", vertices=QUAD, faces=((0, 1, 2, 3),), material=None):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in vertices], [], [tuple(f) for f in faces])
    if material:
        mesh.materials.append(material)
    return link(name, mesh)


def add_light(type="POINT", name="Light", **properties):
    light = bpy.data.lights.new(name, type)
    for key, value in properties.items():
        setattr(light, key, value)
    return link(name, light)


def new_material(name="Material"):
    """A material whose tree holds nothing but its output."""
    material = bpy.data.materials.new(name)
    return _emptied(material, "ShaderNodeOutputMaterial")


def new_world(name="World"):
    world = bpy.data.worlds.new(name)
    bpy.context.scene.world = world
    return _emptied(world, "ShaderNodeOutputWorld")


def _emptied(owner, output):
    if not owner.node_tree:  # always there from 5.0, where use_nodes is deprecated
        owner.use_nodes = True
    owner.node_tree.nodes.clear()
    owner.node_tree.nodes.new(output)
    return owner


def output_of(owner):
    return next(n for n in owner.node_tree.nodes if n.bl_idname.startswith("ShaderNodeOutput"))


def add_node(owner, bl_idname: str, to=None, output=0, **properties):
    """A new node; `to` is an input socket that its output feeds. Inputs are set by identifier."""
    node = owner.node_tree.nodes.new(bl_idname)
    for key, value in properties.items():
        setattr(node, key, value)
    if to is not None:
        owner.node_tree.links.new(node.outputs[output], to)
    return node


def surface(owner):
    """The socket that shades a material or world."""
    return output_of(owner).inputs["Surface"]


def add_uv(mesh, name="UVMap", scale=1.0):
    """A UV layer that is the position's x and y times `scale`."""
    layer = mesh.uv_layers.new(name=name)
    vertices = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", vertices)
    positions = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", positions.ravel())
    layer.data.foreach_set("uv", (scale * positions[vertices][:, :2]).ravel())
    return layer


def new_image(name="Image", size=4):
    return bpy.data.images.new(name, size, size)


def node(material_desc, kind: str):
    """The only node of a kind."""
    (found,) = [n for n in material_desc.nodes if n.kind == kind]
    return found


def links(material_desc) -> set[str]:
    """'from_kind.socket -> to_kind.socket' of every link."""
    nodes = material_desc.nodes
    return {
        f"{nodes[x.from_node].kind}.{x.from_socket} -> {nodes[x.to_node].kind}.{x.to_socket}"
        for x in material_desc.links
    }
