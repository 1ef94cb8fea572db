# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking and shadow linking: what they come to, and Cycles' pictures of them."""

import bpy
import numpy as np
import pytest
import tiles
from scenes import (
    add_camera,
    add_light,
    add_mesh,
    add_node,
    export,
    new_material,
    new_world,
    surface,
)

pytestmark = pytest.mark.skipif(
    "light_linking" not in bpy.types.Object.bl_rna.properties, reason="no light linking yet"
)
SIZE = 24
BLOCK = 6  # pixels


def collection(*members, state="INCLUDE", children=()):
    made = bpy.data.collections.new("Linked")
    for obj in members:
        made.objects.link(obj)
    for child in children:
        made.children.link(child)
    for link in (*made.collection_objects, *made.collection_children):
        link.light_linking.link_state = state
    return made


def sets():
    """Name of each object -> names of the lights that shine on it, and that it blocks."""
    scene, warnings = export()
    assert warnings == []

    def tied(links: str, members: str):
        return {
            one.name: {
                light.name
                for light in scene.lights
                if getattr(light, links) == 0 or getattr(light, links) & getattr(one, members)
            }
            for one in scene.instances
        }

    return tied("receiver_sets", "receives_in"), tied("blocker_sets", "blocks_in")


def test_included_and_excluded():
    a, b, c = (add_mesh(name) for name in "abc")
    lamps = {name: add_light(name=name) for name in ("all", "on a", "but a", "empty", "both")}
    lamps["on a"].light_linking.receiver_collection = collection(a)
    lamps["but a"].light_linking.receiver_collection = collection(a, state="EXCLUDE")
    lamps["empty"].light_linking.receiver_collection = collection()
    both = collection(a, b)
    both.collection_objects[0].light_linking.link_state = "EXCLUDE"
    lamps["both"].light_linking.receiver_collection = both
    lamps["all"].light_linking.blocker_collection = collection(c)
    receives, blocks = sets()
    assert receives == {
        "a": {"all", "empty", "on a"},
        "b": {"all", "but a", "both", "empty"},
        "c": {"all", "but a", "empty"},
    }
    others = set(lamps) - {"all"}
    assert blocks == {"a": others, "b": others, "c": set(lamps)}


def test_children_have_the_state_of_what_they_lie_in():
    a, b, c = (add_mesh(name) for name in "abc")
    inner = collection(a, b)
    linked = collection(c, children=[collection(children=[inner])], state="EXCLUDE")
    linked.objects.link(b)  # counts more
    add_light(name="lamp").light_linking.receiver_collection = linked
    assert sets()[0] == {"a": set(), "b": {"lamp"}, "c": set()}


def test_an_instancer_that_is_linked_speaks_for_its_instances():
    a = add_mesh("a")
    source = bpy.data.collections.new("Source")
    source.objects.link(a)
    bpy.context.scene.collection.objects.unlink(a)
    empty, plain = bpy.data.objects.new("empty", None), bpy.data.objects.new("plain", None)
    for obj in (empty, plain):
        obj.instance_type, obj.instance_collection = "COLLECTION", source
        bpy.context.scene.collection.objects.link(obj)
    lamp = add_light(name="lamp")
    lamp.light_linking.receiver_collection = collection(empty)
    scene, _ = export()
    receives = [one.receives_in for one in scene.instances]
    assert sorted(receives) == [0, scene.lights[0].receiver_sets]


def test_mesh_lights_are_linked():
    glow = add_mesh("glow")
    glow.light_linking.receiver_collection = collection(add_mesh("a"))
    glow.light_linking.blocker_collection = collection()
    scene, _ = export()
    links = {one.name: (one.receiver_sets, one.blocker_sets) for one in scene.instances}
    assert links == {"glow": (1, 1), "a": (0, 0)}


# ------------------------------------------------------------------------------------- pictures


def material(kind: str, **inputs):
    made = new_material(kind)
    node = add_node(made, f"ShaderNode{kind}", surface(made))
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    return made


def stage():
    """A floor, half glossy, with a plate over it and a mirror that shows the lamps."""
    add_camera((0, 0, 6))
    camera = bpy.context.scene.camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 4
    matt = material("BsdfDiffuse", Color=(0.8, 0.6, 0.4, 1))
    glossy = material("BsdfGlossy", Roughness=0.4)
    left = add_mesh("left", [(-2, -2, 0), (0, -2, 0), (0, 2, 0), (-2, 2, 0)], material=matt)
    right = add_mesh("right", [(0, -2, 0), (2, -2, 0), (2, 2, 0), (0, 2, 0)], material=glossy)
    mirror = add_mesh(
        "mirror",
        [(-1.8, 1.2, 0.1), (1.8, 1.2, 0.1), (1.8, 1.9, 0.35), (-1.8, 1.9, 0.35)],
        material=material("BsdfGlossy", Roughness=0.0),
    )
    plate = add_mesh(
        "plate",
        [(-1.2, -0.6, 0.9), (1.2, -0.6, 0.9), (1.2, 0.2, 0.9), (-1.2, 0.2, 0.9)],
        material=matt,
    )
    plate.visible_camera = False
    return {"left": left, "right": right, "mirror": mirror, "plate": plate}


def area_lamp():
    obj = add_light("AREA", name="lamp", energy=150, size=1.0)
    obj.location, obj.rotation_euler = (0.3, -0.3, 2.5), (0.15, 0.1, 0)
    return obj


def sun():
    obj = add_light("SUN", name="sun", energy=2, angle=0.6)
    obj.rotation_euler = (0.68, 0.1, 0)
    return obj


def glowing():
    points = [(-0.4, -0.7, 2.5), (-0.4, 0.1, 2.5), (0.8, 0.1, 2.5), (0.8, -0.7, 2.5)]
    obj = add_mesh("glow", points, material=material("Emission", Strength=12))
    obj.visible_camera = False
    return obj


LAMPS = {"area": area_lamp, "sun": sun, "mesh": glowing}
LINKS = {
    "on the floor's left": ("receiver_collection", {"left": "INCLUDE"}),
    "not on the mirror": ("receiver_collection", {"mirror": "EXCLUDE"}),
    "on the plate and the mirror": (
        "receiver_collection",
        {"plate": "INCLUDE", "mirror": "INCLUDE"},
    ),
    # The plate is named, lest Cycles loses light behind it (docs/limits.md).
    "mirror alone blocks": ("blocker_collection", {"mirror": "INCLUDE", "plate": "EXCLUDE"}),
    "plate does not block": ("blocker_collection", {"plate": "EXCLUDE"}),
}


def means(engine: str, samples: int, folder) -> np.ndarray:
    """The picture in blocks, (SIZE / BLOCK, SIZE / BLOCK)."""
    scene = bpy.context.scene
    scene.specula.samples = scene.cycles.samples = samples
    scene.cycles.seed = 1
    picture = tiles.render(engine, folder).mean(axis=-1)
    return picture.reshape(SIZE // BLOCK, BLOCK, -1, BLOCK).mean(axis=(1, 3))


@pytest.mark.parametrize("links", LINKS)
@pytest.mark.parametrize("lamp", LAMPS)
def test_looks_as_in_cycles(lamp, links, tmp_path):
    objects = stage()
    scene = tiles.prepare(SIZE)
    scene.cycles.max_bounces = 3
    world = new_world()
    add_node(world, "ShaderNodeBackground", surface(world)).inputs["Color"].default_value = (
        *(0.05,) * 3,
        1,
    )
    obj = LAMPS[lamp]()
    name, states = LINKS[links]
    linked = collection(*(objects[member] for member in states))
    for link, state in zip(linked.collection_objects, states.values(), strict=True):
        link.light_linking.link_state = state
    setattr(obj.light_linking, name, linked)
    ours, theirs = (means(engine, 1024, tmp_path) for engine in ("SPECULA", "CYCLES"))
    setattr(obj.light_linking, name, None)
    assert np.abs(means("SPECULA", 256, tmp_path) / ours - 1).max() > 0.2  # it matters
    np.testing.assert_allclose(ours, theirs, rtol=0.02)
