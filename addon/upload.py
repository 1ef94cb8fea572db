# SPDX-License-Identifier: GPL-3.0-or-later
"""`desc.SceneDesc` -> `native.Scene`: each description becomes its C struct and one call."""

from __future__ import annotations

import ctypes
import os
from ctypes import c_uint32, c_void_p

import numpy as np

from . import abi, native
from .export import desc
from .export.log import ExportLog

_PIXEL_TYPES = {np.dtype(np.uint8): 0, np.dtype(np.float32): 1}


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
            scene.add("material", _material(material))
        meshes, scene_desc.meshes = scene_desc.meshes, []
        for mesh in _drain(meshes):
            scene.add("mesh", _mesh(mesh))
        for light in scene_desc.lights:
            scene.add("light", _light(light))
        for instance in scene_desc.instances:
            scene.add("instance", _instance(instance))
        if scene_desc.camera:
            scene.set("camera", _camera(scene_desc.camera))
        if scene_desc.environment:
            scene.set("environment", _environment(scene_desc.environment))
    except BaseException:
        scene.close()
        raise
    return scene


def _add_image(scene: native.Scene, image: desc.ImageDesc, log: ExportLog | None) -> None:
    try:
        scene.add("image", _image(image))
    except native.NativeError as error:
        if log is None or error.status != abi.STATUS_NAMES.index("I/O error"):
            raise
        log.warn("images", f"{error}, shown in magenta")
        scene.add("image", _image(desc.missing_image()))


def _drain(items: list):
    items.reverse()
    while items:
        yield items.pop()


def _text(text: str) -> bytes:
    return text.encode(errors="replace")


def _array(struct, array: np.ndarray | None, dtype: type, shape: tuple[int, ...]):
    """Address of `array` for `struct`, which keeps it alive; None stays NULL."""
    if array is None:
        return None
    array = np.ascontiguousarray(array, dtype)
    if array.shape != shape:
        raise ValueError(f"an array has shape {array.shape} where {shape} is needed")
    struct.keep_alive = [*getattr(struct, "keep_alive", ()), array]
    return c_void_p(array.ctypes.data)


def _transform(matrix: np.ndarray):
    return (ctypes.c_float * 12)(*np.asarray(matrix, np.float32).reshape(12).tolist())


def _image(image: desc.ImageDesc) -> abi.ImageDesc:
    struct = abi.ImageDesc(
        name=_text(image.name),
        path=None if image.path is None else os.fsencode(image.path),
        color_space=image.color_space,
        alpha_mode=image.alpha_mode,
    )
    if image.pixels is not None:
        struct.height, struct.width, struct.channels = image.pixels.shape
        struct.pixel_type = _PIXEL_TYPES[image.pixels.dtype]
        struct.pixels = _array(struct, image.pixels, image.pixels.dtype, image.pixels.shape)
    if image.encoded is not None:
        encoded = np.frombuffer(image.encoded, np.uint8)
        struct.encoded = _array(struct, encoded, np.uint8, encoded.shape)
        struct.encoded_size = encoded.size
    return struct


def _material(material: desc.MaterialDesc) -> abi.MaterialDesc:
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
    return abi.MaterialDesc(
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
    )


def _uv_layer(struct: abi.MeshDesc, layer: desc.UvLayerDesc, triangles: int) -> abi.UvLayer:
    return abi.UvLayer(
        name=_text(layer.name),
        uv=_array(struct, layer.uv, np.float32, (triangles, 3, 2)),
        tangents=_array(struct, layer.tangents, np.float32, (triangles, 3, 4)),
    )


def _mesh(mesh: desc.MeshDesc) -> abi.MeshDesc:
    vertices, triangles = len(mesh.positions), len(mesh.triangles)
    struct = abi.MeshDesc(
        name=_text(mesh.name),
        vertex_count=vertices,
        triangle_count=triangles,
        slot_count=mesh.slot_count,
        uv_layer_count=len(mesh.uv_layers),
        active_uv_layer=mesh.active_uv_layer,
    )
    struct.positions = _array(struct, mesh.positions, np.float32, (vertices, 3))
    struct.triangles = _array(struct, mesh.triangles, np.uint32, (triangles, 3))
    struct.normals = _array(struct, mesh.normals, np.float32, (triangles, 3, 3))
    struct.material_slots = _array(struct, mesh.material_slots, np.uint32, (triangles,))
    layers = [_uv_layer(struct, layer, triangles) for layer in mesh.uv_layers]
    struct.uv_layers = (abi.UvLayer * len(layers))(*layers)
    return struct


def _instance(instance: desc.InstanceDesc) -> abi.InstanceDesc:
    return abi.InstanceDesc(
        name=_text(instance.name),
        mesh=instance.mesh,
        transform=_transform(instance.transform),
        materials=(c_uint32 * len(instance.materials))(*instance.materials),
        material_count=len(instance.materials),
        visibility=instance.visibility,
        caustics_role=instance.caustics_role,
    )


def _light(light: desc.LightDesc) -> abi.LightDesc:
    return abi.LightDesc(
        name=_text(light.name),
        type=light.type,
        transform=_transform(light.transform),
        power=tuple(light.power),
        radius=light.radius,
        spot_angle=light.spot_angle,
        spot_blend=light.spot_blend,
        sun_angle=light.sun_angle,
        shape=light.shape,
        size=tuple(light.size),
        spread=light.spread,
        visibility=light.visibility,
        feeds_caustics=light.feeds_caustics,
        soft_falloff=light.soft_falloff,
    )


def _camera(camera: desc.CameraDesc) -> abi.CameraDesc:
    return abi.CameraDesc(
        projection=camera.projection,
        transform=_transform(camera.transform),
        width=camera.width,
        height=camera.height,
        crop=tuple(camera.crop),
        viewplane=tuple(camera.viewplane),
        clip_near=camera.clip_near,
        clip_far=camera.clip_far,
        aperture_radius=camera.aperture_radius,
        focus_distance=camera.focus_distance,
        aperture_blades=camera.aperture_blades,
        aperture_rotation=camera.aperture_rotation,
        aperture_ratio=camera.aperture_ratio,
    )


def _environment(environment: desc.EnvironmentDesc) -> abi.EnvironmentDesc:
    return abi.EnvironmentDesc(
        material=environment.material,
        visibility=environment.visibility,
        feeds_caustics=environment.feeds_caustics,
    )
