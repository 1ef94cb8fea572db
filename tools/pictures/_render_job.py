# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in today's Blender: renders a picture, as a job says.

The last argument is a JSON file: `scene` (path), `engine`, `seconds` or `samples`, `picture` (JPEG
to write, as the scene's view shows it), and either `width` in pixels, or `size` [width, height] and
`border` [left, bottom, right, top], the part that is rendered.
"""

from __future__ import annotations

import json
import os
import sys

import bpy

ENDLESS = 1 << 20  # samples: time ends the render
QUALITY = 88  # % of JPEG


def set_size(render, job: dict) -> None:
    if "width" in job:
        height = round(job["width"] * render.resolution_y / render.resolution_x)
        render.resolution_x, render.resolution_y = job["width"], height
    else:
        render.resolution_x, render.resolution_y = width, height = job["size"]
        left, bottom, right, top = job["border"]
        render.use_border = render.use_crop_to_border = True
        # Blender truncates: half a pixel keeps shares off the edges.
        render.border_min_x, render.border_max_x = (left + 0.5) / width, (right + 0.5) / width
        render.border_min_y, render.border_max_y = (bottom + 0.5) / height, (top + 0.5) / height
    render.resolution_percentage = 100


def set_engine(scene, engine: str, seconds: float, samples: int) -> None:
    """Both path trace everything; Cycles without what would change its mean, or denoise."""
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.time_limit = samples, seconds
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0.0
    if engine == "CYCLES":
        cycles.device = "CPU"
        for obj in scene.objects:  # its shadow caustics ignore normal maps and reflections
            obj.cycles.is_caustics_caster = False
    else:
        scene.specula.samples, scene.specula.time_limit = samples, seconds


def main(job: dict) -> None:
    bpy.ops.wm.open_mainfile(filepath=job["scene"])
    scene = bpy.context.scene
    set_size(scene.render, job)
    set_engine(scene, job["engine"], job.get("seconds", 0.0), job.get("samples", ENDLESS))
    bpy.ops.render.render()
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.quality = "JPEG", "RGB", QUALITY
    bpy.data.images["Render Result"].save_render(job["picture"], scene=scene)


if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        main(json.load(job_file))
    sys.stdout.flush()
    os._exit(0)  # bpy may crash as the interpreter goes down, after the work is done
