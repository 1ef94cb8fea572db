# SPDX-License-Identifier: GPL-3.0-or-later
"""How a measured quantity grows with what is changed: power laws through measured points."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from tests.instruments.bench._ratios import MeasurementError, Spread

# What an exponent is called: up to the bound.
WORDS = {
    -0.15: "falls",
    0.15: "hardly changes",
    0.85: "grows less than in proportion",
    1.15: "grows in proportion",
    math.inf: "GROWS FASTER THAN IN PROPORTION",
}


@dataclass(frozen=True)
class PowerLaw:
    """y = factor x^exponent. Two points have no `error`."""

    exponent: float
    error: float | None  # standard error of the exponent, from what the points miss the line by
    factor: float

    def at(self, x: float) -> float:
        return self.factor * x**self.exponent

    def text(self) -> str:
        """Such as `0.931 ± 0.024`."""
        error = "" if self.error is None else f" ± {self.error:.3f}"
        return f"{self.exponent:.3f}{error}"


@dataclass(frozen=True)
class Growth:
    """A quantity over the values of a dimension, which ascend."""

    x: tuple[float, ...]
    y: tuple[Spread, ...]

    @property
    def law(self) -> PowerLaw | None:
        """Through all medians; None of a single point."""
        return power_law(self.x, [spread.median for spread in self.y]) if len(self.x) > 1 else None

    @property
    def bars(self) -> list[tuple[float, float]]:
        """How far the extremes lie below and above each median."""
        return [(s.median - s.low, s.high - s.median) for s in self.y]

    @property
    def last_exponent(self) -> float | None:
        """From the last value but one to the largest: where a constant part counts least."""
        if len(self.x) < 2:
            return None
        return power_law(self.x[-2:], [spread.median for spread in self.y[-2:]]).exponent


def power_law(x: Sequence[float], y: Sequence[float]) -> PowerLaw:
    """By least squares over logarithms: log y = log factor + exponent log x."""
    if len(x) != len(y):
        raise MeasurementError(f"{len(x)} values against {len(y)} measurements")
    if len(set(x)) < 2:
        raise MeasurementError("a power law needs two different values")
    if min(*x, *y) <= 0.0:
        raise MeasurementError("a power law needs positive numbers")
    log_x, log_y = [math.log(value) for value in x], [math.log(value) for value in y]
    line = statistics.linear_regression(log_x, log_y)
    mean = statistics.fmean(log_x)
    width = sum((value - mean) ** 2 for value in log_x)
    error = None
    if len(x) > 2:
        misses = (b - line.intercept - line.slope * a for a, b in zip(log_x, log_y, strict=True))
        error = math.sqrt(sum(miss**2 for miss in misses) / (len(x) - 2) / width)
    return PowerLaw(line.slope, error, math.exp(line.intercept))


def word(exponent: float) -> str:
    """What such a growth is called."""
    return next(text for bound, text in WORDS.items() if exponent <= bound)
