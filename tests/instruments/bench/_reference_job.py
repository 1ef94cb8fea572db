# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, in today's Blender with the addon: one part of a reference.

The last argument is a JSON file, the job: `scene` (path), `size`, `method` (Specula's), `threads`,
`seconds` (about how long to sample), `seed`, `window` (left, bottom, width, height of the pixels to
render, or null for all), `image` (.npz to write: mean, variance of the mean,
caustics, and `direct`, the share of light paths, which have no caustics in mirrors or behind glass;
all (H, W, 3) float64 of those pixels, bottom row first) and `result` (the JSON file to write).
"""

from __future__ import annotations

import json
import math
import os
import sys

import bpy
import numpy as np

from specula import native
from specula.export.log import ExportLog
from specula.export.scene import export_scene
from specula.export.settings import export_settings, film_exposure
from specula.upload import upload
from tests.images._render import prepare, render
from tests.instruments.bench._image_job import set_border

PROBE_SAMPLES = 4  # from which the rate of the rest is taken; of a window as many as take that long
DIRECT_SAMPLES = 64
NAME = "reference"


def main(job: dict) -> None:
    scene = prepare(job)
    scene.render.engine = "SPECULA"  # some of what is exported depends on the engine
    size = job["size"]
    if job["window"]:
        left, bottom, *size = job["window"]
        set_border(scene.render, left, bottom, left + size[0], bottom + size[1])
    log = ExportLog()
    exported = export_scene(bpy.context.evaluated_depsgraph_get(), log)
    settings = native.changed(
        export_settings(scene),
        method=job["method"],
        light_tracing="AUTO",
        seed=job["seed"],
        threads=job["threads"],
        time_limit=0.0,
    )

    def rendered(native_scene, samples: int, **changes) -> dict:
        changed = native.changed(settings, samples=samples, **changes)
        return render(native_scene, size, NAME, changed, {})

    with upload(exported) as native_scene:
        native_scene.commit(job["threads"])
        probe_samples = PROBE_SAMPLES * math.prod(job["size"]) // math.prod(size)
        probe = json.loads(rendered(native_scene, probe_samples)[f"{NAME}/stats"])
        samples = max(2, round(probe_samples * job["seconds"] / probe["seconds"]))
        arrays = rendered(native_scene, samples)
        of_light_paths = rendered(native_scene, DIRECT_SAMPLES, method="LT")
        arrays[f"{NAME}/direct"] = of_light_paths[f"{NAME}/caustics"]
    stats = json.loads(arrays.pop(f"{NAME}/stats"))
    layers = {key.rpartition("/")[2]: value for key, value in arrays.items()}
    exposure = film_exposure(scene)  # which every picture that Blender receives has
    factors = {"variance": exposure**2}
    layers = {name: factors.get(name, exposure) * values for name, values in layers.items()}
    np.savez(job["image"], **layers)
    report = {"samples": samples, "seconds": stats["seconds"], "stats": stats}
    with open(job["result"], "w") as file:
        json.dump(report | {"warnings": log.warnings}, file)


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
    sys.stdout.flush()
    # bpy may crash as the interpreter goes down, after the work is done.
    os._exit(0)
