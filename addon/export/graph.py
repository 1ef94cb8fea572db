# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a socket's value comes from, seen through groups, reroutes and muted nodes."""

from __future__ import annotations

from dataclasses import dataclass

# Group nodes around a node, outermost first.
GroupPath = tuple

REC709_LUMINANCE = (0.2126, 0.7152, 0.0722)


@dataclass(frozen=True)
class Constant:
    """The value of a socket that nothing feeds, scalars as (v, v, v, 1)."""

    value: tuple[float, float, float, float]
    type: str  # of the socket: VALUE, RGBA, VECTOR, ...

    def read_as(self, type: str) -> tuple[float, float, float, float]:
        """The value as a socket of `type` reads it; a group's socket may be of another type."""
        if type != "VALUE" or self.type not in ("RGBA", "VECTOR"):
            return self.value
        weights = REC709_LUMINANCE if self.type == "RGBA" else (1 / 3, 1 / 3, 1 / 3)
        return _repeated(sum(w * v for w, v in zip(weights, self.value, strict=False)))


@dataclass(frozen=True)
class Output:
    """Output `socket` of `node` inside the groups `path`."""

    node: object
    socket: object
    path: GroupPath


def source(socket, path: GroupPath) -> Constant | Output | None:
    """What input `socket` reads; None if it has neither link nor value, so that its default holds.

    A shader has no value. The value of a normal or of a texture's vector is hidden and does not
    count: the surface's own normal or coordinates take its place, also where a group offers a
    constant. A link that ends in reroutes, muted nodes or empty groups counts as no link. `socket`
    is None where a group has no such socket.
    """
    if socket is None:
        return None
    found = _behind(socket, path)
    if found is None or (isinstance(found, Constant) and socket.hide_value):
        return constant(socket)
    return found


def _behind(socket, path: GroupPath) -> Constant | Output | None:
    """What the link of input `socket` leads to; None without one or at a dead end."""
    link = next((link for link in socket.links if link.is_valid and not link.is_muted), None)
    return _through(link.from_node, link.from_socket, path) if link else None


def _through(node, socket, path: GroupPath) -> Constant | Output | None:
    """Follows output `socket` of `node` to a node that computes something."""
    if node.bl_idname == "NodeReroute":
        return _behind(node.inputs[0], path)
    if node.mute:
        passed = next((link for link in node.internal_links if link.to_socket == socket), None)
        return _behind(passed.from_socket, path) if passed else None
    if node.bl_idname == "NodeGroupInput":
        return _of_group(_same(path[-1].inputs, socket), path[:-1])
    if hasattr(node, "node_tree"):
        result = group_output(node.node_tree)
        return _of_group(_same(result.inputs, socket), (*path, node)) if result else None
    return Output(node, socket, path)


def _of_group(socket, path: GroupPath) -> Constant | Output | None:
    """What passes through a group's socket, whose value counts even where it is hidden."""
    return None if socket is None else _behind(socket, path) or _value(socket)


def group_output(tree):
    """The active output node of a group, or None."""
    outputs = [node for node in tree.nodes if node.bl_idname == "NodeGroupOutput"] if tree else []
    return next((node for node in outputs if node.is_active_output), None)


def _same(sockets, socket):
    return next((other for other in sockets if other.identifier == socket.identifier), None)


def constant(socket) -> Constant | None:
    """The socket's own value, or None if it has none to set."""
    return None if socket.hide_value else _value(socket)


def _value(socket) -> Constant | None:
    if not hasattr(socket, "default_value"):
        return None
    if socket.type == "VECTOR":
        return Constant((*socket.default_value, 1.0), "VECTOR")
    if socket.type == "RGBA":
        return Constant(tuple(socket.default_value), "RGBA")
    return Constant(_repeated(float(socket.default_value)), "VALUE")


def _repeated(value: float) -> tuple[float, float, float, float]:
    return (value, value, value, 1.0)
