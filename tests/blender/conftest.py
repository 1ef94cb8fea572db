# SPDX-License-Identifier: GPL-3.0-or-later
"""Every test starts from an empty file with the addon enabled."""

import sys
from pathlib import Path

import bpy
import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(autouse=True)
def empty_file():
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "SPECULA"
    scene.render.resolution_x, scene.render.resolution_y = 32, 16
    scene.specula.samples = 1
    # Which are on in a new file.
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    return scene
