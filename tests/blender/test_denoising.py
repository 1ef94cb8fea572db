# SPDX-License-Identifier: GPL-3.0-or-later
"""Denoising of final renders: what it takes away, what it keeps, and where there is none."""

import time

import bpy
import numpy as np
import pytest
from layers import render_layers
from scenes import add_camera, add_light, add_mesh, add_node, new_material, surface

from specula import abi, denoising, native, statistics
from specula.denoising_settings import viewport_denoising
from specula.export import compat
from specula.export.log import ExportLog
from specula.export.scene import export_scene
from specula.export.settings import viewport_settings
from specula.refinement import Refinement
from specula.upload import upload


def has_library() -> bool:
    try:
        denoising.load(compat.library_folders())
    except denoising.DenoisingError:
        return False
    return True


with_library = pytest.mark.skipif(not has_library(), reason="this Blender has no denoiser")
SIZE = 64


@pytest.fixture
def noisy():
    """A plain wall under a large lamp, and a mirror in which an edge of two colours shows."""
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    for name, x, color in (("dark", -1, (0.05, 0.05, 0.05, 1)), ("light", 1, (0.8, 0.8, 0.8, 1))):
        material = new_material(name)
        node = add_node(material, "ShaderNodeBsdfDiffuse", surface(material))
        node.inputs["Color"].default_value = color
        half = add_mesh(name, material=material)
        half.location, half.scale = (x, 0, 3), (1, 2, 1)
        half.rotation_euler = (0, np.pi, 0)
    silver = new_material("silver")
    node = add_node(silver, "ShaderNodeBsdfGlossy", surface(silver))
    node.inputs["Roughness"].default_value = 0.0
    add_mesh("Mirror", material=silver).scale = (3, 3, 1)
    lamp = add_light("AREA", energy=200, size=3.0)
    lamp.location, lamp.rotation_euler = (0, 0, 0.5), (np.pi, 0, 0)
    lamp.visible_glossy = False
    add_camera((0, 0, 1.5)).data.angle = 0.6
    scene.specula.method = "PT"
    scene.specula.samples = 2
    scene.cycles.use_denoising = True
    return scene


@with_library
def test_noise_goes_and_edges_in_mirrors_stay(noisy, tmp_path):
    layers, _ = render_layers(tmp_path)
    denoised, before = layers["ViewLayer.Combined"], layers["ViewLayer.Noisy Image"]
    assert (denoised[..., 3] == before[..., 3]).all()
    noisy.specula.samples = 1024
    noisy.cycles.use_denoising = False
    truth = render_layers(tmp_path)[0]["ViewLayer.Combined"]

    def error(picture):
        return np.square(picture[..., :3] - truth[..., :3]).mean()

    assert error(denoised) < 0.25 * error(before)
    across = denoised[SIZE // 2, :, 0]
    assert np.abs(np.diff(across)).max() > 0.5 * np.ptp(truth[SIZE // 2, :, 0])  # one step


@with_library
def test_switches_of_cycles_hold(noisy, tmp_path):
    pictures = {}
    for inputs in ("RGB", "RGB_ALBEDO", "RGB_ALBEDO_NORMAL"):
        noisy.cycles.denoising_input_passes = inputs
        pictures[inputs] = render_layers(tmp_path)[0]["ViewLayer.Combined"]
    assert (pictures["RGB"] != pictures["RGB_ALBEDO"]).any()
    bpy.context.view_layer.cycles.use_denoising = False
    assert set(render_layers(tmp_path)[0]) == {"ViewLayer.Combined"}


@pytest.mark.skipif(has_library(), reason="this Blender has a denoiser")
def test_without_library_a_message_and_the_noisy_picture(noisy, tmp_path):
    layers, _ = render_layers(tmp_path)
    assert (layers["ViewLayer.Combined"] == layers["ViewLayer.Noisy Image"]).all()
    warnings = statistics.last["Scene", "ViewLayer"].warnings
    assert [line for line in warnings if "Open Image Denoise" in line]


@pytest.fixture
def refinement(noisy):
    """Of the scene as a viewport shows it, with its camera and settings."""
    noisy.cycles.use_preview_denoising = True
    noisy.specula.viewport_samples = 4
    log = ExportLog()
    scene_desc = export_scene(bpy.context.evaluated_depsgraph_get(), log)
    view = scene_desc.camera
    with upload(scene_desc, log) as scene:
        scene.commit()
        made = Refinement()
        made.show(scene)
        yield made, scene, view, viewport_settings(noisy, bpy.context.view_layer)
        made.stop()


@with_library
@pytest.mark.parametrize("prefilter", ["NONE", "ACCURATE"])
def test_the_viewport_ends_with_a_denoised_picture(noisy, refinement, prefilter):
    made, scene, view, settings = refinement
    noisy.cycles.preview_denoising_prefilter = prefilter
    noisy.cycles.preview_denoising_input_passes = "RGB_ALBEDO_NORMAL"
    how = viewport_denoising(noisy)
    made.look(view, settings, 1.0, abi.Pass.COMBINED, how)
    picture = None
    while not made.is_final:
        picture = made.picture() or picture
        time.sleep(0.01)
    passes = sum(1 << source for source in (abi.Pass.COMBINED, *how.guides))
    settings = native.changed(settings, passes=passes, for_denoiser=True)
    with native.Session(scene, settings) as session:
        while session.wait(100).state == abi.RenderState.RUNNING:
            pass

        def read(source):
            return session.read(source, SIZE, SIZE).reshape(SIZE, SIZE, -1)

        expected = how.denoised(read(abi.Pass.COMBINED), read)
        assert np.abs(picture.pixels - expected).max() < 1e-4
        assert np.abs(picture.pixels - read(abi.Pass.COMBINED)).max() > 0.01


@with_library
def test_a_viewport_that_moves_leaves_its_denoiser(noisy, refinement):
    made, _, view, settings = refinement
    for _ in range(8):
        made.look(view, settings, 1.0, abi.Pass.COMBINED, viewport_denoising(noisy))
        while made._denoiser._task is None:
            made.picture()
    made.stop()
    denoising.DenoisingTask.wait_for_all()
    assert denoising.DenoisingTask.left == []


@pytest.mark.skipif(has_library(), reason="this Blender has a denoiser")
def test_a_viewport_without_denoiser_says_so(noisy):
    noisy.cycles.use_preview_denoising = True
    with pytest.raises(denoising.DenoisingError, match="no Open Image Denoise"):
        viewport_denoising(noisy)
