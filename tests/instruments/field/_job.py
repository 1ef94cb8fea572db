# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, inside Blender (either version): renders a scene as an artist left it.

The last argument is a JSON file, the job: `scene` (path), `engine`, `size` (pixels along the longer
side), `samples`, `seconds` (the limit of each render), `seeds` (a render for each), `threads`,
`images` (an EXR file to write for each seed) and `result` (the JSON file to write).

The result is written again whenever there is more to tell, so that a child that is killed has told
how far it came: `stage` (opening, render 1, render 2, done), `open_seconds`, `renders` (see
`render`) and `error`.
"""

from __future__ import annotations

import json
import os
import sys
import time
import traceback
from pathlib import Path

import bpy

from tests.instruments.bench._image_job import CyclesClock
from tests.instruments.pairs.settings import plain_cycles


class FirstSample(CyclesClock):
    """When Cycles had a sample of every pixel, too."""

    first: float | None = None

    def _line(self, text: str, *_) -> None:
        super()._line(text)
        if self.first is None and self.samples:
            self.first = time.perf_counter()


class Report:
    """What the parent reads, always complete on the disk."""

    def __init__(self, path: str):
        self._path = Path(path)
        self.values = {"stage": "opening", "open_seconds": None, "renders": [], "error": None}
        self.write()

    def write(self, **changes) -> None:
        self.values |= changes
        fresh = self._path.with_suffix(".new")
        fresh.write_text(json.dumps(self.values))
        fresh.replace(self._path)


def prepare(job: dict):
    """The file's scene at the job's size; nothing else that shows is changed."""
    bpy.ops.wm.open_mainfile(filepath=job["scene"], load_ui=False)
    scene = bpy.context.scene
    render = scene.render
    render.engine = job["engine"]
    render.threads_mode, render.threads = "FIXED", job["threads"]
    scale = job["size"] / max(render.resolution_x, render.resolution_y)
    render.resolution_x = max(1, round(render.resolution_x * scale))
    render.resolution_y = max(1, round(render.resolution_y * scale))
    render.resolution_percentage = 100
    render.use_border = render.use_multiview = False
    render.use_compositing = render.use_sequencer = False  # the picture is the renderer's own
    prepare_layers(scene)
    prepare_engine(scene, job)
    settings = render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    return scene


def prepare_layers(scene) -> None:
    """Only the first view layer that is rendered; with it, where Specula has caustics."""
    layers = [layer for layer in scene.view_layers if layer.use] or [scene.view_layers[0]]
    for layer in scene.view_layers:
        layer.use = layer == layers[0]
    layers[0].specula.use_pass_caustics = True


def prepare_engine(scene, job: dict) -> None:
    if job["engine"] == "CYCLES":
        plain_cycles(scene)
    scene.cycles.use_animated_seed = False
    scene.cycles.samples = scene.specula.samples = job["samples"]
    scene.cycles.time_limit = scene.specula.time_limit = job["seconds"]


def render(scene, job: dict, seed: int, image: str) -> dict:
    """One picture. Seconds count from the call: `first_sample_seconds` until every pixel had a
    sample, `render_seconds` is that of sampling alone, `call_seconds` that of the whole call."""
    scene.cycles.seed = scene.specula.seed = seed
    scene.render.filepath = image
    start = time.perf_counter()
    with FirstSample() as clock:
        bpy.ops.render.render(write_still=True)
    row = {"call_seconds": time.perf_counter() - start, "warnings": [], "splats": 0}
    if not Path(image).exists():
        raise RuntimeError("there is no picture")
    if job["engine"] == "CYCLES":
        return row | of_cycles(clock, start)
    return row | of_specula(scene)


def of_cycles(clock: FirstSample, start: float) -> dict:
    """None each where Blender 3.4 was done before it told of a sample."""
    told = clock.first is not None
    return {
        "first_sample_seconds": clock.first - start if told else None,
        "render_seconds": clock.end - clock.begin if told else None,
        "samples": clock.samples if told else None,
    }


def of_specula(scene) -> dict:
    from specula import statistics

    layer = next(layer for layer in scene.view_layers if layer.use)
    stats = statistics.last[scene.name, layer.name]
    before = stats.export_seconds + stats.scene_stats["commit_seconds"]
    first = stats.first_sample_seconds
    return {
        "first_sample_seconds": None if first is None else before + first,
        "render_seconds": stats.render_seconds,
        "samples": stats.render_stats["samples"] / stats.pixels,
        "warnings": stats.warnings,
        "splats": stats.render_stats["splats"],
        "nan_samples": stats.render_stats["nan_samples"],
    }


def main(job: dict, report: Report) -> None:
    start = time.perf_counter()
    scene = prepare(job)
    report.write(open_seconds=time.perf_counter() - start)
    for number, (seed, image) in enumerate(zip(job["seeds"], job["images"], strict=True), 1):
        report.write(stage=f"render {number}")
        row = render(scene, job, seed, image)
        report.write(renders=[*report.values["renders"], row])
    report.write(stage="done")


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        content = json.load(job_file)
    told = Report(content["result"])
    try:
        main(content, told)
        code = 0
    except Exception as error:
        traceback.print_exc()
        told.write(error=" ".join(str(error).split()) or type(error).__name__)
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    # bpy may crash as the interpreter goes down, after the work is done.
    os._exit(code)
