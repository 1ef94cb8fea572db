# SPDX-License-Identifier: GPL-3.0-or-later
"""The renders behind a rendered viewport, without Blender."""

import time

import numpy as np
import pytest
from scenes import camera, glowing_triangle

from specula import abi, native
from specula.export import desc
from specula.refinement import Refinement, coarser
from specula.upload import upload

SECONDS = 30


@pytest.fixture
def refinement():
    with upload(glowing_triangle()) as scene:
        scene.commit(2)
        made = Refinement()
        made.show(scene)
        yield made
        made.stop()


def pictures(refinement: Refinement) -> list:
    """All that it shows until nothing better will come."""
    found, end = [], time.monotonic() + SECONDS
    while time.monotonic() < end:
        is_final = refinement.is_final
        picture = refinement.picture()
        if picture is not None:
            found.append(picture)
        if is_final:
            return found
        time.sleep(0.01)
    raise AssertionError("it does not end")


def rendered(view: desc.CameraDesc, settings: abi.RenderSettings) -> np.ndarray:
    scene_desc = glowing_triangle()
    scene_desc.camera = view
    with upload(scene_desc) as scene:
        scene.commit(2)
        with native.Session(scene, settings) as session:
            while session.wait(100).state == abi.RenderState.RUNNING:
                pass
            return session.read(abi.Pass.COMBINED, *view.crop[2:])


@pytest.mark.parametrize("method", [abi.Method.PT, abi.Method.AUTO])
def test_it_begins_coarse_and_ends_with_the_picture_of_a_render(refinement, method):
    view = camera(64, 32)
    settings = native.render_settings(method=method, samples=8)
    refinement.look(view, settings, 1.0)
    shown = pictures(refinement)
    assert shown[0].pixels.shape[0] < 32  # coarse
    sizes = [picture.pixels.shape[0] for picture in shown]
    assert sizes == sorted(sizes)
    assert all(picture.crop == (0, 0, 64, 32) for picture in shown)
    final = shown[-1].pixels
    assert final.shape == (32, 64, 4)
    assert np.array_equal(final.reshape(-1, 4), rendered(view, settings))


def test_looking_elsewhere_begins_anew(refinement):
    settings = native.render_settings(method=abi.Method.AUTO, samples=1 << 16)
    refinement.look(camera(256, 128), settings, 1.0)
    while refinement.picture() is None:
        time.sleep(0.01)
    settings = native.render_settings(method=abi.Method.AUTO, samples=4)
    refinement.look(camera(32, 16, z=2.0), settings, 2.0)
    final = pictures(refinement)[-1].pixels
    assert final.shape == (16, 32, 4)
    assert final[8, 16] == pytest.approx((1.0, 0.5, 0.25, 1.0))  # the exposure doubles


def test_it_shows_other_passes(refinement):
    view = camera(32, 16)
    settings = native.render_settings(method=abi.Method.AUTO, samples=2)
    refinement.look(view, settings, 2.0, abi.Pass.NORMAL)
    final = pictures(refinement)[-1].pixels
    assert final[8, 16] == pytest.approx((0.0, 0.0, 1.0, 1.0))
    refinement.look(view, settings, 2.0, abi.Pass.CAUSTICS)
    final = pictures(refinement)[-1].pixels
    assert np.array_equal(final[8, 16], (0.0, 0.0, 0.0, 1.0))


def test_slow_pictures_are_coarser_the_next_time_however_late_they_come(refinement, monkeypatch):
    monkeypatch.setattr("specula.refinement.COARSE_SECONDS", 1e-9)  # nothing is as fast
    monkeypatch.setattr("specula.refinement.REST_SECONDS", 0.0)
    settings = native.render_settings(method=abi.Method.PT, samples=1)
    refinement.look(camera(64, 32), settings, 1.0)
    pictures(refinement)
    refinement.look(camera(64, 32), settings, 1.0)
    assert pictures(refinement)[0].pixels.shape[0] == 2  # of 16 pixels along an edge


def test_a_bad_camera_is_refused_by_name(refinement):
    view = camera()
    view.clip_far = 0.0
    with pytest.raises(native.NativeError, match="clipping"):
        refinement.look(view, native.render_settings(), 1.0)


def test_a_coarse_camera_covers_the_crop():
    view = coarser(camera(100, 50, crop=(20, 10, 60, 31)), 4)
    assert (view.width, view.height, view.crop) == (15, 8, (0, 0, 15, 8))
    left, right, bottom, top = view.viewplane
    assert (left, right) == pytest.approx((-0.6, 0.6))
    assert (bottom, top) == pytest.approx((-0.3, 0.32))
