# SPDX-License-Identifier: GPL-3.0-or-later
"""What `./dev bench speed` makes of the times that it takes."""

import pytest

from tests.instruments.bench import _children, _ratios
from tests.instruments.bench._machine import CpuTimes
from tests.instruments.bench._ratios import MeasurementError, Target


def test_slope_is_free_of_fixed_costs():
    for fixed in (0.0, 7.0):
        times = [(30, fixed + 30 * 0.25), (10, fixed + 10 * 0.25)]  # in any order
        assert _ratios.seconds_per_sample(times) == pytest.approx(0.25)


@pytest.mark.parametrize(
    "times", [[], [(4, 1.0)], [(4, 1.0), (4, 2.0)], [(4, 2.0), (12, 2.0)], [(4, 2.0), (12, 1.0)]]
)
def test_no_slope_without_two_rising_times(times):
    with pytest.raises(MeasurementError):
        _ratios.seconds_per_sample(times)


def test_ratios_are_taken_round_by_round():
    # The machine became twice as slow: no effect on the ratios.
    assert _ratios.round_ratios([3.0, 1.5], [2.0, 1.0]) == [1.5, 1.5]


@pytest.mark.parametrize(("ours", "theirs"), [([1.0], [1.0, 2.0]), ([1.0], [0.0])])
def test_no_ratio_of_unequal_rounds_or_to_nothing(ours, theirs):
    with pytest.raises(MeasurementError):
        _ratios.round_ratios(ours, theirs)


def test_spread():
    spread = _ratios.spread([1.45, 1.39, 1.42])
    assert (spread.median, spread.low, spread.high) == (1.42, 1.39, 1.45)
    assert spread.text(" s") == "1.42 s (1.39 to 1.45 in 3 rounds)"
    assert _ratios.spread([2.0]).text() == "2 (one round)"
    with pytest.raises(MeasurementError):
        _ratios.spread([])


def test_targets():
    assert Target(1.3, at_least=True).met(1.3)
    assert not Target(1.3, at_least=True).met(1.29)
    assert Target(1.0, at_least=False).met(0.9)
    assert not Target(1.0, at_least=False).met(1.1)
    assert Target(4.0, at_least=False).text(" s") == "<= 4 s"


def test_difference_of_means_is_relative_to_the_brightest_channel():
    assert _ratios.relative_difference([1.0, 0.5], [1.0, 0.4]) == pytest.approx(0.1)
    assert _ratios.relative_difference([0.0], [0.0]) == 0.0


def test_share_of_others():
    before, after = CpuTimes(100.0, 10.0, 5.0), CpuTimes(120.0, 25.0, 10.0)
    assert before.others_share(after) == pytest.approx(0.5)
    assert before.others_share(before) == 0.0
    assert before.others_share(CpuTimes(110.0, 12.0, 9.0)) == 0.0  # clocks tick coarsely
    assert CpuTimes.now().total > 0.0


def test_a_failed_child_is_quoted_with_its_exception():
    log = "Read scene\n\nTraceback:\nnative.NativeError: no light\n[SDL] one more line\n[SDL] end\n"
    assert _children.last_words(log) == "native.NativeError: no light"
    assert _children.last_words("one\n\ntwo\nthree\n") == "two | three"
