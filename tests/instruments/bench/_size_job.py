# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a child process, in today's Blender: reports a scene's frame size in pixels.

The last argument is a JSON file, the job: `scene` (path) and `result` (the JSON file to write).
"""

from __future__ import annotations

import json
import os
import sys

import bpy

if __name__ == "__main__":
    with open(sys.argv[-1]) as job_file:
        job = json.load(job_file)
    bpy.ops.wm.open_mainfile(filepath=job["scene"])
    render = bpy.context.scene.render
    factor = render.resolution_percentage / 100
    with open(job["result"], "w") as file:
        size = [round(render.resolution_x * factor), round(render.resolution_y * factor)]
        json.dump({"size": size}, file)
    sys.stdout.flush()
    os._exit(0)
