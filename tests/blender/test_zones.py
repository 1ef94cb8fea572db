# SPDX-License-Identifier: GPL-3.0-or-later
"""What arranges nodes in Blender 5.0, zones, bundles and menus, is gone when it is exported."""

import bpy
import pytest
from scenes import add_node, new_material, surface
from test_material import convert, links, node

pytestmark = pytest.mark.skipif(bpy.app.version < (5, 0, 0), reason="shaders had no zones")


def doubled_in_rounds(tree, rounds):
    start, end = (tree.nodes.new(f"GeometryNodeRepeat{name}") for name in ("Input", "Output"))
    start.pair_with_output(end)
    end.repeat_items.new("FLOAT", "Value")
    start.inputs["Iterations"].default_value = rounds
    start.inputs["Value"].default_value = 3.0
    twice = tree.nodes.new("ShaderNodeMath")
    twice.operation = "MULTIPLY"
    tree.links.new(start.outputs["Value"], twice.inputs[0])
    tree.links.new(start.outputs["Iteration"], twice.inputs[1])
    tree.links.new(twice.outputs[0], end.inputs["Value"])
    return end.outputs["Value"]


def emission_of(material):
    return add_node(material, "ShaderNodeEmission", surface(material)).inputs["Strength"]


@pytest.mark.parametrize("rounds", [0, 1, 3])
def test_a_repeat_zone_is_unrolled(rounds):
    material = new_material()
    tree = material.node_tree
    tree.links.new(doubled_in_rounds(tree, rounds), emission_of(material))
    desc, *_ = convert(material)
    steps = [n for n in desc.nodes if n.kind == "math"]
    assert len(steps) == rounds
    # From the last round to the first, which reads what the zone is given.
    assert [n.inputs["Value_001"][0] for n in steps] == list(reversed(range(rounds)))
    if rounds:
        assert steps[-1].inputs["Value"][0] == 3.0
        assert "math.Value -> emission.Strength" in links(desc)
    else:
        assert node(desc, "emission").inputs["Strength"][0] == 3.0


def test_rounds_that_are_not_known_are_warned_of():
    material = new_material()
    tree = material.node_tree
    result = doubled_in_rounds(tree, 1)
    start = next(n for n in tree.nodes if n.bl_idname == "GeometryNodeRepeatInput")
    add_node(material, "ShaderNodeObjectInfo", start.inputs["Iterations"])
    tree.links.new(result, emission_of(material))
    _, _, warnings, _ = convert(material)
    assert any("Repeat" in warning for warning in warnings)


def test_a_closure_stands_where_it_is_evaluated():
    material = new_material()
    tree = material.node_tree
    start, end = tree.nodes.new("NodeClosureInput"), tree.nodes.new("NodeClosureOutput")
    start.pair_with_output(end)
    end.input_items.new("FLOAT", "In")
    end.output_items.new("FLOAT", "Out")
    math = tree.nodes.new("ShaderNodeMath")
    tree.links.new(start.outputs["In"], math.inputs[0])
    tree.links.new(math.outputs[0], end.inputs["Out"])
    mix = add_node(material, "ShaderNodeAddShader", surface(material))
    for value, shader in ((2.0, mix.inputs[0]), (5.0, mix.inputs[1])):
        evaluate = tree.nodes.new("NodeEvaluateClosure")
        evaluate.input_items.new("FLOAT", "In")
        evaluate.output_items.new("FLOAT", "Out")
        evaluate.inputs["In"].default_value = value
        tree.links.new(end.outputs[0], evaluate.inputs["Closure"])
        emission = add_node(material, "ShaderNodeEmission", shader)
        tree.links.new(evaluate.outputs["Out"], emission.inputs["Strength"])
    desc, *_ = convert(material)
    assert sorted(n.inputs["Value"][0] for n in desc.nodes if n.kind == "math") == [2.0, 5.0]


def test_a_bundle_gives_what_was_put_in():
    material = new_material()
    tree = material.node_tree
    combine, separate = tree.nodes.new("NodeCombineBundle"), tree.nodes.new("NodeSeparateBundle")
    for bundle in (combine, separate):
        for name in ("First", "Second"):
            bundle.bundle_items.new("FLOAT", name)
    combine.inputs["Second"].default_value = 4.0
    tree.links.new(combine.outputs[0], separate.inputs[0])
    tree.links.new(separate.outputs["Second"], emission_of(material))
    desc, *_ = convert(material)
    assert node(desc, "emission").inputs["Strength"][0] == 4.0


def test_a_menu_switch_gives_what_its_menu_says():
    material = new_material()
    tree = material.node_tree
    switch = tree.nodes.new("GeometryNodeMenuSwitch")
    switch.data_type = "FLOAT"
    switch.inputs["A"].default_value, switch.inputs["B"].default_value = 2.0, 6.0
    switch.inputs["Menu"].default_value = "B"
    tree.links.new(switch.outputs["Output"], emission_of(material))
    desc, *_ = convert(material)
    assert node(desc, "emission").inputs["Strength"][0] == 6.0
