# SPDX-License-Identifier: GPL-3.0-or-later
"""Final renders through Blender's own render call and the real core."""

import math
import re
import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from layers import render_layers
from scenes import add_camera, add_light, add_mesh, add_node, link, new_material, new_world, surface

from specula import native, rendering, statistics
from specula.progress import progress_text

EMITTED = (0.5, 0.25, 0.125)


@pytest.fixture
def glowing_quad():
    """A quad that fills the frame and emits EMITTED, seen from 5 m."""
    material = new_material("glow")
    emission = add_node(material, "ShaderNodeEmission", surface(material))
    emission.inputs["Color"].default_value = (*EMITTED, 1)
    obj = add_mesh("Quad", material=material)
    obj.scale = (10, 10, 1)
    add_camera((0, 0, 5))
    scene = bpy.context.scene
    scene.world = None
    scene.cycles.pixel_filter_type = "BOX"
    return scene


def last_stats():
    return statistics.last["Scene", bpy.context.view_layer.name]


def test_combined_is_what_the_quad_emits(glowing_quad, tmp_path):
    layers, stamp = render_layers(tmp_path)
    combined = layers["ViewLayer.Combined"]
    assert combined.shape == (16, 32, 4)
    np.testing.assert_allclose(combined, np.broadcast_to((*EMITTED, 1), combined.shape), rtol=1e-4)
    assert stamp["specula.version"] == native.version()
    assert int(stamp["specula.scene.triangles"]) == 2
    assert int(stamp["specula.render.nan_samples"]) == 0
    assert last_stats().samples_done == 1


def test_film_exposure_scales_colour_and_not_alpha(glowing_quad, tmp_path):
    glowing_quad.cycles.film_exposure = 2.0
    combined = render_layers(tmp_path)[0]["ViewLayer.Combined"]
    np.testing.assert_allclose(combined[8, 16], (1.0, 0.5, 0.25, 1.0), rtol=1e-4)


def test_passes(glowing_quad, tmp_path):
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_position = layer.use_pass_normal = True
    layer.specula.use_pass_caustics = layer.specula.use_pass_walks = True
    layers, _ = render_layers(tmp_path)
    names = ("Combined", "Depth", "Position", "Normal", "Caustics", "Walk Success", "Walk Trials")
    assert set(layers) == {f"ViewLayer.{name}" for name in names}
    np.testing.assert_allclose(layers["ViewLayer.Depth"], 5.0, rtol=1e-4)
    np.testing.assert_allclose(layers["ViewLayer.Normal"][8, 16], (0, 0, 1), atol=1e-5)
    position = layers["ViewLayer.Position"]
    np.testing.assert_allclose(position[:, :, 2], 0.0, atol=1e-4)
    assert position[8, 0, 0] < -1 < 1 < position[8, 31, 0]  # x grows to the right
    assert position[0, 16, 1] < 0 < position[15, 16, 1]  # and y upwards
    for name in names[4:]:
        assert not layers[f"ViewLayer.{name}"].any(), name  # nothing casts caustics


def test_passes_are_only_there_if_asked_for(glowing_quad, tmp_path):
    assert set(render_layers(tmp_path)[0]) == {"ViewLayer.Combined"}


def test_adaptive_sampling_ends_where_there_is_no_noise(glowing_quad, tmp_path):
    glowing_quad.specula.samples = 1 << 20
    cycles = glowing_quad.cycles
    cycles.use_adaptive_sampling, cycles.adaptive_threshold = True, 0.01
    cycles.adaptive_min_samples = 24
    bpy.context.view_layer.cycles.pass_debug_sample_count = True
    layers, _ = render_layers(tmp_path)
    counts = layers["ViewLayer.Debug Sample Count"] * (1 << 20)
    assert 24 <= counts.min() == counts.max() < 48


def test_border_renders_its_part_of_the_frame(glowing_quad, tmp_path):
    render = glowing_quad.render
    render.use_border = True
    render.border_min_x, render.border_max_x = 0.25, 0.75
    render.border_min_y, render.border_max_y = 0.5, 1.0
    bpy.context.view_layer.use_pass_position = True
    layers, _ = render_layers(tmp_path)
    combined = layers["ViewLayer.Combined"]
    assert combined.shape == (16, 32, 4)
    inside = np.zeros((16, 32), bool)
    inside[8:, 8:24] = True
    np.testing.assert_array_equal(combined[:, :, 3] > 0, inside)
    assert layers["ViewLayer.Position"][15, 16, 1] > 0

    render.use_crop_to_border = True
    cropped = render_layers(tmp_path)[0]["ViewLayer.Combined"]
    assert cropped.shape == (8, 16, 4)
    np.testing.assert_allclose(cropped[:, :, 0], EMITTED[0], rtol=1e-4)


def test_transparent_film(glowing_quad, tmp_path):
    world = new_world()
    background = add_node(world, "ShaderNodeBackground", surface(world))
    background.inputs["Color"].default_value = (1, 1, 1, 1)
    bpy.data.objects["Quad"].location.x = 10  # covers the right half
    glowing_quad.render.film_transparent = True
    alpha = render_layers(tmp_path)[0]["ViewLayer.Combined"][:, :, 3]
    np.testing.assert_array_equal(alpha[:, :15], 0)
    np.testing.assert_array_equal(alpha[:, 17:], 1)


def test_every_view_layer_is_rendered(glowing_quad, tmp_path):
    second = glowing_quad.view_layers.new("Second")
    second.use_pass_z = True
    hidden = bpy.data.collections.new("Hidden")
    glowing_quad.collection.children.link(hidden)
    quad = bpy.data.objects["Quad"]
    glowing_quad.collection.objects.unlink(quad)
    hidden.objects.link(quad)
    second.layer_collection.children["Hidden"].exclude = True
    layers, stamp = render_layers(tmp_path)
    assert layers["ViewLayer.Combined"][8, 16, 0] == pytest.approx(EMITTED[0], rel=1e-4)
    assert layers["Second.Combined"][8, 16, 0] == 0
    assert layers["Second.Depth"][8, 16, 0] == pytest.approx(1e10)
    assert stamp["specula.ViewLayer.scene.triangles"] == "2"
    assert stamp["specula.Second.scene.triangles"] == "0"
    assert {("Scene", "ViewLayer"), ("Scene", "Second")} <= set(statistics.last)


def test_a_disabled_view_layer_is_not_rendered(glowing_quad, tmp_path):
    glowing_quad.view_layers.new("Second").use = False
    assert set(render_layers(tmp_path)[0]) == {"ViewLayer.Combined"}


def test_warnings_are_told_once(glowing_quad, tmp_path, capfd):
    material = bpy.data.objects["Quad"].material_slots[0].material
    emission = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeEmission")
    add_node(material, "ShaderNodeAmbientOcclusion", emission.inputs["Strength"])
    link("Twin", bpy.data.objects["Quad"].data)
    render_layers(tmp_path)
    output = "".join(capfd.readouterr())
    assert output.count("material glow, node Ambient Occlusion") == 1
    assert len(last_stats().warnings) == 1


def test_statistics_are_printed_as_one_block(glowing_quad, tmp_path, capfd):
    render_layers(tmp_path)
    output = "".join(capfd.readouterr())
    assert last_stats().block() in output
    for label in ("Version:", "Samples per pixel:", "Rays:", "Dropped:"):
        assert output.count(label) == 1


@pytest.fixture
def mirrored_light():
    """A floor, a mirror beside it that stands upright, and a small lamp."""
    white, silver = new_material("White"), new_material("Silver")
    add_node(white, "ShaderNodeBsdfDiffuse", surface(white))
    add_node(silver, "ShaderNodeBsdfGlossy", surface(silver)).inputs["Roughness"].default_value = 0
    add_mesh("Floor", material=white)
    mirror = add_mesh("Mirror", material=silver)
    mirror.location, mirror.rotation_euler = (1, 0, 1), (0, -math.pi / 2, 0)
    mirror.specula.caustics = "CASTER"
    add_light(energy=10, shadow_soft_size=0.0).location = (-0.5, 0, 1)
    add_camera((0, 0, 5))
    scene = bpy.context.scene
    scene.world = None
    scene.specula.samples = 16
    bpy.context.view_layer.specula.use_pass_caustics = True
    return scene


@pytest.mark.parametrize(
    ("method", "light_tracing", "walks", "light_paths"),
    [
        ("AUTO", "AUTO", True, True),
        ("SMS_UNBIASED", "ON", True, True),
        ("SMS_BIASED", "OFF", True, False),
        ("LT", "OFF", False, True),
        ("SHEETS", "OFF", True, False),
        ("MNEE", "OFF", True, False),
        ("MNEE_BIASED", "ON", True, True),
        ("PT", "ON", False, False),
    ],
)
def test_light_tracing_reaches_the_core(
    mirrored_light, tmp_path, capfd, method, light_tracing, walks, light_paths
):
    mirrored_light.specula.method = method
    mirrored_light.specula.light_tracing = light_tracing
    layers, stamp = render_layers(tmp_path)
    assert stamp["specula.method"] == method
    assert (int(stamp["specula.render.walks"]) > 0) == walks
    assert (int(stamp["specula.render.light_paths"]) > 0) == light_paths
    assert (int(stamp["specula.render.splats"]) > 0) == light_paths
    assert layers["ViewLayer.Caustics"].any() == (walks or light_paths)
    assert ("Light paths:" in "".join(capfd.readouterr())) == light_paths


def test_walks_show_in_passes(mirrored_light, tmp_path):
    mirrored_light.specula.method = "SMS_UNBIASED"
    mirrored_light.specula.light_tracing = "OFF"
    layer = bpy.context.view_layer
    layer.specula.use_pass_walks = True
    layers, stamp = render_layers(tmp_path)
    success, trials = layers["ViewLayer.Walk Success"], layers["ViewLayer.Walk Trials"]
    lit = layers["ViewLayer.Caustics"].max(axis=2) > 0
    assert lit.any() and not lit.all()
    assert success.min() >= 0.0 and success.max() <= 1.0
    # Light that was found took a walk that converged, and a trial at least.
    assert (success[lit] > 0.0).all() and (trials[lit] >= 1.0).all()
    assert trials.max() <= int(stamp["specula.render.max_trials"])


def test_statistics_do_not_outlive_their_file(glowing_quad):
    bpy.ops.render.render()
    assert statistics.last
    bpy.ops.wm.read_homefile(use_empty=True)
    assert not statistics.last


def test_progress_tells_samples_time_and_what_is_left(glowing_quad, monkeypatch):
    texts = []
    monkeypatch.setattr(rendering, "SHOW_SECONDS", 0.05)
    monkeypatch.setattr(rendering, "POLL_MILLISECONDS", 20)
    monkeypatch.setattr(
        rendering, "progress_text", lambda *args: texts.append(progress_text(*args)) or texts[-1]
    )
    glowing_quad.specula.samples = 1 << 20
    glowing_quad.specula.time_limit = 0.5
    bpy.ops.render.render()
    pattern = re.compile(r"sample ([\d.]+)/1048576 \| 0:0\d, 0:0\d left")
    samples = [float(pattern.fullmatch(text)[1]) for text in texts]
    assert samples == sorted(samples)
    assert 0 < samples[0] < samples[-1] < 1 << 20


def test_progress_text():
    progress = SimpleNamespace(stage=5, stage_fraction=0.25, seconds=1200.4, seconds_left=3601.2)
    assert progress_text(progress, 16.04, 64) == "sample 16.0/64 | 20:00, 1:00:01 left"
    progress = SimpleNamespace(stage=5, stage_fraction=0.0, seconds=0.3, seconds_left=-1.0)
    assert progress_text(progress, 0.0, 64) == "sample 0.0/64 | 0:00"
    progress = SimpleNamespace(stage=1, stage_fraction=0.4, seconds=2.3, seconds_left=7.7)
    assert progress_text(progress, 0.0, 64) == ("tracing light sheets, 40% | 0:02, 0:08 left")


def test_a_time_limit_is_a_success(glowing_quad, tmp_path):
    glowing_quad.specula.samples = 1 << 20
    glowing_quad.specula.time_limit = 1.0
    start = time.monotonic()
    combined = render_layers(tmp_path)[0]["ViewLayer.Combined"]
    assert time.monotonic() - start < 5
    assert combined[8, 16, 0] == pytest.approx(EMITTED[0], rel=1e-3)
    assert 1 <= last_stats().samples_done < 1 << 20
    assert 0.0 < last_stats().first_sample_seconds < last_stats().render_seconds


class BrokenOff:
    """An engine whose user presses Escape after some polls."""

    def __init__(self, engine, polls: int):
        self.engine = engine
        self.polls = polls

    def __getattr__(self, name):
        return getattr(self.engine, name)

    def test_break(self) -> bool:
        self.polls -= 1
        return self.polls < 0


@pytest.mark.parametrize("polls", [0, 4])
def test_a_break_cancels(glowing_quad, monkeypatch, polls):
    glowing_quad.specula.samples = 1 << 20
    render = rendering.render_view_layer
    results = []
    monkeypatch.setattr(
        rendering,
        "render_view_layer",
        lambda engine, depsgraph: results.append(render(BrokenOff(engine, polls), depsgraph)),
    )
    start = time.monotonic()
    bpy.ops.render.render()
    assert time.monotonic() - start < 5
    assert results == [None]


def test_partial_results_are_shown(glowing_quad, monkeypatch):
    shown = []
    monkeypatch.setattr(rendering, "SHOW_SECONDS", 0.05)
    monkeypatch.setattr(rendering, "POLL_MILLISECONDS", 20)
    show = rendering.Film.show
    monkeypatch.setattr(
        rendering.Film, "show", lambda self, session: (show(self, session), shown.append(1))
    )
    glowing_quad.specula.samples = 1 << 20
    glowing_quad.specula.time_limit = 0.5
    bpy.ops.render.render()
    assert len(shown) >= 3
