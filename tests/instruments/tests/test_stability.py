# SPDX-License-Identifier: GPL-3.0-or-later
"""What the stability suite notices."""

import re

import numpy as np
import pytest

from tests.instruments.stability import _report
from tests.instruments.stability._cases import CASES
from tests.instruments.stability._measure import BLOCKS, METHODS, Pictures, compare
from tests.instruments.stability._scenes import brilliant

COMPARISONS = len(CASES) * len(METHODS)
ERROR = 0.002  # of the blocks, relative


def pictures(factor: float, seed: int, one_block: float = 1.0, nan_samples: int = 0) -> Pictures:
    """Noisy by ERROR about 1, times `factor`; one block also times `one_block`."""
    expected = np.full(BLOCKS**2 + 1, factor)
    expected[0] *= one_block
    error = np.append(np.full(BLOCKS**2, ERROR), ERROR / BLOCKS)
    noise = np.random.default_rng(seed).normal(size=error.size)
    return Pictures(expected + error * noise, error**2, 1.0, 0.0, {"nan_samples": nan_samples})


def verdict(method, found: Pictures) -> str:
    comparison = compare(found, pictures(1.0, 1), COMPARISONS)
    return _report.Result(CASES[2], method, found, comparison).verdict


@pytest.mark.parametrize("seed", range(2, 12))
def test_noise_passes(seed):
    assert verdict(METHODS[0], pictures(1.0, seed)) == _report.PASSES


@pytest.mark.parametrize("wrong", [{"factor": 1.02}, {"factor": 0.98}, {"one_block": 0.96}])
def test_wrong_light_fails(wrong):
    found = pictures(**({"factor": 1.0, "seed": 2} | wrong))
    assert verdict(METHODS[0], found) == _report.FAILS
    excused = next(method for method in METHODS if method.excuse)
    assert verdict(excused, found) == _report.KNOWN


@pytest.mark.parametrize(("case", "known"), [("point light", True), ("glass ball", False)])
def test_mnee_seeds_are_excused_where_path_tracing_is_blind(case, known):
    found = compare(pictures(0.5, 2), pictures(1.0, 1), COMPARISONS)
    method = next(method for method in METHODS if method.name == "MNEE seeds")
    where = next(c for c in CASES if c.name == case)
    mark = _report.Result(where, method, pictures(0.5, 2), found).verdict
    assert mark == (_report.KNOWN if known else _report.FAILS)


def test_a_million_triangles_are_so_many():
    case = next(c for c in CASES if c.name == "a million triangles")
    assert sum(len(shape.triangles) for shape in case.build().meshes) >= 1_000_000


def test_the_cut_stone_is_closed_and_faces_outwards():
    stone = brilliant(0.5)
    edges = {tuple(triangle[[i, i - 2]]) for triangle in stone.triangles for i in range(3)}
    assert len(edges) == 3 * len(stone.triangles)
    assert {(b, a) for a, b in edges} == edges
    a, b, c = stone.positions[stone.triangles].astype(np.float64).swapaxes(0, 1)
    volume = np.linalg.det(np.stack([a, b, c], axis=1)) / 6.0  # of tetrahedra to the origin
    assert (volume > 0.0).all()  # which is inside


def test_nothing_excuses_nan():
    excused = next(method for method in METHODS if method.excuse)
    assert verdict(excused, pictures(1.0, 2, nan_samples=1)) == _report.FAILS


def page_with(histogram: dict) -> str:
    """Of one case and one method, with made-up statistics."""
    found = pictures(1.0, 2)
    found.stats |= {"trial_estimates": 3, "trials": 8, "max_trials": 5, "capped_estimates": 0}
    found.stats |= histogram
    comparison = compare(found, pictures(1.0, 1), COMPARISONS)
    result = _report.Result(CASES[2], METHODS[0], found, comparison)
    return _report.page([(CASES[2], {METHODS[0].name: result})], [METHODS[0].name])


def test_the_page_shows_how_many_trials_estimates_took():
    counts = [2, 0, 1] + [0] * 14
    page = page_with({"trial_histogram": counts})
    bars = [float(h) for h in re.findall(r'<rect [^>]*height="([0-9.]+)"', page)]
    assert len(bars) == len(counts)
    assert [bar > 0.0 for bar in bars] == [count > 0 for count in counts]
    assert bars[0] == max(bars) == _report.HISTOGRAM_HEIGHT
    assert "<title>1 .. 1: 2</title>" in page
    assert "<title>4 .. 7: 1</title>" in page


@pytest.mark.parametrize("histogram", [{}, {"trial_histogram": [0] * 17}])
def test_without_trials_there_is_no_histogram(histogram):
    assert "<svg" not in page_with(histogram)
