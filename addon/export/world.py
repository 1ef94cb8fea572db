# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's background as a material."""

from __future__ import annotations

import numpy as np

from . import compat
from .desc import LightDesc, LightType, LinkDesc, MaterialDesc, NodeDesc
from .image import Images
from .log import ExportLog
from .material import Converter, plain_material
from .sky import Sky, sun_irradiance

BLACK = {"Strength": (0.0, 0.0, 0.0, 1.0)}


def export_world(
    world, images: Images, log: ExportLog, aovs: frozenset[str] = frozenset()
) -> tuple[MaterialDesc, LightDesc | None]:
    """The world's nodes, or its plain colour, as a material whose surface is a background, with
    what writes `aovs`.

    A sky that shines through a plain Background gives its sun as a light. Others have it in their
    image.
    """
    if not compat.uses_nodes(world):
        color = (*world.color, 1.0)
        return plain_material(world.name, "background", "Background", color, Strength=1.0), None
    converter = Converter(f"world {world.name}", images, log)
    desc = converter.convert(world.name, world.node_tree)
    strength = _plain_strength(desc) if len(converter.skies) == 1 else None
    converter.add_aovs(desc, world.node_tree, aovs)
    sun = None
    if strength is None:
        converter.draw_suns()
    else:
        sun = _sun(world.name, converter.skies[0][1], strength)
    if not any(node.kind == "background" for node in desc.nodes):
        _add_background(desc)
    return desc, sun


def _plain_strength(desc: MaterialDesc) -> float | None:
    """The strength of a background that shows one environment as it is; None of other worlds."""
    kinds = [node.kind for node in desc.nodes]
    if kinds != ["output", "background", "environment_texture"] or len(desc.links) != 2:
        return None
    return desc.nodes[1].inputs.get("Strength", (1.0,))[0]


def _sun(name: str, sky: Sky, strength: float) -> LightDesc | None:
    irradiance = sun_irradiance(sky)
    if irradiance is None or strength <= 0.0:
        return None
    z = np.array(sky.sun)
    x = np.cross((0.0, 1.0, 0.0) if abs(z[1]) < 0.9 else (1.0, 0.0, 0.0), z)
    x /= np.linalg.norm(x)
    transform = np.column_stack([x, np.cross(z, x), z, np.zeros(3)])
    return LightDesc(
        name=f"{name}: sun",
        type=LightType.SUN,
        transform=transform.astype(np.float32),
        power=tuple(float(strength * channel) for channel in irradiance),
        sun_angle=sky.sun_size,
    )


def _add_background(desc: MaterialDesc) -> None:
    """Adds a black background, by which the core knows a world: one may glow by other shaders."""
    sum_, black = len(desc.nodes), len(desc.nodes) + 1
    desc.nodes += [NodeDesc("Sum", "add_shader"), NodeDesc("Black", "background", inputs=BLACK)]
    desc.links = [
        LinkDesc(link.from_node, link.from_socket, sum_, "Shader") if link.to_node == 0 else link
        for link in desc.links
    ]
    desc.links += [
        LinkDesc(black, "Background", sum_, "Shader_001"),
        LinkDesc(sum_, "Shader", 0, "Surface"),
    ]
