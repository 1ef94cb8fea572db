# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of the matrix, and the same as JSON."""

from __future__ import annotations

import dataclasses
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

from tests.instruments.bench._page import STYLE, table
from tests.instruments.pairs.comparison import Comparison
from tests.instruments.pairs.files import replace
from tests.instruments.pairs.page import badge, comparison_text, figures
from tests.instruments.parity._verdict import BAD, VERDICTS, Outcome, remark

TEMPLATE = Path(__file__).with_name("page.html")


@dataclass(frozen=True)
class Result:
    """A row that was tried."""

    row: Outcome
    verdict: str  # of VERDICTS
    comparison: Comparison | None
    pictures: dict[str, str]  # label -> path from the page

    @property
    def order(self) -> tuple:
        """Worst first."""
        severity = self.comparison.severity if self.comparison else 0.0
        return VERDICTS.index(self.verdict), -severity, self.row.name


def counts(results: Sequence[Result]) -> dict[str, int]:
    found = Counter(result.verdict for result in results)
    return {name: found[name] for name in VERDICTS}


def write(folder: Path, about: str, results: Sequence[Result]) -> Path:
    """index.html and results.json; returns the page."""
    results = sorted(results, key=lambda result: result.order)
    document = {
        "about": about,
        "verdicts": counts(results),
        "rows": [dataclasses.asdict(result) for result in results],
    }
    replace(folder / "results.json", json.dumps(document, indent=1) + "\n")
    page = folder / "index.html"
    replace(page, render(about, results))
    return page


def render(about: str, results: Sequence[Result]) -> str:
    return Template(TEMPLATE.read_text()).substitute(
        style=STYLE.read_text(),
        about=escape(about),
        verdicts=table(
            ["", "rows"],
            [[badge(name, name in BAD), str(n)] for name, n in counts(results).items()],
            f"{len(results)} rows",
        ),
        rows="\n".join(section(result) for result in results),
    )


def section(result: Result) -> str:
    """One row: its pictures, and what is known of it."""
    row = result.row
    lines = [remark(row, result.verdict), *row.warnings]
    noise = ", ".join(
        f"{engine} {share:.2%} in {row.renders[engine]} renders"
        for engine, share in row.noise.items()
    )
    text = "".join(f"<p>{escape(line)}</p>" for line in lines if line)
    if result.comparison:
        text = f"<p>{comparison_text(result.comparison)} Noise of a block: {noise}.</p>" + text
    return (
        f'<section class="row"><h3>{badge(result.verdict, result.verdict in BAD)} '
        f'{escape(row.name)}</h3><div class="crops">{figures(result.pictures)}</div>'
        f"{text}</section>"
    )
