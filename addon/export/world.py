# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's background as a material."""

from __future__ import annotations

from . import compat
from .desc import MaterialDesc
from .image import Images
from .log import ExportLog
from .material import Converter, plain_material


def export_world(world, images: Images, log: ExportLog) -> MaterialDesc:
    """The world's nodes, or its plain colour, as a material whose surface is a background."""
    if not compat.uses_nodes(world):
        color = (*world.color, 1.0)
        return plain_material(world.name, "background", "Background", color, Strength=1.0)
    desc, _ = Converter(f"world {world.name}", images, log).convert(world.name, world.node_tree)
    return desc
