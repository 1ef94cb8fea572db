# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene descriptions as LuxCore's properties, and one picture of LuxCore against closed forms."""

from __future__ import annotations

import json
import math
import pickle
import subprocess

import numpy as np
import pytest

from tests.instruments.bench import _luxcore
from tests.instruments.bench._description import desc
from tests.instruments.bench._luxcore_textures import (
    Translation,
    UntranslatedError,
    doubled,
    linear_pixels,
)
from tools import venvs
from tools.common import CACHE, ROOT

WHITE = (1.0, 1.0, 1.0, 1.0)
IDENTITY = np.eye(3, 4, dtype=np.float32)

needs_luxcore = pytest.mark.skipif(
    not (CACHE / "luxcore" / venvs.STAMP).exists(),
    reason="LuxCore's environment is not there; tools.venvs.luxcore_python() makes it",
)


def scalar(value: float) -> tuple[float, float, float, float]:
    return (value, value, value, 1.0)


def quad_mesh(**kwargs):
    """The unit square in z = 0, two triangles."""
    positions = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32)
    return desc.MeshDesc("Quad", positions, np.array([(0, 1, 2), (0, 2, 3)], np.uint32), **kwargs)


def camera(**kwargs):
    """Looks down -Z from 4 m; the picture is 2 m wide at z = 0."""
    transform = IDENTITY.copy()
    transform[:, 3] = (0, 0, 4)
    values = {"width": 8, "height": 8, "crop": (0, 0, 8, 8), "viewplane": (-0.25, 0.25) * 2}
    values |= {"clip_near": 0.1, "clip_far": 100.0}
    return desc.CameraDesc(transform, **(values | kwargs))


def scene(nodes=(), links=(), images=(), **kwargs):
    """One square with one material: nodes from index 1 on, the output before them."""
    material = desc.MaterialDesc("Paint", [desc.NodeDesc("Output", "output"), *nodes], [*links])
    return desc.SceneDesc(
        images=[*images],
        materials=[material],
        meshes=[quad_mesh()],
        instances=[desc.InstanceDesc("Square", 0, IDENTITY, [0])],
        camera=camera(),
        **kwargs,
    )


def shaded(kind: str, inputs=None, options=None, nodes=(), links=(), images=()) -> dict:
    """LuxCore's properties for a material of one shader, without their prefix."""
    shader = desc.NodeDesc("Shader", kind, inputs=inputs or {}, options=options or {})
    surface = desc.LinkDesc(1, "BSDF", 0, "Surface")
    translation = _luxcore.translate(scene([shader, *nodes], [surface, *links], images))
    prefix = "scene.materials.material0."
    found = {
        key.removeprefix(prefix): value
        for key, value in translation.properties.items()
        if key.startswith(prefix)
    }
    return found | {"all": translation}


def texture_nodes(kind: str = "image_texture"):
    """An image texture (node 2) that reads the UV map, scaled and moved (nodes 3, 4)."""
    mapping = {"Location": (0.5, 0.25, 0, 1), "Rotation": (0, 0, 0, 1), "Scale": (2, 3, 1, 1)}
    nodes = [
        desc.NodeDesc("Image", kind, 0, options={"interpolation": "Linear", "extension": "REPEAT"}),
        desc.NodeDesc("Mapping", "mapping", inputs=mapping, options={"vector_type": "POINT"}),
        desc.NodeDesc("Coordinates", "texture_coordinate"),
    ]
    links = [desc.LinkDesc(4, "UV", 3, "Vector"), desc.LinkDesc(3, "Vector", 2, "Vector")]
    return nodes, links


def image(pixels, color_space=desc.ColorSpace.LINEAR):
    return desc.ImageDesc("Image", pixels=np.asarray(pixels, np.float32), color_space=color_space)


# -------------------------------------------------------------------------------------- materials


def test_a_diffuse_color_is_given_as_text():
    found = shaded("bsdf_diffuse", {"Color": (0.5, 0.25, 0.125, 1.0)})
    assert (found["type"], found["kd"]) == ("matte", "0.5 0.25 0.125")


def test_a_socket_without_value_has_blenders_default():
    assert shaded("bsdf_diffuse")["kd"] == "0.8 0.8 0.8"


def test_a_texture_hangs_from_the_top_and_follows_the_mapping():
    nodes, links = texture_nodes()
    links = [*links, desc.LinkDesc(2, "Color", 1, "Color")]
    found = shaded("bsdf_diffuse", nodes=nodes, links=links, images=[image(np.ones((2, 2, 3)))])
    properties = found["all"].properties
    name = f"scene.textures.{found['kd']}"
    scale, delta = properties[f"{name}.mapping.uvscale"], properties[f"{name}.mapping.uvdelta"]
    # Blender's v = 3 v0 + 0.25 counts from the bottom.
    assert scale == [2, -3]
    assert delta == [0.5, 0.75]
    assert set(found["all"].images) == {properties[f"{name}.file"]}


def test_smooth_metal_is_a_mirror_and_rough_metal_has_facets():
    smooth = {"Metallic": scalar(1.0), "Roughness": scalar(0.0), "Base Color": WHITE}
    assert shaded("bsdf_principled", smooth)["type"] == "mirror"
    rough = shaded("bsdf_principled", smooth | {"Roughness": scalar(0.5)})
    assert (rough["type"], rough["uroughness"]) == ("metal2", "0.25")


def test_rough_metal_reflects_its_color_at_normal_incidence():
    color = (0.9, 0.5, 0.0)
    inputs = {"Color": (*color, 1.0), "Roughness": scalar(0.5)}
    found = shaded("bsdf_glossy", inputs)
    n, k = (np.array(found[key].split(), float) for key in "nk")
    reflected = ((n - 1.0) ** 2 + k**2) / ((n + 1.0) ** 2 + k**2)
    assert reflected == pytest.approx(color)


def test_a_plastic_reflects_at_normal_incidence_what_its_ior_says():
    found = shaded("bsdf_principled", {"IOR": scalar(1.5), "Specular IOR Level": scalar(0.5)})
    assert found["type"] == "glossy2"
    assert [float(part) for part in found["ks"].split()] == pytest.approx([0.04] * 3)


def test_glass_keeps_its_ior():
    found = shaded("bsdf_glass", {"IOR": scalar(1.33), "Roughness": scalar(0.0)})
    assert (found["type"], found["interiorior"], found["kt"]) == ("glass", "1.33", "1 1 1")


def test_a_mix_names_both_its_materials():
    nodes = [desc.NodeDesc("A", "bsdf_diffuse"), desc.NodeDesc("B", "bsdf_glossy")]
    nodes[1].inputs["Roughness"] = scalar(0.0)
    links = [desc.LinkDesc(2, "BSDF", 1, "Shader"), desc.LinkDesc(3, "BSDF", 1, "Shader_001")]
    found = shaded("mix_shader", {"Fac": scalar(0.25)}, nodes=nodes, links=links)
    types = [
        found["all"].properties[f"scene.materials.{found[f'material{i}']}.type"] for i in (1, 2)
    ]
    assert types == ["matte", "mirror"]
    assert found["amount"] == "0.25"


def test_a_normal_map_becomes_a_bump_texture():
    nodes, links = texture_nodes()
    normal = desc.NodeDesc("Bumps", "normal_map", options={"space": "TANGENT", "uv_map": ""})
    links = [
        *links,
        desc.LinkDesc(2, "Color", 5, "Color"),
        desc.LinkDesc(5, "Normal", 1, "Normal"),
    ]
    found = shaded(
        "bsdf_diffuse", nodes=[*nodes, normal], links=links, images=[image(np.ones((2, 2, 3)))]
    )
    assert found["all"].properties[f"scene.textures.{found['bumptex']}.type"] == "normalmap"


@pytest.mark.parametrize(
    ("kind", "inputs", "message"),
    [
        ("bsdf_refraction", {}, "bsdf_refraction"),
        ("emission", {}, "emission"),
        ("add_shader", {}, "add_shader"),
        ("bsdf_glass", {"Roughness": scalar(0.3)}, "rough glass"),
        ("bsdf_transparent", {"Color": scalar(0.5)}, "only white"),
        ("bsdf_principled", {"Metallic": scalar(0.5)}, "partly metallic"),
        ("bsdf_principled", {"Alpha": scalar(0.5)}, "Alpha"),
        ("bsdf_principled", {"Transmission Weight": scalar(1.0)}, "Transmission Weight"),
        ("bsdf_principled", {"Emission Strength": scalar(1.0)}, "one side"),
    ],
)
def test_what_has_no_equal_is_refused_by_name(kind, inputs, message):
    with pytest.raises(UntranslatedError, match=message) as error:
        shaded(kind, inputs)
    assert "material Paint" in str(error.value)


# ----------------------------------------------------------------------------- images and worlds


def test_srgb_is_decoded_and_rows_are_turned_round():
    pixels = np.zeros((2, 1, 3), np.float32)
    pixels[0] = 0.5  # the bottom row
    linear = linear_pixels(image(pixels, desc.ColorSpace.SRGB))
    assert linear[1, 0] == pytest.approx([((0.5 + 0.055) / 1.055) ** 2.4] * 3)
    assert linear[0, 0] == pytest.approx([0.0] * 3)


def test_doubling_an_environment_keeps_its_mean_and_its_values_between_texels():
    pixels = np.random.default_rng(1).random((4, 8, 3), np.float32)
    twice = doubled(pixels)
    assert twice.shape == (8, 16, 3)
    assert twice.mean() == pytest.approx(pixels.mean(), rel=1e-5)
    between = 0.5 * (twice[3:5, 7:9].sum(axis=(0, 1)) / 2)
    assert between == pytest.approx(pixels[1:3, 3:5].mean(axis=(0, 1)), rel=1e-5)


def world(node, links=()):
    nodes = [desc.NodeDesc("Output", "output"), node]
    surface = desc.LinkDesc(1, "Background", 0, "Surface")
    return desc.MaterialDesc("World", nodes, [surface, *links])


def test_a_constant_world_is_its_color_times_its_strength():
    base = scene([desc.NodeDesc("Shader", "bsdf_diffuse")])
    inputs = {"Color": (1.0, 0.5, 0.25, 1.0), "Strength": scalar(2.0)}
    base.materials.append(world(desc.NodeDesc("Background", "background", inputs=inputs)))
    base.environment = desc.EnvironmentDesc(1)
    properties = _luxcore.translate(base).properties
    assert properties["scene.lights.world.type"] == "constantinfinite"
    assert properties["scene.lights.world.color"] == [2.0, 1.0, 0.5]


# --------------------------------------------------------------------------- camera and geometry


def test_a_crop_is_a_part_of_the_screen():
    translation = Translation()
    _luxcore.add_camera(camera(crop=(4, 2, 4, 6)), translation)
    left, right, bottom, top = translation.properties["scene.camera.screenwindow"]
    pixel = 0.5 / 8
    assert (left, right) == pytest.approx((0.0, 0.25))
    assert (bottom + pixel, top + pixel) == pytest.approx((-0.125, 0.25))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"projection": desc.Projection.ORTHOGRAPHIC}, "orthographic"),
        ({"aperture_radius": 0.01}, "depth of field"),
    ],
)
def test_other_cameras_are_refused(fields, message):
    with pytest.raises(UntranslatedError, match=f"camera: .*{message}"):
        _luxcore.add_camera(camera(**fields), Translation())


def test_the_view_width_is_measured_at_the_casters():
    base = scene()
    behind = IDENTITY.copy()
    behind[2, 3] = -4.0
    role = desc.CausticsRole.CASTER
    base.instances.append(desc.InstanceDesc("Far", 0, behind, [0], caustics_role=role))
    assert _luxcore.view_width(base, Translation()) == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("kind", "role", "casts"),
    [
        ("bsdf_glossy", desc.CausticsRole.AUTO, True),
        ("bsdf_glass", desc.CausticsRole.AUTO, True),
        ("bsdf_diffuse", desc.CausticsRole.AUTO, False),
        ("bsdf_glossy", desc.CausticsRole.OFF, False),
        ("bsdf_glossy", desc.CausticsRole.RECEIVER, False),
        ("bsdf_diffuse", desc.CausticsRole.CASTER, True),
    ],
)
def test_mirrors_and_glass_cast_unless_told_otherwise(kind, role, casts):
    shader = desc.NodeDesc("Shader", kind, inputs={"Roughness": scalar(0.0)})
    base = scene([shader], [desc.LinkDesc(1, "BSDF", 0, "Surface")])
    base.instances[0].caustics_role = role
    assert bool(_luxcore.casters(base, _luxcore.translate(base))) == casts


def test_corners_become_vertices_of_their_material():
    normals = np.arange(18, dtype=np.float32).reshape(2, 3, 3)
    uv = np.arange(12, dtype=np.float32).reshape(2, 3, 2)
    mesh = quad_mesh(
        normals=normals,
        material_slots=np.array([0, 1], np.uint32),
        slot_count=2,
        attributes=[desc.uv_layer("UV", uv)],
    )
    positions, triangles, found_normals, found_uv = _luxcore.slot_arrays(mesh, 1)
    assert positions.tolist() == [[0, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert triangles.tolist() == [[0, 1, 2]]
    assert found_normals.tolist() == normals[1].tolist()
    assert found_uv.tolist() == uv[1].tolist()


def geometric_normal(positions, triangles):
    a, b, c = positions[triangles[0]]
    return np.cross(b - a, c - a)


def test_a_mirrored_mesh_keeps_its_outside():
    mirror = IDENTITY.copy()
    mirror[0, 0] = -2.0
    normals = np.tile(np.array((0, 0, 1), np.float32), (6, 1))
    arrays = (quad_mesh().positions, quad_mesh().triangles, normals, None)
    positions, triangles, turned, _ = _luxcore.bake(arrays, mirror)
    assert geometric_normal(positions, triangles)[2] > 0.0
    assert turned[0].tolist() == [0, 0, 1]


def test_shared_meshes_stay_instances():
    base = scene([desc.NodeDesc("Shader", "bsdf_diffuse")])
    moved = IDENTITY.copy()
    moved[:, 3] = (1, 2, 3)
    base.instances.append(desc.InstanceDesc("Other", 0, moved, [0]))
    translation = _luxcore.translate(base)
    assert len(translation.meshes) == 1
    matrix = translation.properties["scene.objects.object1_0.transformation"]
    assert matrix[12:] == [1, 2, 3, 1]


# ------------------------------------------------------------------------------------------ lights


def lamp(kind, **kwargs):
    values = {"power": (math.pi,) * 3, "visibility": desc.Visibility.ALL ^ desc.Visibility.CAMERA}
    transform = IDENTITY.copy()
    transform[:, 3] = (0.5, 0.5, 2.0)
    return desc.LightDesc("Lamp", kind, transform, **(values | kwargs))


@pytest.mark.parametrize("shape", list(desc.AreaShape))
def test_an_area_light_shines_down(shape):
    light = lamp(desc.LightType.AREA, shape=shape, size=(0.5, 0.25))
    positions, triangles = _luxcore.area_mesh(light)
    assert geometric_normal(positions, triangles)[2] < 0.0
    assert positions[:, 2] == pytest.approx(2.0)


def test_a_point_light_has_the_area_of_its_sphere():
    light = lamp(desc.LightType.POINT, radius=0.1)
    positions, triangles = _luxcore.sphere_mesh(light)
    corners = positions[triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 0.5 * np.linalg.norm(cross, axis=1).sum()
    assert area == pytest.approx(4.0 * math.pi * 0.1**2)
    outward = corners.mean(axis=1) - light.transform[:, 3]
    assert (np.sum(outward * cross, axis=1) > 0.0).all()


@pytest.mark.parametrize("kind", desc.LightType)
def test_lights_without_equal_are_refused_by_name(kind):
    base = scene([desc.NodeDesc("Shader", "bsdf_diffuse")])
    base.lights.append(lamp(kind, spread=2.0))
    with pytest.raises(UntranslatedError, match="light Lamp"):
        _luxcore.translate(base)


# ----------------------------------------------------------------------------- LuxCore's pictures

RENDER_SECONDS = 1.0
SIZE = 16  # pixels
# Of the mean of 16 pixels; the noise is a few times smaller.
UNIT_TOLERANCE = 0.02


def floor_scene():
    """A diffuse floor, its right half darker, under a small lamp straight above its middle."""
    nodes = [desc.NodeDesc("Shader", "bsdf_diffuse", inputs={"Color": scalar(0.8)})]
    base = scene(nodes, [desc.LinkDesc(1, "BSDF", 0, "Surface")])
    dark = desc.NodeDesc("Shader", "bsdf_diffuse", inputs={"Color": scalar(0.4)})
    base.materials.append(
        desc.MaterialDesc(
            "Dark",
            [desc.NodeDesc("Output", "output"), dark],
            [desc.LinkDesc(1, "BSDF", 0, "Surface")],
        )
    )
    base.instances = []
    for number, x in enumerate((-4.0, 0.0)):
        transform = np.diag([4.0, 8.0, 1.0, 1.0]).astype(np.float32)[:3]
        transform[:, 3] = (x, -4.0, 0.0)
        base.instances.append(desc.InstanceDesc(f"Half {number}", 0, transform, [number]))
    light = lamp(desc.LightType.AREA, size=(0.02, 0.02))
    light.transform[:, 3] = (0.0, 1.0, 2.0)  # above the picture's upper edge
    base.lights.append(light)
    return base


def run_job(folder, method, pixel_filter):
    """LuxCore's report on the floor, in half the light."""
    base = floor_scene()
    base.camera = camera(width=SIZE, height=SIZE, crop=(0, 0, SIZE, SIZE))
    (folder / "scene.pickle").write_bytes(pickle.dumps(base))
    job = {
        "description": str(folder / "scene.pickle"),
        "method": method,
        "size": [SIZE, SIZE],
        "settings": {"bounces": 12, "filter": [pixel_filter, 1.0], "exposure": 0.5},
        "threads": 2,
        "seconds": RENDER_SECONDS,
        "seed": 0,
        "image": str(folder / "image.npy"),
        "result": str(folder / "result.json"),
    }
    (folder / "job.json").write_text(json.dumps(job))
    script = ROOT / "tests" / "instruments" / "bench" / "_luxcore_job.py"
    command = [str(venvs.luxcore_python()), str(script), str(folder / "job.json")]
    run = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stderr[-1000:]
    return json.loads((folder / "result.json").read_text())


@needs_luxcore
def test_a_pixel_filter_that_luxcore_does_not_have_is_told(tmp_path):
    assert run_job(tmp_path, "lux-light", "GAUSSIAN") == {
        "untranslated": "the pixel filter GAUSSIAN"
    }


@needs_luxcore
@pytest.mark.slow
@pytest.mark.parametrize("method", ["lux-light", "lux-bidir-sobol", "lux-bidir-metropolis"])
def test_a_picture_has_our_orientation_and_units(method, tmp_path):
    report = run_job(tmp_path, method, "BOX")
    assert report["render_seconds"] >= RENDER_SECONDS
    assert report["samples"] > 0
    assert report["peak_memory"] > 2**20

    pixels = np.load(tmp_path / "image.npy")
    assert (pixels.shape, pixels.dtype) == ((SIZE, SIZE, 3), np.float32)
    # The lamp has the intensity P / pi = 1 W/sr along its axis: E = cos^4 / h^2, L = albedo E / pi.
    centres = (np.arange(SIZE) + 0.5) / (SIZE / 2) - 1.0
    x, y = np.meshgrid(centres, centres)
    cosine = 2.0 / np.sqrt(x**2 + (y - 1.0) ** 2 + 4.0)
    radiance = np.where(x < 0.0, 0.8, 0.4) * cosine**4 / 4.0 / math.pi
    blocks = (SIZE // 4, 4, SIZE // 4, 4)
    expected = radiance.reshape(blocks).mean(axis=(1, 3))
    found = 2.0 * pixels.mean(axis=2).reshape(blocks).mean(axis=(1, 3))
    assert found == pytest.approx(expected, rel=UNIT_TOLERANCE)
