# SPDX-License-Identifier: GPL-3.0-or-later
"""From times to what is said of them: slopes, ratios of rounds, spreads and targets."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass


class MeasurementError(Exception):
    """A measurement came to no number; its text says why."""


@dataclass(frozen=True)
class Spread:
    """Median and extremes of a value over the rounds."""

    median: float
    low: float
    high: float
    rounds: int

    def text(self, unit: str = "") -> str:
        """Such as `1.42 (1.39 to 1.45 in 3 rounds)`; a single round has no spread."""
        value = f"{self.median:.3g}{unit}"
        if self.rounds == 1:
            return f"{value} (one round)"
        return f"{value} ({self.low:.3g} to {self.high:.3g} in {self.rounds} rounds)"


@dataclass(frozen=True)
class Target:
    """What a median should reach."""

    bound: float
    at_least: bool  # else at most

    def met(self, value: float) -> bool:
        return value >= self.bound if self.at_least else value <= self.bound

    def text(self, unit: str = "") -> str:
        return f"{'>=' if self.at_least else '<='} {self.bound:g}{unit}"


def spread(values: Sequence[float]) -> Spread:
    """Of one value for each round."""
    if not values:
        raise MeasurementError("there is no round")
    return Spread(statistics.median(values), min(values), max(values), len(values))


def seconds_per_sample(times: Sequence[tuple[int, float]]) -> float:
    """Slope of (samples, seconds) from the fewest samples to the most.

    Whatever a render costs once (scene, BVH, the picture's way back) is in every time and cancels.
    """
    if len({samples for samples, _ in times}) < 2:
        raise MeasurementError("a slope needs renders with two numbers of samples")
    (few, short), (many, long) = min(times), max(times)
    if long <= short:
        raise MeasurementError(
            f"{many} samples took {long:.3f} s, no longer than {few} with {short:.3f} s: "
            "the machine is too busy"
        )
    return (long - short) / (many - few)


def round_ratios(ours: Sequence[float], theirs: Sequence[float]) -> list[float]:
    """ours / theirs of each round: the two of a round stand close in time, so that a machine that
    slows down hits both."""
    if len(ours) != len(theirs):
        raise MeasurementError(f"{len(ours)} rounds against {len(theirs)}")
    if min(theirs, default=1.0) <= 0.0:
        raise MeasurementError("a time or rate is not positive")
    return [mine / other for mine, other in zip(ours, theirs, strict=True)]


def relative_difference(a: Sequence[float], b: Sequence[float]) -> float:
    """Largest |a - b| of any channel, relative to the larger of the two brightest channels."""
    scale = max(*map(abs, a), *map(abs, b))
    difference = max(abs(x - y) for x, y in zip(a, b, strict=True))
    return difference / scale if scale > 0.0 else 0.0
