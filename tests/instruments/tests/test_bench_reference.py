# SPDX-License-Identifier: GPL-3.0-or-later
"""How `./dev bench reference` puts its parts together, and what it stores."""

import json

import numpy as np
import pytest

from tests.images import _reference
from tests.instruments.bench import reference
from tools.common import DevError

COUNTS = (5, 2, 9)  # samples of each part
ENDS = [(sum(COUNTS[: i + 1]), n) for i, n in enumerate(COUNTS)]
SHAPE = (3, 4, 3)


def add_part(folder, seed, samples, caustics):
    """As _reference_job.py leaves it."""
    np.savez(
        folder / f"{seed}.npz",
        mean=samples.mean(axis=0),
        variance=samples.var(axis=0, ddof=1) / len(samples),
        caustics=caustics,
        direct=0.5 * caustics,
    )
    report = {"samples": len(samples), "seconds": 2.0, "seed": seed}
    (folder / f"{seed}.json").write_text(json.dumps(report))


def test_merged_parts_have_the_moments_of_all_samples(tmp_path):
    samples = np.random.default_rng(1).random((sum(COUNTS), *SHAPE))
    caustics = 0.5 * samples
    parts, start = reference.Parts(tmp_path), 0
    assert parts.next_seed() == reference.FIRST_SEED
    for count in COUNTS:
        chunk = slice(start, start + count)
        add_part(tmp_path, parts.next_seed(), samples[chunk], caustics[chunk].mean(axis=0))
        parts, start = reference.Parts(tmp_path), start + count
    assert parts.next_seed() == reference.FIRST_SEED + len(COUNTS)
    assert parts.seconds == 2.0 * len(COUNTS)
    mean, variance, manifold, direct, count = parts.merged()
    assert count == len(samples)
    np.testing.assert_allclose(mean, samples.mean(axis=0))
    np.testing.assert_allclose(variance, samples.var(axis=0, ddof=1) / len(samples))
    np.testing.assert_allclose(manifold, caustics.mean(axis=0))
    parts_means = [caustics[start - n : start].mean(axis=0) for start, n in ENDS]
    np.testing.assert_allclose(direct, 0.5 * np.mean(parts_means, axis=0))


def test_many_parts_tell_their_variance_by_themselves(tmp_path):
    # The samples of a part, one in each half of the range, say little of the error of its mean.
    rng = np.random.default_rng(4)
    counts = (8, 10, 12) * 60
    for seed, count in enumerate(counts, reference.FIRST_SEED):
        halves = (rng.random((count, *SHAPE)) + np.arange(count)[:, None, None, None] % 2) / 2.0
        add_part(tmp_path, seed, halves, halves[0])
    _, variance, _, _, count = reference.Parts(tmp_path).merged()
    assert count == sum(counts)
    of_a_sample = 1.0 / 48.0  # within its half; a quarter of that over the whole range
    np.testing.assert_allclose(variance.mean(), of_a_sample / count, rtol=0.05)


def test_added_parts_have_the_moments_of_all_samples(tmp_path):
    samples = np.random.default_rng(3).random((3000, *SHAPE))
    caustics = 0.5 * samples
    stored = _reference.Reference(
        samples[:2000].mean(axis=0),
        samples[:2000].var(axis=0, ddof=1) / 2000,
        {"samples": "2000", "seeds": "500000 500003"},
        caustics[:2000].mean(axis=0),
    )
    parts = reference.Parts(tmp_path, max(reference.seeds_of(stored)) + 1)
    assert parts.next_seed() == 500004  # a seed of the stored ones would repeat their noise
    add_part(tmp_path, parts.next_seed(), samples[2000:], caustics[2000:].mean(axis=0))
    merged = reference.Parts(tmp_path).merged()
    mean, variance, manifold, direct, count = reference.joined(stored, merged)
    assert count == len(samples)
    # Weights come from variances of 12 pixels, which know their own to a percent.
    np.testing.assert_allclose(mean, samples.mean(axis=0), rtol=1e-3)
    np.testing.assert_allclose(variance, samples.var(axis=0, ddof=1) / len(samples), rtol=0.05)
    np.testing.assert_array_equal(manifold, stored.caustics)
    assert not direct.any()


def test_added_parts_count_where_caustics_are_seen_directly_by_their_variance_there(capsys):
    shape, ones = (40, 30, 3), np.ones((40, 30, 3))
    direct = np.arange(40)[:, None] + np.zeros((1, 30)) < 8
    variance = np.where(direct[..., None], 1.0, 100.0) * ones
    stored = _reference.Reference(0.0 * ones, ones, {"samples": "8"}, ones, direct)
    with pytest.raises(DevError, match=r"2\.00 times"):
        reference.joined(stored, (2.0 * ones, variance, ones, ones, 8))
    # A region that is refused does not stand in the way of the other.
    differs = np.where(direct[..., None], 1.0, 2.0) * ones
    mean, joint, _, _, _ = reference.joined(stored, (differs, ones, ones, ones, 8))
    np.testing.assert_allclose(mean[direct], 1.0 / 2.0)
    np.testing.assert_array_equal(mean[~direct], 0.0)
    np.testing.assert_array_equal(joint[~direct], 1.0)
    assert "left as it is: elsewhere squares" in capsys.readouterr().out
    mean, joint, _, found, _ = reference.joined(stored, (ones, variance, ones, ones, 8))
    assert mean.shape == shape
    np.testing.assert_allclose(mean[direct], 1.0 / 2.0)
    np.testing.assert_allclose(joint[direct], 1.0 / 2.0)
    np.testing.assert_allclose(mean[~direct], 1.0 / 101.0)
    np.testing.assert_allclose(joint[~direct], 100.0 / 101.0)
    np.testing.assert_array_equal(found, direct)
    # However little it would count for: nothing that is not true is added.
    differs = np.where(direct[..., None], 1.0, 50.0) * ones
    mean, _, _, _, _ = reference.joined(stored, (differs, variance, ones, ones, 8))
    np.testing.assert_allclose(mean[direct], 1.0 / 2.0)
    np.testing.assert_array_equal(mean[~direct], 0.0)


def test_more_seconds_do_not_make_way_for_fewer(tmp_path):
    path, zeros = tmp_path / "a.exr", np.zeros(SHAPE)
    reference.check_worth(path, "1", 1.0)  # there is none
    _reference.write(path, zeros, zeros, {"sceneDigest": "1", "seconds": "600"}, zeros)
    reference.check_worth(path, "1", 600.0)
    reference.check_worth(path, "2", 1.0)  # of what the scene was before
    with pytest.raises(DevError, match="rendered for 600 s"):
        reference.check_worth(path, "1", 599.0)


def test_a_window_takes_the_place_of_stored_pixels():
    zeros, threes, ones = np.zeros(SHAPE), np.full(SHAPE, 3.0), np.ones((2, 1, 3))
    stored = _reference.Reference(zeros, threes, {"samples": "8"}, zeros, zeros[..., 0] > 1.0)
    mean, variance, caustics, direct, samples = reference.replaced(
        stored, (ones, 2.0 * ones, ones, ones, 99), (3, 1, 1, 2)
    )
    inside = np.zeros(SHAPE)
    inside[1:3, 3:4] = 1.0
    np.testing.assert_array_equal(mean, inside)
    np.testing.assert_array_equal(variance, 3.0 - inside)
    assert (samples, caustics is stored.caustics, direct is stored.direct) == (8, True, True)
    assert not stored.mean.any()
    with pytest.raises(DevError, match="render it longer"):
        reference.replaced(stored, (ones, 4.0 * ones, ones, ones, 99), (3, 1, 1, 2))
    with pytest.raises(DevError, match="not within 4x3"):
        reference.window_edges((3, 1, 1, 3), (4, 3))


def test_what_is_added_later_leaves_windows_as_they_are(tmp_path):
    zeros, ones, path = np.zeros(SHAPE), np.ones(SHAPE), tmp_path / "a.exr"
    about = {"samples": "8", "seeds": "500000", "seconds": "600", "method": "SHEETS"}
    stored = _reference.Reference(zeros, ones, about, zeros)
    for window, folder in (((3, 1, 1, 2), "first"), ((0, 0, 2, 1), "second")):
        (tmp_path / folder).mkdir()
        _, _, width, height = window
        for seed in range(reference.LEAST_PARTS):
            part = np.full((8, height, width, 3), 5.0)
            add_part(tmp_path / folder, seed, part, part[0])
        parts = reference.Parts(tmp_path / folder)
        reference.write(path, {"method": "PT"}, parts, stored, window)
        stored = _reference.read(path)
    assert reference.windows_of(stored) == [(3, 1, 1, 2), (0, 0, 2, 1)]
    mean, variance, _, _, _ = reference.joined(stored, (ones, ones, zeros, zeros, 8))
    windows = np.zeros(SHAPE, bool)
    windows[1:3, 3] = windows[0, 0:2] = True
    np.testing.assert_array_equal(mean[windows], 5.0)
    np.testing.assert_array_equal(variance[windows], stored.variance[windows])
    np.testing.assert_allclose(mean[~windows], 0.5)


def test_a_pixel_too_bright_to_be_stored_is_told(tmp_path):
    sun = np.full((8, *SHAPE), 1e5)
    add_part(tmp_path, 1, sun, sun[0])
    about = {"method": "PT"}
    with pytest.raises(DevError, match="too bright"):
        reference.write(tmp_path / "a.exr", about, reference.Parts(tmp_path), None)


def test_parts_are_added_to_the_same_picture_alone(tmp_path):
    path, zeros = tmp_path / "a.exr", np.zeros(SHAPE)
    height, width, _ = SHAPE
    with pytest.raises(DevError, match="there is no"):
        reference.stored_reference(path, "1", (width, height))
    _reference.write(path, zeros, zeros, {"sceneDigest": "1", "samples": "7"}, zeros)
    assert reference.stored_reference(path, "1", (width, height)).samples == 7
    with pytest.raises(DevError, match="scene has changed"):
        reference.stored_reference(path, "2", (width, height))
    with pytest.raises(DevError, match="4x3 pixels"):
        reference.stored_reference(path, "1", (8, 8))


@pytest.mark.parametrize("layers", [2, 3, 4])
def test_a_reference_is_read_as_it_was_written(tmp_path, layers):
    mean, variance, caustics = np.random.default_rng(2).random((3, *SHAPE))
    written = caustics if layers >= 3 else None
    direct = mean[..., 0] > 0.4 if layers == 4 else None
    _reference.write(tmp_path / "a.exr", mean, variance, {"samples": "7"}, written, direct)
    found = _reference.read(tmp_path / "a.exr")
    assert found.samples == 7
    np.testing.assert_allclose(found.mean, mean, rtol=2.0**-10 / _reference.FINE)
    np.testing.assert_allclose(found.variance, variance, rtol=3e-3)
    if layers == 4:
        np.testing.assert_array_equal(found.direct, direct)
    else:
        assert found.direct is None
    if layers >= 3:
        np.testing.assert_allclose(found.caustics, caustics, rtol=1e-3, atol=1e-6)
    else:
        assert found.caustics is None


def test_what_rounding_leaves_is_within_the_stated_error(tmp_path):
    # Of evenly lit surfaces, and on and beside a power of two.
    mean = np.geomspace(0.2, 5.0, 30000).reshape(100, 100, 3)
    mean[0, 0], mean[0, 1] = 1.0, np.nextafter(1.0, 0.0)
    _reference.write(tmp_path / "a.exr", mean, np.zeros(mean.shape), {"samples": "7"})
    found = _reference.read(tmp_path / "a.exr")
    squares = (found.mean - mean) ** 2
    assert (squares <= 4.0 * found.variance).all()
    np.testing.assert_allclose(squares.mean(), found.variance.mean(), rtol=0.1)


def test_a_sun_that_half_floats_cannot_hold_is_refused(tmp_path):
    mean = np.full(SHAPE, 1e6)
    with pytest.raises(ValueError, match="half floats"):
        _reference.write(tmp_path / "a.exr", mean, np.zeros(SHAPE), {})
