# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, in today's Blender with the addon: writes what Specula is told of a
scene to a file, for another renderer to read, and reports how it is to be rendered.

The last argument is a JSON file, the job: `scene` (path), `size` ([width, height], pixels),
`description` (file to write: the pickle of a `specula.export.desc.SceneDesc`, its images decoded),
`result` (the JSON file to write: `warnings`, what the export says it falls back from, and
`settings`: `bounces`, `filter` ([name, width in pixels]), `exposure`).
"""

from __future__ import annotations

import json
import os
import pickle
import sys

import bpy
import numpy as np

from specula.abi import PixelFilter
from specula.export import desc
from specula.export.log import ExportLog
from specula.export.scene import export_scene
from specula.export.settings import export_settings, film_exposure


def decode(description) -> None:
    """Gives every image its pixels: (H, W, 4) as Blender holds them, bottom row first."""
    for image in description.images:
        if image.pixels is not None:
            continue
        source = bpy.data.images[image.name]
        width, height = source.size
        pixels = np.empty((height, width, source.channels), np.float32)
        source.pixels.foreach_get(pixels.ravel())
        image.pixels, image.encoded, image.path = pixels, None, None
        if source.is_float and image.color_space == desc.ColorSpace.SRGB:
            image.color_space = desc.ColorSpace.LINEAR  # such images are linear in memory


def main(job: dict) -> None:
    bpy.ops.wm.open_mainfile(filepath=job["scene"])
    scene = bpy.context.scene
    render = scene.render
    # Some of what is exported, ray visibility among it, depends on the engine.
    render.engine = "SPECULA"
    render.resolution_x, render.resolution_y = job["size"]
    render.resolution_percentage = 100
    log = ExportLog()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    description = export_scene(depsgraph, log)
    decode(description)
    with open(job["description"], "wb") as file:
        pickle.dump(description, file)
    settings = export_settings(scene)
    report = {
        "warnings": log.warnings,
        "settings": {
            "bounces": settings.max_bounces,
            "filter": [PixelFilter(settings.pixel_filter).name, settings.filter_width],
            "exposure": film_exposure(scene),
        },
    }
    with open(job["result"], "w") as file:
        json.dump(report, file)


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
    sys.stdout.flush()
    # bpy may crash as the interpreter goes down, after the work is done.
    os._exit(0)
