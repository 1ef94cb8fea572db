# SPDX-License-Identifier: GPL-3.0-or-later
"""Which methods `./dev bench` compares, and what it checks of its own measurements."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from tests.instruments.bench import _checks, _page, _standings, _summary
from tests.instruments.bench._methods import WITH_GLINTS
from tests.instruments.bench._metrics import Estimate
from tests.instruments.bench._summary import Curve, Point, RegionErrors, SceneResult

BUDGET = 8.0


def region(mse=1.0, bias=0.0, bias_z=0.0, shared=None, trimmed=None, own=0.0):
    trimmed = mse if trimmed is None else trimmed
    biases = (bias, bias_z, bias, bias_z)
    return RegionErrors(mse, 0.01 * mse, trimmed, mse, trimmed, *biases, shared, own, own)


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
        processors=("one",),
        flip=Estimate(0.1, 0.01, 2),
        regions=regions,
        success_rate=None,
        trials=None,
        capped_energy_share=None,
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


def test_rows_of_the_files_have_what_the_page_has():
    shared = region(mse=0.5, shared=(0.1, 0.02))
    result = scene(sms=[point(regions={"image": shared})], cycles_pt=[point(mse=2.0)])
    ours, theirs = _summary.rows_of([result])
    assert (ours["method"], ours["region"], ours["mse"], ours["charted"]) == (
        "sms",
        "image",
        0.5,
        True,
    )
    assert (ours["cycles_over_this"], ours["sms_over_this"], ours["luxcore_over_this"]) == (
        4.0,
        1.0,
        None,
    )
    assert (ours["shared"], ours["shared_error"], theirs["shared"]) == (0.1, 0.02, None)
    assert ours.keys() == theirs.keys()


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
    caustics_known=True,
)


def difference(method, *points, **changes):
    flat = SimpleNamespace(**vars(FLAT) | changes)
    return _summary._difference(Curve(method, list(points)), flat)


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
    nowhere_known = {"regions": {"image": None}, "caustics_known": False}
    assert not difference("cycles-pt", point(regions={"image": dark}), **nowhere_known)


@pytest.mark.parametrize(
    ("shared", "error", "other"), [(0.09, 0.01, True), (0.09, 0.03, False), (0.019, 1e-4, False)]
)
def test_a_flat_caustic_in_place_of_a_net_is_something_else(shared, error, other):
    assert bool(difference("cycles-mnee", point(shared=(shared, error)))) == other
    assert not difference("lux-cache", point(shared=(shared, error)))  # blurred by design


@pytest.mark.parametrize(
    ("method", "budgets", "left", "other"),
    [
        ("cycles-mnee", (2.0, 8.0), 0.55, True),
        ("cycles-mnee", (2.0, 8.0), 0.45, False),
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


def test_path_tracers_are_not_checked_where_there_may_be_caustics():
    result = scene(pt=falling(0.5, bias=-0.5, bias_z=-50.0))
    assert len(failing(result)) == 2  # 1/time and the mean
    result.caustics_known = False
    assert failing(result) == []


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
        ({"processors": ("one", "two")}, "same processor"),
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


# ---------------------------------------------------------------------------------------- promises


def named(name, where="image", budget=BUDGET, **errors):
    """A scene with one region beside the image; of each method's error, or error and trimmed error,
    a point at `budget`, None being a method that is not charted."""
    result = scene()
    result.name = name
    result.regions[where] = 1.0
    result.reference["mse"][where] = 1e-4
    for method, error in errors.items():
        mse, trimmed = error if isinstance(error, tuple) else (error, error)
        regions = {r: region(mse=mse or 1.0, trimmed=trimmed) for r in {"image", where}}
        curve = Curve(method.replace("_", "-"), [point(budget=budget, regions=regions)])
        curve.differs = "" if mse else "it is something else"
        result.curves[curve.method] = curve
    return result


def promised(*scenes):
    """Passed and text of each promise that applies, by what its title begins and ends with."""
    found = [check for check in _checks.checks(scenes, BUDGET) if check.promise]
    assert len({check.name for check in found}) == len(found)
    return {check.name: (check.passed, check.text) for check in found}


def test_a_scene_of_the_users_by_the_same_name_promises_nothing_of_its_own():
    ours = named("ring", "direct", sms=100.0, lt=0.9)
    titles = promised(ours)
    ours.is_example = False
    assert any("1/100" in title for title in titles)
    assert not any("1/100" in title for title in promised(ours))


BOTH = "SMS unbiased + LT: at most 1.15x the better of SMS and LT's error, whole image"


@pytest.mark.parametrize(
    ("both", "holds"), [((1.14, 1.16), (True, False)), ((1.16, 1.14), (False, True))]
)
def test_both_are_held_against_the_better_of_two(both, holds):
    found = promised(named("box", sms=(1.0, 3.0), lt=(2.0, 1.0), sms_lt=both))
    texts = [found[f"{BOTH} ({pixels})"] for pixels in ("all pixels", "trimmed")]
    assert tuple(passed for passed, _ in texts) == holds
    for (passed, text), error in zip(texts, both, strict=True):
        assert text.startswith(f"box {error:g}x at 8 s")
        assert ("TOO MUCH" in text) == (not passed)


def test_what_was_not_rendered_promises_nothing():
    assert not promised(named("box", sms=1.0, sms_lt=9.0), named("ring", lt=1.0, sms_lt=9.0))
    assert not promised(named("box", sms=1.0, lt=None, sms_lt=9.0)), "shows something else"


def test_a_promise_holds_on_all_scenes_and_at_all_times():
    kept = named("box", sms=1.0, lt=2.0, sms_lt=0.5)
    broken = named("ring", sms=1.0, lt=2.0, sms_lt=0.5)
    for name, error in (("sms", 1.0), ("lt", 2.0), ("sms-lt", 1.5)):
        broken.curves[name].points.insert(0, point(budget=2.0, mse=error))
    assert promised(kept)[f"{BOTH} (all pixels)"] == (True, "box 1/2 at 8 s")
    text = "box 1/2 at 8 s; ring 1.5x at 2 s, TOO MUCH (at 1 of 2 times)"
    assert promised(kept, broken)[f"{BOTH} (all pixels)"] == (False, text)


def test_what_cannot_be_compared_is_told_and_proves_nothing():
    result = named("box", sms=1.0, lt=2.0, sms_lt=0.5)
    for name in result.curves:
        result.curves[name].points.insert(0, point(budget=2.0, mse=0.5))
    result.curves["lt"].points[0] = point(budget=2.0, seconds=3.0)
    found = promised(result)[f"{BOTH} (all pixels)"]
    assert found == (True, "box 1/2 at 8 s (nothing to compare at 2 s)")
    late = named("box", sms=1.0, lt=2.0, sms_lt=0.5)
    late.curves["lt"].points[0] = point(seconds=2.0 * BUDGET)
    assert promised(late)[f"{BOTH} (all pixels)"] == (False, "box: nothing to compare at 8 s")


@pytest.mark.parametrize("method", ["sms_lt", "lt"])
@pytest.mark.parametrize(
    ("error", "scene_name", "holds"),
    [
        (0.9, "reflective_plane", {"SMS": True, "LuxCore": True}),
        (1.1, "reflective_plane", {"SMS": False, "LuxCore": True}),
        (2.1, "reflective_plane", {"SMS": False, "LuxCore": False}),
        (2.1, "ring", {"SMS": False}),
        (0.9, "ring", {"SMS": True}),
        (2.1, "swimming_pool", {}),
    ],
)
def test_caustics_that_are_seen_directly(method, error, scene_name, holds):
    errors = {"sms": 100.0, "lux_light": 10.0, method: error}
    found = promised(named(scene_name, "direct", **errors))
    who = {"sms_lt": "SMS unbiased + LT", "lt": "light tracing"}[method]
    than = {"SMS": "1/100 of SMS unbiased", "LuxCore": "1/5 of LuxCore light tracing"}
    end = "error, caustics that the camera sees directly"
    assert {name: passed for name, (passed, _) in found.items()} == {
        f"{who}: at most {than[against]}'s {end} ({pixels})": passed
        for against, passed in holds.items()
        for pixels in ("all pixels", "trimmed")
    }


def test_all_pixels_and_trimmed_are_judged_by_themselves():
    result = named("ring", "direct", sms=(100.0, 1.0), lt=(0.9, 0.02))
    assert sorted(passed for passed, _ in promised(result).values()) == [False, True]


@pytest.mark.parametrize("name", WITH_GLINTS)
@pytest.mark.parametrize(
    ("best", "yan", "cycles"), [(0.9, True, True), (1.9, True, False), (2.1, False, False)]
)
def test_glints_are_held_against_yan_and_cycles(name, best, yan, cycles):
    result = named(name, "glints", pt=5.0, sheets_lt=best, glints_yan=10.0, cycles_pt=50.0)
    found = promised(result)
    assert len(found) == 4
    for title, (passed, text) in found.items():
        assert passed == (yan if "Yan" in title else cycles)
        assert "by light sheets + LT" in text
    assert not promised(named("box", "glints", pt=0.1, glints_yan=10.0, cycles_pt=50.0))
    others = named(name, "glints", glints_yan=1.0, cycles_pt=100.0)
    assert not promised(others), "Yan's method is not ours"


def test_a_promise_says_where_the_reference_is_too_noisy():
    result = named("ring", "direct", sms=100.0, lt=0.9)
    near = {name: region(mse=0.9, own=0.1) for name in ("image", "direct")}
    result.curves["lt"].points[0] = point(regions=near)
    for passed, text in promised(result).values():
        assert passed
        assert "less than the reference is good for" in text


# ------------------------------------------------------------------------------------------- page

ABOUT = {
    "date": "today",
    "processor": "one",
    "threads": 1,
    "load_average": 0.0,
    "budgets": [BUDGET],
    "seeds": 2,
    "quick": False,
    "command": "./dev bench",
    "missing": {},
}


def page(result):
    checks = _checks.checks([result], BUDGET)
    return _page.render(ABOUT, [result], checks, {result.name: []}, {result.name: []})


@pytest.mark.parametrize(("own", "marked"), [(0.04, False), (0.06, True)])
def test_errors_near_the_reference_s_are_marked(own, marked):
    near = point(regions={"image": region(mse=1.0, own=own)})
    assert near.regions["image"].near_reference() == marked
    assert near.regions["image"].near_reference(trimmed=True) == marked
    result = scene(sms=[near], cycles_pt=[point(mse=2.0)])
    rows = [line for line in page(result).splitlines() if line.startswith("<tr>")]
    # Summary; MSE, trimmed MSE, and two ratios; work.
    marks = [row.count(_page.NEAR) for row in rows if "SMS unbiased</th>" in row]
    assert marks == ([1, 4, 0] if marked else [0, 0, 0])
    assert _standings.standing([result], "sms", "cycles-pt", "image", BUDGET).near_reference == (
        1 if marked else 0
    )


def test_a_bias_that_one_seed_cannot_tell_has_no_z_score():
    unknown = point(bias=0.1, bias_z=None)
    assert f"+10.00% ({_page.NONE})" in page(scene(lux_cache=[unknown]))
    assert not difference("lux-cache", unknown)


def test_the_page_tells_what_is_measured_from_what_is_promised():
    text = page(named("ring", "direct", sms=100.0, lt=2.0))
    sound, _, promises = text.partition("What methods should do")
    assert "light tracing: at most 1/100 of SMS unbiased" in promises
    assert "light tracing: at most 1/100 of SMS unbiased" not in sound
    assert "None of what they speak of was rendered" in page(scene(sms=[point()]))


def test_light_of_capped_estimates_is_called_so():
    capped = dataclasses.replace(point(), capped_energy_share=0.0125)
    text = page(scene(sms=[capped]))
    assert "manifold's light from<br>capped estimates" in text
    assert "1.250%" in text
    assert "share of capped" not in text
