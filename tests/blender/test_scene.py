# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
import numpy as np
import pytest
from mathutils import Matrix
from scenes import (
    add_camera,
    add_light,
    add_mesh,
    add_node,
    export,
    link,
    new_image,
    new_material,
    new_world,
    surface,
)

from specula.export.desc import CausticsRole, ExportError, Visibility


def names(scene):
    return sorted(instance.name for instance in scene.instances)


def test_every_kind_of_geometry_arrives_once():
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.object.data.bevel_depth = 0.1
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    bpy.ops.object.text_add()
    bpy.ops.object.metaball_add()
    scene, warnings = export()
    assert len(scene.instances) == len(scene.meshes) == 5
    assert all(len(mesh.triangles) > 0 for mesh in scene.meshes)
    assert warnings == []


def test_curve_keeps_its_material():
    bpy.ops.object.text_add()
    bpy.context.object.data.materials.append(new_material("ink"))
    scene, _ = export()
    (index,) = scene.instances[0].materials
    assert scene.materials[index].name == "ink"


def test_objects_that_share_a_mesh_share_it_here():
    first = add_mesh()
    second = link("Second", first.data)
    second.location.x = 3
    scene, _ = export()
    assert len(scene.meshes) == 1
    assert [instance.mesh for instance in scene.instances] == [0, 0]
    assert scene.instances[0].transform[0, 3] == 0
    assert scene.instances[1].transform[0, 3] == 3


def test_a_modifier_makes_a_mesh_of_its_own():
    first = add_mesh()
    second = link("Second", first.data)
    second.modifiers.new("Array", "ARRAY")
    scene, _ = export()
    assert sorted(len(mesh.triangles) for mesh in scene.meshes) == [2, 4]


def test_collection_instances_share_geometry_and_are_placed():
    obj = add_mesh()
    collection = bpy.data.collections.new("Group")
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    for x in (1.0, 2.0):
        empty = link("Empty", None)
        empty.instance_type = "COLLECTION"
        empty.instance_collection = collection
        empty.location.x = x
    scene, _ = export()
    assert len(scene.meshes) == 1
    assert sorted(i.transform[0, 3] for i in scene.instances) == [1.0, 2.0]


def test_instances_have_the_caustics_role_of_their_object():
    obj = add_mesh()
    obj.specula.caustics = "CASTER"
    collection = bpy.data.collections.new("Group")
    collection.objects.link(obj)
    empty = link("Empty", None)
    empty.instance_type = "COLLECTION"
    empty.instance_collection = collection
    scene, _ = export()
    assert [i.caustics_role for i in scene.instances] == [CausticsRole.CASTER] * 2


def test_vertex_instancer_shows_its_children_and_not_the_child_itself():
    parent = add_mesh("Parent")
    child = add_mesh("Child")
    child.parent = parent
    parent.instance_type = "VERTS"
    parent.show_instancer_for_render = False
    scene, _ = export()
    assert names(scene) == ["Child"] * 4


def test_transform_is_the_world_matrix():
    obj = add_mesh()
    matrix = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.3, 4, "X") @ Matrix.Scale(-2, 4)
    obj.matrix_world = matrix
    scene, _ = export()
    np.testing.assert_allclose(scene.instances[0].transform, np.array(matrix)[:3], atol=1e-6)


def test_hidden_objects_stay_away():
    add_mesh("Shown")
    add_mesh("Hidden").hide_render = True
    excluded = bpy.data.collections.new("Excluded")
    bpy.context.scene.collection.children.link(excluded)
    obj = add_mesh("InExcluded")
    bpy.context.scene.collection.objects.unlink(obj)
    excluded.objects.link(obj)
    bpy.context.view_layer.layer_collection.children["Excluded"].exclude = True
    scene, _ = export()
    assert names(scene) == ["Shown"]


def test_hidden_in_the_viewport_only_is_rendered():
    add_mesh("Shown").hide_viewport = True
    scene, _ = export()
    assert names(scene) == ["Shown"]


def test_ray_visibility_of_object_and_instancer():
    obj = add_mesh()
    obj.visible_camera = False
    obj.visible_shadow = False
    scene, _ = export()
    expected = Visibility.DIFFUSE | Visibility.GLOSSY | Visibility.TRANSMISSION
    assert scene.instances[0].visibility == expected


def in_collection(obj, name="Collection"):
    """Moves `obj` to a new collection; returns that as the view layer has it."""
    collection = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(collection)
    bpy.context.scene.collection.objects.unlink(obj)
    collection.objects.link(obj)
    return bpy.context.view_layer.layer_collection.children[name]


def test_an_indirect_only_collection_is_not_seen_by_the_camera():
    in_collection(add_mesh("Unseen")).indirect_only = True
    add_mesh("Seen")
    scene, warnings = export()
    seen = {instance.name: instance.visibility for instance in scene.instances}
    assert seen == {"Unseen": Visibility.ALL & ~Visibility.CAMERA, "Seen": Visibility.ALL}
    assert warnings == []


def test_a_view_layer_without_environment_has_no_world():
    new_world()
    assert export()[0].environment is not None
    bpy.context.view_layer.use_sky = False
    scene, warnings = export()
    assert (scene.environment, scene.materials, warnings) == (None, [], [])


@pytest.mark.skipif(
    "world_override" not in bpy.types.ViewLayer.bl_rna.properties, reason="no such setting"
)
def test_a_view_layer_has_a_world_of_its_own():
    new_world("Scene's")
    bpy.context.view_layer.world_override = bpy.data.worlds.new("Layer's")
    scene, _ = export()
    assert scene.materials[scene.environment.material].name == "Layer's"


def test_a_view_layer_without_surfaces_has_lights_alone():
    add_mesh()
    add_light()
    bpy.context.view_layer.use_solid = False
    scene, _ = export()
    assert (len(scene.instances), len(scene.lights)) == (0, 1)


def test_a_view_layer_overrides_materials():
    mesh = add_mesh(material=new_material("Own"))
    mesh.data.materials.append(new_material("Other"))
    add_mesh("Bare")
    bpy.context.view_layer.material_override = new_material("Clay")
    scene, _ = export()
    assert [material.name for material in scene.materials] == ["Clay"]
    assert sorted(instance.materials for instance in scene.instances) == [[0], [0, 0]]


def test_what_a_view_layer_leaves_out_is_not_missed():
    add_fur()
    link("Smoke", bpy.data.volumes.new("Smoke"))
    layer = bpy.context.view_layer
    layer.use_strand = layer.use_volumes = False
    assert export()[1] == []


def test_a_mesh_without_faces_is_left_out():
    add_mesh(faces=[])
    scene, warnings = export()
    assert (scene.meshes, scene.instances, warnings) == ([], [], [])


def test_a_scale_of_zero_is_left_out_with_a_warning():
    add_mesh("Flat").scale.x = 0
    scene, warnings = export()
    assert scene.instances == []
    assert warnings == ["object Flat: has a scale of zero, it is not rendered"]


def test_objects_and_collections_are_held_out():
    add_mesh("Hole").is_holdout = True
    add_mesh("Seen")
    in_collection(add_mesh("Cut")).holdout = True
    scene, warnings = export()
    assert warnings == []
    assert {x.name: x.holdout for x in scene.instances} == {
        "Hole": True,
        "Seen": False,
        "Cut": True,
    }


def test_unsupported_objects_are_named_once():
    link("Smoke", bpy.data.volumes.new("Smoke"))
    add_mesh("Catcher").is_shadow_catcher = True
    _, warnings = export()
    assert len(warnings) == 2
    assert any("Catcher" in warning and "shadow catcher" in warning for warning in warnings)
    assert any("Smoke" in warning and "VOLUME" in warning for warning in warnings)


def add_fur():
    obj = add_mesh("Fur")
    obj.modifiers.new("Hair", "PARTICLE_SYSTEM")
    obj.particle_systems[0].settings.type = "HAIR"


def test_hair_is_a_mesh_of_its_own_that_casts_nothing():
    add_fur()
    scene, warnings = export()
    assert warnings == []
    emitter, hair = scene.instances
    assert scene.meshes[hair.mesh].name.startswith("Fur: ")
    assert len(scene.meshes[hair.mesh].triangles) > len(scene.meshes[emitter.mesh].triangles)
    assert hair.caustics_role == CausticsRole.RECEIVER
    bpy.data.objects["Fur"].show_instancer_for_render = False
    assert [x.mesh for x in export()[0].instances] == [0]


def test_stereoscopy_and_motion_blur_are_named():
    render = bpy.context.scene.render
    render.use_motion_blur = render.use_multiview = True
    _, warnings = export()
    assert len(warnings) == 2


def test_settings_of_cycles_that_are_ignored_are_named_once():
    scene = bpy.context.scene
    glass = new_material("Glass")
    mesh, world = add_mesh("Ball", material=glass), new_world("Sky")
    assert export()[1] == []
    own = glass if hasattr(glass, "use_transparent_shadow") else glass.cycles
    own.use_transparent_shadow = False
    scene.cycles.use_fast_gi = True
    mesh.cycles.shadow_terminator_geometry_offset = 0.3
    world.cycles.max_bounces = 0
    _, warnings = export()
    owners = [warning.partition(":")[0] for warning in warnings]
    expected = ["scene", "object Ball", "material Glass", "world Sky"]
    assert sorted(owners) == sorted(expected)


@pytest.mark.parametrize("role", ["AUTO", "CASTER", "RECEIVER", "BOTH", "OFF"])
def test_caustics_role(role):
    add_mesh().specula.caustics = role
    scene, _ = export()
    assert scene.instances[0].caustics_role == CausticsRole[role]


@pytest.mark.parametrize(
    ("caster", "receiver", "role"),
    [
        (False, False, "AUTO"),
        (False, True, "AUTO"),
        (True, False, "CASTER"),
        (True, True, "BOTH"),
    ],
)
def test_caustics_role_follows_the_flags_of_cycles(caster, receiver, role):
    obj = add_mesh()
    obj.cycles.is_caustics_caster = caster
    obj.cycles.is_caustics_receiver = receiver
    scene, _ = export()
    assert scene.instances[0].caustics_role == CausticsRole[role]


def test_material_slots_of_object_and_data():
    data_material, object_material = new_material("data"), new_material("object")
    obj = add_mesh(material=data_material)
    other = link("Other", obj.data)
    other.material_slots[0].link = "OBJECT"
    other.material_slots[0].material = object_material
    scene, _ = export()
    by_name = {i.name: scene.materials[i.materials[0]].name for i in scene.instances}
    assert by_name == {"Mesh": "data", "Other": "object"}
    assert len(scene.meshes) == 1


def test_empty_slot_is_what_cycles_has_there():
    add_mesh().data.materials.append(None)
    add_mesh("NoSlots")
    scene, _ = export()
    kind = "bsdf_principled" if bpy.app.version >= (5, 0, 0) else "bsdf_diffuse"
    assert [m.nodes[1].kind for m in scene.materials] == [kind]
    if kind == "bsdf_diffuse":
        assert scene.materials[0].nodes[1].inputs["Color"] == (0.8, 0.8, 0.8, 1.0)


def test_an_exception_names_its_object(monkeypatch):
    from specula.export import scene

    def broken(*_):
        raise RuntimeError("broken")

    monkeypatch.setattr(scene, "export_mesh", broken)
    add_mesh("Culprit")
    with pytest.raises(ExportError, match="object Culprit: RuntimeError: broken"):
        export()


def test_memory_that_runs_out_names_what_it_was_for(monkeypatch):
    from specula.export import image, scene

    def full(*_):
        raise MemoryError("1 GiB")

    material = new_material()
    emission = add_node(material, "ShaderNodeEmission", surface(material))
    add_node(material, "ShaderNodeTexImage", emission.inputs["Color"], image=new_image("Huge"))
    add_mesh("Mountain", material=material)
    monkeypatch.setattr(image, "_pixels", full)
    with pytest.raises(ExportError, match=r"^image Huge: out of memory \(1 GiB\)$"):
        export()
    monkeypatch.undo()
    monkeypatch.setattr(scene, "export_mesh", full)
    with pytest.raises(ExportError, match=r"^object Mountain: out of memory \(1 GiB\)$"):
        export()


def test_everything_together_reaches_the_core():
    from specula.upload import upload

    add_camera()
    add_light()
    add_mesh()
    scene, _ = export()
    with upload(scene) as native_scene:
        native_scene.commit(1)
        stats = native_scene.stats()
    assert stats["triangles"] == 2
    assert stats["instances"] == 1


def test_terminator_offset():
    add_mesh("Ball").cycles.shadow_terminator_offset = 0.25
    scene, warnings = export()
    assert scene.instances[0].terminator_offset == 0.25
    assert warnings == []
