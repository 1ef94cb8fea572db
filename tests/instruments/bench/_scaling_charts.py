# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts of cost, memory and preparation against what is changed."""

from __future__ import annotations

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from tests.instruments.bench._charts import STYLE
from tests.instruments.bench._growth import Growth
from tests.instruments.bench._scaling_plan import PANELS, QUANTITIES, Quantity
from tests.instruments.bench._scaling_summary import Series, exponents, shown

PANEL_WIDTH, HEIGHT = 4.8, 4.6  # inches
LEGEND_SHARE = 0.15  # of the height
ROOM = 1.6  # factor beyond the lowest and highest point
CROWDED = 100.0  # highest over lowest, from which ticks at powers of ten are enough


def growth_chart(series: Series) -> plt.Figure:
    """A panel for each kind of quantity, both axes logarithmic."""
    dimension = series.dimension
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, len(PANELS), figsize=(PANEL_WIDTH * len(PANELS), HEIGHT))
        for axis, (panel, title) in zip(axes, PANELS.items(), strict=True):
            drawn = [quantity for quantity in QUANTITIES.values() if quantity.panel == panel]
            for quantity in drawn:
                _curve(axis, series.growths[quantity.name], quantity)
            _scales(axis, series, drawn)
            axis.set_title(title, loc="left", fontsize=10, color="#444444")
            axis.set_xlabel(dimension.unit)
            axis.legend(
                loc="upper left", bbox_to_anchor=(-0.1, -0.27), frameon=False, fontsize=9
            ).set_in_layout(False)  # a long text must not make its panel small
        figure.suptitle(dimension.what, x=0.01, ha="left", fontsize=12)
        figure.tight_layout(rect=(0, LEGEND_SHARE, 1, 1))
        for axis in axes:
            axis.get_legend().set_in_layout(True)  # what is saved has room for it
    return figure


def _curve(axis, growth: Growth, quantity: Quantity) -> None:
    """Medians with their extremes, and the power law through them."""
    label = quantity.label
    if growth.law:
        axis.plot(
            growth.x, [growth.law.at(x) for x in growth.x], color=quantity.color, linewidth=1.2
        )
        label += f", exponent {', '.join(exponents(growth))}"
    axis.errorbar(
        growth.x,
        [spread.median for spread in growth.y],
        yerr=list(zip(*growth.bars, strict=True)),
        color=quantity.color,
        marker=quantity.marker,
        linestyle="none",
        label=label,
        markersize=6,
        capsize=3,
    )


def _scales(axis, series: Series, drawn: list[Quantity]) -> None:
    """Ticks at the measured values; at least a decade high, so that what is flat looks flat."""
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xticks(
        [point.value for point in series.points],
        [series.dimension.tick(point.value) for point in series.points],
        rotation=30,
        ha="right",
    )
    axis.xaxis.set_minor_locator(NullLocator())
    spreads = [spread for quantity in drawn for spread in series.growths[quantity.name].y]
    low, high = min(s.low for s in spreads), max(s.high for s in spreads)
    axis.yaxis.set_major_locator(
        LogLocator(subs=(1.0, 2.0, 5.0) if high < CROWDED * low else (1.0,))
    )
    axis.yaxis.set_major_formatter(FuncFormatter(lambda y, _: shown(y, drawn[0].unit)))
    axis.yaxis.set_minor_formatter(NullFormatter())
    room = max(ROOM, (10.0 * low / high) ** 0.5)
    axis.set_ylim(low / room, high * room)
