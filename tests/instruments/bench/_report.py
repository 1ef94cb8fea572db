# SPDX-License-Identifier: GPL-3.0-or-later
"""The files that a bench leaves: index.html, summary.json, summary.csv, charts/."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from tests.instruments.bench import _charts, _page
from tests.instruments.bench._checks import Check
from tests.instruments.bench._methods import GROUPS, METHODS
from tests.instruments.bench._page import Picture
from tests.instruments.bench._scenes import Scene
from tests.instruments.bench._standings import BASELINES, standing
from tests.instruments.bench._store import Record, Task
from tests.instruments.bench._summary import (
    REGION_TITLES,
    SceneResult,
    rows_of,
    seeds_of,
    with_samples,
)

CROP = 96  # pixels, shown twice as large


def write(
    folder: Path,
    about: dict,
    scenes: Sequence[Scene],
    results: Sequence[SceneResult],
    records: Mapping[Task, Record],
    checks: Sequence[Check],
) -> Path:
    """Writes everything; returns the page."""
    charts = folder / "charts"
    charts.mkdir(parents=True, exist_ok=True)
    budget = max(about["budgets"])
    drawings, pictures = {}, {}
    for scene, result in zip(scenes, results, strict=True):
        drawings[result.name] = [
            _charts.save(
                _charts.error_chart(result, curves, GROUPS[group]),
                charts / f"{result.name}_{group}",
            )
            for group, curves in _charts.charted_groups(result).items()
        ]
        if glints := _charts.glint_curves(result):
            figure = _charts.glints_chart(result, glints, GROUPS["glints"])
            drawings[result.name].append(_charts.save(figure, charts / f"{result.name}_rmse"))
        pictures[result.name] = list(_pictures(scene, result, records, budget))
    rows = list(rows_of(results))
    document = {
        "about": about,
        "checks": [asdict(check) for check in checks],
        "standings": _standings(results, budget),
        "scenes": [asdict(result) for result in results],
        "rows": rows,
    }
    (folder / "summary.json").write_text(json.dumps(document, indent=1) + "\n")
    with open(folder / "summary.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys() if rows else ["scene"])
        writer.writeheader()
        writer.writerows(rows)
    page = folder / "index.html"
    page.write_text(_page.render(about, results, checks, drawings, pictures))
    return page


def _pictures(
    scene: Scene, result: SceneResult, records: Mapping[Task, Record], budget: float
) -> Iterator[Picture]:
    """Reference, whole and its crop, then the crop of each method after the longest time."""
    mean = scene.reference.mean
    caustics = None if scene.caustics is None else scene.reference.caustics
    row, column = _charts.crop_window(mean, caustics, CROP)

    def crop(image):
        return _charts.png(image[row : row + CROP, column : column + CROP], result.exposure, 2)

    yield Picture("reference, whole", _charts.png(mean, result.exposure))
    yield Picture("reference", crop(mean))
    for name, curve in result.curves.items():
        if point := curve.at(budget):
            first = with_samples(seeds_of(records, scene.name, name, budget))[0]
            label = f"{METHODS[name].full_label}, {point.render_seconds:.1f}\u00a0s"
            yield Picture(label, crop(first.image()), f"FLIP {point.flip.mean:.3f}")


def _standings(results: Sequence[SceneResult], budget: float) -> dict:
    """Method -> baseline -> region -> Standing."""
    names = dict.fromkeys(name for result in results for name in result.curves)
    return {
        name: {
            against: {
                region: asdict(found)
                for region in REGION_TITLES
                if (found := standing(results, name, against, region, budget))
            }
            for against in BASELINES
        }
        for name in names
    }
