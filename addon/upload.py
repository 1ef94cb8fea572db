# SPDX-License-Identifier: GPL-3.0-or-later
"""`desc.SceneDesc` -> `native.Scene`: each description becomes its C struct and one call.

A scene that will be edited is a `Snapshot`: the next one shares what is described by the same
objects.
"""

from __future__ import annotations

import ctypes
import dataclasses
import os
import pickle
from dataclasses import dataclass, fields

import numpy as np

from . import abi, native
from .export import desc
from .export.log import ExportLog

_PIXEL_TYPES = {
    np.dtype(np.uint8): abi.PixelType.U8,
    np.dtype(np.float32): abi.PixelType.F32,
}


def upload(scene_desc: desc.SceneDesc, log: ExportLog | None = None) -> native.Scene:
    """A new scene with everything in `scene_desc`, not yet committed.

    Images and meshes leave `scene_desc` as they are copied, so that a large scene is in memory
    once. An image file that cannot be read is told to `log` and shown in magenta. Raises
    native.NativeError, whose message names the object.
    """
    scene = native.Scene()
    try:
        images, scene_desc.images = scene_desc.images, []
        for image in _drain(images):
            _add_image(scene, image, log)
        for material in scene_desc.materials:
            scene.add("material", material_struct(material))
        meshes, scene_desc.meshes = scene_desc.meshes, []
        for mesh in _drain(meshes):
            scene.add("mesh", _mesh(mesh))
        _set_the_rest(scene, scene_desc)
    except BaseException:
        scene.close()
        raise
    return scene


def _set_the_rest(scene: native.Scene, scene_desc: desc.SceneDesc) -> None:
    """What is cheap: all that refers to the parts, and to which nothing refers."""
    for light in scene_desc.lights:
        scene.add("light", _struct(abi.LightDesc, light))
    for instance in scene_desc.instances:
        scene.add("instance", _instance(instance))
    if scene_desc.camera:
        scene.set("camera", camera_struct(scene_desc.camera))
    if scene_desc.environment:
        scene.set("environment", _struct(abi.EnvironmentDesc, scene_desc.environment))


@dataclass
class Snapshot:
    """A scene of the core, which a thread of the core commits, and which of its parts came of which
    description; free it with `close`."""

    scene: native.Scene
    content: tuple  # tells it, but for the camera, from others; see `_content`
    # By the identity of the description, which stays alive with it; no index where another part
    # stands for it.
    parts: dict[int, tuple[object, int | None]] = dataclasses.field(default_factory=dict)
    is_built: bool = False

    def builds(self, milliseconds: int) -> bool:
        """Whether the scene is committed within that time. Its images and meshes then give up their
        arrays: only the core has them from here on. Raises native.NativeError."""
        if not self.is_built and self.scene.ends_commit(milliseconds):
            self.is_built = True
            for part, index in self.parts.values():
                if index is not None:
                    _give_up_arrays(part)
        return self.is_built

    def cancel(self) -> None:
        """Asks the core to stop building it. Of its descriptions others can be made."""
        self.scene.cancel_commit()

    def close(self) -> None:
        self.scene.close()


def snapshot(
    scene_desc: desc.SceneDesc, log: ExportLog | None, before: Snapshot | None, threads: int = 0
) -> Snapshot:
    """Begins to build a scene with everything in `scene_desc`; gives `before`, which is built, if
    only the camera may differ, and then nothing of it is set.

    Raises native.NativeError; later snapshots must then be made of new descriptions.
    """
    content = _content(scene_desc)
    complete = before is not None and all(index is not None for _, index in before.parts.values())
    if complete and before.content == content:
        return before
    made = Snapshot(native.Scene.edited(before and before.scene), content)
    try:
        _add_parts(made, scene_desc, log, before)
        _set_the_rest(made.scene, scene_desc)
        made.scene.begin_commit(threads)
    except BaseException:
        made.close()
        raise
    return made


def _content(scene_desc: desc.SceneDesc) -> tuple:
    parts = (scene_desc.images, scene_desc.materials, scene_desc.meshes)
    rest = (scene_desc.lights, scene_desc.instances, scene_desc.environment)
    return tuple(tuple(map(id, part)) for part in parts), pickle.dumps(rest)


def _add_parts(
    made: Snapshot, scene_desc: desc.SceneDesc, log: ExportLog | None, before: Snapshot | None
) -> None:
    scene, parts_before = made.scene, before.parts if before else {}
    same_images = set()  # indices of images that are what they were in the scene before

    def kept(kind: str, part) -> int | None:
        _, index_before = parts_before.get(id(part), (None, None))
        index = None if index_before is None else scene.keep(kind, index_before)
        if kind == "image" and index is not None and index == index_before:
            same_images.add(index)
        return index

    def note(part, index: int | None) -> None:
        made.parts[id(part)] = part, index

    for image in scene_desc.images:
        index = kept("image", image)
        note(image, _add_image(scene, image, log) if index is None else index)
    for material in scene_desc.materials:
        images = {node.image for node in material.nodes if node.image != desc.NONE}
        index = kept("material", material) if images <= same_images else None
        note(material, scene.add("material", material_struct(material)) if index is None else index)
    for mesh in scene_desc.meshes:
        index = kept("mesh", mesh)
        note(mesh, scene.add("mesh", _mesh(mesh)) if index is None else index)


def _give_up_arrays(part) -> None:
    """Of an image or a mesh; a material has none of size."""
    if isinstance(part, desc.ImageDesc):
        part.pixels = part.encoded = None
    elif isinstance(part, desc.MeshDesc):
        for array in fields(part):
            if isinstance(getattr(part, array.name), (np.ndarray, list)):
                setattr(part, array.name, None)


def camera_struct(camera: desc.CameraDesc) -> abi.CameraDesc:
    """For `native.Scene.set`."""
    return _struct(abi.CameraDesc, camera)


def _add_image(scene: native.Scene, image: desc.ImageDesc, log: ExportLog | None) -> int | None:
    """Index of an image; None if its file cannot be read, so that another one stands for it."""
    try:
        return scene.add("image", image_struct(image))
    except native.NativeError as error:
        if log is None or error.status != abi.Status.IO_ERROR:
            raise
        log.warn("images", f"{error}, shown in magenta")
        scene.add("image", image_struct(desc.missing_image()))
        return None


def _drain(items: list):
    items.reverse()
    while items:
        yield items.pop()


def _text(text: str) -> bytes:
    return text.encode(errors="replace")


def _struct(kind: type[ctypes.Structure], description, **given) -> ctypes.Structure:
    """The C struct of a dataclass: `given` fields, and the rest from those of the same name."""
    types = dict(kind._fields_)
    for name in (field.name for field in fields(description) if field.name not in given):
        value = getattr(description, name)
        if isinstance(value, str):
            value = _text(value)
        elif issubclass(types[name], ctypes.Array):
            value = types[name](*np.asarray(value).ravel().tolist())
        given[name] = value
    return kind(**given)


def _point_to(owner, struct, name: str, array: np.ndarray | None, shape: tuple[int, ...]) -> None:
    """Lets field `name` of `struct` point to `array`, which `owner` keeps alive; None stays NULL.

    Numbers are converted to the type that the field points to; to void they stay as they are.
    """
    if array is None:
        return
    kind = dict(struct._fields_)[name]
    array = np.ascontiguousarray(array, array.dtype if kind is ctypes.c_void_p else kind._type_)
    if array.shape != shape:
        raise ValueError(f"an array has shape {array.shape} where {shape} is needed")
    setattr(struct, name, ctypes.cast(array.ctypes.data, kind))
    owner.keep_alive = [*getattr(owner, "keep_alive", ()), array]


def image_struct(image: desc.ImageDesc) -> abi.ImageDesc:
    struct = abi.ImageDesc(
        name=_text(image.name),
        path=None if image.path is None else os.fsencode(image.path),
        color_space=image.color_space,
        alpha_mode=image.alpha_mode,
    )
    if image.pixels is not None:
        struct.height, struct.width, struct.channels = image.pixels.shape
        struct.pixel_type = _PIXEL_TYPES[image.pixels.dtype]
        _point_to(struct, struct, "pixels", image.pixels, image.pixels.shape)
    if image.encoded is not None:
        encoded = np.frombuffer(image.encoded, np.uint8)
        struct.encoded_size = encoded.size
        _point_to(struct, struct, "encoded", encoded, encoded.shape)
    return struct


def material_struct(material: desc.MaterialDesc) -> abi.MaterialDesc:
    nodes = [
        abi.Node(name=_text(node.name), kind=_text(node.kind), image=node.image)
        for node in material.nodes
    ]
    inputs = [
        abi.NodeInput(node=index, socket=_text(socket), value=tuple(value))
        for index, node in enumerate(material.nodes)
        for socket, value in node.inputs.items()
    ]
    options = [
        abi.NodeOption(node=index, option=_text(option), value=_text(value))
        for index, node in enumerate(material.nodes)
        for option, value in node.options.items()
    ]
    links = [
        abi.NodeLink(link.from_node, _text(link.from_socket), link.to_node, _text(link.to_socket))
        for link in material.links
    ]
    struct = abi.MaterialDesc(
        name=_text(material.name),
        nodes=(abi.Node * len(nodes))(*nodes),
        node_count=len(nodes),
        inputs=(abi.NodeInput * len(inputs))(*inputs),
        input_count=len(inputs),
        options=(abi.NodeOption * len(options))(*options),
        option_count=len(options),
        links=(abi.NodeLink * len(links))(*links),
        link_count=len(links),
        glints=material.glints,
        displacement=material.displacement,
        bump_correction=material.bump_correction,
        pass_index=material.pass_index,
        crypto=material.crypto,
    )
    arrays = []
    for index, node in enumerate(material.nodes):
        for name, values in node.arrays.items():
            arrays.append(abi.NodeArray(node=index, name=_text(name), count=values.size))
            _point_to(struct, arrays[-1], "values", values, values.shape)
    struct.arrays = (abi.NodeArray * len(arrays))(*arrays)
    struct.array_count = len(arrays)
    return struct


def _mesh(mesh: desc.MeshDesc) -> abi.MeshDesc:
    vertices, triangles = len(mesh.positions), len(mesh.triangles)
    struct = abi.MeshDesc(
        name=_text(mesh.name),
        vertex_count=vertices,
        triangle_count=triangles,
        slot_count=mesh.slot_count,
    )
    _point_to(struct, struct, "positions", mesh.positions, (vertices, 3))
    _point_to(struct, struct, "triangles", mesh.triangles, (triangles, 3))
    _point_to(struct, struct, "normals", mesh.normals, (triangles, 3, 3))
    _point_to(struct, struct, "flat_faces", mesh.flat_faces, (triangles,))
    _point_to(struct, struct, "material_slots", mesh.material_slots, (triangles,))
    domains = abi.AttributeDomain
    elements = {
        domains.CORNER: 3 * triangles,
        domains.VERTEX: vertices,
        domains.TRIANGLE: triangles,
    }
    _set_attributes(struct, mesh.attributes, elements)
    return struct


def _set_attributes(
    owner, attributes: list[desc.AttributeDesc], elements: dict[abi.AttributeDomain, int]
) -> None:
    """Gives a mesh or an instance its attributes; `elements` is the size of its domains."""
    structs = (abi.Attribute * len(attributes))()
    for struct, attribute in zip(structs, attributes, strict=True):
        count, components = elements[attribute.domain], attribute.values.shape[1]
        struct.name = _text(attribute.name)
        struct.kind, struct.domain = attribute.kind, attribute.domain
        struct.components = components
        _point_to(owner, struct, "values", attribute.values, (count, components))
        _point_to(owner, struct, "tangents", attribute.tangents, (count // 3, 3, 4))
    owner.attributes, owner.attribute_count = structs, len(attributes)


def _instance(instance: desc.InstanceDesc) -> abi.InstanceDesc:
    count = len(instance.materials)
    materials = (ctypes.c_uint32 * count)(*instance.materials)
    struct = _struct(
        abi.InstanceDesc, instance, materials=materials, material_count=count, attributes=None
    )
    _set_attributes(struct, instance.attributes, {abi.AttributeDomain.OBJECT: 1})
    return struct
