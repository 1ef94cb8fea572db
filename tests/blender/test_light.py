# SPDX-License-Identifier: GPL-3.0-or-later
import math

import bpy
import numpy as np
import pytest
from scenes import add_light, add_node, export

from specula.export.desc import AreaShape, LightType, Visibility

PROPERTIES = bpy.types.AreaLight.bl_rna.properties


def only_light():
    scene, warnings = export()
    (light,) = scene.lights
    return light, warnings


def emission_of(light):
    """The Emission node that shades a light."""
    if not light.use_nodes:
        light.use_nodes = True
    light.node_tree.nodes.clear()
    output = light.node_tree.nodes.new("ShaderNodeOutputLight")
    return add_node(light, "ShaderNodeEmission", output.inputs["Surface"])


def test_point():
    obj = add_light("POINT", energy=10.0, color=(1, 0.5, 0.25), shadow_soft_size=0.125)
    obj.location = (1, 2, 3)
    light, warnings = only_light()
    assert light.type == LightType.POINT
    assert light.power == (10, 5, 2.5)
    assert light.radius == 0.125
    assert light.visibility == Visibility.ALL & ~Visibility.CAMERA  # Blender's own default
    assert light.feeds_caustics is True
    np.testing.assert_array_equal(light.transform[:, 3], (1, 2, 3))
    assert warnings == []


def test_soft_falloff():
    obj = add_light("SPOT", shadow_soft_size=0.5)
    assert only_light()[0].soft_falloff is True  # Blender's default, and all that 3.4 has
    if hasattr(obj.data, "use_soft_falloff"):
        obj.data.use_soft_falloff = False
        assert only_light()[0].soft_falloff is False


def test_spot():
    add_light("SPOT", spot_size=1.0, spot_blend=0.25, shadow_soft_size=0.5)
    light, _ = only_light()
    assert light.type == LightType.SPOT
    assert (light.spot_angle, light.spot_blend, light.radius) == (1.0, 0.25, 0.5)


def test_sun():
    add_light("SUN", energy=3.0, angle=0.125)
    light, _ = only_light()
    assert light.type == LightType.SUN
    assert light.power == (3, 3, 3)
    assert light.sun_angle == 0.125


@pytest.mark.parametrize(
    ("shape", "expected", "size"),
    [
        ("SQUARE", AreaShape.RECTANGLE, (2.0, 2.0)),
        ("RECTANGLE", AreaShape.RECTANGLE, (2.0, 3.0)),
        ("DISK", AreaShape.ELLIPSE, (2.0, 2.0)),
        ("ELLIPSE", AreaShape.ELLIPSE, (2.0, 3.0)),
    ],
)
def test_area(shape, expected, size):
    add_light("AREA", shape=shape, size=2.0, size_y=3.0, energy=7.0)
    light, warnings = only_light()
    assert light.type == LightType.AREA
    assert (light.shape, light.size) == (expected, size)
    today = bpy.app.version >= (4, 0, 0)
    assert light.power == pytest.approx([7 if today else 7 * math.pi / 4] * 3)
    assert warnings == []


def test_spread():
    softbox = add_light("AREA")
    assert only_light()[0].spread == pytest.approx(math.pi)
    softbox.data.spread = math.radians(90)
    light, warnings = only_light()
    assert light.spread == pytest.approx(math.pi / 2)
    assert warnings == []


def test_emission_node_multiplies():
    obj = add_light("POINT", energy=2.0, color=(1, 0.5, 1))
    emission = emission_of(obj.data)
    emission.inputs["Color"].default_value = (0.5, 1, 1, 1)
    emission.inputs["Strength"].default_value = 4.0
    light, warnings = only_light()
    assert light.power == (4, 4, 8)
    assert warnings == []


def test_nodes_of_constants_count():
    obj = add_light("POINT", energy=2.0)
    emission = emission_of(obj.data)
    math = add_node(obj.data, "ShaderNodeMath", emission.inputs["Strength"], operation="POWER")
    math.inputs[0].default_value, math.inputs[1].default_value = 3.0, 2.0
    light, warnings = only_light()
    assert light.power == (18, 18, 18)
    assert warnings == []


def test_nodes_that_vary_are_a_material():
    obj = add_light("POINT", energy=2.0)
    emission = emission_of(obj.data)
    add_node(obj.data, "ShaderNodeTexChecker", emission.inputs["Color"])
    twin = bpy.data.objects.new("Twin", obj.data)
    bpy.context.scene.collection.objects.link(twin)
    scene, warnings = export()
    assert [light.power for light in scene.lights] == [(2, 2, 2)] * 2
    assert {light.material for light in scene.lights} == {len(scene.materials) - 1}
    assert [node.kind for node in scene.materials[-1].nodes if "check" in node.kind] == [
        "checker_texture"
    ]
    assert warnings == []


def test_a_light_can_be_kept_from_caustics_shadows_and_rays():
    obj = add_light("POINT")
    obj.data.specula.caustics = False
    obj.visible_camera = True
    obj.visible_glossy = False
    if hasattr(obj.data.cycles, "cast_shadow"):
        obj.data.cycles.cast_shadow = False
    else:
        obj.data.use_shadow = False
    light, _ = only_light()
    assert light.feeds_caustics is False
    assert light.visibility == Visibility.ALL & ~(Visibility.SHADOW | Visibility.GLOSSY)


@pytest.mark.parametrize("kind", ["SPOT", "SUN", "AREA"])
def test_a_light_without_extent_gives_none(kind):
    obj = add_light(kind)
    obj.scale.x = 0
    if kind == "AREA":
        add_light(kind, "Small", shape="RECTANGLE", size=0.0)
    scene, warnings = export()
    assert scene.lights == []
    assert len(warnings) == (2 if kind == "AREA" else 1)
    assert "light Light: has a scale or size of zero, it gives no light" in warnings


def test_a_point_shines_whatever_its_scale():
    obj = add_light("POINT", energy=10.0)
    obj.location, obj.scale = (1, 2, 3), (0, 0, 0)
    light, warnings = only_light()
    np.testing.assert_array_equal(light.transform, np.c_[np.eye(3), (1, 2, 3)])
    assert (light.power, warnings) == ((10, 10, 10), [])


def test_negative_light_is_left_out():
    obj = add_light("POINT", energy=-1.0)
    light, warnings = only_light()
    assert light.power == (0, 0, 0)
    assert warnings == ["light Light: negative light is not supported, it is left out"]
    emission_of(obj.data).inputs["Strength"].default_value = -2.0
    assert only_light()[0].power == (2, 2, 2)


def test_limit_of_bounces():
    obj = add_light()
    assert only_light()[0].max_bounces == 1024
    obj.data.cycles.max_bounces = 3
    light, warnings = only_light()
    assert (light.max_bounces, warnings) == (3, [])


def test_a_portal_is_no_light():
    add_light("AREA").data.cycles.is_portal = True
    assert export()[0].lights == []


@pytest.mark.skipif("exposure" not in PROPERTIES, reason="lights have no exposure yet")
def test_exposure_and_temperature():
    obj = add_light("POINT", energy=1.0, exposure=2.0)
    assert only_light()[0].power == (4, 4, 4)
    obj.data.use_temperature = True
    obj.data.temperature = 3000
    red, green, blue = only_light()[0].power
    assert red > green > blue


@pytest.mark.skipif("normalize" not in PROPERTIES, reason="always normalized")
@pytest.mark.parametrize(
    ("type", "properties", "factor"),
    [
        ("AREA", {"shape": "RECTANGLE", "size": 2.0, "size_y": 3.0}, 12.0),
        ("AREA", {"shape": "ELLIPSE", "size": 2.0, "size_y": 3.0}, 3.0 * math.pi),
        ("POINT", {"shadow_soft_size": 0.5}, math.pi),
        ("POINT", {"shadow_soft_size": 0.0}, 4.0),
        ("SUN", {"angle": 0.5}, 0.192293),
    ],
)
def test_power_that_is_not_normalized(type, properties, factor):
    """Factors between Cycles' renders with and without `normalize`, scale (2, 1, 1)."""
    obj = add_light(type, energy=1.0, normalize=False, **properties)
    obj.scale = (2, 1, 1)
    assert only_light()[0].power == pytest.approx([factor] * 3, rel=1e-4)


def test_animation_counts():
    """Keyframes and drivers of a light, its nodes and its object."""
    obj = add_light("POINT", energy=1.0)
    emission = emission_of(obj.data)
    animated = (
        (obj.data, "energy", 5.0),
        (obj.data, "color", (0.5, 1.0, 0.25)),
        (emission.inputs["Strength"], "default_value", 3.0),
        (obj, "location", (1, 2, 3)),
    )
    for owner, name, value in animated:
        owner.keyframe_insert(name, frame=1)
        setattr(owner, name, value)
        owner.keyframe_insert(name, frame=5)
    radius = obj.data.driver_add("shadow_soft_size").driver
    radius.expression = "frame / 8"
    bpy.context.scene.frame_set(5)
    obj.data.energy = 77.0  # a value that the animation replaces
    light, warnings = only_light()
    assert light.power == pytest.approx((7.5, 15, 3.75))
    assert light.radius == 0.625
    np.testing.assert_array_equal(light.transform[:, 3], (1, 2, 3))
    assert warnings == []
