# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a socket's value comes from, seen through what only arranges nodes.

That is groups, reroutes, muted nodes, switches of menus, bundles, and the zones of Blender 5.0: a
repeat zone of a constant number of rounds is unrolled, a closure stands where it is evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass

# What a node is in, outermost first: group nodes, rounds of repeat zones, evaluations of closures.
GroupPath = tuple

MOST_ROUNDS = 32  # of a repeat zone; each has nodes of its own

REC709_LUMINANCE = (0.2126, 0.7152, 0.0722)


@dataclass(frozen=True)
class Constant:
    """The value of a socket that nothing feeds, scalars as (v, v, v, 1); of a menu its entry."""

    value: tuple[float, float, float, float] | str
    type: str  # of the socket: VALUE, RGBA, VECTOR, ...

    def read_as(self, type: str) -> tuple[float, float, float, float]:
        """The value as a socket of `type` reads it; a group's socket may be of another type."""
        if type != "VALUE" or self.type not in ("RGBA", "VECTOR"):
            return self.value
        weights = REC709_LUMINANCE if self.type == "RGBA" else (1 / 3, 1 / 3, 1 / 3)
        return _repeated(sum(w * v for w, v in zip(weights, self.value, strict=False)))


@dataclass(frozen=True)
class Round:
    """A round of the repeat zone that ends with `end`."""

    end: object
    number: int


@dataclass(frozen=True)
class Evaluation:
    """That of the closure that ends with `end`, by a node inside `path`."""

    end: object
    node: object
    path: GroupPath


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
        group, outside = _around(path, lambda entry: hasattr(entry, "node_tree"))
        return _passed(_same(group.inputs, socket), outside)
    if hasattr(node, "node_tree"):
        result = group_output(node.node_tree)
        return _passed(_same(result.inputs, socket), (*path, node)) if result else None
    arranged = _ARRANGED.get(node.bl_idname)
    return arranged(node, socket, path) if arranged else Output(node, socket, path)


def _passed(socket, path: GroupPath) -> Constant | Output | None:
    """What passes through a socket, whose value counts even where it is hidden."""
    return None if socket is None else _behind(socket, path) or _value(socket)


def _around(path: GroupPath, is_it) -> tuple[object, GroupPath] | None:
    """The innermost entry of a path that `is_it`, and the path around that."""
    places = (place for place in reversed(range(len(path))) if is_it(path[place]))
    place = next(places, None)
    return None if place is None else (path[place], path[:place])


# Each returns the output itself where what it arranges is not known when a scene is exported.


def _menu_switch(node, socket, path: GroupPath) -> Constant | Output | None:
    menu = _passed(node.inputs["Menu"], path)
    if not isinstance(menu, Constant):
        return Output(node, socket, path)
    chosen = next((item for item in node.inputs if item.name == menu.value), None)
    if socket.identifier == "Output":
        return _passed(chosen, path)
    return Constant(_repeated(float(socket.name == menu.value)), "VALUE")


def _separate_bundle(node, socket, path: GroupPath) -> Constant | Output | None:
    bundle = _behind(node.inputs["Bundle"], path)
    if not _is_of(bundle, "NodeCombineBundle"):
        return Output(node, socket, path)
    return _passed(_named(bundle.node.inputs, socket), bundle.path)


def _evaluate_closure(node, socket, path: GroupPath) -> Constant | Output | None:
    closure = _behind(node.inputs["Closure"], path)
    if not _is_of(closure, "NodeClosureOutput"):
        return Output(node, socket, path)
    inside = (*closure.path, Evaluation(closure.node, node, path))
    return _passed(_named(closure.node.inputs, socket), inside)


def _closure_input(node, socket, path: GroupPath) -> Constant | Output | None:
    end = node.paired_output
    found = _around(path, lambda entry: isinstance(entry, Evaluation) and entry.end == end)
    if found is None:
        return Output(node, socket, path)
    evaluation, _ = found
    return _passed(_named(evaluation.node.inputs, socket), evaluation.path)


def _repeat_output(node, socket, path: GroupPath) -> Constant | Output | None:
    starts = (start for start in node.id_data.nodes if _is_start(start, node))
    start = next(starts, None)
    rounds = _passed(start.inputs["Iterations"], path) if start else None
    if not isinstance(rounds, Constant) or rounds.value[0] > MOST_ROUNDS:
        return Output(node, socket, path)
    if rounds.value[0] < 1:
        return _passed(_same(start.inputs, socket), path)
    last = Round(node, int(rounds.value[0]) - 1)
    return _passed(_same(node.inputs, socket), (*path, last))


def _repeat_input(node, socket, path: GroupPath) -> Constant | Output | None:
    end = node.paired_output
    found = _around(path, lambda entry: isinstance(entry, Round) and entry.end == end)
    if found is None:
        return Output(node, socket, path)
    current, outside = found
    if socket.identifier == "Iteration":
        return Constant(_repeated(float(current.number)), "VALUE")
    if current.number == 0:
        return _passed(_same(node.inputs, socket), outside)
    before = Round(end, current.number - 1)
    return _passed(_same(end.inputs, socket), (*outside, before))


def _is_start(node, end) -> bool:
    return node.bl_idname == "GeometryNodeRepeatInput" and node.paired_output == end


def _is_of(found: Constant | Output | None, bl_idname: str) -> bool:
    return isinstance(found, Output) and found.node.bl_idname == bl_idname


_ARRANGED = {
    "GeometryNodeMenuSwitch": _menu_switch,
    "NodeSeparateBundle": _separate_bundle,
    "NodeEvaluateClosure": _evaluate_closure,
    "NodeClosureInput": _closure_input,
    "GeometryNodeRepeatOutput": _repeat_output,
    "GeometryNodeRepeatInput": _repeat_input,
}


def group_output(tree):
    """The active output node of a group, or None."""
    outputs = [node for node in tree.nodes if node.bl_idname == "NodeGroupOutput"] if tree else []
    return next((node for node in outputs if node.is_active_output), None)


def _same(sockets, socket):
    return next((other for other in sockets if other.identifier == socket.identifier), None)


def _named(sockets, socket):
    return next((other for other in sockets if other.name == socket.name), None)


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
    if socket.type == "MENU":
        return Constant(socket.default_value, "MENU")
    if socket.type not in ("VALUE", "INT", "BOOLEAN"):
        return None
    return Constant(_repeated(float(socket.default_value)), "VALUE")


def _repeated(value: float) -> tuple[float, float, float, float]:
    return (value, value, value, 1.0)
