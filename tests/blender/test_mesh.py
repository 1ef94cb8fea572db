# SPDX-License-Identifier: GPL-3.0-or-later
import time

import bpy
import numpy as np
import pytest
from scenes import QUAD, add_mesh, add_node, add_uv, export, new_image, new_material, surface

# A pentagon beside a quad, in one plane.
NGON = [(-1, -1, 0), (0, -1, 0), (0, 0, 0), (-1, 0, 0), (1, -1, 0), (1.5, 0, 0), (0.5, 0.5, 0)]
NGON_FACES = [(0, 1, 2, 3), (1, 4, 5, 6, 2)]
TENT = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, 0, 1)]
TENT_FACES = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
MILLION_GRID = 708  # vertices along an edge: 2 * 707^2 triangles
EXPORT_SECONDS = 15.0  # loose: the machine may be busy; 4 s is the aim


def only_mesh():
    scene, _ = export()
    (mesh,) = scene.meshes
    return mesh


def set_smooth(mesh, smooth: bool) -> None:
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    mesh.update()


def honour_normals(mesh) -> None:
    """Until 4.0 custom normals and sharp edges had to be switched on."""
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = np.pi


def image_material(name="textured", uv_map=None):
    material = new_material(name)
    diffuse = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    texture = add_node(material, "ShaderNodeTexImage", diffuse.inputs["Color"], image=new_image())
    if uv_map is not None:
        add_node(material, "ShaderNodeUVMap", texture.inputs["Vector"], uv_map=uv_map)
    return material


def normal_material(name="bumpy", uv_map=""):
    material = new_material(name)
    diffuse = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
    add_node(material, "ShaderNodeNormalMap", diffuse.inputs["Normal"], uv_map=uv_map)
    return material


def test_triangles_and_positions():
    add_mesh()
    mesh = only_mesh()
    np.testing.assert_array_equal(mesh.positions, np.array(QUAD, np.float32))
    assert mesh.positions.dtype == np.float32
    assert mesh.triangles.dtype == np.uint32
    assert mesh.triangles.shape == (2, 3)
    assert set(mesh.triangles.ravel()) == {0, 1, 2, 3}
    a, b, c = (mesh.positions[mesh.triangles[:, i]] for i in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_flat_faces_have_no_normals():
    set_smooth(add_mesh(vertices=TENT, faces=TENT_FACES).data, False)
    assert only_mesh().normals is None


def test_smooth_normals_agree_at_a_vertex():
    set_smooth(add_mesh(vertices=TENT, faces=TENT_FACES).data, True)
    mesh = only_mesh()
    assert mesh.normals.shape == (4, 3, 3)
    at_top = mesh.normals[mesh.triangles == 4]
    np.testing.assert_allclose(at_top, [(0, 0, 1)] * 4, atol=1e-5)


def test_mixed_shading_has_both_normals():
    obj = add_mesh(vertices=TENT, faces=TENT_FACES)
    set_smooth(obj.data, True)
    obj.data.polygons[0].use_smooth = False
    mesh = only_mesh()
    np.testing.assert_allclose(mesh.normals[0], [obj.data.polygons[0].normal] * 3, atol=1e-5)
    assert not np.allclose(mesh.normals[1][0], mesh.normals[1][2])


def test_custom_normals_are_kept():
    data = add_mesh().data
    set_smooth(data, True)
    custom = np.array([(0.6, 0, 0.8)] * 4)
    data.normals_split_custom_set(custom)
    honour_normals(data)
    np.testing.assert_allclose(only_mesh().normals.reshape(-1, 3), [custom[0]] * 6, atol=1e-3)


def test_sharp_edges_split_normals():
    data = add_mesh(vertices=TENT, faces=TENT_FACES).data
    set_smooth(data, True)
    honour_normals(data)
    for edge in data.edges:
        edge.use_edge_sharp = tuple(sorted(edge.vertices)) in {(0, 4), (2, 4)}
    mesh = only_mesh()
    top = mesh.normals[mesh.triangles == 4]  # of the faces around the tip, in order
    np.testing.assert_allclose(top[0], top[1], atol=1e-4)
    np.testing.assert_allclose(top[2], top[3], atol=1e-4)
    assert np.linalg.norm(top[1] - top[2]) > 0.1


def test_material_slots_follow_the_faces():
    obj = add_mesh(vertices=TENT, faces=TENT_FACES, material=new_material("a"))
    obj.data.materials.append(new_material("b"))
    obj.data.polygons.foreach_set("material_index", [0, 1, 0, 7])
    mesh = only_mesh()
    assert mesh.slot_count == 2
    assert mesh.material_slots.dtype == np.uint32
    assert list(mesh.material_slots) == [0, 1, 0, 1]  # beyond the last slot: the last


def test_uv_layers_only_where_read():
    obj = add_mesh(material=new_material())
    add_uv(obj.data)
    assert only_mesh().attributes == []


def test_image_texture_reads_the_layer_active_for_rendering():
    obj = add_mesh(material=image_material())
    add_uv(obj.data, "first")
    second = add_uv(obj.data, "second", scale=0.5)
    second.active_render = True
    mesh = only_mesh()
    (layer,) = mesh.attributes
    assert layer.name == "second"
    assert layer.tangents is None
    uv = layer.values.reshape(-1, 3, 2)
    np.testing.assert_allclose(uv, 0.5 * mesh.positions[mesh.triangles][:, :, :2])


def test_uv_map_node_reads_the_layer_that_it_names():
    obj = add_mesh(material=image_material(uv_map="second"))
    add_uv(obj.data, "first")
    add_uv(obj.data, "second")
    assert [layer.name for layer in only_mesh().attributes] == ["second"]


def test_a_missing_layer_is_left_out():
    add_mesh(material=image_material(uv_map="nowhere"))
    assert only_mesh().attributes == []


def test_a_second_user_that_reads_more_gets_more():
    obj = add_mesh(material=new_material("plain"))
    add_uv(obj.data)
    other = bpy.data.objects.new("Other", obj.data)
    bpy.context.scene.collection.objects.link(other)
    other.material_slots[0].link = "OBJECT"
    other.material_slots[0].material = normal_material()
    mesh = only_mesh()
    assert mesh.attributes[0].tangents is not None


@pytest.mark.parametrize(
    ("vertices", "faces"), [(QUAD, [(0, 1, 2, 3)]), (NGON, NGON_FACES)], ids=["quad", "ngon"]
)
def test_tangents_point_along_u(vertices, faces):
    obj = add_mesh(vertices=vertices, faces=faces, material=normal_material())
    set_smooth(obj.data, True)
    add_uv(obj.data, scale=-2.0)
    mesh = only_mesh()
    (layer,) = mesh.attributes
    corners = len(mesh.triangles) * 3
    assert layer.tangents.dtype == np.float32
    np.testing.assert_allclose(layer.tangents.reshape(-1, 4), [(-1, 0, 0, 1)] * corners, atol=1e-3)
    uv = layer.values.reshape(-1, 3, 2)
    np.testing.assert_allclose(uv, -2.0 * mesh.positions[mesh.triangles][:, :, :2], rtol=1e-6)


def test_tangents_of_a_mirrored_layout_flip_the_sign():
    obj = add_mesh(material=normal_material())
    layer = add_uv(obj.data)
    mirrored = [(-u, v) for u, v in (tuple(item.uv) for item in layer.data)]
    for item, uv in zip(layer.data, mirrored, strict=True):
        item.uv = uv
    tangents = only_mesh().attributes[0].tangents.reshape(-1, 4)
    np.testing.assert_allclose(tangents, [(-1, 0, 0, -1)] * 6, atol=1e-5)


def test_tangents_of_faces_above_four_corners_agree_with_those_of_their_triangles():
    """A bent pentagon with smooth normals: the same triangles entered as a mesh of triangles."""
    pentagon = [(-1, -1, 0), (1, -1, 0.3), (1.5, 0.5, 0), (0, 1, 0.5), (-1.5, 0.5, 0)]
    obj = add_mesh(vertices=pentagon, faces=[(0, 1, 2, 3, 4)], material=normal_material())
    set_smooth(obj.data, True)
    add_uv(obj.data)
    ngon = only_mesh()
    data = bpy.data.meshes.new("Triangles")
    data.from_pydata(pentagon, [], [tuple(int(v) for v in t) for t in ngon.triangles])
    set_smooth(data, True)
    add_uv(data)
    data.normals_split_custom_set(ngon.normals.reshape(-1, 3))
    honour_normals(data)
    data.materials.append(normal_material())
    obj.data = data
    triangles = only_mesh()
    np.testing.assert_array_equal(triangles.triangles, ngon.triangles)
    np.testing.assert_allclose(
        triangles.attributes[0].tangents, ngon.attributes[0].tangents, atol=2e-3
    )


def test_modifiers_are_applied():
    obj = add_mesh()
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type = "SIMPLE"
    modifier.levels, modifier.render_levels = 0, 2
    assert len(only_mesh().triangles) == 32


def test_a_million_triangles_in_seconds():
    from specula.upload import upload

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=MILLION_GRID, y_subdivisions=MILLION_GRID)
    data = bpy.context.object.data
    set_smooth(data, True)
    data.materials.append(image_material())
    assert data.uv_layers
    start = time.process_time()
    scene, _ = export()
    exported = time.process_time()
    assert len(scene.meshes[0].triangles) >= 999_000
    with upload(scene) as native_scene:
        uploaded = time.process_time()
        native_scene.commit()
        committed = time.process_time()
    print(
        f"\n1M triangles: {exported - start:.2f} s render call with export, "
        f"{uploaded - exported:.2f} s upload, {committed - uploaded:.2f} s commit"
    )
    assert committed - start < EXPORT_SECONDS
