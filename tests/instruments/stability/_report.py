# SPDX-License-Identifier: GPL-3.0-or-later
"""The suite's table, as text and as a page."""

from __future__ import annotations

import html
import json
import math
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from tests.instruments.stability._cases import Case
from tests.instruments.stability._measure import Comparison, Method, Pictures

PASSES, KNOWN, FAILS = "pass", "fails as known", "FAILS"


@dataclass
class Result:
    case: Case
    method: Method
    pictures: Pictures
    comparison: Comparison

    @property
    def excuse(self) -> str:
        if self.method.excuse:
            return self.method.excuse
        blind = self.case.truth != "path tracing"
        if blind and self.method.needs_path_tracing:
            return "it needs path tracing, which finds no light without size"
        return ""

    @property
    def verdict(self) -> str:
        if self.pictures.stats["nan_samples"] > 0:
            return FAILS
        if self.comparison.worst <= 1.0:
            return PASSES
        return KNOWN if self.excuse else FAILS


Rows = list[tuple[Case, dict[str, Result]]]  # by the method's name; none for a case's own truth


def relative_cost(rows: Rows, result: Result) -> float:
    name = result.method.name
    costs = [results[name].pictures.seconds for _, results in rows if name in results]
    return result.pictures.seconds / median(costs)


def columns(rows: Rows, result: Result) -> list[str]:
    stats, comparison = result.pictures.stats, result.comparison
    trials = (
        f"{stats['trials'] / stats['trial_estimates']:.1f}, {stats['max_trials']}"
        if stats["trial_estimates"]
        else "-"
    )
    return [
        result.method.name,
        result.verdict,
        f"{100.0 * comparison.excess:+.2f} +- {100.0 * comparison.precision:.2f} %",
        f"{comparison.worst:.2f}",
        f"{100.0 * result.pictures.brightest:.0f} %",
        trials,
        f"{stats['capped_estimates']}",
        f"{stats['nan_samples']}",
        f"{relative_cost(rows, result):.2f}",
    ]


HEADINGS = [
    "method",
    "verdict",
    "light, against the truth",
    "worst block",
    "brightest",
    "trials: mean, most",
    "capped",
    "NaN",
    "cost",
]


def truth_of(case: Case) -> str:
    return case.truth if isinstance(case.truth, str) else "closed form"


def text(rows: Rows, methods: list[str]) -> str:
    """Markdown: a table of verdicts, and one of all that was measured."""
    lines = [
        "| case | held against | " + " | ".join(methods) + " |",
        "|---" * (len(methods) + 2) + "|",
    ]
    for case, results in rows:
        marks = [results[name].verdict if name in results else "-" for name in methods]
        lines.append(f"| {case.name} | {truth_of(case)} | {' | '.join(marks)} |")
    lines += ["", "| case | " + " | ".join(HEADINGS) + " |", "|---" * (len(HEADINGS) + 1) + "|"]
    for case, results in rows:
        for result in results.values():
            lines.append(f"| {case.name} | {' | '.join(columns(rows, result))} |")
    return "\n".join(lines)


BAR, HISTOGRAM_HEIGHT = 5, 24  # pixels


def histogram(stats: dict) -> str:
    """Inline SVG: how many estimates took [2^i, 2^(i+1)) trials; empty if none took any.

    The bars' heights are logarithms: a few estimates that took very many trials show, too.
    """
    counts = stats.get("trial_histogram", [])
    if not any(counts):
        return ""
    scale = HISTOGRAM_HEIGHT / math.log1p(max(counts))
    bars = []
    for i, count in enumerate(counts):
        height = scale * math.log1p(count)
        bars.append(
            f'<rect x="{i * BAR}" y="{HISTOGRAM_HEIGHT - height:.1f}" width="{BAR - 1}" '
            f'height="{height:.1f}"><title>{1 << i} .. {(2 << i) - 1}: {count}</title></rect>'
        )
    return f'<svg width="{len(counts) * BAR}" height="{HISTOGRAM_HEIGHT}">{"".join(bars)}</svg>'


HEAD = """<!doctype html><html lang=en><meta charset=utf-8><title>Stability</title><style>
body{font:15px/1.5 sans-serif;max-width:75em;margin:2em auto;padding:0 1em}
table{border-collapse:collapse;margin:1em 0}
td,th{border:1px solid #bbb;padding:.2em .6em;text-align:left}
.pass{background:#e3f1fa}.known{background:#fdf0d5}.fails{background:#f6d0c4;font-weight:bold}
</style><h1>Stability</h1>
<p>Scenes in which methods fail, by every method. <i>Worst block</i>: difference from the truth over
what chance explains in the whole table; above 1 it fails. <i>Brightest</i>: share of the light in
the brightest 0.1 % of the pixels of one sample. <i>Capped</i>: estimates that gave up counting
trials. <i>Cost</i>: time of a sample, in medians over the cases. <i>Trials of estimates</i>: one
bar for 1, 2 to 3, 4 to 7 trials and so on, logarithmic.</p>
"""
CLASSES = {PASSES: "pass", KNOWN: "known", FAILS: "fails"}


def page(rows: Rows, methods: list[str]) -> str:
    def heads_of(cells):
        return "<tr>" + "".join(f"<th>{html.escape(c)}</th>" for c in cells) + "</tr>"

    def marked(result: Result | None) -> str:
        if result is None:
            return "<td>-</td>"
        title = result.excuse if result.verdict == KNOWN else ""
        return (
            f'<td class="{CLASSES[result.verdict]}" title="{html.escape(title)}">'
            f"{html.escape(result.verdict)}</td>"
        )

    verdicts, figures = [], []
    for case, results in rows:
        heads = "".join(
            f"<td>{html.escape(c)}</td>" for c in (case.name, case.hazard, truth_of(case))
        )
        marks = "".join(marked(results.get(name)) for name in methods)
        verdicts.append(f"<tr>{heads}{marks}</tr>")
        for result in results.values():
            cells = "".join(f"<td>{html.escape(c)}</td>" for c in columns(rows, result))
            bars = histogram(result.pictures.stats)
            figures.append(f"<tr><td>{html.escape(case.name)}</td>{cells}<td>{bars}</td></tr>")
    head = heads_of(["case", "hazard", "held against", *methods])
    figures_head = heads_of(["case", *HEADINGS, "trials of estimates"])
    return (
        f"{HEAD}<table>{head}{''.join(verdicts)}</table>"
        f"<table>{figures_head}{''.join(figures)}</table></html>\n"
    )


def write(folder: Path, rows: Rows, methods: list[str]) -> None:
    """index.html, table.md and summary.json."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "index.html").write_text(page(rows, methods))
    (folder / "table.md").write_text(text(rows, methods) + "\n")
    summary = [
        {
            "case": case.name,
            "method": r.method.name,
            "verdict": r.verdict,
            "excess": r.comparison.excess,
            "precision": r.comparison.precision,
            "worst": r.comparison.worst,
            "brightest": r.pictures.brightest,
            "seconds_per_sample": r.pictures.seconds,
            "stats": r.pictures.stats,
        }
        for case, results in rows
        for r in results.values()
    ]
    (folder / "summary.json").write_text(json.dumps(summary, indent=1))
