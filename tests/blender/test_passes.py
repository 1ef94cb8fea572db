# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes beside Cycles', and beside each other: light passes add up to the picture."""

import math

import bpy
import numpy as np
import pytest
from layers import render_layers
from scenes import (
    add_camera,
    add_light,
    add_mesh,
    add_node,
    add_uv,
    new_material,
    new_world,
    surface,
)

from specula import passes
from specula.export import compat

SIZE = (60, 40)
SAMPLES = 768
# Of a pass's mean over the frame, and over each of BLOCKS squared parts, which have more noise.
TOLERANCE, BLOCK_TOLERANCE, BLOCKS = 0.02, 0.2, 3
# What a pass may change within a pixel (m, at the floor): first samples lie at different places.
PIXEL = 0.3
EDGES = 0.06  # share of the pixels that may be at edges, where first samples and means differ
LIGHT = [
    f"{kind} {part}"
    for kind in ("Diffuse", "Glossy", "Transmission")
    for part in ("Direct", "Indirect")
]
COLORS = ["Diffuse Color", "Glossy Color", "Transmission Color"]
MEANS = [*LIGHT, *COLORS, "Emission", "Environment", "Combined", "Denoising Albedo"]
FIRSTS = ["Depth", "Position", "Normal", "UV", "Mist", "Object Index", "Material Index"]


def switch_on(layer) -> None:
    for switch in passes.SWITCHES.values():
        owner, _, name = switch.rpartition(".")
        if name and owner != "specula":
            setattr(getattr(layer, owner) if owner else layer, name, True)


def add_patch(name, x, kind, index, inputs, **properties):
    """A tilted square of one closure, above the floor."""
    material = new_material(name)
    node = add_node(material, kind, surface(material), **properties)
    for key, value in inputs.items():
        node.inputs[key].default_value = value
    material.pass_index = index
    patch = add_mesh(name, material=material)
    patch.location, patch.scale, patch.rotation_euler = (x, 0.3, 0.9), (0.42, 0.6, 1), (0.5, 0.2, 0)
    patch.pass_index = index + 10
    return patch


@pytest.fixture
def still_life():
    """Patches of each kind of closure above a plain floor, a lamp, and an even sky."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    floor = add_mesh("Floor", [(-4, -3, 0), (4, -3, 0), (4, 1.5, 0), (-4, 1.5, 0)])
    add_uv(floor.data)
    material = new_material("plaster")
    node = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    node.inputs["Color"].default_value = (0.7, 0.6, 0.5, 1)
    floor.data.materials.append(material)
    copper = (0.8, 0.4, 0.2, 1)
    add_patch("diffuse", -2, "ShaderNodeBsdfDiffuse", 1, {"Color": copper})
    rough = {"Color": copper, "Roughness": 0.5}
    add_patch("glossy", -1, "ShaderNodeBsdfGlossy", 2, rough, distribution="GGX")
    add_patch("glass", 0, "ShaderNodeBsdfRefraction", 3, {**rough, "IOR": 1.3}, distribution="GGX")
    add_patch("mirror", 1, "ShaderNodeBsdfGlossy", 4, {"Color": copper, "Roughness": 0.0})
    add_patch("glow", 2, "ShaderNodeEmission", 5, {"Color": copper, "Strength": 0.7})
    lamp = add_light("POINT", energy=300, shadow_soft_size=0.5)
    lamp.location = (1, -2, 4)
    camera = add_camera((0, -5, 4))
    camera.rotation_euler = (math.radians(52), 0, 0)
    world = new_world()
    background = add_node(world, "ShaderNodeBackground", surface(world))
    background.inputs["Color"].default_value = (0.2, 0.3, 0.4, 1)
    world.mist_settings.start, world.mist_settings.depth = 3, 6
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = SAMPLES, False, False
    cycles.sample_clamp_indirect = cycles.blur_glossy = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    scene.specula.method, scene.specula.samples = "PT", SAMPLES
    switch_on(bpy.context.view_layer)
    return scene


def rendered(engine, tmp_path) -> dict[str, np.ndarray]:
    bpy.context.scene.render.engine = engine
    layers, _ = render_layers(tmp_path)
    return {name.removeprefix("ViewLayer."): pixels for name, pixels in layers.items()}


def blocks(pixels: np.ndarray) -> np.ndarray:
    """(BLOCKS, BLOCKS, C) means."""
    rows = np.array_split(pixels, BLOCKS)
    return np.array([[b.mean((0, 1)) for b in np.array_split(row, BLOCKS, axis=1)] for row in rows])


def with_products(layers: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """With the names of Blender 5; light passes times their colours: the parts of the picture."""
    found = {name: layers[compat.pass_name(name)] for name in [*MEANS, *FIRSTS]}
    for name in LIGHT:
        found[name] = found[name] * found[f"{name.split()[0]} Color"]
    return found


def test_passes_are_those_of_cycles(still_life, tmp_path):
    ours, theirs = rendered("SPECULA", tmp_path), rendered("CYCLES", tmp_path)
    assert set(ours) == set(theirs)
    ours, theirs = with_products(ours), with_products(theirs)
    brightness = theirs["Combined"][..., :3].mean()
    wrong = {}
    for name in MEANS:
        a, b = ours[name], theirs[name]
        scale = max(float(b.mean()), 0.02 * brightness)
        whole = np.abs(a.mean((0, 1)) - b.mean((0, 1))).max() / scale
        part = np.abs(blocks(a) - blocks(b)).max() / scale
        if whole > TOLERANCE or part > BLOCK_TOLERANCE:
            wrong[name] = (a.mean((0, 1)), b.mean((0, 1)), whole, part)
    for name in FIRSTS:
        a, b = ours[name], theirs[name]
        differs = (np.abs(a - b) > PIXEL).any(axis=2)
        if differs.mean() > EDGES:
            wrong[name] = (a[20, 30], b[20, 30], differs.mean())
    assert not wrong, "\n".join(f"{name}: {value}" for name, value in wrong.items())


@pytest.mark.parametrize("method", ["PT", "AUTO"])
def test_light_passes_add_up_to_the_picture(still_life, tmp_path, method):
    still_life.specula.method = method
    still_life.specula.samples = 16
    bpy.data.objects["mirror"].rotation_euler = (1.5, 0, 0)  # throws the lamp on the floor
    bpy.context.view_layer.specula.use_pass_caustics = True
    found = rendered("SPECULA", tmp_path)
    get = with_products(found)
    total = sum((get[name] for name in LIGHT), get["Emission"] + get["Environment"])
    combined = get["Combined"][:, :, :3]
    np.testing.assert_allclose(total, combined, rtol=2e-4, atol=2e-5)
    assert found["Caustics"].any() == (method == "AUTO")


def add_aov(layer, material_or_world, name, kind, value):
    """An AOV of the layer, and a node that writes a value, or a colour that varies, to it."""
    if name not in layer.aovs:
        aov = layer.aovs.add()
        aov.name, aov.type = name, kind
    tree = material_or_world.node_tree
    node = tree.nodes.new("ShaderNodeOutputAOV")
    if hasattr(node, "aov_name"):
        node.aov_name = name
    else:
        node.name = name
    if kind == "VALUE":
        node.inputs["Value"].default_value = value
        return
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], node.inputs["Color"])


def group_lights(scene, layer) -> list[str]:
    """A group for each light; their names."""
    groups = ["key", "glow", "sky"]
    for name in groups:
        layer.lightgroups.add(name=name)
    lamp = next(obj for obj in scene.objects if obj.type == "LIGHT")
    lamp.lightgroup, bpy.data.objects["glow"].lightgroup = "key", "glow"
    scene.world.lightgroup = "sky"
    return groups


def test_light_groups_and_aovs_are_those_of_cycles(still_life, tmp_path):
    layer = bpy.context.view_layer
    groups = group_lights(still_life, layer)
    add_aov(layer, bpy.data.materials["plaster"], "mask", "VALUE", 0.25)
    add_aov(layer, bpy.data.materials["glow"], "mask", "VALUE", 3.0)
    add_aov(layer, bpy.data.materials["plaster"], "place", "COLOR", None)
    add_aov(layer, still_life.world, "place", "COLOR", None)
    ours, theirs = rendered("SPECULA", tmp_path), rendered("CYCLES", tmp_path)
    assert set(ours) == set(theirs)
    brightness = theirs["Combined"][..., :3].mean()
    for name in [*(f"Combined_{group}" for group in groups), "mask", "place"]:
        a, b = ours[name], theirs[name]
        assert a.shape == b.shape, name
        scale = max(float(b.mean()), 0.02 * brightness)
        assert np.abs(a.mean((0, 1)) - b.mean((0, 1))).max() < TOLERANCE * scale, name
        assert np.abs(blocks(a) - blocks(b)).max() < BLOCK_TOLERANCE * scale, name


@pytest.mark.parametrize("method", ["PT", "AUTO"])
def test_light_groups_add_up_to_the_picture(still_life, tmp_path, method):
    groups = group_lights(still_life, bpy.context.view_layer)
    still_life.specula.method, still_life.specula.samples = method, 16
    bpy.data.objects["mirror"].rotation_euler = (1.5, 0, 0)  # throws the lamp on the floor
    found = rendered("SPECULA", tmp_path)
    total = sum(found[f"Combined_{group}"] for group in groups)
    np.testing.assert_allclose(total, found["Combined"][:, :, :3], rtol=2e-4, atol=2e-5)
