# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader nodes that Specula knows: one row each, under the names that the core uses.

Names of sockets and options are Blender 5.0's; `compat` finds them in an older Blender.
"""

from __future__ import annotations

from .nodes_converter import CONVERTER_NODES
from .nodes_input import INPUT_NODES
from .nodes_surface import SURFACE_NODES
from .nodes_texture import TEXTURE_NODES

NODES = SURFACE_NODES | TEXTURE_NODES | INPUT_NODES | CONVERTER_NODES
