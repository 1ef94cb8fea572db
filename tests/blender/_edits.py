# SPDX-License-Identifier: GPL-3.0-or-later
"""Random edits of a scene through Blender's operators and properties, as artists make them."""

from __future__ import annotations

import random

import bpy
from scenes import (
    add_camera,
    add_light,
    add_mesh,
    add_node,
    add_uv,
    new_image,
    new_material,
    surface,
)

MOST = 9  # objects: as many are deleted as added
LEAST = 3
SHAPES = ("cube", "uv_sphere", "cone", "torus", "ico_sphere")
COARSE = {"uv_sphere": {"segments": 8, "ring_count": 6}, "torus": {"major_segments": 8}}


def make_scene() -> None:
    """A floor, a few objects, textures, glass, a moving lamp and an animated colour."""
    floor = add_mesh("Floor")
    add_uv(floor.data)
    floor.scale = (4, 4, 1)
    floor.location.z = -0.83
    for name, kind in (("Plain", "Diffuse"), ("Glass", "Glass"), ("Metal", "Glossy")):
        shader = add_node(new_material(name), f"ShaderNodeBsdf{kind}", surface_of(name))
        shader.name = "Shader"
    image = new_image("Pattern", 8)
    image.generated_type = "COLOR_GRID"
    textured = new_material("Textured")
    shader = add_node(textured, "ShaderNodeBsdfDiffuse", surface(textured))
    add_node(textured, "ShaderNodeTexImage", shader.inputs["Color"], image=image)
    floor.data.materials.append(textured)
    moving = new_material("Animated")
    shader = add_node(moving, "ShaderNodeBsdfDiffuse", surface(moving))
    shader.name = "Shader"
    animate(moving.node_tree, 'nodes["Shader"].inputs[0].default_value', 0)
    lamp = add_light(energy=300.0)
    lamp.name, lamp.location = "Lamp", (1, 1, 3)
    animate(lamp, "location", 2)
    camera = add_camera((0, -3, 6))
    camera.rotation_euler.x = 0.45
    bpy.context.scene.world = bpy.data.worlds.new("World")
    edits = Edits(0)
    for _ in range(LEAST):
        edits.add()


def surface_of(name: str):
    return surface(bpy.data.materials[name])


def animate(owner, path: str, index: int) -> None:
    owner.animation_data_create()
    if owner.animation_data.action is None:
        owner.animation_data.action = bpy.data.actions.new(owner.name)
    for frame, value in ((1, 0.2), (9, 3.4)):
        holder = owner.path_resolve(path)
        holder[index] = value
        owner.keyframe_insert(path, index=index, frame=frame)


class Edits:
    """Draws edits; `one` makes the next and returns its name. Objects are found by name each time:
    an undo moves them."""

    def __init__(self, seed: int, with_undo: bool = True):
        self._random = random.Random(seed)
        self._number = 0
        others = {"one"} if with_undo else {"one", "undo"}
        self._kinds = [
            name for name in dir(self) if not name.startswith("_") and name not in others
        ]

    def one(self) -> str:
        name = self._random.choice(self._kinds)
        getattr(self, name)()
        return name

    def _any(self, kind="MESH"):
        found = [o for o in bpy.context.scene.objects if o.type == kind and o.name != "Floor"]
        return self._random.choice(sorted(found, key=lambda obj: obj.name))

    def _meshes(self) -> int:
        return sum(obj.type == "MESH" for obj in bpy.context.scene.objects)

    def _select(self, obj) -> None:
        bpy.ops.object.select_all(action="DESELECT")
        obj.select_set(True)
        bpy.context.view_layer.objects.active = obj

    def _number_between(self, low: float, high: float) -> float:
        return self._random.uniform(low, high)

    def _place(self) -> tuple:
        between = self._random.uniform
        return between(-1.6, 1.6), between(-1.2, 1.2), between(-0.4, 0.9)

    def _angles(self) -> tuple:
        return tuple(self._random.uniform(-3.0, 3.0) for _ in range(3))

    def _material(self):
        return self._random.choice(sorted(bpy.data.materials, key=lambda item: item.name))

    # --------------------------------------------------------------------------------- objects

    def add(self) -> None:
        if self._meshes() > MOST:
            self.delete()
        shape = self._random.choice(SHAPES)
        make = getattr(bpy.ops.mesh, f"primitive_{shape}_add")
        make(location=self._place(), rotation=self._angles(), **COARSE.get(shape, {}))
        obj = bpy.context.view_layer.objects.active
        obj.scale = (self._number_between(0.3, 0.5),) * 3
        obj.data.materials.append(self._material())

    def delete(self) -> None:
        if self._meshes() > LEAST:
            self._select(self._any())
            bpy.ops.object.delete()

    def duplicate(self) -> None:
        if self._meshes() > MOST:
            return
        self._select(self._any())
        bpy.ops.object.duplicate(linked=self._random.random() < 0.7)
        bpy.context.view_layer.objects.active.location = self._place()

    def move(self) -> None:
        self._select(self._any())
        bpy.ops.transform.translate(value=[0.3 * x for x in self._place()])

    def turn(self) -> None:
        self._any().rotation_euler = self._angles()

    def rename(self) -> None:
        self._number += 1
        self._any().name = f"Renamed {self._number}"

    def hide(self) -> None:
        obj = self._any()
        obj.hide_viewport = obj.hide_render = not obj.hide_render

    def camera_ray_visibility(self) -> None:
        obj = self._any()
        obj.visible_camera = not obj.visible_camera

    def parent(self) -> None:
        child, parent = self._any(), self._any()
        child.parent = parent if parent != child and parent.parent is None else None

    # ------------------------------------------------------------------------------- geometry

    def shape(self) -> None:
        mesh = self._any().data
        mesh.vertices[0].co.z += 0.2
        mesh.update()

    def edit_mode(self) -> None:
        obj = self._any()
        if len(obj.data.vertices) > 300 or obj.hide_viewport:
            return
        self._select(obj)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.quads_convert_to_tris()
        bpy.ops.object.mode_set(mode="OBJECT")

    def smooth(self) -> None:
        obj = self._any()
        if not obj.hide_viewport:
            self._select(obj)
            bpy.ops.object.shade_smooth()

    def modifier(self) -> None:
        obj = self._any()
        if obj.modifiers:
            obj.modifiers.clear()
        else:
            cast = obj.modifiers.new("Cast", "CAST")
            cast.factor = self._number_between(0.2, 0.8)

    # ------------------------------------------------------------------- materials and lights

    def slot(self) -> None:
        mesh = self._any().data
        if mesh.materials:
            mesh.materials[0] = self._material()
        else:
            mesh.materials.append(self._material())

    def node_value(self) -> None:
        for name in ("Plain", "Metal", "Glass"):
            shader = bpy.data.materials[name].node_tree.nodes["Shader"]
            shader.inputs[0].default_value[:3] = [self._random.random() for _ in range(3)]

    def new_nodes(self) -> None:
        material = bpy.data.materials["Plain"]
        shader = material.node_tree.nodes["Shader"]
        if shader.inputs[0].is_linked:
            material.node_tree.links.remove(shader.inputs[0].links[0])
        else:
            color = add_node(material, "ShaderNodeRGB", shader.inputs[0])
            color.outputs[0].default_value[:3] = [self._random.random() for _ in range(3)]

    def texture(self) -> None:
        material = bpy.data.materials["Textured"]
        number = self._random.randrange(3)
        image = bpy.data.images.get(f"Image {number}") or new_image(f"Image {number}", 4)
        image.generated_color = [self._random.random() for _ in range(3)] + [1.0]
        nodes = material.node_tree.nodes
        next(node for node in nodes if node.type == "TEX_IMAGE").image = image

    def paint(self) -> None:
        image = bpy.data.images["Pattern"]
        image.pixels[self._random.randrange(0, 64) * 4] = self._random.random()
        image.update()
        image.update_tag()  # which a stroke of the brush does

    def light(self) -> None:
        light = self._any("LIGHT")
        light.data.energy = self._number_between(100.0, 500.0)
        light.data.color = [self._number_between(0.4, 1.0) for _ in range(3)]

    def lamps(self) -> None:
        lights = [obj for obj in bpy.context.scene.objects if obj.type == "LIGHT"]
        if len(lights) > 2:
            self._select(lights[-1])
            bpy.ops.object.delete()
        else:
            kind = self._random.choice(("POINT", "SUN", "AREA", "SPOT"))
            bpy.ops.object.light_add(type=kind, location=(*self._place()[:2], 2.5))

    def world(self) -> None:
        bpy.context.scene.world.color = [self._random.random() for _ in range(3)]

    # ------------------------------------------------------------------------------- the rest

    def frame(self) -> None:
        bpy.context.scene.frame_set(self._random.randrange(1, 10))

    def camera(self) -> None:
        bpy.context.scene.camera.location.x = self._number_between(-0.5, 0.5)

    def select(self) -> None:
        self._select(self._any())

    def undo(self) -> None:
        """An undo, or an undo and a redo."""
        bpy.ops.ed.undo_push(message="before")
        self.move()
        self.light()
        bpy.ops.ed.undo_push(message="after")
        bpy.ops.ed.undo()
        if self._random.random() < 0.5:
            bpy.ops.ed.redo()
