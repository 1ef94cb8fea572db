# SPDX-License-Identifier: GPL-3.0-or-later
"""The files that `./dev bench scaling` leaves: index.html, scaling.json, scaling.csv, charts/."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import asdict
from html import escape
from pathlib import Path
from string import Template

from tests.instruments.bench import _charts, _page, _scaling_charts, _scaling_summary
from tests.instruments.bench._scaling_plan import BASE, COST, PROCESSOR, QUANTITIES, Outcome
from tests.instruments.bench._scaling_summary import REMARKABLE, Series, shown

TEMPLATE = _page.HERE / "scaling.html"


def write(folder: Path, about: dict, all_series: Sequence[Series], outcome: Outcome) -> Path:
    """Writes everything; returns the page."""
    charts = folder / "charts"
    charts.mkdir(parents=True, exist_ok=True)
    drawings = [
        _charts.save(_scaling_charts.growth_chart(series), charts / series.dimension.name)
        for series in all_series
    ]
    document = {
        "about": about,
        "failures": list(outcome.failures.values()),
        "remarks": _scaling_summary.remarks(all_series),
        "dimensions": [_record(series, outcome) for series in all_series],
    }
    (folder / "scaling.json").write_text(json.dumps(document, indent=1) + "\n")
    with open(folder / "scaling.csv", "w", newline="") as file:
        rows = list(_scaling_summary.rows(all_series))
        writer = csv.DictWriter(file, rows[0].keys() if rows else ["dimension"])
        writer.writeheader()
        writer.writerows(rows)
    page = folder / "index.html"
    page.write_text(_render(about, all_series, drawings, outcome))
    return page


def _record(series: Series, outcome: Outcome) -> dict:
    """For the JSON file."""
    return {
        "name": series.dimension.name,
        "what": series.dimension.what,
        "unit": series.dimension.unit,
        "quantities": {
            name: asdict(growth)
            | {
                "unit": QUANTITIES[name].unit,
                "law": asdict(growth.law) if growth.law else None,
                "last_exponent": growth.last_exponent,
            }
            for name, growth in series.growths.items()
        },
        "points": [
            {
                "value": point.value,
                "job": point.job,
                "runs": [asdict(run) for run in outcome.runs[point]],
            }
            for point in series.points
        ],
    }


def _render(
    about: dict, all_series: Sequence[Series], drawings: Sequence[str], outcome: Outcome
) -> str:
    """The page's text; `drawings` are SVG texts."""
    return Template(TEMPLATE.read_text()).substitute(
        style=_page.STYLE.read_text(),
        about=_about(about),
        failures="".join(
            f'<p class="fail"><b>FAILED</b> {escape(why)}</p>' for why in outcome.failures.values()
        ),
        summary=_summary_table(all_series),
        remarkable=f"{REMARKABLE:g}",
        remarks=_list(_scaling_summary.remarks(all_series)),
        size=" x ".join(map(str, BASE["size"])),
        triangles=f"{2 * BASE['quads'] ** 2:,}",
        dimensions="\n".join(map(_section, all_series, drawings)),
    )


def _about(about: dict) -> str:
    quick = " A quick look: small sizes, not a measurement." if about["quick"] else ""
    return escape(
        f"{about['date']}, {about['processor']}, {about['threads']} threads, load average "
        f"{about['load_average']:.1f} at the start; other programs took "
        f"{about['others_share']:.0%} of the processors' time meanwhile. {about['rounds']} rounds, "
        f"about {about['seconds']:g} s of sampling by each method.{quick} Command: "
        f"{about['command']}"
    )


def _list(lines: Sequence[str]) -> str:
    return f"<ul>{''.join(f'<li>{escape(line)}</li>' for line in lines)}</ul>"


def _summary_table(all_series: Sequence[Series]) -> str:
    head = ["what is changed", *(escape(quantity.label) for quantity in QUANTITIES.values())]
    rows = []
    for series in all_series:
        dimension = series.dimension
        ends = " to ".join(dimension.label(series.points[i].value) for i in (0, -1))
        row = [f"{escape(dimension.what)}<br><small>{escape(ends)}</small>"]
        for name in QUANTITIES:
            first, *others = map(escape, _scaling_summary.cells(series, name))
            row.append("<br>".join([f"<b>{first}</b>", *(f"<small>{o}</small>" for o in others)]))
        rows.append(row)
    return _page.table(head, rows)


def _section(series: Series, svg: str) -> str:
    """A dimension's chart and what was measured."""
    dimension = series.dimension
    head = [escape(dimension.unit), *(escape(quantity.label) for quantity in QUANTITIES.values())]
    rows = [
        [escape(dimension.label(point.value)), *(_cell(series, i, name) for name in QUANTITIES)]
        for i, point in enumerate(series.points)
    ]
    chart = _page.data_url(svg.encode(), "svg+xml")
    return "\n".join(
        [
            f'<section id="{escape(dimension.name)}"><h2>{escape(dimension.what)}</h2>',
            f'<img class="chart" alt="{escape(dimension.what)}" src="{chart}">',
            _page.table(head, rows),
            "</section>",
        ]
    )


def _cell(series: Series, index: int, name: str) -> str:
    """Median, extremes, and the cost of a sample of one pixel."""
    quantity, spread = QUANTITIES[name], series.growths[name].y[index]
    text = escape(shown(spread.median, quantity.unit))
    if spread.rounds > 1:
        ends = " to ".join(shown(value, quantity.unit) for value in (spread.low, spread.high))
        text += f"<br><small>{escape(ends)}</small>"
    if quantity.panel in (COST, PROCESSOR):
        each = shown(series.per_pixel_sample(index, name), "s")
        text += f"<br><small>{escape(each)} per pixel</small>"
    return text
