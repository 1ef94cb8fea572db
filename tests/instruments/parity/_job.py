# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, inside Blender: builds rows and renders each by Cycles and by Specula.

The last argument is a JSON file, the job: `rows` (pairs of a name and an .npz file to write),
`method` (Specula's), `samples` (of a render), `noise` (of a block, relative, that is asked for),
`most` (renders of each engine), `seconds` (that a row may take), `threads` and `result` (the JSON
file to write).

The result is a list of what _verdict.Outcome holds, written anew as each row begins and ends. A row
that takes too long ends the process: whoever reads the result sees which was begun.
"""

from __future__ import annotations

import faulthandler
import json
import os
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np

from specula.export import compat
from tests.images._render import render_result
from tests.instruments.pairs.comparison import Picture, noise, picture
from tests.instruments.parity import _passes
from tests.instruments.parity._rows import ROWS
from tests.instruments.parity._stage import Absent, Stage
from tests.instruments.parity._verdict import REFUSED

FEWEST = 2  # renders, which tell the noise
ENGINES = ("CYCLES", "SPECULA")


class Report:
    """What the parent reads, always complete on the disk."""

    def __init__(self, path: str):
        self._path = Path(path)
        self._rows: list[dict] = []

    def begin(self, name: str) -> None:
        empty = {"why": "", "warnings": [], "renders": {}, "noise": {}}
        self._rows.append({"name": name, "outcome": "begun"} | empty)
        self._write()

    def tell(self, **changes) -> None:
        self._rows[-1] |= changes
        self._write()

    def _write(self) -> None:
        fresh = self._path.with_suffix(".new")
        fresh.write_text(json.dumps(self._rows))
        fresh.replace(self._path)


def prepare(scene, job: dict) -> None:
    render = scene.render
    render.threads_mode, render.threads = "FIXED", job["threads"]
    scene.cycles.use_animated_seed = False
    scene.cycles.samples = scene.specula.samples = job["samples"]
    scene.specula.method = job["method"]


def render(scene, job: dict, shows: str) -> np.ndarray:
    """(H, W, 3) float64 of the pass that a row shows, 0 where there is none; bottom row first."""
    if shows == "Combined":
        bpy.ops.render.render()
        return render_result(scene, job["result"])
    settings, path = scene.render.image_settings, f"{job['result']}.layers.exr"
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    size = (scene.render.resolution_y, scene.render.resolution_x)
    return _passes.comparable(shows, _passes.read(path, compat.pass_name(shows), size))


def rendered(scene, job: dict, engine: str, shows: str) -> tuple[Picture, int, list[str]]:
    """Of as many renders as the noise asks for; how many; Specula's warnings."""
    from specula import statistics

    scene.render.engine = engine
    renders, warnings, splats = [], [], 0
    while True:
        scene.cycles.seed = scene.specula.seed = len(renders) + 1
        renders.append({"Combined": render(scene, job, shows)})
        if engine == "SPECULA":
            stats = statistics.last[scene.name, scene.view_layers[0].name]
            warnings = [*stats.warnings, *(line for line in stats.report if REFUSED in line)]
            splats += stats.render_stats["splats"]
        if len(renders) >= FEWEST:
            found = picture(renders, splats)
            if noise(found) <= job["noise"] or len(renders) >= job["most"]:
                return found, len(renders), warnings


def examine(name: str, path: str, job: dict, report: Report) -> None:
    stage = Stage()
    row = ROWS[name]
    try:
        row.build(stage)
    except Absent as absent:
        report.tell(outcome="absent", why=str(absent))
        return
    prepare(stage.scene, job)
    arrays, noises, counts = {}, {}, {}
    for engine in ENGINES:
        found, counts[engine], warnings = rendered(stage.scene, job, engine, row.shows)
        noises[engine] = noise(found)
        arrays[f"{engine}/mean"], arrays[f"{engine}/variance"] = found.mean, found.variance
        arrays[f"{engine}/splats"] = found.stats["splats"]
    np.savez(path, **arrays)
    report.tell(outcome="done", warnings=warnings, noise=noises, renders=counts)


def main(job: dict) -> None:
    report = Report(job["result"])
    for name, path in job["rows"]:
        report.begin(name)
        faulthandler.dump_traceback_later(job["seconds"], exit=True)
        try:
            examine(name, path, job, report)
        except Exception as error:
            traceback.print_exc()
            report.tell(outcome="failed", why=" ".join(str(error).split()) or type(error).__name__)
        faulthandler.cancel_dump_traceback_later()


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
    sys.stdout.flush()
    sys.stderr.flush()
    # bpy may crash as the interpreter goes down, after the work is done.
    os._exit(0)
