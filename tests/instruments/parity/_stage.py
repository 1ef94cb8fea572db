# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: the stage that a row changes.

A smooth ball, a card that shows its back, and a flat block carry the material of the row; all stand
on a grey floor under a textured sky and a square lamp. So every coordinate, both sides and all
angles are seen.
"""

from __future__ import annotations

import math

import bpy
import numpy as np
from mathutils import Vector

from specula.export import compat
from tests.instruments.pairs.settings import plain_cycles
from tests.instruments.parity import _images
from tests.instruments.parity._nodes import HUES, N, Node

SIZE = 96  # pixels
CAMERA, TARGET = (0.0, -6.0, 3.0), (0.0, 0.0, 0.7)
LAMP = (2.5, -2.5, 4.5)
GREY = (0.6, 0.6, 0.6, 1.0)
BALL = (-0.9, 0.0, 1.0)
MAP = 256  # cells along Cycles' map of the world's importance


class Absent(Exception):
    """This Blender has no such node, mode, socket or setting."""


def assign(owner, values: dict) -> None:
    """Sets properties; a dictionary is for what the property holds, dots go deeper."""
    for name, value in values.items():
        *path, last = name.split(".")
        target = owner
        for part in path:
            target = getattr(target, part)
        if not hasattr(target, last):
            raise Absent(f"{type(target).__name__} has no {last}")
        if isinstance(value, dict):
            assign(getattr(target, last), value)
            continue
        try:
            setattr(target, last, value)
        except TypeError as error:  # an enumeration that lacks the value
            raise Absent(f"{last}: {error}") from error


class Stage:
    """The open file's only scene; what rows change it by."""

    def __init__(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        self.scene.render.resolution_x = self.scene.render.resolution_y = SIZE
        plain_cycles(self.scene)
        self.grey = self.material(N("BsdfDiffuse", {"Color": GREY}))
        bpy.ops.mesh.primitive_plane_add(size=9.0)
        self.floor = self._dressed(self.grey)
        self.sphere = self._ball(32, 16)
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=1.4)
        self.card = self._dressed(self.grey)
        self.card.location = (1.0, 0.5, 0.9)
        self.card.rotation_euler = (math.radians(-70), math.radians(15), math.radians(25))
        bpy.ops.mesh.primitive_cube_add(size=0.8)
        self.block = self._dressed(self.grey)
        self.block.location = (0.75, -1.2, 0.41)
        self.block.rotation_euler = (0.0, 0.0, 0.6)
        self.block.color = (0.2, 0.7, 0.4, 0.6)
        self.block.pass_index = 2
        self.sphere.color = (0.7, 0.3, 0.5, 0.8)
        self.sphere["shade"] = 0.6
        self.scene.view_layers[0]["shade"] = 0.4
        for obj in self.subjects:
            self._attributes(obj.data)
        self.lamp = self.add_light("AREA", LAMP, energy=150.0, shape="SQUARE", size=2.0)
        self._aim(self.lamp, TARGET)
        self.world(N("Background", {"Color": N("TexEnvironment", image="sky")}))
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        self.scene.collection.objects.link(camera)
        camera.location = CAMERA
        self._aim(camera, TARGET)
        self.scene.camera = camera

    @property
    def subjects(self):
        """What carries the row's material."""
        return self.sphere, self.card, self.block

    def _dressed(self, material):
        obj = bpy.context.object
        obj.data.materials.append(material)
        return obj

    def _ball(self, segments: int, rings: int, location=BALL, radius=1.0):
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=segments, ring_count=rings, radius=radius, location=location
        )
        _set_smooth(bpy.context.object.data, True)
        return self._dressed(self.grey)

    def _attributes(self, mesh) -> None:
        """A colour and a number for each vertex."""
        positions = np.empty((len(mesh.vertices), 3), np.float32)
        mesh.vertices.foreach_get("co", positions.ravel())
        shades = np.clip(0.5 + 0.4 * positions, 0.0, 1.0)
        tint = mesh.color_attributes.new("Tint", "FLOAT_COLOR", "POINT")
        tint.data.foreach_set("color", np.c_[shades, np.ones(len(shades))].ravel())
        weight = mesh.attributes.new("weight", "FLOAT", "POINT")
        weight.data.foreach_set("value", shades[:, 2].copy())

    def _aim(self, obj, target) -> None:
        direction = Vector(target) - obj.location
        obj.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()

    # -------------------------------------------------------------------------------- materials

    def material(self, shader: Node | None, displacement: str = "BUMP", **sockets: Node):
        """A new material; `sockets`: Volume or Displacement, whose method is `displacement`."""
        material = bpy.data.materials.new("Subject")
        self.graph(material, "ShaderNodeOutputMaterial", {"Surface": shader} | sockets)
        if "Displacement" in sockets:
            owner = material if hasattr(material, "displacement_method") else material.cycles
            owner.displacement_method = displacement
        return material

    def graph(self, owner, output: str, sockets: dict[str, Node | None]) -> None:
        """The node tree of a material, world or light."""
        if not owner.node_tree or not owner.use_nodes:
            owner.use_nodes = True
        tree = owner.node_tree
        tree.nodes.clear()
        end = tree.nodes.new(output)
        made = {}
        for name, node in sockets.items():
            if node is not None:
                tree.links.new(self._node(tree, node, made), end.inputs[name])

    def _node(self, tree, spec: Node, made: dict):
        """The output socket that `spec` means; a Node that feeds several sockets is made once."""
        node = made.get(id(spec))
        if node is None:
            try:
                node = tree.nodes.new(f"ShaderNode{spec.kind}")
            except RuntimeError as error:
                raise Absent(f"no {spec.kind}") from error
            made[id(spec)] = node
            for name, value in spec.properties.items():
                _set_property(node, name, value)
            for key, value in spec.inputs.items():
                socket = _input(node, key)
                if isinstance(value, Node):
                    tree.links.new(self._node(tree, value, made), socket)
                else:
                    _set_constant(socket, value)
        return _output(node, spec.output)

    def dress(self, shader: Node | None, displacement: str = "BUMP", **sockets: Node) -> None:
        """Ball, card and block of one material."""
        material = self.material(shader, displacement, **sockets)
        for obj in self.subjects:
            obj.data.materials[0] = material

    def put(self, obj, shader: Node, index: int) -> None:
        """A material of its own on an object; `index` is that of both in passes."""
        material = self.material(shader)
        material.pass_index = obj.pass_index = index
        obj.data.materials[0] = material

    def switch_on(self, switch: str) -> None:
        """One of a view layer, or "cycles.NAME"."""
        assign(self.scene.view_layers[0], {switch: True})

    def mist(self, start: float, depth: float) -> None:
        assign(self.scene.world.mist_settings, {"start": start, "depth": depth})

    def show(self, shader: Node, floor: Node | None = None) -> None:
        """As light, in the dark; the floor shows it, too, unless it has a shader of its own."""
        self.light_off()
        self.no_world()
        self.dress(shader)
        self.floor.data.materials[0] = self.material(floor or shader)
        if floor is None:
            self.scene.cycles.max_bounces = 0

    def varied(self, settings: dict) -> None:
        """A mirror, glass, a see-through card, and Cycles' settings."""
        glass = self.material(N("BsdfGlass", {"Roughness": 0.0}))
        see_through = N(
            "MixShader", {0: 0.5, 1: N("BsdfTransparent"), 2: N("BsdfDiffuse", {"Color": HUES})}
        )
        self.block.data.materials[0] = glass
        self.card.data.materials[0] = self.material(see_through)
        self.sphere.data.materials[0] = self.material(N("BsdfGlossy", {"Roughness": 0.15}))
        assign(self.scene.cycles, settings)

    # ---------------------------------------------------------------------------- light and world

    def light(self, kind, cycles=None, nodes=None, object=None, glossy=False, **values) -> None:
        """Another lamp in place of the stage's."""
        self.light_off()
        self.lamp = self.add_light(kind, LAMP, **values)
        self._aim(self.lamp, TARGET)
        assign(self.lamp.data.cycles, cycles or {})
        assign(self.lamp, object or {})
        if nodes:
            self.graph(self.lamp.data, "ShaderNodeOutputLight", {"Surface": nodes})
        if glossy:
            self.dress(N("BsdfGlossy", {"Roughness": 0.2}))
            self.card.data.materials[0] = self.material(N("BsdfGlass", {"Roughness": 0.2}))

    def add_light(self, kind: str, location, **values):
        data = bpy.data.lights.new("Lamp", kind)
        assign(data, values)
        obj = bpy.data.objects.new("Lamp", data)
        self.scene.collection.objects.link(obj)
        obj.location = location
        return obj

    def light_off(self) -> None:
        bpy.data.objects.remove(self.lamp)

    def glow(self, shader: Node) -> None:
        """A mesh in the lamp's place."""
        bpy.ops.mesh.primitive_plane_add(size=1.2, location=LAMP)
        self._dressed(self.material(shader))
        self._aim(bpy.context.object, TARGET)

    def link_light(self, receivers: bool) -> None:
        """The lamp lights, or is blocked by, the ball alone."""
        if not hasattr(self.lamp, "light_linking"):
            raise Absent("no light linking")
        collection = bpy.data.collections.new("Linked")
        collection.objects.link(self.sphere)
        name = "receiver_collection" if receivers else "blocker_collection"
        setattr(self.lamp.light_linking, name, collection)

    def world(self, shader: Node | None, volume: Node | None = None) -> None:
        world = bpy.data.worlds.new("World")
        self.graph(world, "ShaderNodeOutputWorld", {"Surface": shader, "Volume": volume})
        # Cycles' own choice costs a second for each render.
        world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", MAP
        self.scene.world = world

    def no_world(self) -> None:
        self.scene.world = None

    def hide_world(self, ray: str) -> None:
        """Among surfaces of all kinds."""
        self.varied({})
        setattr(self.scene.world.cycles_visibility, ray, False)

    # ------------------------------------------------------------------------------------- camera

    def camera(self, **values) -> None:
        assign(self.scene.camera.data, values)

    def panorama(self, kind: str) -> None:
        camera = self.scene.camera
        camera.location = (0.2, -2.6, 1.4)
        camera.data.type = "PANO"
        owner = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
        assign(owner, {"panorama_type": kind})

    # ----------------------------------------------------------------------------------- geometry

    def smooth(self, smooth: bool) -> None:
        _set_smooth(self.sphere.data, smooth)

    def replace_sphere(self, segments: int, rings: int) -> None:
        bpy.data.objects.remove(self.sphere)
        self.sphere = self._ball(segments, rings)

    def can(self, smooth: bool, sharp: bool = False) -> None:
        bpy.data.objects.remove(self.sphere)
        bpy.ops.mesh.primitive_cylinder_add(vertices=24, radius=0.8, depth=1.4, location=BALL)
        self.sphere = self._dressed(self.grey)
        mesh = self.sphere.data
        _set_smooth(mesh, smooth)
        if sharp and hasattr(mesh, "use_auto_smooth"):
            mesh.use_auto_smooth = True
        elif sharp:
            mesh.set_sharp_from_angle(angle=math.radians(30))

    def custom_normals(self) -> None:
        """Corner normals that lean."""
        mesh = self.sphere.data
        normals = compat.corner_normals(mesh) + np.array([0.0, 0.0, 0.4])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        compat.set_corner_normals(mesh, normals)

    def modify(self, kind: str, **values) -> None:
        for obj in (self.sphere, self.block):
            assign(obj.modifiers.new(kind.title(), kind), values)

    def two_materials(self) -> None:
        """Of the ball: one for every second face."""
        mesh = self.sphere.data
        mesh.materials.append(self.material(N("BsdfDiffuse", {"Color": (0.8, 0.2, 0.1, 1.0)})))
        indices = np.arange(len(mesh.polygons), dtype=np.int32) % 2
        mesh.polygons.foreach_set("material_index", indices)

    def inner_sphere(self, radius: float, shader: Node) -> None:
        self._ball(32, 16, radius=radius).data.materials[0] = self.material(shader)

    def rescale(self, factor: float) -> None:
        """The whole scene; light falls off as it grows."""
        for obj in self.scene.objects:
            obj.location *= factor
            if obj.type != "LIGHT":
                obj.scale *= factor
        data = self.scene.camera.data
        data.clip_start, data.clip_end = 0.1 * factor, 1000.0 * factor
        self.lamp.data.size *= factor
        self.lamp.data.energy *= factor**2

    def move(self, offset) -> None:
        for obj in self.scene.objects:
            obj.location += Vector(offset)

    def other_geometry(self, kind: str) -> None:
        """In place of the ball, of what is no mesh."""
        bpy.data.objects.remove(self.sphere)
        if kind == "text":
            bpy.ops.object.text_add(location=(-1.6, -0.4, 0.6), rotation=(1.2, 0.0, 0.2))
            obj = bpy.context.object
            obj.data.body, obj.data.extrude, obj.data.bevel_depth = "Aa", 0.1, 0.03
        elif kind == "curve":
            bpy.ops.curve.primitive_bezier_circle_add(location=BALL, rotation=(1.0, 0.3, 0.0))
            obj = bpy.context.object
            obj.data.bevel_depth = 0.25
        elif kind == "surface":
            bpy.ops.surface.primitive_nurbs_surface_torus_add(location=BALL, rotation=(0.6, 0.2, 0))
            obj = bpy.context.object
            obj.scale = (0.7, 0.7, 0.7)
        else:
            bpy.ops.object.metaball_add(type="BALL", location=BALL, radius=1.6)
            obj = bpy.context.object
            obj.data.render_resolution = 0.1
        self.sphere = obj
        obj.data.materials.append(self.material(N("BsdfDiffuse", {"Color": (0.8, 0.4, 0.2, 1.0)})))

    def loose_vertices(self) -> None:
        mesh = self.sphere.data
        mesh.vertices.add(3)
        mesh.edges.add(1)
        mesh.edges[-1].vertices = (len(mesh.vertices) - 2, len(mesh.vertices) - 1)

    def hair_curves(self) -> None:
        """Strands of the Curves object."""
        if not hasattr(bpy.data, "hair_curves"):
            raise Absent("no hair curves")
        curves = bpy.data.hair_curves.new("Strands")
        if not hasattr(curves, "add_curves"):
            raise Absent("strands cannot be made by scripts")
        curves.add_curves([4] * 40)
        angles = np.linspace(0.0, 2.0 * math.pi, 40, endpoint=False)
        heights = np.linspace(0.0, 1.0, 4)
        feet = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        points = np.stack(
            [np.c_[feet * (0.4 + 0.3 * h), np.full(40, 1.4 * h)] for h in heights], axis=1
        )
        curves.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
        radius = curves.attributes.new("radius", "FLOAT", "POINT")
        radius.data.foreach_set("value", np.full(160, 0.03, np.float32))
        obj = bpy.data.objects.new("Strands", curves)
        curves.materials.append(self.grey)
        obj.location = (0.6, -1.0, 0.8)
        self.scene.collection.objects.link(obj)

    # ---------------------------------------------------------------------------------- instances

    def copy(self, obj, location, scale: float):
        """A linked duplicate."""
        new = obj.copy()
        new.location, new.scale = location, (scale,) * 3
        self.scene.collection.objects.link(new)
        return new

    def _collection(self):
        """Ball and block, which are in the scene as well."""
        collection = bpy.data.collections.new("Pair")
        for obj in (self.sphere, self.block):
            collection.objects.link(obj)
        return collection

    def collection_instance(self, location, scale: float) -> None:
        empty = bpy.data.objects.new("Instance", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", self._collection()
        empty.location, empty.scale = location, (scale,) * 3
        empty.rotation_euler = (0.2, 0.1, 0.5)
        self.scene.collection.objects.link(empty)

    def _bead(self):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6, radius=0.12)
        return self._dressed(self.material(N("BsdfDiffuse", {"Color": (0.8, 0.3, 0.1, 1.0)})))

    def instances_on(self, what: str) -> None:
        """A bead on each vertex, or face, of the card."""
        bead = self._bead()
        bead.parent = self.card
        self.card.instance_type = what

    def particles(self, kind: str, shown: str) -> None:
        """On the ball: beads, dots or strands."""
        modifier = self.sphere.modifiers.new("Particles", "PARTICLE_SYSTEM")
        settings = modifier.particle_system.settings
        values = {"type": kind, "count": 60, "render_type": shown, "use_advanced_hair": True}
        if kind == "HAIR":
            values |= {"hair_length": 0.4, "radius_scale": 0.06}
        else:
            values |= {"frame_start": 1, "frame_end": 1, "physics_type": "NO", "lifetime": 100}
        if shown == "OBJECT":
            values |= {"instance_object": self._bead(), "particle_size": 1.0}
            values["instance_object"].location = (0.0, 0.0, -5.0)
        assign(settings, values)
        self.scene.frame_set(1)

    def dress_particles(self, shader: Node) -> None:
        """Strands of a shader on the ball, which keeps its own."""
        self.sphere.data.materials.append(self.material(shader))
        self.particles("HAIR", "PATH")
        self.sphere.particle_systems[0].settings.material = 2

    def geometry_nodes(self, what: str) -> None:
        """Points on the card's vertices, shown as such or as beads."""
        group = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
        if hasattr(group, "interface"):
            group.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
            group.interface.new_socket(
                "Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry"
            )
        else:
            group.inputs.new("NodeSocketGeometry", "Geometry")
            group.outputs.new("NodeSocketGeometry", "Geometry")
        nodes, links = group.nodes, group.links
        start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
        points = nodes.new("GeometryNodeMeshToPoints")
        points.inputs["Radius"].default_value = 0.08
        links.new(start.outputs[0], points.inputs[0])
        result = points.outputs[0]
        if what == "instances":
            place, bead = (
                nodes.new("GeometryNodeInstanceOnPoints"),
                nodes.new("GeometryNodeObjectInfo"),
            )
            bead.inputs["Object"].default_value = self._bead()
            links.new(result, place.inputs["Points"])
            links.new(bead.outputs["Geometry"], place.inputs["Instance"])
            result = place.outputs[0]
        else:
            dress = nodes.new("GeometryNodeSetMaterial")
            dress.inputs["Material"].default_value = self.grey
            links.new(result, dress.inputs[0])
            result = dress.outputs[0]
        links.new(result, end.inputs[0])
        self.card.modifiers.new("Scatter", "NODES").node_group = group

    # ------------------------------------------------------------------------- objects and layers

    def sphere_among_mirrors(self, values: dict) -> None:
        """The ball of some visibility, seen in a mirror and through glass."""
        self.floor.data.materials[0] = self.material(
            N("MixShader", {0: 0.5, 1: N("BsdfDiffuse"), 2: N("BsdfGlossy", {"Roughness": 0.1})})
        )
        self.block.data.materials[0] = self.material(N("BsdfGlass", {"Roughness": 0.0}))
        self.sphere.data.materials[0] = self.material(
            N("BsdfDiffuse", {"Color": (0.8, 0.2, 0.1, 1)})
        )
        assign(self.sphere, values)

    def layer_switch(self, name: str) -> None:
        """Of a collection that holds the ball."""
        collection = bpy.data.collections.new("Apart")
        self.scene.collection.children.link(collection)
        self.scene.collection.objects.unlink(self.sphere)
        collection.objects.link(self.sphere)
        setattr(self.scene.view_layers[0].layer_collection.children["Apart"], name, True)

    def terminator_offset(self) -> None:
        self.sphere.cycles.shadow_terminator_geometry_offset = 0.3

    def animate(self, obj, shift) -> None:
        """Moves by `shift` within the frame."""
        self.scene.frame_set(1)
        for frame, sign in ((0, -1.0), (2, 1.0)):
            obj.location = Vector(BALL) + sign * Vector(shift)
            obj.keyframe_insert("location", frame=frame)
        self.scene.frame_set(1)


# ------------------------------------------------------------------------------------------- nodes


def _set_smooth(mesh, smooth: bool) -> None:
    mesh.polygons.foreach_set("use_smooth", np.full(len(mesh.polygons), smooth))
    mesh.update()


def _set_property(node, name: str, value) -> None:
    """`image`, `ies`: by name; `ramp`, `curve`: what they hold; `value`: of the only output."""
    if name == "image":
        node.image = _images.image(value)
    elif name == "ies":
        node.ies = _images.ies_text(value)
    elif name == "value":
        node.outputs[0].default_value = value
    elif name == "ramp":
        _set_ramp(node.color_ramp, value)
    elif name == "curve":
        _set_curve(node.mapping, value)
    else:
        assign(node, {name: value})


def _set_ramp(ramp, mode) -> None:
    """Three colours; `mode` is an interpolation, or a colour space and the way round."""
    if isinstance(mode, str):
        ramp.interpolation = mode
    else:
        ramp.color_mode, ramp.hue_interpolation = mode
    ramp.elements[0].position, ramp.elements[0].color = 0.2, (0.8, 0.2, 0.1, 0.3)
    ramp.elements[1].position, ramp.elements[1].color = 0.8, (0.1, 0.3, 0.9, 1.0)
    ramp.elements.new(0.55).color = (0.2, 0.8, 0.3, 0.6)


def _set_curve(mapping, points) -> None:
    """The last curve, which is that of all channels where there are several."""
    curve = mapping.curves[len(mapping.curves) - 1]
    first, *inner, last = points
    curve.points[0].location, curve.points[len(curve.points) - 1].location = first, last
    for point in inner:
        curve.points.new(*point)
    mapping.update()


def _input(node, key):
    if isinstance(key, int):
        if key >= len(node.inputs):
            raise Absent(f"{node.bl_idname} has no input {key}")
        return node.inputs[key]
    socket = compat.find_input(node, key) or _named(node.inputs, key)
    if socket is None:
        raise Absent(f"{node.bl_idname} has no input {key}")
    return socket


def _output(node, key):
    socket = node.outputs[key] if isinstance(key, int) else _named(node.outputs, key)
    if socket is None:
        raise Absent(f"{node.bl_idname} has no output {key}")
    return socket


def _named(sockets, key: str):
    """By identifier, then by name."""
    for of in ("identifier", "name"):
        for socket in sockets:
            if getattr(socket, of) == key:
                return socket
    return None


def _set_constant(socket, value) -> None:
    if socket.type == "RGBA" and len(value) == 3:
        value = (*value, 1.0)
    if socket.type == "BOOLEAN":
        value = bool(value)
    socket.default_value = value
