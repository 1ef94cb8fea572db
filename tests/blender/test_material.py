# SPDX-License-Identifier: GPL-3.0-or-later
from dataclasses import replace

import bpy
import numpy as np
import pytest
from scenes import (
    add_mesh,
    add_node,
    export,
    links,
    new_image,
    new_material,
    new_world,
    node,
    output_of,
    surface,
)

from specula.export import compat
from specula.export.desc import (
    NONE,
    AlphaMode,
    AttributeKind,
    AttributeNeed,
    ColorSpace,
    Visibility,
)
from specula.export.image import Images
from specula.export.log import ExportLog
from specula.export.material import export_material
from specula.export.nodes import NODES
from specula.inquiry import Inquiry
from specula.upload import upload

OLD_PRINCIPLED = bpy.app.version < (4, 0, 0)


def uv_needs(*layers, tangents=frozenset()):
    """What a material needs that reads UV layers, of some their tangents."""
    return frozenset(AttributeNeed(AttributeKind.UV, name, name in tangents) for name in layers)


def convert(material):
    """(MaterialDesc, AttributeKind, AttributeNeed, warnings, images)"""
    log = ExportLog()
    images = Images(log)
    desc = export_material(material, images, log)
    with Inquiry() as core:
        needs = core.needs(core.add(desc, images.descs))
    return desc, needs, log.warnings, images.descs


def set_input(blender_node, name, value):
    compat.find_input(blender_node, name).default_value = value


def group_with(material, inner, socket_type, interface_name):
    """A group node in `material` whose group has one output; returns (group node, group tree)."""
    tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket(interface_name, in_out="OUTPUT", socket_type=socket_type)
    else:
        tree.outputs.new(socket_type, interface_name)
    result = tree.nodes.new("NodeGroupOutput")
    shader = tree.nodes.new(inner)
    tree.links.new(shader.outputs[0], result.inputs[0])
    group = material.node_tree.nodes.new("ShaderNodeGroup")
    group.node_tree = tree
    return group, shader


def add_group_input(group, name, socket_type):
    tree = group.node_tree
    if hasattr(tree, "interface"):
        tree.interface.new_socket(name, in_out="INPUT", socket_type=socket_type)
    else:
        tree.inputs.new(socket_type, name)
    return tree.nodes.new("NodeGroupInput")


def test_constants_and_options_of_a_shader():
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfGlass", surface(material), distribution="GGX")
    set_input(shader, "IOR", 1.33)
    set_input(shader, "Roughness", 0.25)
    desc, needs, warnings, _ = convert(material)
    glass = node(desc, "bsdf_glass")
    assert links(desc) == {"bsdf_glass.BSDF -> output.Surface"}
    assert glass.options == {"distribution": "GGX"}
    assert glass.inputs["IOR"][0] == pytest.approx(1.33)
    assert glass.inputs["Roughness"][0] == pytest.approx(0.25)
    assert glass.inputs["Color"] == (1, 1, 1, 1)
    assert "Normal" not in glass.inputs
    assert glass.image == NONE
    assert (needs, warnings) == (frozenset(), [])


def test_only_reachable_nodes_are_exported():
    material = new_material()
    add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    add_node(material, "ShaderNodeAmbientOcclusion")
    desc, _, warnings, _ = convert(material)
    assert [n.kind for n in desc.nodes] == ["output", "bsdf_diffuse"]
    assert warnings == []


def test_the_output_for_cycles_wins():
    material = new_material()
    output_of(material).target = "EEVEE"
    add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    other = add_node(material, "ShaderNodeOutputMaterial", target="CYCLES")
    add_node(material, "ShaderNodeEmission", other.inputs["Surface"])
    desc, *_ = convert(material)
    assert links(desc) == {"emission.Emission -> output.Surface"}


def test_no_output_and_no_nodes():
    material = new_material()
    material.node_tree.nodes.clear()
    desc, *_ = convert(material)
    assert [n.kind for n in desc.nodes] == ["output"]


def test_mix_and_a_shared_node_once():
    material = new_material()
    mix = add_node(material, "ShaderNodeMixShader", surface(material))
    one = add_node(material, "ShaderNodeBsdfDiffuse", mix.inputs[1])
    two = add_node(material, "ShaderNodeBsdfTransparent", mix.inputs[2])
    rgb = add_node(material, "ShaderNodeRGB", one.inputs["Color"])
    rgb.outputs[0].default_value = (0.1, 0.2, 0.3, 1)
    material.node_tree.links.new(rgb.outputs[0], two.inputs["Color"])
    desc, *_ = convert(material)
    assert links(desc) == {
        "mix_shader.Shader -> output.Surface",
        "bsdf_diffuse.BSDF -> mix_shader.Shader",
        "bsdf_transparent.BSDF -> mix_shader.Shader_001",
        "rgb.Color -> bsdf_diffuse.Color",
        "rgb.Color -> bsdf_transparent.Color",
    }
    assert node(desc, "mix_shader").inputs == {"Fac": (0.5, 0.5, 0.5, 1.0)}
    assert node(desc, "rgb").inputs["Color"] == pytest.approx((0.1, 0.2, 0.3, 1))


def test_groups_are_flattened_both_ways():
    material = new_material()
    group, shader = group_with(material, "ShaderNodeBsdfDiffuse", "NodeSocketShader", "Shader")
    inside = add_group_input(group, "Tint", "NodeSocketColor")
    group.node_tree.links.new(inside.outputs[0], shader.inputs["Color"])
    material.node_tree.links.new(group.outputs[0], surface(material))
    group.inputs[0].default_value = (0.5, 0.25, 0.125, 1)
    desc, *_ = convert(material)
    assert links(desc) == {"bsdf_diffuse.BSDF -> output.Surface"}
    assert node(desc, "bsdf_diffuse").inputs["Color"] == (0.5, 0.25, 0.125, 1)

    add_node(material, "ShaderNodeRGB", group.inputs[0])
    desc, *_ = convert(material)
    assert "rgb.Color -> bsdf_diffuse.Color" in links(desc)


def test_one_group_used_twice_keeps_its_uses_apart():
    material = new_material()
    mix = add_node(material, "ShaderNodeMixShader", surface(material))
    group, shader = group_with(material, "ShaderNodeBsdfDiffuse", "NodeSocketShader", "Shader")
    inside = add_group_input(group, "Rough", "NodeSocketFloat")
    group.node_tree.links.new(inside.outputs[0], shader.inputs["Roughness"])
    second = material.node_tree.nodes.new("ShaderNodeGroup")
    second.node_tree = group.node_tree
    for value, user, socket in ((0.25, group, 1), (0.75, second, 2)):
        user.inputs[0].default_value = value
        material.node_tree.links.new(user.outputs[0], mix.inputs[socket])
    desc, *_ = convert(material)
    roughness = [n.inputs["Roughness"][0] for n in desc.nodes if n.kind == "bsdf_diffuse"]
    assert roughness == [0.25, 0.75]


def test_a_colour_given_to_a_group_for_a_scalar_is_its_luminance():
    material = new_material()
    group, shader = group_with(material, "ShaderNodeBsdfDiffuse", "NodeSocketShader", "Shader")
    inside = add_group_input(group, "Mask", "NodeSocketColor")
    group.node_tree.links.new(inside.outputs[0], shader.inputs["Roughness"])
    material.node_tree.links.new(group.outputs[0], surface(material))
    group.inputs[0].default_value = (0, 1, 0, 1)
    desc, *_ = convert(material)
    assert node(desc, "bsdf_diffuse").inputs["Roughness"][0] == pytest.approx(0.7152, abs=1e-4)


def test_reroutes_and_muted_nodes_are_seen_through():
    material = new_material()
    tree = material.node_tree
    reroute = add_node(material, "NodeReroute", surface(material))
    mix = add_node(material, "ShaderNodeMixShader", reroute.inputs[0])
    add_node(material, "ShaderNodeBsdfDiffuse", mix.inputs[1])
    mix.mute = True
    tree.update_tag()
    desc, *_ = convert(material)
    assert links(desc) == {"bsdf_diffuse.BSDF -> output.Surface"}


def test_a_muted_link_is_no_link():
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    add_node(material, "ShaderNodeRGB", shader.inputs["Color"])
    shader.inputs["Color"].links[0].is_muted = True
    desc, *_ = convert(material)
    assert [n.kind for n in desc.nodes] == ["output", "bsdf_diffuse"]
    assert "Color" in node(desc, "bsdf_diffuse").inputs


@pytest.mark.parametrize(
    ("shader", "reader", "socket_type"),
    [
        ("ShaderNodeBsdfDiffuse", "Normal", "NodeSocketVector"),
        ("ShaderNodeBsdfPrincipled", "Coat Normal", "NodeSocketVector"),
        ("ShaderNodeTexImage", "Vector", "NodeSocketColor"),
    ],
)
def test_a_constant_of_a_group_does_not_replace_what_a_surface_has(shader, reader, socket_type):
    material = new_material()
    group, inner = group_with(material, shader, "NodeSocketShader", "Shader")
    inputs = add_group_input(group, "In", socket_type)
    group.node_tree.links.new(inputs.outputs[0], compat.find_input(inner, reader))
    material.node_tree.links.new(group.outputs[0], surface(material))
    desc, needs, _, _ = convert(material)
    assert all(reader not in n.inputs for n in desc.nodes)
    assert needs == (uv_needs("") if reader == "Vector" else frozenset())


def test_a_hidden_value_of_a_group_counts():
    material = new_material()
    group, emission = group_with(material, "ShaderNodeEmission", "NodeSocketShader", "Shader")
    inputs = add_group_input(group, "Color", "NodeSocketColor")
    group.node_tree.links.new(inputs.outputs[0], emission.inputs["Color"])
    group.inputs[0].default_value, group.inputs[0].hide_value = (0.5, 0.25, 0.75, 1), True
    material.node_tree.links.new(group.outputs[0], surface(material))
    assert node(convert(material)[0], "emission").inputs["Color"] == (0.5, 0.25, 0.75, 1)


DEAD_ENDS = {
    "reroute": ("NodeReroute", {}),
    "muted texture": ("ShaderNodeTexImage", {"mute": True}),
    "muted value": ("ShaderNodeRGB", {"mute": True}),
    "muted filter": ("ShaderNodeGamma", {"mute": True}),
    "empty group": ("ShaderNodeGroup", {}),
}


@pytest.mark.parametrize("name", DEAD_ENDS)
def test_a_link_with_nothing_behind_it_is_none(name):
    """As in Cycles 5.0; 3.4 took black for some of these."""
    bl_idname, properties = DEAD_ENDS[name]
    material = new_material()
    emission = add_node(material, "ShaderNodeEmission", surface(material))
    emission.inputs["Color"].default_value = (0.5, 0.25, 0.75, 1)
    end = add_node(material, bl_idname, **properties)
    if bl_idname == "ShaderNodeGroup":
        end.node_tree = group_with(material, "ShaderNodeRGB", "NodeSocketColor", "Color")[
            0
        ].node_tree
    material.node_tree.links.new(end.outputs[0], emission.inputs["Color"])
    if bl_idname == "ShaderNodeGroup":
        end.node_tree.nodes.clear()
    desc, _, warnings, _ = convert(material)
    assert node(desc, "emission").inputs["Color"] == (0.5, 0.25, 0.75, 1)
    assert warnings == []


def test_unknown_shader_is_magenta_and_warned_of_once():
    material = new_material("strange")
    mix = add_node(material, "ShaderNodeMixShader", surface(material))
    strange = add_node(material, "ShaderNodeEeveeSpecular", mix.inputs[1])
    material.node_tree.links.new(strange.outputs[0], mix.inputs[2])
    desc, _, warnings, _ = convert(material)
    assert all(n.inputs["Color"] == (1, 0, 1, 1) for n in desc.nodes if n.kind == "emission")
    assert "emission.Emission -> mix_shader.Shader" in links(desc)
    (warning,) = warnings
    assert "material strange" in warning
    assert strange.name in warning


def test_unknown_value_node_leaves_the_reader_its_constant(monkeypatch):
    monkeypatch.delitem(NODES, "ShaderNodeGamma")
    material = new_material("noisy")
    shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    shader.inputs["Color"].default_value = (0.25, 0.5, 0.75, 1)
    add_node(material, "ShaderNodeGamma", shader.inputs["Color"])
    desc, _, warnings, _ = convert(material)
    assert node(desc, "bsdf_diffuse").inputs["Color"] == (0.25, 0.5, 0.75, 1)
    assert len(warnings) == 1
    assert "material noisy, node Gamma" in warnings[0]


def test_settings_that_are_not_modelled_are_named():
    material = new_material()
    volume = add_node(material, "ShaderNodeVolumePrincipled", output_of(material).inputs["Volume"])
    set_input(volume, "Emission Strength", 0.5)
    _, _, warnings, _ = convert(material)
    assert any("Emission Strength" in warning for warning in warnings), warnings


@pytest.mark.parametrize("method", ["BUMP", "DISPLACEMENT", "BOTH"])
def test_displacement_is_exported_with_what_it_does(method):
    material = new_material()
    add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    add_node(
        material,
        "ShaderNodeDisplacement",
        output_of(material).inputs["Displacement"],
        space="WORLD",
    )
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = method
    desc, _, warnings, _ = convert(material)
    assert not warnings
    assert desc.displacement == compat.DISPLACEMENTS[method]
    assert node(desc, "displacement").options == {"space": "WORLD"}
    assert "displacement.Displacement -> output.Displacement" in links(desc)


def test_principled_has_the_names_of_blender_5():
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfPrincipled", surface(material))
    for name, value in {
        "Transmission Weight": 0.5,
        "Specular IOR Level": 0.25,
        "Emission Color": (1, 0, 0, 1),
        "Emission Strength": 2.0,
        "IOR": 1.25,
    }.items():
        set_input(shader, name, value)
    desc, _, warnings, _ = convert(material)
    inputs = node(desc, "bsdf_principled").inputs
    absent = {"Normal", "Coat Normal", "Tangent"}
    if OLD_PRINCIPLED:
        absent |= {"Coat IOR", "Coat Tint", "Diffuse Roughness", "Sheen Roughness"}
        absent |= {"Thin Film Thickness", "Thin Film IOR"}
    assert set(inputs) == set(NODES["ShaderNodeBsdfPrincipled"].inputs) - absent
    assert inputs["Transmission Weight"][0] == 0.5
    assert inputs["Specular IOR Level"][0] == 0.25
    assert inputs["Emission Color"] == (1, 0, 0, 1)
    assert inputs["Emission Strength"][0] == 2.0
    assert inputs["IOR"][0] == 1.25
    assert inputs["Specular Tint"] == (1, 1, 1, 1)
    assert warnings == []


def test_coat():
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfPrincipled", surface(material))
    set_input(shader, "Coat Weight", 0.8)
    set_input(shader, "Coat Roughness", 0.25)
    normal = add_node(material, "ShaderNodeNormalMap", compat.find_input(shader, "Coat Normal"))
    add_node(material, "ShaderNodeTexImage", normal.inputs["Color"], image=new_image())
    desc, needs, warnings, _ = convert(material)
    inputs = node(desc, "bsdf_principled").inputs
    assert inputs["Coat Weight"][0] == pytest.approx(0.2 if OLD_PRINCIPLED else 0.8)
    assert inputs["Coat Roughness"][0] == 0.25
    assert inputs.get("Coat IOR", (1.5,))[0] == 1.5
    assert "normal_map.Normal -> bsdf_principled.Coat Normal" in links(desc)
    assert needs == uv_needs("", tangents={""})
    assert warnings == []


@pytest.mark.skipif(not OLD_PRINCIPLED, reason="Clearcoat is Coat Weight since 4.0")
def test_a_textured_clearcoat_has_a_lower_index():
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfPrincipled", surface(material))
    add_node(material, "ShaderNodeTexImage", shader.inputs["Clearcoat"], image=new_image())
    desc, *_ = convert(material)
    assert node(desc, "bsdf_principled").inputs["Coat IOR"][0] == 1.2  # as Blender 5.0 opens it
    assert "image_texture.Color -> bsdf_principled.Coat Weight" in links(desc)


def volume(material):
    return output_of(material).inputs["Volume"]


def test_volumes_that_absorb():
    material = new_material()
    add_node(material, "ShaderNodeBsdfGlass", surface(material))
    add = add_node(material, "ShaderNodeAddShader", volume(material))
    absorption = add_node(material, "ShaderNodeVolumeAbsorption", add.inputs[0])
    absorption.inputs["Color"].default_value = (0.25, 0.5, 1, 1)
    absorption.inputs["Density"].default_value = 3.0
    principled = add_node(material, "ShaderNodeVolumePrincipled", add.inputs[1])
    principled.inputs["Color"].default_value = (0, 0, 0, 1)
    desc, needs, warnings, _ = convert(material)
    assert links(desc) == {
        "bsdf_glass.BSDF -> output.Surface",
        "add_shader.Shader -> output.Volume",
        "volume_absorption.Volume -> add_shader.Shader",
        "volume_principled.Volume -> add_shader.Shader_001",
    }
    absorbs = node(desc, "volume_absorption").inputs
    assert absorbs == {"Color": (0.25, 0.5, 1, 1), "Density": (3, 3, 3, 1)}
    assert set(node(desc, "volume_principled").inputs) == {"Color", "Density", "Absorption Color"}
    assert (needs, warnings) == (frozenset(), [])


def test_a_volume_alone_has_an_invisible_surface():
    material = new_material()
    add_node(material, "ShaderNodeVolumeAbsorption", volume(material))
    desc, _, warnings, _ = convert(material)
    assert links(desc) == {
        "bsdf_transparent.BSDF -> output.Surface",
        "volume_absorption.Volume -> output.Volume",
    }
    assert node(desc, "bsdf_transparent").inputs["Color"] == (1, 1, 1, 1)
    assert warnings == []


def test_what_volumes_cannot_do_is_named():
    fog = new_material("fog")
    scatter = add_node(fog, "ShaderNodeVolumeScatter", volume(fog))
    desc, _, warnings, _ = convert(fog)
    assert links(desc) == {"bsdf_transparent.BSDF -> output.Surface"}
    assert len(warnings) == 1
    assert f"material fog, node {scatter.name}" in warnings[0]
    assert "volume" in warnings[0]
    fire = new_material("fire")
    principled = add_node(fire, "ShaderNodeVolumePrincipled", volume(fire))
    principled.inputs["Blackbody Intensity"].default_value = 1.0
    assert "Blackbody Intensity" in convert(fire)[2][0]
    world = new_world("mist")
    add_node(world, "ShaderNodeBackground", surface(world))
    add_node(world, "ShaderNodeVolumeAbsorption", volume(world))
    scene, warnings = export()
    assert links(scene.materials[scene.environment.material]) == {
        "background.Background -> output.Surface"
    }
    assert len(warnings) == 1
    assert "world mist" in warnings[0]


@pytest.mark.skipif(not OLD_PRINCIPLED, reason="Specular Tint is a colour since 4.0")
def test_scalar_specular_tint_mixes_towards_the_base_colour():
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfPrincipled", surface(material))
    set_input(shader, "Base Color", (0.2, 0.4, 0.6, 1))
    set_input(shader, "Specular Tint", 0.4)
    desc, *_ = convert(material)
    tint = node(desc, "bsdf_principled").inputs["Specular Tint"]
    assert tint == pytest.approx((0.68, 0.76, 0.84, 1), abs=1e-6)  # as Blender 5.0 opens it


def test_sharp_is_ggx_of_roughness_zero():
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfGlossy", surface(material))
    set_input(shader, "Roughness", 0.5)
    try:
        shader.distribution = "SHARP"
    except TypeError:
        pytest.skip("no SHARP in this Blender")
    desc, _, warnings, _ = convert(material)
    glossy = node(desc, "bsdf_glossy")
    assert glossy.options == {"distribution": "GGX"}
    assert glossy.inputs["Roughness"][0] == 0.0
    assert warnings == []


def test_an_unknown_choice_falls_back_with_a_warning(monkeypatch):
    known = replace(NODES["ShaderNodeNormalMap"], options={"space": ("TANGENT", "OBJECT")})
    monkeypatch.setitem(NODES, "ShaderNodeNormalMap", known)
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    add_node(material, "ShaderNodeNormalMap", shader.inputs["Normal"], space="BLENDER_OBJECT")
    desc, _, warnings, _ = convert(material)
    assert node(desc, "normal_map").options["space"] == "TANGENT"
    assert "BLENDER_OBJECT" in warnings[0]


def test_normal_map_reads_tangents_of_its_layer():
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    normal = add_node(material, "ShaderNodeNormalMap", shader.inputs["Normal"], uv_map="detail")
    add_node(material, "ShaderNodeTexImage", normal.inputs["Color"], image=new_image())
    desc, needs, *_ = convert(material)
    assert node(desc, "normal_map").options == {"space": "TANGENT", "uv_map": "detail"}
    assert needs == uv_needs("", "detail", tangents={"detail"})
    normal.space = "WORLD"
    assert convert(material)[1] == uv_needs("")


def test_bump_and_the_height_that_it_reads():
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfGlass", surface(material))
    bump = add_node(material, "ShaderNodeBump", shader.inputs["Normal"])
    bump.inputs["Distance"].default_value = 0.25
    bump.invert = True
    add_node(material, "ShaderNodeTexImage", bump.inputs["Height"], image=new_image())
    desc, needs, warnings, _ = convert(material)
    assert node(desc, "bump").options == {"invert": "True"}
    assert node(desc, "bump").inputs["Distance"][0] == 0.25
    assert needs == uv_needs("")
    assert not warnings
    bump.invert = False
    assert node(convert(material)[0], "bump").options == {"invert": "False"}


@pytest.mark.parametrize(("output", "kind"), [("UV", "UV"), ("Generated", "GENERATED")])
def test_texture_coordinates_need_what_is_read(output, kind):
    material = new_material()
    shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    texture = add_node(material, "ShaderNodeTexImage", shader.inputs["Color"], image=new_image())
    mapping = add_node(material, "ShaderNodeMapping", texture.inputs["Vector"])
    coordinate = add_node(material, "ShaderNodeTexCoord", mapping.inputs["Vector"], output)
    assert coordinate.outputs[output].is_linked
    desc, needs, warnings, _ = convert(material)
    assert needs == {AttributeNeed(AttributeKind[kind])}
    assert node(desc, "mapping").options == {"vector_type": "POINT"}
    assert f"texture_coordinate.{output} -> mapping.Vector" in links(desc)
    assert warnings == []


def test_one_image_for_two_users():
    image = new_image()
    for name in ("a", "b"):
        material = new_material(name)
        shader = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
        add_node(material, "ShaderNodeTexImage", shader.inputs["Color"], image=image)
        add_mesh(material=material)
    scene, _ = export()
    assert len(scene.images) == 1
    assert {node(m, "image_texture").image for m in scene.materials} == {0}


def added(image, user="test", **properties):
    """(ImageDesc, warnings) of adding one image."""
    log = ExportLog()
    images = Images(log, **properties)
    images.add(image, image_user(), user)
    return images.descs[0], log.warnings


def image_user(**properties):
    node = add_node(new_material(), "ShaderNodeTexImage")
    for name, value in properties.items():
        setattr(node.image_user, name, value)
    return node.image_user


def test_generated_image_gives_pixels_from_the_bottom_up():
    image = bpy.data.images.new("Ramp", 2, 3, float_buffer=True)
    pixels = np.arange(24, dtype=np.float32) / 24
    image.pixels.foreach_set(pixels)
    desc, _ = added(image)
    np.testing.assert_array_equal(desc.pixels, pixels.reshape(3, 2, 4))
    assert desc.color_space == ColorSpace.LINEAR
    assert (desc.path, desc.encoded) == (None, None)


@pytest.fixture
def image_file(tmp_path):
    """An image that was loaded from a PNG file."""
    image = new_image()
    image.file_format = "PNG"
    image.filepath_raw = str(tmp_path / "texture.png")
    image.save()
    return bpy.data.images.load(str(tmp_path / "texture.png"))


def test_image_file_is_left_to_the_core(image_file):
    image_file.alpha_mode = "NONE"
    image_file.colorspace_settings.name = "Non-Color"
    desc, warnings = added(image_file)
    assert desc.path == image_file.filepath
    assert desc.pixels is None
    assert desc.color_space == ColorSpace.DATA
    assert desc.alpha_mode == AlphaMode.NONE
    assert warnings == []


def test_painted_image_gives_its_pixels(image_file):
    image_file.pixels[0] = 1.0
    assert image_file.is_dirty
    desc, _ = added(image_file)
    assert desc.path is None
    assert desc.pixels.dtype == np.uint8
    assert desc.pixels[0, 0, 0] == 255
    assert desc.color_space == ColorSpace.SRGB


@pytest.mark.parametrize("packed", [False, True])
def test_blender_decodes_images_for_a_core_that_does_not(image_file, packed):
    if packed:
        image_file.pack()
    desc, _ = added(image_file, as_pixels=True)
    assert (desc.path, desc.encoded) == (None, None)
    assert (desc.pixels.shape, desc.pixels.dtype) == ((4, 4, 4), np.uint8)
    assert (desc.color_space, desc.alpha_mode) == (ColorSpace.SRGB, AlphaMode.STRAIGHT)


def test_packed_image_gives_its_bytes(image_file, tmp_path):
    image_file.pack()
    (tmp_path / "texture.png").unlink()
    desc, warnings = added(image_file)
    assert desc.encoded.startswith(b"\x89PNG")
    assert warnings == []


def test_node_without_image_is_magenta():
    desc, warnings = added(None, "material m, node n")
    assert desc.pixels.tolist() == [[[255, 0, 255, 255]]]
    assert warnings == ["material m, node n: has no image, shown in magenta"]


def test_missing_file_is_magenta():
    image = bpy.data.images.new("gone", 1, 1)
    image.source = "FILE"
    image.filepath = "/nowhere/gone.png"
    desc, warnings = added(image)
    assert desc.pixels.tolist() == [[[255, 0, 255, 255]]]
    assert warnings == ["image gone: /nowhere/gone.png is missing, shown in magenta"]


def test_bytes_in_memory_are_straight_whatever_their_file_is():
    image = bpy.data.images.new("Cut", 4, 4, alpha=True)
    image.alpha_mode = "PREMUL"
    desc, _ = added(image)
    assert desc.alpha_mode == AlphaMode.STRAIGHT


@pytest.mark.parametrize("size", [(3, 5), (1200, 900)])
@pytest.mark.parametrize("alpha", [True, False])
def test_bytes_in_memory_are_exact(size, alpha):
    """The larger one goes through in several parts."""
    image = bpy.data.images.new("Noise", *size, alpha=alpha)
    count = size[0] * size[1] * image.channels
    wanted = np.random.default_rng(1).integers(0, 256, count, np.uint8)
    image.pixels.foreach_set(wanted.astype(np.float32) / 255)
    desc, _ = added(image)
    assert desc.pixels.dtype == np.uint8
    np.testing.assert_array_equal(desc.pixels.ravel(), wanted)
    # Nothing keeps the floats that it was made of.
    owner = desc.pixels
    while owner.base is not None:
        owner = owner.base
    assert owner.nbytes <= wanted.nbytes + 3


@pytest.fixture
def sequence(tmp_path):
    """An image sequence of the numbers 0 to 9, whose red is ten times the number, of 255."""
    for number in range(10):
        save_color(tmp_path / f"take2_{number:04}.png", 10 * number / 255)
    image = bpy.data.images.load(str(tmp_path / "take2_0000.png"))
    image.source = "SEQUENCE"
    return image


def save_color(path, red):
    image = new_image(path.stem)
    image.pixels.foreach_set([red, 0, 0, 1] * 16)
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()


# As Cycles shows them: frame_start, frame_offset, frame_duration, use_cyclic, frame -> number.
SHOWN = [
    (1, 0, 5, False, -3, 0),
    (1, 0, 5, False, 1, 1),
    (1, 0, 5, False, 3, 3),
    (1, 0, 5, False, 9, 5),
    (1, 0, 5, True, -3, 2),
    (1, 0, 5, True, 0, 5),
    (1, 0, 5, True, 9, 4),
    (3, 0, 5, False, 5, 3),
    (1, 2, 3, False, -3, 2),
    (1, 2, 3, False, 3, 5),
    (1, 0, 2, True, 0, 2),
]


@pytest.mark.parametrize(("start", "offset", "count", "cyclic", "frame", "number"), SHOWN)
def test_a_sequence_shows_the_file_of_its_frame(
    sequence, tmp_path, start, offset, count, cyclic, frame, number
):
    user = image_user(
        frame_start=start, frame_offset=offset, frame_duration=count, use_cyclic=cyclic
    )
    log = ExportLog()
    images = Images(log, frame=frame)
    images.add(sequence, user, "user")
    assert images.descs[0].path == str(tmp_path / f"take2_{number:04}.png")
    assert log.warnings == []


def test_a_sequence_without_the_file_is_magenta(sequence, tmp_path):
    images = Images(ExportLog(), frame=30)
    images.add(sequence, image_user(frame_duration=50), "user")
    assert images.descs[0].pixels.tolist() == [[[255, 0, 255, 255]]]


def test_blender_decodes_the_frame_of_a_sequence(sequence):
    before = len(bpy.data.images)
    images = Images(ExportLog(), as_pixels=True, frame=7)
    for start in (1, 3, 1):
        images.add(sequence, image_user(frame_duration=20, frame_start=start), "user")
    assert [desc.pixels[0, 0, 0] for desc in images.descs] == [70, 50]
    assert len(bpy.data.images) == before


@pytest.mark.parametrize("name", ["skin.<UDIM>.png", "skin.<UVTILE>.png"])
def test_a_udim_has_an_image_for_each_tile(tmp_path, name):
    numbers = ("1001", "1012") if "UDIM" in name else ("u1_v1", "u2_v2")
    for number in numbers:
        save_color(tmp_path / f"skin.{number}.png", 0.5)
    image = bpy.data.images.load(str(tmp_path / f"skin.{numbers[0]}.png"))
    image.source = "TILED"
    image.filepath = str(tmp_path / name)
    if len(image.tiles) == 1:
        image.tiles.new(1012)
    images = Images(ExportLog())
    assert images.add(image, None, "user") == 0
    assert images.tiles(image) == [(0, 0), (11, 1)]
    paths = [str(tmp_path / f"skin.{number}.png") for number in numbers]
    assert [desc.path for desc in images.descs] == paths
    image.tiles.remove(image.tiles[1])
    image.tiles[0].number = 1012
    assert images.tiles(image) == []
    desc, warnings = added(image)
    assert desc.path == str(tmp_path / f"skin.{numbers[1]}.png")
    assert warnings == []


def test_a_movie_without_pixels_is_magenta(image_file):
    image_file.source = "MOVIE"
    desc, warnings = added(image_file)
    assert desc.pixels.tolist() == [[[255, 0, 255, 255]]]
    assert "has no pixels" in warnings[-1]


def test_unknown_colour_space_is_named():
    image = new_image("odd")
    image.colorspace_settings.name = "Filmic sRGB"
    desc, warnings = added(image)
    assert desc.color_space == ColorSpace.SRGB
    assert warnings == ["image odd: colour space Filmic sRGB is not supported, sRGB is used"]


def test_world_is_a_background_graph():
    world = new_world()
    background = add_node(world, "ShaderNodeBackground", surface(world))
    add_node(world, "ShaderNodeTexEnvironment", background.inputs["Color"], image=new_image())
    world.specula.caustics = False
    world.cycles_visibility.camera = False
    scene, warnings = export()
    desc = scene.materials[scene.environment.material]
    assert links(desc) == {
        "background.Background -> output.Surface",
        "environment_texture.Color -> background.Color",
    }
    assert node(desc, "environment_texture").options["projection"] == "EQUIRECTANGULAR"
    assert scene.environment.feeds_caustics is False
    assert scene.environment.visibility == Visibility.ALL & ~Visibility.CAMERA
    assert warnings == []


def test_a_background_on_a_surface_is_an_emission():
    material = new_material()
    mix = add_node(material, "ShaderNodeMixShader", surface(material))
    add_node(material, "ShaderNodeBackground", mix.inputs[1])
    desc, *_ = convert(material)
    assert links(desc) == {
        "emission.Emission -> mix_shader.Shader",
        "mix_shader.Shader -> output.Surface",
    }


@pytest.mark.parametrize("bl_idname", [None, "ShaderNodeEmission", "ShaderNodeAmbientOcclusion"])
def test_every_world_has_a_background(bl_idname):
    world = new_world()
    if bl_idname:
        add_node(world, bl_idname, surface(world))
    scene, _ = export()
    with upload(scene) as native_scene:
        native_scene.commit(1)
    assert node(scene.materials[0], "background").inputs["Strength"] == (0, 0, 0, 1)


def test_no_world_is_no_environment():
    bpy.context.scene.world = None
    assert export()[0].environment is None


@pytest.mark.parametrize("glints", ["AUTO", "ON", "OFF"])
def test_glints(glints):
    material = new_material()
    add_node(material, "ShaderNodeBsdfGlossy", surface(material))
    material.specula.glints = glints
    assert convert(material)[0].glints.name == glints
