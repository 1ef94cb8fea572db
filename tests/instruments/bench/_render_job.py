# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, in today's Blender: renders a scene as a job says.

The last argument is a JSON file, the job: `scene` (path), `engine`, `threads`, `samples` (a list:
a render for each, after one of a
single sample), `result` (the JSON file to write); and optionally `method` (Specula's),
`specula` (values of its other properties), `size` ([width, height]), `picture` (PNG to write),
`mean` (whether to report the picture's mean), `shadow_caustics` (whether Cycles walks where the
scene's flags say so).
"""

from __future__ import annotations

import json
import os
import sys
import time

import bpy

from tests.images._render import render_result

# Cycles' settings that Specula has no counterpart for: as Blender sets them for a new scene.
CYCLES_DEFAULTS = ("use_light_tree", "use_auto_tile", "tile_size", "sampling_pattern")
# What changes the mean, which Specula has no counterpart for, either.
BIASED = ("sample_clamp_direct", "sample_clamp_indirect", "blur_glossy")


def prepare(job: dict):
    """The job's scene, ready to render."""
    bpy.ops.wm.open_mainfile(filepath=job["scene"])
    scene = bpy.context.scene
    render = scene.render
    render.engine = job["engine"]
    render.threads_mode, render.threads = "FIXED", job["threads"]
    if "size" in job:
        render.resolution_x, render.resolution_y = job["size"]
        render.resolution_percentage = 100
    if job["engine"] == "CYCLES":
        prepare_cycles(scene, job.get("shadow_caustics", False))
    else:
        scene.specula.method = job["method"]
        scene.specula.samples = 0  # Cycles' number
        scene.specula.time_limit = 0.0
        for name, value in job.get("specula", {}).items():
            setattr(scene.specula, name, value)
    return scene


def prepare_cycles(scene, shadow_caustics: bool) -> None:
    """Path tracing of every sample on the processor; manifold walks only if they are asked for."""
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_denoising = False
    cycles.use_adaptive_sampling = False
    cycles.time_limit = 0.0
    for name in CYCLES_DEFAULTS:
        cycles.property_unset(name)
    for name in BIASED:
        setattr(cycles, name, 0.0)
    if not shadow_caustics:  # without flagged casters there is no walk
        for obj in scene.objects:
            obj.cycles.is_caustics_caster = False


def rendered(scene, samples: int, engine: str) -> dict:
    """Renders; returns the seconds of the whole call, by the clock and of all threads together,
    and those that the engine reports if it does."""
    scene.cycles.samples = samples
    start, cpu_start = time.perf_counter(), time.process_time()
    bpy.ops.render.render()
    row = {
        "samples": samples,
        "seconds": time.perf_counter() - start,
        "cpu_seconds": time.process_time() - cpu_start,
    }
    if engine == "SPECULA":
        from specula import statistics

        stats = statistics.last[scene.name, scene.view_layers[0].name]
        if stats.samples_done != samples:
            raise RuntimeError(f"{stats.samples_done} samples rendered in place of {samples}")
        row["engine_seconds"] = stats.render_seconds
        counts = stats.render_stats
        row["success"] = counts["walks_converged"] / max(counts["walks"], 1)
        row["trials"] = counts["trials"] / max(counts["trial_estimates"], 1)
    return row


def main(job: dict) -> None:
    scene = prepare(job)
    render = scene.render
    if "picture" in job:
        render.image_settings.file_format = "PNG"
        render.filepath = job["picture"]
        scene.cycles.samples = job["samples"][0]
        bpy.ops.render.render(write_still=True)
        report = {}
    else:
        first = rendered(scene, 1, job["engine"])  # pays for what a process loads
        renders = [rendered(scene, count, job["engine"]) for count in job["samples"]]
        report = {"first": first} | ({"renders": renders} if renders else {})
    percent = render.resolution_percentage
    report["pixels"] = (render.resolution_x * percent // 100) * (
        render.resolution_y * percent // 100
    )
    if job.get("mean"):
        report["mean"] = render_result(scene, job["result"]).mean(axis=(0, 1)).tolist()
    with open(job["result"], "w") as file:
        json.dump(report, file)


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
    sys.stdout.flush()
    # Both engines alike: what bpy does as the interpreter goes down is not the renderer's.
    os._exit(0)
