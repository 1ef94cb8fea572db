# SPDX-License-Identifier: GPL-3.0-or-later
"""How a Blender node becomes a node of the core, and options that many nodes have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

ANY = ()  # an option that takes any text
SWITCH = ("False", "True")


@dataclass(frozen=True)
class NodeKind:
    """How a Blender node becomes a node of the core."""

    kind: str
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    # Property of the node, or of what it holds -> values that the core knows, of which the first is
    # the fallback. The core's option is called as the property.
    options: dict[str, tuple[str, ...]] = field(default_factory=dict)
    # What Specula does not model, and the value at which that makes no difference.
    neutral_inputs: dict[str, float] = field(default_factory=dict)
    neutral_properties: dict[str, object] = field(default_factory=dict)
    # Options of the core that the type of the node decides.
    fixed_options: dict[str, str] = field(default_factory=dict)
    # Array of the core -> its (rows, columns) numbers from the node.
    arrays: dict[str, Callable] = field(default_factory=dict)
    # Changes the finished node: adjust(converter, blender_node, node_desc).
    adjust: Callable | None = None
