# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of pairs, and the same as JSON."""

from __future__ import annotations

import dataclasses
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

from tests.instruments.bench._page import NONE, STYLE, table
from tests.instruments.field._measure import BAD, VERDICTS, Child, kind
from tests.instruments.pairs.comparison import Comparison
from tests.instruments.pairs.files import replace
from tests.instruments.pairs.page import badge, comparison_text, figures

TEMPLATE = Path(__file__).with_name("page.html")


@dataclass(frozen=True)
class Scene:
    """One file's result."""

    blend: str
    verdict: str  # of VERDICTS
    specula: Child
    cycles: Child
    comparison: Comparison | None
    pictures: dict[str, str]  # label -> path from the page

    @property
    def order(self) -> tuple:
        """Worst first."""
        severity = self.comparison.severity if self.comparison else 0.0
        return VERDICTS.index(self.verdict), -severity, self.blend


# --------------------------------------------------------------------------------------------- page


def write(folder: Path, about: str, limit: float, scenes: Sequence[Scene]) -> Path:
    """index.html and results.json; returns the page."""
    scenes = sorted(scenes, key=lambda scene: scene.order)
    folder.mkdir(parents=True, exist_ok=True)
    document = {
        "about": about,
        "verdicts": verdict_counts(scenes),
        "warnings": warning_counts(scenes),
        "scenes": [dataclasses.asdict(scene) for scene in scenes],
    }
    replace(folder / "results.json", json.dumps(document, indent=1) + "\n")
    page = folder / "index.html"
    replace(page, render(about, limit, scenes))
    return page


def verdict_counts(scenes: Sequence[Scene]) -> dict[str, int]:
    counts = Counter(scene.verdict for scene in scenes)
    return {name: counts[name] for name in VERDICTS}


def warning_counts(scenes: Sequence[Scene]) -> dict[str, int]:
    """Kind of warning -> files that have it, most first."""
    counts = Counter(text for s in scenes for text in {kind(w) for w in s.specula.warnings})
    return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))


def render(about: str, limit: float, scenes: Sequence[Scene]) -> str:
    return Template(TEMPLATE.read_text()).substitute(
        style=STYLE.read_text(),
        about=escape(about),
        verdicts=table(
            ["", "files"],
            [[badge(name, name in BAD), str(n)] for name, n in verdict_counts(scenes).items()],
            f"{len(scenes)} files",
        ),
        warnings=table(
            ["Specula warns", "files"],
            [[escape(text), str(number)] for text, number in warning_counts(scenes).items()],
        ),
        scenes="\n".join(section(scene, limit) for scene in scenes),
    )


def section(scene: Scene, limit: float) -> str:
    """One file: its pictures, and what is known of it."""
    return (
        f'<section class="scene"><h3>{badge(scene.verdict, scene.verdict in BAD)} '
        f"{escape(scene.blend)}</h3>"
        f'<div class="crops">{figures(scene.pictures)}{children(scene, limit)}</div>'
        f"<p>{comparison_text(scene.comparison)}</p>"
        f"{troubles(scene)}{warnings(scene.specula)}</section>"
    )


def children(scene: Scene, limit: float) -> str:
    rows = [
        [
            name,
            escape(child.outcome),
            "killed" if child.code is None else str(child.code),
            seconds(child.worst("first_sample_seconds")),
            f"{seconds(child.worst('render_seconds'))} / {limit:g}",
            seconds(child.worst("call_seconds")),
            f"{child.cpu_seconds:.1f}",
            number(child.worst("samples")),
            f"{child.peak_memory / 1e6:.0f} MB",
            f"{child.others_share:.0%}",
        ]
        for name, child in (("Specula", scene.specula), ("Cycles", scene.cycles))
    ]
    head = [
        "",
        "outcome",
        "exit code",
        "first<br>sample, s",
        "render s<br>/ limit",
        "whole<br>call, s",
    ]
    head += ["processor s<br>in all", "samples", "peak<br>memory", "other<br>programs"]
    return table(head, rows)


def seconds(value: float | None) -> str:
    return NONE if value is None else f"{value:.1f}"


def number(value: float | None) -> str:
    return NONE if value is None else f"{value:.1f}"


def troubles(scene: Scene) -> str:
    lines = []
    for name, child in (("Specula", scene.specula), ("Cycles", scene.cycles)):
        if child.why:
            lines.append(f"<p>{name} {escape(child.outcome)}: {escape(child.why)}</p>")
            lines.append(f"<pre>{escape(chr(10).join(child.last_lines))}</pre>")
    return "".join(lines)


def warnings(child: Child) -> str:
    if not child.warnings:
        return ""
    items = "".join(f"<li>{escape(text)}</li>" for text in child.warnings)
    return f"<details><summary>{len(child.warnings)} warnings</summary><ul>{items}</ul></details>"
