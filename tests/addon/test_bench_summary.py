# SPDX-License-Identifier: GPL-3.0-or-later
"""Which methods `./dev bench` compares, and what it checks of its own measurements."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from tests.bench import _checks, _standings, _summary
from tests.bench._metrics import Estimate
from tests.bench._summary import Curve, Point, RegionErrors, SceneResult

BUDGET = 8.0


def region(mse=1.0, bias=0.0, bias_z=0.0, shared=None):
    return RegionErrors(mse, 0.01 * mse, mse, mse, mse, bias, bias_z, bias, bias_z, shared)


def point(budget=BUDGET, seconds=None, regions=None, **errors):
    regions = regions or {"image": region(**errors)}
    return Point(
        budget=budget,
        seeds=2,
        render_seconds=seconds or budget,
        load_seconds=0.5,
        wall_seconds=budget + 2.0,
        samples=64.0,
        peak_memory=1e8,
        others_share=0.0,
        flip=Estimate(0.1, 0.01, 2),
        regions=regions,
        success_rate=None,
        trials=None,
        capped_energy=None,
    )


def scene(**curves):
    """Points by method, a dash in its name being an underscore."""
    curves = {name.replace("_", "-"): points for name, points in curves.items()}
    return SceneResult(
        "box",
        (64, 64),
        {"image": 1.0},
        {"mse": {"image": 1e-4}},
        1.0,
        {name: Curve(name, points) for name, points in curves.items()},
    )


def test_ratio_at_equal_time_says_how_many_times_better():
    result = scene(sms=[point(mse=0.5)], cycles_pt=[point(mse=2.0)])
    assert result.equal_time("sms", "cycles-pt", "image", BUDGET) == 4.0
    assert result.equal_time("cycles-pt", "sms", "image", BUDGET) == 0.25


@pytest.mark.parametrize(("seconds", "compared"), [(8.39, True), (8.41, False), (7.5, False)])
def test_times_that_differ_by_more_than_five_percent_are_not_compared(seconds, compared):
    result = scene(sms=[point(seconds=seconds)], cycles_pt=[point()])
    assert (result.equal_time("sms", "cycles-pt", "image", BUDGET) is not None) == compared


def test_nothing_is_compared_that_was_not_measured():
    result = scene(sms=[point(mse=-1e-6)], cycles_pt=[point()], pt=[point(budget=4.0)])
    for pair in (("sms", "cycles-pt"), ("cycles-pt", "pt"), ("cycles-pt", "lux-light")):
        assert result.equal_time(*pair, "image", BUDGET) is None


@pytest.mark.parametrize("change", [{"mse": -1e-6}, {"mse": 0.5, "seconds": 1.2 * BUDGET}])
def test_the_best_of_a_renderer_can_be_compared(change):
    result = scene(lux_light=[point(mse=2.0)], lux_cache=[point(**change)])
    assert result.best_of("luxcore", "image", BUDGET) == "lux-light"
    alone = scene(lux_cache=[point(**change)])
    assert alone.best_of("luxcore", "image", BUDGET) is None


FLAT = SimpleNamespace(  # of mean 2 and variance 0.01
    regions={"image": None, "caustics": None, "rest": None},
    reference=SimpleNamespace(mean=np.full((4, 4, 3), 2.0), variance=np.full((4, 4, 3), 0.01)),
)


def difference(method, *points):
    return _summary._difference(Curve(method, list(points)), FLAT)


@pytest.mark.parametrize(
    ("bias", "z", "other"), [(0.03, 3.0, False), (0.01, 30.0, False), (-0.03, -5.0, True)]
)
def test_another_renderer_with_another_mean_renders_something_else(bias, z, other):
    found = point(bias=bias, bias_z=z)
    assert bool(difference("cycles-pt", found)) == other
    assert not difference("sms", found)  # ours stands for what it is


def test_path_tracers_are_judged_beside_the_caustics():
    dark = region(bias=-0.5, bias_z=-50.0)
    missed = point(regions={"image": dark, "caustics": dark, "rest": region()})
    assert not difference("cycles-pt", missed)
    assert "normal maps" in difference("cycles-mnee", missed)


@pytest.mark.parametrize(
    ("shared", "error", "other"), [(0.09, 0.01, True), (0.09, 0.03, False), (0.019, 1e-4, False)]
)
def test_a_flat_caustic_in_place_of_a_net_is_something_else(shared, error, other):
    assert bool(difference("cycles-mnee", point(shared=(shared, error)))) == other
    assert not difference("lux-cache", point(shared=(shared, error)))  # blurred by design


@pytest.mark.parametrize(
    ("method", "budgets", "left", "other"),
    [
        ("cycles-mnee", (2.0, 8.0), 0.85, True),
        ("cycles-mnee", (2.0, 8.0), 0.75, False),
        ("cycles-mnee", (4.0, 8.0), 0.85, False),
        ("cycles-pt", (2.0, 8.0), 0.85, False),
        ("sms", (2.0, 8.0), 0.85, False),
    ],
)
def test_an_error_that_time_does_not_lower_is_no_noise(method, budgets, left, other):
    points = [point(budget=budgets[0], mse=1.0), point(budget=budgets[1], mse=left)]
    assert bool(_summary._standstill(Curve(method, points))) == other


def test_what_is_something_else_is_not_compared():
    result = scene(cycles_mnee=[point()], sms=[point()])
    assert result.equal_time("sms", "cycles-mnee", "image", BUDGET) == 1.0
    result.curves["cycles-mnee"].differs = "it is something else"
    assert result.equal_time("sms", "cycles-mnee", "image", BUDGET) is None


def test_standing_is_the_geometric_mean_over_scenes():
    scenes = [
        scene(sms=[point(mse=1.0)], lux_light=[point(mse=mse)], lux_cache=[point(mse=16.0)])
        for mse in (2.0, 8.0)
    ]
    found = _standings.standing(scenes, "sms", "luxcore", "image", BUDGET)
    assert (found.mean, found.low, found.high, found.scenes) == (pytest.approx(4.0), 2.0, 8.0, 2)
    assert _standings.standing(scenes, "sms", "cycles-pt", "image", BUDGET) is None


def failing(result, budget=BUDGET):
    return [check.name for check in _checks.checks([result], budget) if not check.passed]


def falling(exponent, budgets=(2.0, 4.0, 8.0), **errors):
    return [point(budget=b, mse=b**exponent, **errors) for b in budgets]


def test_a_sound_measurement_passes_all_checks():
    assert failing(scene(pt=falling(-1.0, shared=(5e-5, 1e-3)))) == []


def test_a_point_with_a_single_seed_does_not_hide_what_others_share():
    points = falling(-1.0, budgets=(4.0, BUDGET), shared=(0.02, 1e-3))
    points[0].regions["image"] = dataclasses.replace(points[0].regions["image"], shared=None)
    assert any("seeds" in name for name in failing(scene(pt=points)))


@pytest.mark.parametrize(("exponent", "passes"), [(-0.9, False), (-1.1, True), (-1.8, False)])
def test_error_that_does_not_fall_as_time_fails(exponent, passes):
    assert (not failing(scene(pt=falling(exponent)))) == passes


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"render_seconds": 8.5}, "times"),
        ({"others_share": 0.2}, "other program"),
        ({"regions": {"image": region(mse=1e-3)}}, "references"),
        ({"regions": {"image": region(mse=0.1, bias=0.02, bias_z=5.0)}}, "reference's mean"),
        ({"regions": {"image": region(mse=0.1, shared=(0.02, 1e-3))}}, "seeds"),
    ],
)
def test_each_check_can_fail(change, name):
    sound = falling(-1.0, budgets=(BUDGET,))[0]
    found = failing(scene(pt=[dataclasses.replace(sound, **change)]))
    assert len(found) == 1
    assert name in found[0]
