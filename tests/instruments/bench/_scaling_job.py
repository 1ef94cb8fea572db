# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, in today's Blender with the addon: one point of `./dev bench scaling`.

The last argument is a JSON file, the job: what `_scaling_scene.build` reads, and `threads`,
`seconds` (about how long to sample by each method), `methods` (Specula's) and `result` (the JSON
file to write). Memory is in bytes, beyond what the process holds before there is a scene.
"""

from __future__ import annotations

import json
import os
import sys
import time

import bpy

from blend_scenes.generators import stage
from specula import native
from specula.abi import Method, RenderSettings, RenderState
from specula.export.log import ExportLog
from specula.export.scene import export_scene
from specula.export.settings import export_settings
from specula.upload import upload
from tests.instruments.bench import _scaling_scene
from tests.instruments.bench._machine import peak_memory, reset_peak_memory, resident_memory

POLL_MILLISECONDS = 100
PROBE_SHARE = 0.05  # of the seconds, from which the number of samples is taken
PROBE_FACTOR = 4  # by which a probe that was too short grows


def rendered(native_scene, settings: RenderSettings, samples: int) -> dict:
    """Seconds of one render, by the clock and of all threads together, and its statistics."""
    cpu_start = time.process_time()
    with native.Session(native_scene, native.changed(settings, samples=samples)) as session:
        while (progress := session.wait(POLL_MILLISECONDS)).state == RenderState.RUNNING:
            pass
        if progress.samples_done != samples:
            raise RuntimeError(f"{progress.samples_done} of {samples} samples rendered")
        return {
            "samples": samples,
            "seconds": progress.seconds,
            "cpu_seconds": time.process_time() - cpu_start,
            "stats": session.stats(),
        }


def renders(native_scene, settings: RenderSettings, seconds: float) -> list[dict]:
    """Renders of N and of 3 N samples, which take about so many seconds together."""
    probe = rendered(native_scene, settings, 1)
    while probe["seconds"] < PROBE_SHARE * seconds:
        probe = rendered(native_scene, settings, PROBE_FACTOR * probe["samples"])
    fewer = max(1, round(0.25 * seconds * probe["samples"] / probe["seconds"]))
    # One sample of a large picture is long enough already.
    first = probe if fewer == probe["samples"] else rendered(native_scene, settings, fewer)
    rows = [first, rendered(native_scene, settings, 3 * fewer)]
    if settings.method != Method.PT and not rows[-1]["stats"]["walks_converged"]:
        raise RuntimeError(f"{Method(settings.method).name}: no walk found a path")
    return rows


def check(job: dict, stats: dict) -> None:
    """Raises unless the core has the scene that the job asks for."""
    mirror = 2 if job["texels"] else 2 * job["quads"] ** 2
    wanted = {
        "triangles": 2 + mirror,
        "casters": job["pieces"] ** 2,
        "lights": job["lights"],
        "receivers": 1,
    }
    found = {name: stats[name] for name in wanted}
    if found != wanted:
        raise RuntimeError(f"the core has {found} in place of {wanted}")


def main(job: dict) -> None:
    native.version()  # loads the core
    scene = stage.reset("scaling", job["size"])
    scene.render.engine = "SPECULA"  # some of what is exported depends on the engine
    scene.render.threads_mode, scene.render.threads = "FIXED", job["threads"]
    empty = resident_memory()
    _scaling_scene.build(job)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    held = resident_memory()
    reset_peak_memory()
    log = ExportLog()
    start = time.perf_counter()
    exported = export_scene(depsgraph, log, images_as_pixels=not native.reads_image_files())
    with upload(exported) as native_scene:
        export_seconds = time.perf_counter() - start
        native_scene.commit(job["threads"])
        scene_stats = native_scene.stats()
        check(job, scene_stats)
        prepared = peak_memory()
        settings = export_settings(scene)
        rows = {
            method: renders(
                native_scene,
                native.changed(settings, method=method, light_tracing="OFF"),
                job["seconds"],
            )
            for method in job["methods"]
        }
    report = {
        "export_seconds": export_seconds,
        "commit_seconds": scene_stats["commit_seconds"],
        "blender_memory": held - empty,
        "preparation_memory": prepared - empty,
        "peak_memory": peak_memory() - empty,
        "scene_stats": scene_stats,
        "renders": rows,
        "warnings": log.warnings,
    }
    with open(job["result"], "w") as file:
        json.dump(report, file)


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
    sys.stdout.flush()
    # bpy may crash as the interpreter goes down, after the work is done.
    os._exit(0)
