# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of what arranges nodes in Blender 5.0: between a colour and the light that shows it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from tests.instruments.parity._nodes import HUES, N, Row


def _new(tree, kind: str):
    """A node that Blender may not have."""
    from tests.instruments.parity._stage import Absent  # not above: it needs Blender

    try:
        return tree.nodes.new(kind)
    except RuntimeError as error:
        raise Absent(f"no {kind}") from error


def _darker(tree, color, by: float):
    gamma = tree.nodes.new("ShaderNodeGamma")
    gamma.inputs["Gamma"].default_value = by
    tree.links.new(color, gamma.inputs["Color"])
    return gamma.outputs[0]


def repeat(tree, color):
    start, end = (_new(tree, f"GeometryNodeRepeat{side}") for side in ("Input", "Output"))
    start.pair_with_output(end)
    end.repeat_items.new("RGBA", "Color")
    start.inputs["Iterations"].default_value = 3
    tree.links.new(color, start.inputs["Color"])
    tree.links.new(_darker(tree, start.outputs["Color"], 1.3), end.inputs["Color"])
    return end.outputs["Color"]


def closure(tree, color):
    start, end = (_new(tree, f"NodeClosure{side}") for side in ("Input", "Output"))
    start.pair_with_output(end)
    evaluate = _new(tree, "NodeEvaluateClosure")
    for node in (end, evaluate):
        node.input_items.new("RGBA", "In")
        node.output_items.new("RGBA", "Out")
    tree.links.new(_darker(tree, start.outputs["In"], 2.0), end.inputs["Out"])
    tree.links.new(end.outputs[0], evaluate.inputs["Closure"])
    tree.links.new(color, evaluate.inputs["In"])
    return evaluate.outputs["Out"]


def bundle(tree, color):
    combine, separate = (_new(tree, f"Node{what}Bundle") for what in ("Combine", "Separate"))
    for node in (combine, separate):
        node.bundle_items.new("RGBA", "Light")
        node.bundle_items.new("RGBA", "Dark")
    tree.links.new(color, combine.inputs["Light"])
    tree.links.new(_darker(tree, color, 2.0), combine.inputs["Dark"])
    tree.links.new(combine.outputs[0], separate.inputs[0])
    return separate.outputs["Dark"]


def menu_switch(tree, color):
    switch = _new(tree, "GeometryNodeMenuSwitch")
    switch.data_type = "RGBA"
    tree.links.new(_darker(tree, color, 2.0), switch.inputs["A"])
    tree.links.new(color, switch.inputs["B"])
    switch.inputs["Menu"].default_value = "A"
    return switch.outputs["Output"]


def _shown(arrange: Callable) -> Callable:
    def build(stage) -> None:
        stage.show(N("Emission", {"Color": HUES}))
        trees = {obj.data.materials[0].node_tree for obj in (*stage.subjects, stage.floor)}
        for tree in trees:
            socket = next(node for node in tree.nodes if node.type == "EMISSION").inputs["Color"]
            tree.links.new(arrange(tree, socket.links[0].from_socket), socket)

    return build


def rows() -> Iterator[Row]:
    for arrange in (repeat, closure, bundle, menu_switch):
        yield Row(f"zones/{arrange.__name__}", _shown(arrange))
