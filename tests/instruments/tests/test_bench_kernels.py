# SPDX-License-Identifier: GPL-3.0-or-later
"""What `./dev bench kernels` makes of Google Benchmark's JSON."""

import re
import sys

import pytest

from tests.instruments.bench import kernels
from tests.instruments.bench._ratios import MeasurementError


def google_run(name, rate, **more):
    """A repetition as Google Benchmark 1.7 writes it."""
    run = {
        "name": name,
        "family_index": 0,
        "per_family_instance_index": 0,
        "run_name": name,
        "run_type": "iteration",
        "repetitions": 3,
        "repetition_index": 0,
        "threads": 1,
        "iterations": 31,
        "real_time": 2.2e7,
        "cpu_time": 2.1e7,
        "time_unit": "ns",
        "items_per_second": rate,
        "label": "ray",
    }
    return run | more


def google_mean(name, rate):
    return google_run(f"{name}_mean", rate, run_name=name, run_type="aggregate")


def google_error(name, message):
    """A kernel that refused: no rate and no label."""
    run = google_run(name, 0.0, error_occurred=True, error_message=message)
    del run["items_per_second"], run["label"]
    return run


def read(*runs, names=None):
    names = names or list(dict.fromkeys(run["run_name"] for run in runs))
    return kernels.read({"context": {}, "benchmarks": list(runs)}, names)


def test_median_and_spread_are_of_the_repetitions_alone():
    rates = (4e6, 1e6, 2e6)
    (kernel,) = read(
        *(google_run("closest/1e4", rate) for rate in rates), google_mean("closest/1e4", 9e6)
    )
    assert (kernel.name, kernel.item, kernel.error) == ("closest/1e4", "ray", "")
    spread = kernel.per_second
    assert (spread.low, spread.median, spread.high, spread.rounds) == (1e6, 2e6, 4e6, 3)
    assert kernel.nanoseconds == pytest.approx(500.0)


def test_counters_are_what_google_benchmark_does_not_know():
    (kernel,) = read(google_run("walk", 1e6, success=0.25, rays_per_walk=17.0))
    assert kernel.counters == {"success": 0.25, "rays_per_walk": 17.0}


def test_kernels_keep_the_order_of_the_names():
    found = read(google_run("b", 1e6), google_run("a", 2e6), google_run("c", 3e6), names=["a", "b"])
    assert [kernel.name for kernel in found] == ["a", "b"]


@pytest.mark.parametrize(
    ("runs", "message"),
    [
        ([], "is missing in the program's output"),
        ([google_mean("walk", 1e6)], "is missing in the program's output"),
        ([google_run("walk", 1e6), google_error("walk", "no walk converges")], "no walk converges"),
        ([google_run("walk", 0.0)], "counted nothing"),
    ],
)
def test_a_kernel_without_a_number_says_why(runs, message):
    (kernel,) = read(*runs, names=["walk"])
    assert kernel.per_second is None
    assert kernel.error == message
    assert f"FAILED: {message}" in kernels.table([kernel])


def test_table():
    head, first, second = kernels.table(
        read(
            google_run("walk/plane", 1.6e6, success=0.4375, rays_per_walk=17.25),
            google_run("walk/plane", 2.0e6),
            google_run("walk/plane", 2.5e6),
            google_run("eval", 1e8),
        )
    ).splitlines()
    assert head.split() == ["kernel", "item", "ns", "M/s", "low", "to", "high"]
    assert first.split(maxsplit=7) == (
        ["walk/plane", "ray", "500.0", "2", "1.6", "to", "2.5", "success 0.438, rays per walk 17.2"]
    )
    assert second.split() == ["eval", "ray", "10.0", "100", "100", "to", "100"]


@pytest.mark.parametrize(("rate", "verdict"), [(1.0e6, "met"), (0.99e6, "not met")])
def test_a_promised_rate_is_held_against_its_target(rate, verdict):
    (line,) = kernels.promises(
        read(google_run("eval", 5e6), google_run(kernels.PROMISES[0].kernel, rate))
    )
    assert line.endswith(f"{rate / 1e6:.3g} M/s (one round), target >= 1 M/s: {verdict}")


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        ((1.0, 2.0, 2.5), "2 s (1 to 2.5 in 3 rounds), target <= 2 s: met"),
        ((2.01,), "2.01 s (one round), target <= 2 s: not met"),
    ],
)
def test_a_promised_time_is_held_against_its_target(seconds, text):
    name = "glints/prepare_heights_4096"
    (line,) = kernels.promises(read(*(google_run(name, 4096**2 / time) for time in seconds)))
    assert line.endswith(f", on one core: {text}")


def test_every_kind_of_map_is_promised():
    promised = [promise.kernel for promise in kernels.PROMISES]
    assert promised[1:] == ["glints/prepare_normals_4096", "glints/prepare_heights_4096"]


def test_no_promise_about_what_was_not_measured():
    assert kernels.promises(read(google_run("eval", 5e6))) == []
    (line,) = kernels.promises(read(names=[kernels.PROMISES[0].kernel]))
    assert line.endswith("FAILED")


def test_only_chooses_by_a_part_of_the_name():
    names = ["newton/ring", "walk/ring", "closest/1e2"]
    assert kernels.choose(names, re.compile("ring")) == names[:2]
    assert kernels.choose(names, re.compile("")) == names
    with pytest.raises(MeasurementError, match="no kernel matches 'pool'; there are: newton/ring"):
        kernels.choose(names, re.compile("pool"))


def test_a_program_that_fails_is_quoted():
    assert kernels.run(sys.executable, "-c", "print('text')") == "text\n"
    with pytest.raises(MeasurementError, match=r"exit code 3: no lamp"):
        kernels.run(sys.executable, "-c", "import sys; print('no lamp', file=sys.stderr); exit(3)")
