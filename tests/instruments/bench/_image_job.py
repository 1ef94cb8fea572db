# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, in today's Blender: renders one image for a time, and reports both.

The last argument is a JSON file, the job: `scene` (path), `engine`, `size`, `threads`, `seconds`
(of rendering), `seed`, `image` (.npy to write: (H, W, 3) float32, linear, bottom row first) and
`result` (the JSON file to write); and optionally
  specula          properties of `scene.specula`
  materials        properties of `specula` of every material
  cycles           properties of `scene.cycles`
  shadow_caustics  whether Cycles walks where the scene's flags say so
  light_factor     on the power of every lamp
  border           [left, bottom, right, top] in pixels: the part that is rendered, all of the image
  hidden           names of objects that are not rendered
  roughness        by name of a material, of its Principled BSDF
"""

from __future__ import annotations

import json
import os
import re
import sys
import time
from dataclasses import dataclass, field

import bpy
import numpy as np

from tests.images._render import render_result
from tests.instruments.bench._machine import peak_memory
from tests.instruments.bench._render_job import prepare

ENDLESS = 1 << 20  # samples: time ends the render
TIME_TOLERANCE = 0.025  # of the budget: two methods are then within 5 % of each other
MORE_TRIES = 3  # to come within it
SAMPLE = re.compile(r"\bSample (\d+)/\d+")


@dataclass
class Rendered:
    """One call of the renderer."""

    call_seconds: float  # export or synchronisation, trees and all
    render_seconds: float  # of sampling
    samples: float  # per pixel
    stats: dict = field(default_factory=dict)


class CyclesClock:
    """Reads from Cycles' status lines when sampling began and ended, and how far it came."""

    def __enter__(self):
        self.begin = self.end = None
        self.samples = 0
        bpy.app.handlers.render_stats.append(self._line)
        return self

    def __exit__(self, *_) -> None:
        bpy.app.handlers.render_stats.remove(self._line)

    def _line(self, text: str, *_) -> None:
        now = time.perf_counter()
        if match := SAMPLE.search(text):
            self.begin = now if self.begin is None else self.begin
            self.end = now
            self.samples = max(self.samples, int(match[1]))


def render_cycles(scene, seconds: float, samples: int = ENDLESS) -> Rendered:
    """Renders for `seconds`, or so many samples if `seconds` is 0."""
    scene.cycles.time_limit, scene.cycles.samples = seconds, samples
    start = time.perf_counter()
    with CyclesClock() as clock:
        bpy.ops.render.render()
    call = time.perf_counter() - start
    if not clock.samples:
        raise RuntimeError("Cycles reported no sample")
    return Rendered(call, clock.end - clock.begin, clock.samples)


def render_cycles_in_time(scene, job: dict) -> Rendered:
    """Where Cycles' own limit is too coarse, again, with as many samples as fit at its rate; what
    is closest to the time stays."""
    seconds = job["seconds"]

    def missed(rendered: Rendered) -> float:
        return abs(rendered.render_seconds / seconds - 1.0)

    best = render_cycles(scene, seconds)
    write_image(scene, job["image"])
    for _ in range(MORE_TRIES):
        fitting = max(1, round(best.samples * seconds / best.render_seconds))
        # Equal where a single sample is longer than the tolerance.
        if missed(best) <= TIME_TOLERANCE or fitting == best.samples:
            break
        again = render_cycles(scene, 0.0, fitting)
        if missed(again) < missed(best):
            best = again
            write_image(scene, job["image"])
    return best


def render_specula(scene, job: dict) -> Rendered:
    from specula import statistics

    scene.specula.time_limit, scene.specula.samples = job["seconds"], ENDLESS
    start = time.perf_counter()
    bpy.ops.render.render()
    call = time.perf_counter() - start
    stats = statistics.last[scene.name, scene.view_layers[0].name]
    samples = stats.render_stats["samples"] / stats.pixels
    write_image(scene, job["image"])
    return Rendered(call, stats.render_seconds, samples, stats.render_stats)


def configure(scene, job: dict) -> None:
    """What the method and the seed ask for."""
    for group in ("cycles", "specula"):
        for name, value in job.get(group, {}).items():
            setattr(getattr(scene, group), name, value)
    scene.cycles.seed = job["seed"]
    scene.cycles.use_animated_seed = False
    if job["engine"] == "SPECULA":
        scene.specula.seed = job["seed"]
    for name, value in job.get("materials", {}).items():
        for material in bpy.data.materials:
            setattr(material.specula, name, value)
    for light in bpy.data.lights:
        light.energy *= job.get("light_factor", 1.0)
    if "border" in job:
        set_border(scene.render, *job["border"])
    for name in job.get("hidden", ()):
        bpy.data.objects[name].hide_render = True
    for name, roughness in job.get("roughness", {}).items():
        nodes = bpy.data.materials[name].node_tree.nodes
        principled = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
        principled.inputs["Roughness"].default_value = roughness


def set_border(render, left: int, bottom: int, right: int, top: int) -> None:
    """Blender takes shares and truncates: half a pixel keeps them off the edges."""
    render.use_border = render.use_crop_to_border = True
    render.border_min_x = (left + 0.5) / render.resolution_x
    render.border_max_x = (right + 0.5) / render.resolution_x
    render.border_min_y = (bottom + 0.5) / render.resolution_y
    render.border_max_y = (top + 0.5) / render.resolution_y


def write_image(scene, path: str) -> None:
    """The last render."""
    np.save(path, render_result(scene, path).astype(np.float32))


def main(job: dict) -> None:
    start = time.perf_counter()
    scene = prepare(job)
    configure(scene, job)
    opened = time.perf_counter() - start
    render = render_cycles_in_time if job["engine"] == "CYCLES" else render_specula
    rendered = render(scene, job)
    report = {
        "load_seconds": opened + rendered.call_seconds - rendered.render_seconds,
        "render_seconds": rendered.render_seconds,
        "samples": rendered.samples,
        "peak_memory": peak_memory(),
        "stats": rendered.stats,
    }
    with open(job["result"], "w") as file:
        json.dump(report, file)


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
    sys.stdout.flush()
    # bpy may crash as the interpreter goes down, after the work is done.
    os._exit(0)
