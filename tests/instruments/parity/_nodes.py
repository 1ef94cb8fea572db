# SPDX-License-Identifier: GPL-3.0-or-later
"""Shader graphs as data, and rows made of them. Nothing here needs Blender: what a Blender lacks
is found out when a row is built there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Node:
    """A shader node and which of its outputs is read.

    `inputs` maps a socket's identifier, name or index to a constant or to a Node that feeds it.
    `properties` are Python's, dots included; what `image`, `ies`, `ramp`, `curve` and `value` mean
    is told in _stage.py.
    """

    kind: str  # Blender's type without "ShaderNode"
    inputs: Mapping = field(default_factory=dict)
    output: int | str = 0
    properties: Mapping = field(default_factory=dict)


def N(kind: str, inputs: Mapping | None = None, output: int | str = 0, **properties) -> Node:
    return Node(kind, inputs or {}, output, properties)


@dataclass(frozen=True)
class Row:
    """One scene of the matrix: `build` changes the stage that is set."""

    name: str
    build: Callable
    shows: str = "Combined"  # the pass that is compared, by its name in Blender 5


# What varies over the stage, by nodes that have long been there.
GENERATED = N("TexCoord", output="Generated")
OBJECT = N("TexCoord", output="Object")
UV = N("TexCoord", output="UV")
HUES = N("TexImage", {"Vector": UV}, image="hues")  # colours, linear, 0.05 to 0.95
COLORS = N("TexImage", {"Vector": OBJECT}, image="hues")  # others
CENTRED = N("Mapping", {"Vector": HUES, "Location": (-0.5, -0.5, -0.5)})  # both signs
NORMAL = N("TexCoord", output="Normal")


def halved(vector: Node) -> Node:
    """From [-1, 1] to [0, 1], to be seen."""
    return N("Mapping", {"Vector": vector, "Location": (0.5, 0.5, 0.5), "Scale": (0.5, 0.5, 0.5)})


def shown(name: str, node: Node) -> Row:
    """The node's value as light: no noise but that of edges."""
    return Row(name, lambda stage: stage.show(N("Emission", {"Color": node})))


def lit(name: str, shader: Node, displacement: str = "BUMP", **sockets: Node) -> Row:
    """A shader under lights; `sockets`: Volume or Displacement of the output."""
    return Row(name, lambda stage: stage.dress(shader, displacement, **sockets))


def modes(name: str, make: Callable[..., Row], choices: Mapping[str, Sequence]) -> Iterator[Row]:
    """A row for each value of each property, the others left as they are."""
    for prop, values in choices.items():
        for value in values:
            label = str(value).lower().replace(" ", "_")
            yield make(f"{name}/{prop.rpartition('.')[2]}={label}", **{prop: value})
