# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels foretell is what the render then does."""

import bpy
import pytest
from scenes import (
    add_camera,
    add_light,
    add_mesh,
    add_node,
    add_uv,
    new_image,
    new_material,
    surface,
)

from specula import forecast, native, statistics
from specula.abi import CausticsSearch
from specula.inquiry import Forecast, Inquiry


def material_of(bl_idname: str, **inputs):
    material = new_material(bl_idname)
    node = add_node(material, bl_idname, surface(material))
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    return material


def mixed():
    """Diffuse and mirror: casts and receives; the mirror has a texture."""
    material = new_material("Mixed")
    mix = add_node(material, "ShaderNodeMixShader", surface(material))
    add_node(material, "ShaderNodeBsdfDiffuse", mix.inputs[1])
    mirror = add_node(material, "ShaderNodeBsdfGlossy", mix.inputs[2])
    mirror.inputs["Roughness"].default_value = 0.0
    add_node(material, "ShaderNodeTexImage", mirror.inputs["Color"])
    return material


MATERIALS = {
    "glass": lambda: material_of("ShaderNodeBsdfGlass", Roughness=0.0),
    "frosted glass": lambda: material_of("ShaderNodeBsdfGlass", Roughness=0.2),
    "rough glass": lambda: material_of("ShaderNodeBsdfGlass", Roughness=0.5),
    "diffuse": lambda: material_of("ShaderNodeBsdfDiffuse"),
    "mixed": mixed,
    "none": lambda: None,
}


@pytest.mark.parametrize("role", ["AUTO", "CASTER", "RECEIVER", "BOTH", "OFF"])
@pytest.mark.parametrize("material", MATERIALS)
def test_the_forecast_of_an_object_is_what_the_render_counts(material, role):
    obj = add_mesh("Quad", material=MATERIALS[material]())
    obj.specula.caustics = role
    add_camera()
    add_light()
    found = forecast.of_object(obj)
    bpy.ops.render.render()
    counted = statistics.last["Scene", "ViewLayer"].scene_stats
    assert (found.casts, found.receives) == (bool(counted["casters"]), bool(counted["receivers"]))


def test_slots_count_together():
    obj = add_mesh(material=MATERIALS["diffuse"]())
    obj.data.materials.append(MATERIALS["glass"]())
    found = forecast.of_object(obj)
    assert found.casts
    assert found.receives


def test_what_hides_from_scattered_rays_casts_nothing():
    obj = add_mesh(material=MATERIALS["glass"]())
    obj.visible_diffuse = False
    assert not forecast.of_object(obj).casts


def test_the_flag_of_cycles_counts_where_the_role_is_automatic():
    obj = add_mesh(material=MATERIALS["mixed"]())
    assert forecast.of_object(obj).receives
    obj.cycles.is_caustics_caster = True
    assert not forecast.of_object(obj).receives


@pytest.mark.parametrize(
    ("material", "casts", "reason"),
    [
        ("glass", True, "Glass BSDF, roughness 0, IOR"),
        ("frosted glass", True, "Glass BSDF, roughness 0.2"),
        ("rough glass", False, "roughness 0.5"),
        ("diffuse", False, "no specular closure"),
        ("mixed", True, "Glossy BSDF, roughness 0"),
    ],
)
def test_a_material_says_why(material, casts, reason):
    found = forecast.of_material(MATERIALS[material]())
    assert found.casts == casts
    assert reason in found.reason


def bumped(normal_below: bool = False):
    """A shiny material raised by an image, on top of a normal map or not."""
    material = material_of("ShaderNodeBsdfGlossy", Roughness=0.2)
    shader = surface(material).links[0].from_node
    bump = add_node(material, "ShaderNodeBump", shader.inputs["Normal"])
    bump.inputs["Distance"].default_value = 0.1
    image = new_image(size=64)
    image.colorspace_settings.name = "Non-Color"
    rows = [[(x * y) % 7 / 7.0 for x in range(64)] for y in range(64)]
    image.pixels.foreach_set([c for row in rows for h in row for c in (h, h, h, 1.0)])
    add_node(material, "ShaderNodeTexImage", bump.inputs["Height"], image=image)
    if normal_below:
        add_node(material, "ShaderNodeNormalMap", bump.inputs["Normal"])
    return material


@pytest.mark.parametrize(
    ("glints", "normal_below", "foretold", "why_not"),
    [
        ("AUTO", False, "Glossy BSDF, roughness 0.2", ""),
        ("ON", False, "Glossy BSDF, roughness 0.2", ""),
        ("OFF", False, "", ""),
        ("ON", True, "", "Glossy BSDF: its bump rises from another normal"),
    ],
)
def test_bumps_glint_as_foretold(glints, normal_below, foretold, why_not):
    material = bumped(normal_below)
    material.specula.glints = glints
    obj = add_mesh("Quad", material=material)
    add_uv(obj.data)
    add_camera()
    add_light().location = (0.5, 0.0, 4.0)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 8
    found = forecast.of_material(material)
    assert (found.glints, found.no_glints) == (foretold, why_not)
    bpy.ops.render.render()
    estimates = statistics.last["Scene", "ViewLayer"].render_stats["glint_estimates"]
    assert (estimates > 0) == bool(foretold)


def test_the_core_is_asked_once_for_each_state_of_a_material(monkeypatch):
    forecast.forget()
    material = MATERIALS["frosted glass"]()
    asked = []
    answer = Inquiry.forecast
    monkeypatch.setattr(Inquiry, "forecast", lambda *args: asked.append(1) or answer(*args))
    monkeypatch.setattr(native.Scene, "commit", None)  # nothing is built
    before = forecast.of_material(material)
    assert forecast.of_material(material) is before
    node = surface(material).links[0].from_node
    node.inputs["Roughness"].default_value = 0.0625
    assert "roughness 0.0625" in forecast.of_material(material).reason
    obj = add_mesh(material=material)
    assert forecast.of_object(obj).casts
    obj.specula.caustics = "OFF"
    assert forecast.of_object(obj) == Forecast(False, CausticsSearch.NONE, "", "", "")
    assert len(asked) == 4


def normal_mapped():
    material = material_of("ShaderNodeBsdfGlossy", Roughness=0.2)
    shader = surface(material).links[0].from_node
    normal = add_node(material, "ShaderNodeNormalMap", shader.inputs["Normal"])
    add_node(material, "ShaderNodeTexImage", normal.inputs["Color"])
    return material


@pytest.mark.parametrize(
    ("make", "search"),
    [
        (MATERIALS["glass"], CausticsSearch.MANIFOLD),
        (MATERIALS["frosted glass"], CausticsSearch.MANIFOLD),
        (normal_mapped, CausticsSearch.MANIFOLD_IF_COARSE),
        (lambda: material_of("ShaderNodeBsdfGlossy", Roughness=0.35), CausticsSearch.LIGHT_PATHS),
        (MATERIALS["diffuse"], CausticsSearch.NONE),
    ],
)
def test_who_searches(make, search):
    assert forecast.of_material(make()).search == search
