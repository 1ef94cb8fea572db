# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's background as a material."""

from __future__ import annotations

from . import compat
from .desc import LinkDesc, MaterialDesc, NodeDesc
from .image import Images
from .log import ExportLog
from .material import Converter, plain_material

BLACK = {"Strength": (0.0, 0.0, 0.0, 1.0)}


def export_world(world, images: Images, log: ExportLog) -> MaterialDesc:
    """The world's nodes, or its plain colour, as a material whose surface is a background."""
    if not compat.uses_nodes(world):
        color = (*world.color, 1.0)
        return plain_material(world.name, "background", "Background", color, Strength=1.0)
    desc = Converter(f"world {world.name}", images, log).convert(world.name, world.node_tree)
    if not any(node.kind == "background" for node in desc.nodes):
        _add_background(desc)
    return desc


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
