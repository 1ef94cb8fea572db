# SPDX-License-Identifier: GPL-3.0-or-later
"""The core beside Blender's own libraries."""

import os
import subprocess
import sys

import bpy
import numpy as np
import pytest
from scenes import add_camera, add_light, add_mesh

# Blender's own libraries where an official build has them: in the scope that is searched first.
RENDER = """
import os, sys
sys.setdlopenflags(os.RTLD_NOW | {scope})
import bpy
sys.setdlopenflags(os.RTLD_NOW)
import addon_utils
bpy.ops.wm.open_mainfile(filepath={blend!r})
assert addon_utils.enable("specula", default_set=True)
bpy.context.scene.render.engine = "SPECULA"
bpy.context.scene.render.filepath = {image!r}
bpy.ops.render.render(write_still=True)
sys.stdout.flush()
os._exit(0)
"""


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="Debian's Blender has the core's own Embree")
def test_blenders_embree_does_not_stand_in_for_ours(tmp_path):
    scene = bpy.context.scene
    add_camera()
    add_light(energy=1000.0).location = (0, 0, 3)
    add_mesh("Quad")
    scene.render.image_settings.file_format = "OPEN_EXR"
    blend = str(tmp_path / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    pictures = []
    for scope in ("os.RTLD_LOCAL", "os.RTLD_GLOBAL"):
        image = str(tmp_path / f"{len(pictures)}.exr")
        script = RENDER.format(scope=scope, blend=blend, image=image)
        subprocess.run([sys.executable, "-c", script], check=True, timeout=120, env=os.environ)
        loaded = bpy.data.images.load(image)
        pictures.append(np.array(loaded.pixels[:]))
    assert pictures[0].max() > 0.5
    np.testing.assert_array_equal(pictures[0], pictures[1])
