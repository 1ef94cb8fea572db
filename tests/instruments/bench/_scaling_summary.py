# SPDX-License-Identifier: GPL-3.0-or-later
"""From the runs of `./dev bench scaling` to what is said of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from tests.instruments.bench import _growth, _ratios
from tests.instruments.bench._growth import Growth
from tests.instruments.bench._ratios import Spread
from tests.instruments.bench._scaling_plan import (
    COST,
    PROCESSOR,
    QUANTITIES,
    Dimension,
    Outcome,
    Point,
)

REMARKABLE = 1.5  # by which a quantity must change over a dimension to be spoken of
PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


@dataclass(frozen=True)
class Series:
    """What came of a dimension: its points that were measured, and each quantity over them."""

    dimension: Dimension
    points: tuple[Point, ...]
    growths: Mapping[str, Growth]  # by quantity

    def per_pixel_sample(self, index: int, quantity: str) -> float:
        """Seconds, of a point's cost."""
        width, height = self.points[index].job["size"]
        return self.growths[quantity].y[index].median / (width * height)


def summarize(dimensions: Sequence[Dimension], outcome: Outcome) -> list[Series]:
    """Dimensions without a measured point are left out."""
    found = []
    for dimension in dimensions:
        points = [p for p, runs in outcome.runs.items() if p.dimension == dimension and runs]
        points.sort(key=lambda point: point.value)
        growths = {
            name: Growth(
                tuple(point.value for point in points),
                tuple(
                    _ratios.spread([quantity.value(run) for run in outcome.runs[point]])
                    for point in points
                ),
            )
            for name, quantity in QUANTITIES.items()
        }
        if points:
            found.append(Series(dimension, tuple(points), growths))
    return found


def shown(value: float, unit: str) -> str:
    """Three digits with the unit's prefix, such as `41.2 ms`; a share in percent."""
    if not unit:
        return f"{100.0 * value:.3g} %"
    factor, prefix = next((row for row in PREFIXES if value >= row[0]), PREFIXES[-1])
    text = f"{value / factor:.0f}" if value >= 100.0 * factor else f"{value / factor:.3g}"
    return f"{text} {prefix}{unit}"


def exponents(growth: Growth) -> list[str]:
    """Over all values and at the end, such as `0.412 ± 0.081` and `at the end 0.97`."""
    if not growth.law:
        return []
    end = [f"at the end {growth.last_exponent:.2f}"] if len(growth.x) > 2 else []
    return [growth.law.text(), *end]


def range_text(growth: Growth, unit: str) -> str:
    """From the dimension's smallest value to its largest."""
    return f"{shown(growth.y[0].median, unit)} to {shown(growth.y[-1].median, unit)}"


def cells(series: Series, quantity: str) -> list[str]:
    """Lines of a cell of the summary's table: exponents, range, that of one pixel's sample."""
    growth, unit = series.growths[quantity], QUANTITIES[quantity].unit
    lines = [*exponents(growth), range_text(growth, unit)]
    if QUANTITIES[quantity].panel in (COST, PROCESSOR):
        ends = (shown(series.per_pixel_sample(i, quantity), "s") for i in (0, -1))
        lines.append(f"{' to '.join(ends)} per pixel")
    return lines


def remarks(all_series: Sequence[Series]) -> list[str]:
    """Where the growth is that a user should know."""
    found = []
    for series in all_series:
        for name, quantity in QUANTITIES.items():
            growth = series.growths[name]
            first, last = growth.y[0].median, growth.y[-1].median
            if quantity.panel == PROCESSOR or len(growth.x) < 2:
                continue
            if max(first, last) < REMARKABLE * min(first, last):
                continue
            found.append(
                f"{series.dimension.name}: {quantity.label} {_growth.word(growth.last_exponent)} "
                f"at the end (exponent {growth.last_exponent:.2f}): "
                f"{range_text(growth, quantity.unit)}"
            )
    return found


def text(all_series: Sequence[Series]) -> str:
    """For the terminal."""
    lines = []
    for series in all_series:
        dimension = series.dimension
        ends = (dimension.label(series.points[i].value) for i in (0, -1))
        lines.append(f"{dimension.name}  {dimension.what}, {' to '.join(ends)}")
        lines += [
            f"   {quantity.label + ':':<27}{'; '.join(cells(series, name))}"
            for name, quantity in QUANTITIES.items()
        ]
    return "\n".join(lines)


def rows(all_series: Sequence[Series]) -> Iterator[dict]:
    """For the CSV file: one for each point and quantity."""
    for series in all_series:
        for name, quantity in QUANTITIES.items():
            for i, point in enumerate(series.points):
                spread: Spread = series.growths[name].y[i]
                cost = quantity.panel in (COST, PROCESSOR)
                yield {
                    "dimension": series.dimension.name,
                    "value": point.value,
                    "quantity": name,
                    "unit": quantity.unit,
                    "median": spread.median,
                    "low": spread.low,
                    "high": spread.high,
                    "rounds": spread.rounds,
                    "per_pixel_sample": series.per_pixel_sample(i, name) if cost else "",
                }
