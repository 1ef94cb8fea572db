# SPDX-License-Identifier: GPL-3.0-or-later
"""A lamp's nodes make of its light what they make of it in Cycles, in this Blender.

Lamps without size light a plane, and others are seen directly, so that there is no noise.
"""

import bpy
import numpy as np
import pytest
import tiles
from scenes import add_camera, add_light, add_mesh, add_node, surface

from specula.export import compat

TOLERANCE = 2e-3  # of 1 + the value
MOST_JUMPS = 0.05  # share of the pixels, where a value jumps or a lamp ends
SIZE = 24

LAMPS = {
    "point": ("POINT", {"energy": 500, "shadow_soft_size": 0}),
    "spot": ("SPOT", {"energy": 900, "spot_size": 1.3, "spot_blend": 0.3, "shadow_soft_size": 0}),
    "sun": ("SUN", {"energy": 3, "angle": 0}),
    "area": ("AREA", {"energy": 60, "shape": "RECTANGLE", "size": 1.5, "size_y": 1.2}),
    "ball": ("POINT", {"energy": 60, "shadow_soft_size": 0.7, "use_soft_falloff": False}),
}
SEEN = ("area", "ball")
OUTPUTS = (
    ("TexCoord", "Generated"),
    ("TexCoord", "Normal"),
    ("TexCoord", "UV"),
    ("TexCoord", "Object"),
    ("NewGeometry", "Position"),
    ("NewGeometry", "Normal"),
    ("NewGeometry", "True Normal"),
    ("NewGeometry", "Incoming"),
    ("NewGeometry", "Parametric"),
    ("CameraData", "View Vector"),
    ("LayerWeight", "Facing"),
    ("TexGradient", "Fac"),
)
# Of lights that are no objects of Cycles: what it has instead of images' coordinates, and a normal
# in the world's space where a ray runs into the lamp.
NOT_BEFORE_4_4 = {("area", "Normal")} | {
    (lamp, output)
    for lamp in LAMPS
    for output in ("UV", "Parametric")
    if (lamp, output) != ("area", "Parametric")
}
FALLOFFS = {("Quadratic", 0.0), ("Quadratic", 2.0), ("Linear", 0.0), ("Constant", 0.0)}


def has(lamp: str, output: str) -> bool:
    _, values = LAMPS[lamp]
    if lamp == "spot" and bpy.app.version < (4, 0, 0):
        return False  # the edge of Cycles' spots had another profile
    known = bpy.types.PointLight.bl_rna.properties
    if not all(name in known for name in values if name.startswith("use_")):
        return False
    return compat.lights_have_coordinates() or (lamp, output) not in NOT_BEFORE_4_4


def stage(lamp: str):
    """The lamp's data, in a scene that shows it."""
    kind, values = LAMPS[lamp]
    obj = add_light(kind, **values)
    obj.location, obj.rotation_euler = (0.3, 0.2, 1.5), (0.3, -0.2, 0.5)
    obj.scale = (1, 1.5, 1) if lamp not in SEEN else (1, 1, 1)
    camera = add_camera((0, 0, 4))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.5
    if lamp in SEEN:
        obj.visible_camera = True
        camera.location, camera.rotation_euler = (0.3, 0.2, -4), (np.pi, 0, 0)
    else:
        material = bpy.data.materials.new("White")
        material.use_nodes = True
        material.node_tree.nodes.clear()
        add_node(material, "ShaderNodeOutputMaterial")
        add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
        add_mesh("Plane", [(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)], material=material)
    obj.data.use_nodes = True
    obj.data.node_tree.nodes.clear()
    add_node(obj.data, "ShaderNodeOutputLight")
    return obj.data


def pictures(folder):
    """By Specula and by Cycles, (SIZE, SIZE, 3)."""
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.specula.samples = scene.cycles.samples = 1
    scene.specula.method = "PT"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = 0
    scene.cycles.sample_clamp_direct = scene.cycles.light_sampling_threshold = 0
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    return [tiles.render(engine, folder) for engine in ("SPECULA", "CYCLES")]


def assert_alike(folder) -> None:
    ours, theirs = pictures(folder)
    assert theirs.max() > 0.01
    off = (np.abs(ours - theirs) > TOLERANCE * (1 + np.abs(theirs))).any(axis=-1)
    assert off.mean() <= MOST_JUMPS, (
        f"{off.mean():.2f} of the pixels, in the middle {ours[SIZE // 2, SIZE // 2]}, "
        f"Cycles {theirs[SIZE // 2, SIZE // 2]}"
    )


@pytest.mark.parametrize("output", OUTPUTS, ids=" ".join)
@pytest.mark.parametrize("lamp", LAMPS)
def test_of_points(lamp, output, tmp_path):
    kind, socket = output
    if not has(lamp, socket):
        pytest.skip("not in this Blender")
    light = stage(lamp)
    node = add_node(light, f"ShaderNode{kind}")
    tiles.show(light, node.outputs[socket])
    assert_alike(tmp_path)


@pytest.mark.parametrize("falloff", sorted(FALLOFFS), ids=str)
@pytest.mark.parametrize("lamp", ["point", "area"])
def test_falloff(lamp, falloff, tmp_path):
    light = stage(lamp)
    emission = add_node(light, "ShaderNodeEmission", surface(light))
    output, smooth = falloff
    node = add_node(light, "ShaderNodeLightFalloff", emission.inputs["Strength"], output)
    node.inputs["Strength"].default_value, node.inputs["Smooth"].default_value = 0.3, smooth
    assert_alike(tmp_path)


def ies(kind: int, polars, azimuths) -> str:
    """A lamp that varies but next to the azimuth 0 or, of type B, to the ends.

    There Cycles 5.0 does not go round.
    """

    def candela_at(azimuth: float) -> float:
        return max(min(azimuth, 360 - azimuth) - 60, 0) + 50 * (100 < azimuth < 170)

    def sideways(across: float, along: float) -> float:
        return 200 + across + 3 * max(60 - abs(along), 0)

    candela = [
        sideways(b, a) if kind == 2 else 100 + 3 * a + 2 * candela_at(b)
        for b in azimuths
        for a in polars
    ]
    counts = f"1 1000 2 {len(polars)} {len(azimuths)} {kind} 2 0 0 0"
    rows = (["IESNA:LM-63-1995", "TILT=NONE", counts, "0.9 1 10"], polars, azimuths, candela)
    return "\n".join(rows[0] + [" ".join(map(str, row)) for row in rows[1:]]) + "\n"


PROFILES = {
    "round": ies(1, range(0, 181, 15), [0]),
    "quadrant": ies(1, range(0, 91, 10), range(0, 91, 30)),
    "half": ies(1, range(0, 181, 20), range(0, 181, 45)),
    "full": ies(1, range(0, 181, 20), range(0, 361, 40)),
    "without the last": ies(1, range(0, 91, 10), range(0, 360, 60)),
    "sideways": ies(2, range(-90, 91, 30), range(-90, 91, 30)),
    "unreadable": "not a lamp",
}


@pytest.mark.parametrize("profile", PROFILES)
def test_ies(profile, tmp_path):
    light = stage("point")
    if profile == "sideways" and not compat.lights_have_coordinates():
        pytest.skip("Blender 3.4 closes the half turn")
    emission = add_node(light, "ShaderNodeEmission", surface(light))
    node = add_node(light, "ShaderNodeTexIES", emission.inputs["Strength"])
    node.ies = bpy.data.texts.new("Lamp")
    node.ies.from_string(PROFILES[profile])
    node.inputs["Strength"].default_value = 0.1
    assert_alike(tmp_path)
