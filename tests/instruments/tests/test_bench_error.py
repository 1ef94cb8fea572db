# SPDX-License-Identifier: GPL-3.0-or-later
"""What `./dev bench` makes of images and times, and the order in which it renders."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.images import _reference
from tests.instruments.bench import _children, _metrics, _scenes, _schedule, _store
from tests.instruments.bench._luxcore_textures import UntranslatedError
from tests.instruments.bench._methods import GROUPS, METHODS, suited
from tests.instruments.bench._metrics import Slope
from tests.instruments.bench._ratios import MeasurementError
from tests.instruments.bench._scenes import BLENDS, Scene

SHAPE = (64, 64, 3)


@pytest.fixture
def random():
    return np.random.default_rng(1)


@pytest.fixture
def truth(random):
    return 0.2 + random.random(SHAPE)


def noisy(random, truth, deviation=0.3):
    return truth + deviation * random.standard_normal(SHAPE)


def exact(truth):
    return np.zeros_like(truth)


def test_mse_is_the_variance_of_unbiased_noise(random, truth):
    found = _metrics.errors(noisy(random, truth), truth, exact(truth))
    assert found.mse == pytest.approx(0.09, abs=4.0 * found.mse_error)
    assert found.mse_error == pytest.approx(0.09 * np.sqrt(2.0 / 3.0) / 64.0, rel=0.2)


def test_noise_of_the_reference_is_no_error_of_the_image(random, truth):
    variance = np.full(SHAPE, 0.04)
    found = _metrics.errors(noisy(random, truth), noisy(random, truth, 0.2), variance)
    assert found.mse == pytest.approx(0.09, abs=4.0 * found.mse_error)


def test_what_was_subtracted_is_told(random, truth):
    variance = np.full(SHAPE, 0.04)
    variance[5, 7] = 400.0
    found = _metrics.errors(noisy(random, truth), truth, variance)
    assert found.reference_mse == pytest.approx(variance.mean())
    assert found.reference_mse_trimmed == pytest.approx(0.04)
    clean = _metrics.errors(noisy(np.random.default_rng(1), truth), truth, exact(truth))
    assert (clean.reference_mse, clean.reference_mse_trimmed) == (0.0, 0.0)


def test_relative_mse_does_not_depend_on_exposure(random, truth):
    image = noisy(random, truth)
    once = _metrics.errors(image, truth, exact(truth))
    brighter = _metrics.errors(10.0 * image, 10.0 * truth, exact(truth))
    assert brighter.rel_mse == pytest.approx(once.rel_mse)
    assert brighter.mse == pytest.approx(100.0 * once.mse)


def test_trimming_takes_the_outliers_and_little_else(random, truth):
    image = noisy(random, truth)
    clean = _metrics.errors(image, truth, exact(truth))
    image[5, 7] += 1000.0
    hit = _metrics.errors(image, truth, exact(truth))
    assert hit.mse > 100.0 * clean.mse
    assert hit.mse_trimmed == pytest.approx(clean.mse, rel=0.02)
    assert hit.rel_mse_trimmed == pytest.approx(clean.rel_mse, rel=0.05)
    assert hit.bias > 0.2
    assert abs(hit.bias_z) < 2.0  # a single pixel proves nothing
    assert abs(hit.bias_trimmed) < 0.05


@pytest.mark.parametrize(("factor", "biased"), [(1.0, False), (0.98, True), (1.02, True)])
def test_two_percent_of_energy_show_in_the_bias(random, truth, factor, biased):
    found = _metrics.errors(factor * noisy(random, truth, 0.1), truth, exact(truth))
    assert (abs(found.bias_z) > 4.0) == biased
    assert found.bias == pytest.approx(factor - 1.0, abs=0.01)


def test_masked_errors_are_those_of_the_pixels_inside(random, truth):
    image = noisy(random, truth)
    mask = np.zeros(SHAPE[:2], bool)
    mask[8:24, 32:48] = True  # whole blocks: the z-score is of their sums
    inside = _metrics.errors(image, truth, exact(truth), mask)
    cut = (slice(8, 24), slice(32, 48))
    assert inside == _metrics.errors(image[cut], truth[cut], exact(truth)[cut])


@pytest.mark.parametrize("shared", [0.0, 0.2])
def test_seeds_that_share_noise_are_found(random, truth, shared):
    common = shared * random.standard_normal(SHAPE)
    images = [noisy(random, truth) + common for _ in range(3)]
    found, error = _metrics.shared_error(images, truth)
    assert found == pytest.approx(shared**2, abs=4.0 * error)
    assert (found > 4.0 * error) == (shared > 0.0)


def test_dependent_pixels_are_judged_by_seeds():
    assert _metrics.cautious_z(50.0, [0.03, 0.01, 0.02]) == pytest.approx(np.sqrt(3.0) * 2.0)
    assert _metrics.cautious_z(-1.0, [-0.02, -0.021]) == -1.0
    assert _metrics.cautious_z(50.0, [0.03]) is None


def test_noise_that_neighbours_share_is_no_bias(random, truth):
    def z() -> float:
        noise = 0.1 * random.standard_normal(SHAPE)
        spread = sum(np.roll(noise, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1))
        return _metrics.errors(truth + spread, truth, exact(truth)).bias_z

    assert 0.7 < np.std([z() for _ in range(100)]) < 1.6  # 3 if pixels were taken one by one


def test_outliers_of_the_reference_are_trimmed_as_well(random, truth):
    reference, variance = truth.copy(), np.zeros(SHAPE)
    reference[5, 7] += 10.0
    variance[5, 7] = 400.0  # so that the error less the variance is very negative
    found = _metrics.errors(noisy(random, truth), reference, variance)
    assert found.mse < 0.05
    assert found.mse_trimmed == pytest.approx(0.09, rel=0.05)


def test_slope_of_a_power_law():
    x = [1.0, 2.0, 4.0, 8.0]
    slope = _metrics.log_slope(x, [3.0 / value for value in x], [0.03 / value for value in x])
    assert slope.value == pytest.approx(-1.0)
    # Errors of 1 % over logarithms with a sum of squares of 5 (ln 2)^2.
    assert slope.error == pytest.approx(0.01 / (np.sqrt(5.0) * np.log(2.0)))
    assert isinstance(slope, Slope)


def test_slope_trusts_points_by_their_errors():
    slope = _metrics.log_slope([1.0, 2.0, 4.0], [1.0, 0.5, 10.0], [0.001, 0.001, 100.0])
    assert slope.value == pytest.approx(-1.0, abs=0.01)


@pytest.mark.parametrize(
    ("target", "text"), [(0.5, "2"), (0.25, "4"), (2.0, "< 1"), (0.01, "> 4"), (0.7071, "1.41")]
)
def test_time_to_a_target_is_interpolated_never_extrapolated(target, text):
    assert _metrics.time_to_reach(target, [1.0, 2.0, 4.0], [1.0, 0.5, 0.25]) == text


@pytest.mark.parametrize(
    ("values", "text"),
    [([2.0, -0.1], "< 2"), ([2.0, -0.1, 0.1], "< 2"), ([-0.1, 2.0], "< 1"), ([2.0, 0.0], "< 2")],
)
def test_an_error_below_the_references_has_reached_the_target(values, text):
    assert _metrics.time_to_reach(0.5, [1.0, 2.0, 4.0][: len(values)], values) == text


def test_estimate_over_seeds():
    found = _metrics.estimate([1.0, 2.0, 3.0])
    assert (found.mean, found.count) == (2.0, 3)
    assert found.error == pytest.approx(1.0 / np.sqrt(3.0))
    assert _metrics.estimate([1.0]).error is None


def test_caustics_are_where_they_matter(truth):
    caustics = np.zeros(SHAPE)
    caustics[:8] = 0.5 * truth[:8]
    caustics[8:16] = 0.01 * truth[8:16]
    mask = _metrics.caustics_mask(truth, caustics)
    assert mask[:8].all()
    assert not mask[8:].any()


def test_display_is_srgb():
    shown = _metrics.display(np.array([0.0, 0.001, 0.214, 1.0, 7.0]), 1.0)
    np.testing.assert_allclose(shown, [0.0, 0.01292, 0.5, 1.0, 1.0], atol=1e-3)


def test_everything_takes_turns_and_seeds_end_one_by_one():
    scenes = [Scene(name, Path(f"{name}.blend"), None) for name in "ab"]
    methods = ("pt", "sms", "lux-light")
    tasks = _schedule.plan(scenes, methods, (1.0, 2.0), (1, 2), 2)
    keys = [(task.seed, task.budget, task.scene.name, task.method) for task in tasks]
    assert len(set(keys)) == len(keys) == 2 * 2 * 2 * 3
    assert [key[:3] for key in keys] == sorted(key[:3] for key in keys)
    assert {keys[i][3] for i in range(0, len(keys), 3)} == set(methods)  # who comes first


def test_what_renders_something_else_is_not_rendered():
    scenes = [Scene(name, BLENDS / f"{name}.blend", None) for name in ("cornell", "ring")]
    tasks = _schedule.plan(scenes, ("sms", "lux-light"), (1.0,), (1,), 2)
    assert [(task.scene.name, task.method) for task in tasks] == [
        ("cornell", "sms"),
        ("ring", "lux-light"),
        ("ring", "sms"),
    ]


def test_a_scene_of_the_users_by_the_same_name_is_rendered(tmp_path):
    scene = Scene("cornell", tmp_path / "cornell.blend", None)
    assert len(_schedule.plan([scene], ("lux-light",), (1.0,), (1,), 2)) == 1


def test_what_cannot_be_shown_is_no_failure(monkeypatch):
    errors = {"lux-light": UntranslatedError("a sun"), "sms": MeasurementError("a crash")}
    rendered = []

    def render(task):
        rendered.append(task)
        if task.method in errors:
            raise errors[task.method]
        return "record"

    monkeypatch.setattr(_store, "find", lambda task: None)
    monkeypatch.setattr(_store, "render", render)
    scene = Scene("box", Path("box.blend"), None)
    tasks = _schedule.plan([scene], ("pt", "sms", "lux-light"), (1.0, 2.0), (1,), 2)
    outcome = _schedule.render_all(tasks)
    assert [task.method for task in outcome.records] == ["pt", "pt"]
    assert outcome.failures == {("box", "sms"): "a crash"}
    assert outcome.untranslated == {("box", "lux-light"): "a sun"}
    assert len(rendered) == 4  # what failed is not tried again


@pytest.mark.parametrize(("undisturbed", "of_sms"), [(False, 0.5), (True, 0.01)])
def test_what_was_disturbed_is_rendered_again(monkeypatch, undisturbed, of_sms):
    def record(others):
        return _store.Record({}, 1.0, others, "one", Path("image.npy"))

    found = {"pt": record(0.0), "sms": record(0.5), "lux-light": None}
    monkeypatch.setattr(_store, "find", lambda task: found[task.method])
    monkeypatch.setattr(_store, "render", lambda task: record(0.01))
    scene = Scene("box", Path("box.blend"), None)
    tasks = _schedule.plan([scene], tuple(found), (1.0,), (1,), 2)
    outcome = _schedule.render_all(tasks, undisturbed)
    shares = {task.method: record.others_share for task, record in outcome.records.items()}
    assert shares == {"pt": 0.0, "sms": of_sms, "lux-light": 0.01}


def test_an_image_with_a_value_that_is_no_number_is_a_failure(monkeypatch, tmp_path):
    def run(name, where, script, job, folder, limit):
        np.save(job["image"], np.where(np.arange(12) == 5, np.nan, 1.0).reshape(2, 2, 3))
        return _children.Run(1.0, 0, {"samples": 1.0})

    monkeypatch.setattr(_children, "run", run)
    monkeypatch.setattr(_store, "FOLDER", tmp_path)
    task = _store.Task(_scenes.named("cornell"), "cycles-pt", 1.0, 1, 2)
    earlier = {"report": {}, "wall_seconds": 1.0, "others_share": 0.5, "processor": "one"}
    record = _store._path(task)
    np.save(record.with_suffix(".npy"), np.ones((2, 2, 3)))
    record.write_text(json.dumps(earlier))
    assert _store.find(task).processor == "one"
    with pytest.raises(MeasurementError, match="1 values"):
        _store.render(task)
    assert _store.find(task) is None
    del earlier["processor"]  # as another version of the bench would store it
    record.write_text(json.dumps(earlier))
    assert _store.find(task) is None


@pytest.mark.parametrize(
    ("method", "layer", "known"),
    [("SHEETS PT", True, True), ("PT", True, False), ("", False, False)],
)
def test_path_tracing_does_not_tell_where_caustics_are(method, layer, known, tmp_path):
    zeros, path = np.zeros((2, 2, 3)), tmp_path / "a.exr"
    _reference.write(path, zeros, zeros, {"method": method}, zeros if layer else None)
    assert Scene("box", tmp_path / "box.blend", path).caustics_known == known
    if layer:  # of those of blend_scenes/ the one that is path traced has none
        assert Scene("cornell", BLENDS / "cornell.blend", path).caustics_known


def test_insets_of_glints_are_of_pictures_of_their_size(tmp_path):
    zeros, path = np.zeros((128, 128, 3)), tmp_path / "a.exr"
    _reference.write(path, zeros, zeros, {}, zeros)
    assert "glints" not in Scene("kettle", BLENDS / "kettle.blend", path).regions
    assert "glints" in _scenes.named("kettle").regions


def test_light_tracing_is_where_the_name_says():
    for name, method in METHODS.items():
        if method.family != "specula":
            continue
        settings = method.job["specula"]
        traced = name == "lt" or name.endswith("-lt") or name.startswith("glints-")
        if settings["method"].startswith(("SMS_", "MNEE")):
            assert settings["light_tracing"] == ("ON" if traced else "OFF")
        assert (settings["method"] == "LT") == (name == "lt")
        biased = "biased" in name.split("-") or name in ("glints-walks-8", "glints-yan")
        assert method.unbiased == (not biased and not method.hidden)


def test_methods_for_glints_run_where_there_are_any():
    glints = [name for name in METHODS if name.startswith("glints-")]
    glints.append("pt-plain")
    for name, methods in (("shoes", glints), ("kettle", glints), ("cornell", [])):
        assert suited(glints, _scenes.example(name)) == methods
    assert suited(glints, Scene("box", Path("box.blend"), None)) == glints, "who knows"
    scene = _scenes.example("ring")
    tasks = _schedule.plan([scene], ["pt", *glints], (1.0,), (1,), 2)
    assert [task.method for task in tasks] == ["pt"]


def test_methods_fit_into_their_charts():
    for group in GROUPS:
        members = [method for method in METHODS.values() if group in method.groups]
        assert 2 <= len(members) <= 8
        # Either colour alone or marker and line alone tell them apart.
        assert len({method.color for method in members}) == len(members)
        assert len({(method.marker, method.line) for method in members}) == len(members)


def test_a_method_looks_like_no_other_one():
    looks = {name: (m.color, m.marker, m.line) for name, m in METHODS.items()}
    assert len(set(looks.values())) == len(looks)


def test_light_tracing_of_others_stands_beside_ours():
    assert {"lt", "lux-light"} <= {n for n, m in METHODS.items() if "light" in m.groups}


def test_all_ways_to_see_glints_share_a_chart():
    wanted = {"pt", "pt-plain", "sheets-lt", "glints-walks", "glints-walks-8", "glints-yan"}
    found = {name for name, method in METHODS.items() if "glints" in method.groups}
    assert found == wanted | {"cycles-pt"}
    assert METHODS["pt-plain"].job["materials"] == {"glints": "OFF"}
    assert "materials" not in METHODS["pt"].job
