# SPDX-License-Identifier: GPL-3.0-or-later
"""Light objects -> `LightDesc`."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..abi import NONE
from . import compat
from .desc import AreaShape, LightDesc, LightType, LinkDesc, MaterialDesc, NodeDesc, Visibility
from .image import Images
from .log import ExportLog
from .material import Converter, make_emission

# What the nodes of a light emit where they do so everywhere alike, and the index of the material
# that says it where they do not, or NONE.
Shade = Callable[[object], tuple[tuple[float, float, float], int]]

# Textures that are laid out by Generated coordinates where nothing else is linked.
BY_GENERATED = {
    f"{name}_texture"
    for name in ["brick", "checker", "gradient", "magic", "musgrave", "noise", "voronoi", "wave"]
}

# Blender's area shape -> the core's, and the properties that hold its extents in x and y.
AREA_SHAPES = {
    "SQUARE": (AreaShape.RECTANGLE, "size", "size"),
    "RECTANGLE": (AreaShape.RECTANGLE, "size", "size_y"),
    "DISK": (AreaShape.ELLIPSE, "size", "size"),
    "ELLIPSE": (AreaShape.ELLIPSE, "size", "size_y"),
}


def export_light(
    obj,
    transform: np.ndarray,
    visibility: Visibility,
    shade: Shade,
    log: ExportLog,
) -> LightDesc | None:
    """The light of `obj` at `transform` (3, 4); None if it gives no light to the scene."""
    light = obj.data
    owner = f"light {obj.name}"
    if getattr(compat.cycles_settings(light), "is_portal", False):
        return None  # a hint for sampling the world, not a light
    transform = _usable(transform, light)
    if transform is None:
        log.warn(owner, "has a scale or size of zero, it gives no light")
        return None
    if not compat.casts_shadows(light):
        visibility &= ~Visibility.SHADOW
    emission, material = shade(light) if compat.uses_nodes(light) else ((1.0, 1.0, 1.0), NONE)
    desc = LightDesc(
        name=obj.name,
        type=LightType[light.type],
        transform=transform,
        power=_power(light, emission, owner, log),
        visibility=visibility,
        feeds_caustics=light.specula.caustics,
        material=material,
        max_bounces=compat.cycles_value(light, "max_bounces", LightDesc.max_bounces),
    )
    _TYPES[desc.type](desc, light, owner, log)
    return desc


def _usable(transform: np.ndarray, light) -> np.ndarray | None:
    """A transform that can be inverted; None where, as in Cycles, nothing shines.

    A point has no direction: its scale may be 0.
    """
    if np.linalg.det(transform[:, :3].astype(np.float64)) == 0.0:
        point = np.c_[np.eye(3, dtype=np.float32), transform[:, 3]]
        return point if light.type == "POINT" else None
    if light.type == "AREA":
        _, size_x, size_y = AREA_SHAPES[light.shape]
        return transform if getattr(light, size_x) * getattr(light, size_y) > 0.0 else None
    return transform


def _power(light, emission, owner: str, log: ExportLog) -> tuple[float, float, float]:
    """Colour times energy (W; sun: W/m^2), times what its nodes emit everywhere alike."""
    factors = (light.color, compat.light_gain(light), emission)
    power = tuple(light.energy * math.prod(channels) for channels in zip(*factors, strict=True))
    if min(power) < 0.0:
        log.warn(owner, "negative light is not supported, it is left out")
    return tuple(max(channel, 0.0) for channel in power)


def export_light_nodes(light, images: Images, log: ExportLog) -> MaterialDesc:
    """The graph of what shades `light`; its emission is a factor of the light's own."""
    owner = f"light {light.name}"
    converter = Converter(owner, images, log)
    material = converter.convert(owner, light.node_tree)
    converter.draw_suns()
    make_emission(material)
    if not compat.lights_have_coordinates():
        _place_in_world(material)
    return material


def _place_in_world(material: MaterialDesc) -> None:
    """What is laid out by Object or Generated coordinates goes by the world's."""
    index = len(material.nodes)
    position = (index, "Position")
    placed = {(link.to_node, link.to_socket) for link in material.links}
    links = []
    for link in material.links:
        source = material.nodes[link.from_node]
        by_lamp = source.kind == "texture_coordinate" and "Object" not in source.arrays
        if by_lamp and link.from_socket in ("Object", "Generated"):
            link = LinkDesc(*position, link.to_node, link.to_socket)
        links.append(link)
    for i, node in enumerate(material.nodes):
        if node.kind in BY_GENERATED and (i, "Vector") not in placed:
            links.append(LinkDesc(*position, i, "Vector"))
    material.nodes.append(NodeDesc("World", "geometry"))
    material.links = links


def _point(desc: LightDesc, light, owner: str, log: ExportLog) -> None:
    """A sphere or, with soft falloff, a disk that faces what it lights."""
    desc.radius = light.shadow_soft_size
    desc.soft_falloff = compat.has_soft_falloff(light)
    if not compat.is_normalized(light):
        # Of a sphere; Cycles' point, which has no area, shines with a factor of 4.
        _scale(desc, 4.0 * math.pi * desc.radius**2 if desc.radius > 0.0 else 4.0)


def _spot(desc: LightDesc, light, owner: str, log: ExportLog) -> None:
    _point(desc, light, owner, log)
    desc.spot_angle = light.spot_size
    desc.spot_blend = light.spot_blend


def _sun(desc: LightDesc, light, owner: str, log: ExportLog) -> None:
    desc.sun_angle = light.angle
    if not compat.is_normalized(light) and desc.sun_angle > 0.0:
        _scale(desc, math.pi * math.sin(0.5 * desc.sun_angle) ** 2)  # projected solid angle, sr


def _area(desc: LightDesc, light, owner: str, log: ExportLog) -> None:
    desc.shape, size_x, size_y = AREA_SHAPES[light.shape]
    desc.size = (getattr(light, size_x), getattr(light, size_y))
    desc.spread = light.spread
    if not compat.is_normalized(light):
        _scale(desc, _area_of(desc))


def _area_of(desc: LightDesc) -> float:
    """m^2 in the world."""
    edge_x, edge_y = desc.transform[:, 0] * desc.size[0], desc.transform[:, 1] * desc.size[1]
    rectangle = float(np.linalg.norm(np.cross(edge_x, edge_y)))
    return rectangle * (math.pi / 4 if desc.shape == AreaShape.ELLIPSE else 1.0)


def _scale(desc: LightDesc, factor: float) -> None:
    """For lights that are not normalized; factors measured in Cycles 5.0."""
    desc.power = tuple(factor * channel for channel in desc.power)


_TYPES = {
    LightType.POINT: _point,
    LightType.SPOT: _spot,
    LightType.SUN: _sun,
    LightType.AREA: _area,
}
