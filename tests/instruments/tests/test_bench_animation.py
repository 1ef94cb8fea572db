# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev bench animation`: the measure of flicker, by closed forms; and from end to end."""

from __future__ import annotations

import json
import subprocess

import numpy as np
import pytest

from tests.instruments.bench import _flicker
from tools.common import ROOT

SHAPE = (24, 32, 32)
SIGMA = 0.05  # of noise, by the mean
EVERYWHERE = np.ones(SHAPE[1:], bool)


def grey(luminance: np.ndarray) -> np.ndarray:
    return np.repeat(luminance[..., None], 3, axis=-1)


@pytest.fixture
def truth() -> np.ndarray:
    """Frames of a wave that runs through the picture; its mean is 1."""
    x = np.arange(SHAPE[2]) / SHAPE[2]
    phases = np.arange(SHAPE[0]) / SHAPE[0]
    wave = 1.0 + 0.5 * np.sin(2.0 * np.pi * (x[None, :] - phases[:, None]))
    return grey(np.repeat(wave[:, None, :], SHAPE[1], axis=1))


def noise(*shape: int) -> np.ndarray:
    return grey(SIGMA * np.random.default_rng(1).standard_normal(shape))


def test_the_truth_does_not_flicker(truth):
    found = _flicker.measure(truth, truth, EVERYWHERE)
    assert (found.noise, found.pops) == (0.0, 0.0)
    assert found.variance_ratio == pytest.approx(1.0)


def test_noise_that_changes_is_found_with_its_deviation(truth):
    found = _flicker.measure(truth + noise(*SHAPE), truth, EVERYWHERE)
    assert found.noise == pytest.approx(SIGMA, rel=0.02)
    # The wave's variance over time is that of a sine of amplitude 1/2.
    assert found.variance_ratio == pytest.approx(1.0 + SIGMA**2 / 0.125, rel=0.005)


def test_noise_that_stands_still_is_none(truth):
    found = _flicker.measure(truth + noise(1, *SHAPE[1:]), truth, EVERYWHERE)
    assert found.noise == pytest.approx(0.0, abs=1e-12)


def test_a_frame_that_is_darker_pops(truth):
    frames = truth.copy()
    frames[7] -= 0.1
    found = _flicker.measure(frames, truth, EVERYWHERE)
    assert found.pops == pytest.approx(0.1 * (1.0 - 1.0 / SHAPE[0]))


def test_only_pixels_with_caustics_count(truth):
    caustics = np.zeros_like(truth)
    caustics[3, 5, 6] = 0.5
    mask = _flicker.caustics_mask(caustics, truth)
    assert mask.sum() == 1 and mask[5, 6]
    frames = truth.copy()
    frames[:, 0, 0] += np.arange(SHAPE[0])[:, None]
    assert _flicker.measure(frames, truth, mask).noise == 0.0
    assert _flicker.caustics_mask(np.zeros_like(truth), truth).all()


@pytest.mark.slow  # it starts Blender
def test_a_small_run(tmp_path):
    command = [str(ROOT / "dev"), "bench", "animation", "--only", "lamp", "--frames", "3"]
    command += ["--size", "16", "--seconds", "0.5", "--reference-samples", "16"]
    command += ["--methods", "specula,cycles", "--out", str(tmp_path)]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    rows = json.loads((tmp_path / "animation.json").read_text())["flicker"]["lamp"]
    assert rows.keys() == {"specula", "cycles"}
    for row in rows.values():
        assert row["noise"] > 0.0 and row["variance_ratio"] > 0.0
    assert (tmp_path / "lamp-specula.png").exists()
