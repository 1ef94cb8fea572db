# SPDX-License-Identifier: GPL-3.0-or-later
"""How `./dev bench scaling` chooses what to measure, fits power laws and tells of them."""

import random

import pytest

from tests.instruments.bench import (
    _children,
    _growth,
    _machine,
    _ratios,
    _scaling_plan,
    _scaling_summary,
)
from tests.instruments.bench._children import Progress, Run
from tests.instruments.bench._growth import Growth
from tests.instruments.bench._ratios import MeasurementError
from tests.instruments.bench._scaling_plan import BASE
from tools.common import DevError

DECADES = (1e2, 1e3, 1e4, 1e5, 1e6)
NOISE = 0.05  # standard deviation of log y
TRIALS = 2000


def noisy_laws(exponent):
    """Fits to that many noisy sets of measurements."""
    generator = random.Random(7)
    for _ in range(TRIALS):
        y = [3.0 * x**exponent * generator.lognormvariate(0.0, NOISE) for x in DECADES]
        yield _growth.power_law(DECADES, y)


def test_a_power_law_is_found_to_the_letter():
    law = _growth.power_law(DECADES, [3.0 * x**0.7 for x in DECADES])
    assert law.exponent == pytest.approx(0.7)
    assert law.error == pytest.approx(0.0, abs=1e-12)
    assert law.at(50.0) == pytest.approx(3.0 * 50.0**0.7)


@pytest.mark.parametrize("exponent", [-1.0, 0.0, 0.7])
def test_standard_errors_are_what_noise_makes_of_the_exponent(exponent):
    laws = list(noisy_laws(exponent))
    misses = [law.exponent - exponent for law in laws]
    assert abs(sum(misses) / TRIALS) < 4.0 * 0.0069 / TRIALS**0.5
    # NOISE over the root of the squared distances of log x from their mean: 0.05 / 7.28.
    deviation = (sum(miss**2 for miss in misses) / TRIALS) ** 0.5
    assert deviation == pytest.approx(0.00687, rel=0.06)
    variance = sum(law.error**2 for law in laws) / TRIALS
    assert variance**0.5 == pytest.approx(deviation, rel=0.08)


def test_two_points_have_an_exponent_without_an_error():
    law = _growth.power_law((1, 2), (8.0, 4.0))
    assert law.exponent == pytest.approx(-1.0)
    assert law.error is None
    assert law.text() == "-1.000"


@pytest.mark.parametrize(
    ("x", "y"),
    [((1.0,), (2.0,)), ((3.0, 3.0), (1.0, 2.0)), ((1.0, 2.0), (0.0, 1.0)), ((1.0, 2.0), (1.0,))],
)
def test_no_power_law_through_what_has_none(x, y):
    with pytest.raises(MeasurementError):
        _growth.power_law(x, y)


def growth(x, y):
    return Growth(tuple(x), tuple(_ratios.spread(values) for values in y))


def test_a_constant_part_hides_in_the_whole_and_not_at_the_end():
    found = growth(DECADES, ([1e4 + x] for x in DECADES))
    assert found.law.exponent < 0.6
    assert found.last_exponent == pytest.approx(0.963, abs=0.001)


def test_charts_show_medians_with_their_extremes():
    found = growth((1, 10), ([1.0, 3.0, 2.0], [5.0, 4.0, 7.0]))
    assert [spread.median for spread in found.y] == [2.0, 5.0]
    assert found.bars == [(1.0, 1.0), (1.0, 2.0)]
    assert growth((1,), ([2.0],)).law is None


@pytest.mark.parametrize(
    ("exponent", "word"),
    [
        (-1.0, "falls"),
        (0.1, "hardly changes"),
        (0.5, "grows less than in proportion"),
        (1.0, "grows in proportion"),
        (1.2, "GROWS FASTER THAN IN PROPORTION"),
    ],
)
def test_words(exponent, word):
    assert _growth.word(exponent) == word


# --------------------------------------------------------------------------------------- the plan


def test_each_dimension_departs_from_the_base_by_itself():
    changed = {"triangles": "quads", "map": "texels", "casters": "pieces", "image": "size"}
    for dimension in _scaling_plan.chosen(None, 6, quick=False):
        assert list(dimension.values) == sorted(set(dimension.values))
        for point in _scaling_plan.points([dimension], 6, 2.0):
            other = {k for k, v in (BASE | {"threads": 6}).items() if point.job[k] != v}
            assert other <= {changed.get(dimension.name, dimension.name)}


def test_values_are_what_the_jobs_make():
    known = _scaling_plan.dimensions(6)
    assert [2 * known["triangles"].change(v)["quads"] ** 2 for v in known["triangles"].values] == [
        98,
        968,
        10082,
        100352,
        999698,
    ]
    assert known["map"].values[0] == 128**2
    assert known["map"].values[-1] == 4096**2
    assert [known["casters"].change(v)["pieces"] ** 2 for v in known["casters"].values] == list(
        known["casters"].values
    )
    assert all(BASE["quads"] % known["casters"].change(v)["pieces"] == 0 for v in (4, 9, 25, 100))
    assert known["threads"].values == (1, 2, 4, 6)
    assert known["image"].label(64**2) == "64 x 64"


def test_dimensions_are_chosen_by_name():
    names = [d.name for d in _scaling_plan.chosen("image, lights,image", 2, quick=False)]
    assert names == ["image", "lights"]
    quick = _scaling_plan.chosen("lights", 2, quick=True)[0]
    assert quick.values == (1, 3, 10)
    assert quick.change(3) == {"lights": 3}


def test_what_a_chart_shows_can_be_told_apart():
    for panel in _scaling_plan.PANELS:
        drawn = [q for q in _scaling_plan.QUANTITIES.values() if q.panel == panel]
        assert len({q.color for q in drawn} - {""}) == len(drawn) > 0
        assert len({q.marker for q in drawn} - {""}) == len(drawn)


@pytest.mark.parametrize(
    ("text", "message"), [("lihgts", "no dimension 'lihgts'; there are: tri"), (" ,", "--only")]
)
def test_bad_names_are_refused(text, message):
    with pytest.raises(DevError, match=message):
        _scaling_plan.chosen(text, 2, quick=False)


# -------------------------------------------------------------------------------------- measuring


def run(job, slow=1.0):
    """What a child reports whose costs are known: the manifold's grows with the root of lights."""

    def rows(seconds, **stats):
        return [
            {
                "samples": n,
                "seconds": 0.5 + n * seconds,
                "cpu_seconds": 0.7 + 2.0 * n * seconds,
                "stats": stats,
            }
            for n in (2, 6)
        ]

    plain = 0.01 * slow
    report = {
        "export_seconds": 0.001 * job["lights"],
        "commit_seconds": 0.002 * job["lights"],
        "peak_memory": 5e6,
        "renders": {
            "PT": rows(plain),
            "SMS_UNBIASED": rows(
                plain + 0.1 * job["lights"] ** 0.5, trial_estimates=30, estimates=100
            ),
        },
    }
    return Run(1.0, 0, report)


@pytest.fixture
def lights():
    return _scaling_plan.chosen("lights", 2, quick=True)


@pytest.fixture
def measured(lights, monkeypatch, tmp_path):
    """Three rounds; in the second path tracing is slower; what failed is listed."""
    started = []

    def child(name, where, script, job, folder):
        started.append(job["lights"])
        if job["lights"] == 3 and len(started) > 3:
            raise MeasurementError("exit code 9")
        return run(job, slow=1.2 if 3 < len(started) < 7 else 1.0)

    monkeypatch.setattr(_children, "run", child)
    monkeypatch.setattr(Progress, "show", lambda *_: None)
    outcome = _scaling_plan.measure(_scaling_plan.points(lights, 2, 1.0), 3, tmp_path)
    return outcome, started


def test_points_take_turns_and_each_round_starts_elsewhere(measured):
    _, started = measured
    assert started == [1, 3, 10, 3, 10, 1, 10, 1]  # 3 failed in the second round


def test_a_failure_names_dimension_and_value_and_keeps_the_rest(measured):
    outcome, _ = measured
    assert list(outcome.failures.values()) == ["lights 3: exit code 9"]
    assert [len(runs) for runs in outcome.runs.values()] == [3, 1, 3]


def test_a_cost_that_does_not_grow_with_samples_is_a_failure(lights, monkeypatch, tmp_path):
    def child(name, where, script, job, folder):
        found = run(job)
        found.report["renders"]["PT"][1]["seconds"] = 0.0
        return found

    monkeypatch.setattr(_children, "run", child)
    monkeypatch.setattr(Progress, "show", lambda *_: None)
    outcome = _scaling_plan.measure(_scaling_plan.points(lights, 2, 1.0), 1, tmp_path)
    assert [why.partition(":")[0] for why in outcome.failures.values()] == [
        "lights 1",
        "lights 3",
        "lights 10",
    ]
    assert _scaling_summary.summarize(lights, outcome) == []


def test_peak_memory_forgets_what_was_before():
    size = 1 << 26
    held = bytearray(size)  # zeros: nothing is resident until it is written
    held[::4096] = b"\1" * (size // 4096)
    before = _machine.peak_memory()
    assert before >= _machine.resident_memory() > size
    del held
    _machine.reset_peak_memory()
    assert before - _machine.peak_memory() > 0.9 * size


@pytest.fixture
def series(lights, measured):
    return _scaling_summary.summarize(lights, measured[0])[0]


def test_quantities_are_what_the_runs_say(series):
    assert series.growths["pt"].y[0].high == pytest.approx(0.012)
    assert series.growths["pt"].y[0].median == pytest.approx(0.01)
    assert series.growths["pt_cpu"].y[0].median == pytest.approx(0.02)
    assert series.growths["manifold"].law.exponent == pytest.approx(0.5)
    assert series.growths["preparation"].law.exponent == pytest.approx(1.0)
    assert series.growths["memory"].law.exponent == pytest.approx(0.0)
    assert series.growths["found"].y[0].median == pytest.approx(0.3)
    assert series.per_pixel_sample(0, "pt") == pytest.approx(0.01 / 128**2)


def test_the_table_has_exponent_and_ends(series):
    assert _scaling_summary.cells(series, "preparation") == [
        "1.000 ± 0.000",
        "at the end 1.00",
        "3 ms to 30 ms",
    ]
    assert _scaling_summary.cells(series, "manifold")[2:] == [
        "100 ms to 316 ms",
        "6.1 µs to 19.3 µs per pixel",
    ]


def test_remarks_tell_what_changes(series):
    assert _scaling_summary.remarks([series]) == [
        "lights: SMS unbiased grows less than in proportion at the end (exponent 0.48): "
        "110 ms to 326 ms",
        "lights: the manifold's own grows less than in proportion at the end (exponent 0.50): "
        "100 ms to 316 ms",
        "lights: ready to render grows in proportion at the end (exponent 1.00): 3 ms to 30 ms",
    ]


def test_rows_of_the_csv_file(series):
    rows = list(_scaling_summary.rows([series]))
    assert len(rows) == 3 * len(_scaling_plan.QUANTITIES)
    first = rows[0]
    assert (first["dimension"], first["value"], first["quantity"]) == ("lights", 1, "pt")
    assert first["median"] == pytest.approx(0.01)
    assert first["rounds"] == 3
    assert first["per_pixel_sample"] == pytest.approx(0.01 / 128**2)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [(0.0412, "s", "41.2 ms"), (3.2e-6, "s", "3.2 µs"), (8.13e8, "B", "813 MB"), (0.4, "", "40 %")],
)
def test_numbers_have_three_digits_and_a_prefix(value, unit, text):
    assert _scaling_summary.shown(value, unit) == text
