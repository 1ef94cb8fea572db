# SPDX-License-Identifier: GPL-3.0-or-later
"""A farm sees every failure: headless Blenders of their own, started as a farm would."""

import os
import subprocess
from pathlib import Path

import bpy
import pytest
from scenes import add_camera, add_light, add_mesh

ROOT = Path(__file__).parents[2]
IS_MODULE = not bpy.app.binary_path  # PyPI's bpy: no program, so a script renders
SECONDS = 120

RENDER = """
import bpy
bpy.ops.wm.open_mainfile(filepath={blend!r})
{before}
bpy.context.scene.render.engine = "SPECULA"
bpy.context.scene.render.filepath = {image!r}
bpy.ops.render.render(write_still=True)
"""

INJECT = """
import specula.export.scene as scene
def broken(*_):
    raise RuntimeError("injected")
scene.export_mesh = broken
"""


@pytest.fixture
def farm(tmp_path):
    """Saves the open file and renders it elsewhere: farm(before=Python, **environment)."""

    def render(before="", **environment):
        blend, image = str(tmp_path / "scene.blend"), str(tmp_path / "image")
        bpy.ops.wm.save_as_mainfile(filepath=blend)
        (tmp_path / "before.py").write_text(before)
        if IS_MODULE:
            script = tmp_path / "render.py"
            script.write_text(RENDER.format(blend=blend, image=image, before=before))
            command = ["bpy", str(script)]
        else:
            setup = ["--python", str(tmp_path / "before.py")]
            still = ["--render-output", image, "--engine", "SPECULA", "--render-frame", "1"]
            command = ["blender", "--background", blend, *setup, *still]
        result = subprocess.run(
            [str(ROOT / "dev"), *command],
            cwd=ROOT,
            env=os.environ | environment,
            capture_output=True,
            text=True,
            timeout=SECONDS,
        )
        images = [path for path in tmp_path.iterdir() if path.name.startswith("image")]
        return result.returncode, result.stdout + result.stderr, images

    return render


@pytest.fixture
def scene():
    scene = bpy.context.scene
    add_camera()
    add_light()
    add_mesh("Quad")
    return scene


def test_success(scene, farm):
    code, output, images = farm()
    assert code == 0, output
    assert len(images) == 1
    assert "Specula: Scene, ViewLayer" in output


def test_a_time_limit_is_a_success(scene, farm):
    scene.specula.samples = 1 << 20
    scene.specula.time_limit = 1.0
    code, output, images = farm()
    assert code == 0, output
    assert len(images) == 1


def test_a_warning_is_a_success(scene, farm):
    bpy.data.objects["Quad"].is_shadow_catcher = True
    code, output, images = farm()
    assert code == 0, output
    assert output.count("object Quad: shadow catchers are not supported") == 1
    assert len(images) == 1


def test_a_vertex_that_is_not_a_number(scene, farm):
    bpy.data.objects["Quad"].data.vertices[0].co.x = float("nan")
    code, output, images = farm()
    assert code == 1, output
    assert "Quad" in output
    assert images == []


def test_an_exception_in_the_export(scene, farm):
    code, output, images = farm(before=INJECT)
    assert code == 1, output
    assert "object Quad: RuntimeError: injected" in output
    assert "Traceback" in output
    assert images == []


def test_no_camera(farm):
    add_mesh()
    code, output, images = farm()
    assert code == 1, output
    assert "camera" in output
    assert images == []


def test_an_unsupported_camera(scene, farm):
    types = bpy.types.Camera.bl_rna.properties["type"].enum_items
    if "CUSTOM" not in types:
        pytest.skip("all types of cameras are supported")
    scene.camera.data.type = "CUSTOM"
    code, output, images = farm()
    assert code == 1, output
    assert "camera Camera: type CUSTOM is not supported" in output
    assert images == []


def test_no_library(scene, farm, tmp_path):
    code, output, images = farm(SPECULA_LIBRARY_DIR=str(tmp_path / "empty"))
    assert code == 1, output
    assert "the core library is missing" in output
    assert images == []


def test_no_numpy(scene, farm):
    before = "import sys\nfor m in [m for m in sys.modules if m.split('.')[0] == 'numpy']:\n"
    before += "    del sys.modules[m]\nsys.modules['numpy'] = None\n"
    code, output, images = farm(before=before)
    assert code == 1, output
    assert "NumPy" in output
    assert images == []


def test_an_exception_in_a_callback(scene, farm):
    before = "import specula.passes\nspecula.passes.SWITCHES = None\n"
    code, output, images = farm(before=before)
    assert code == 1, output
    assert "Specula: AttributeError" in output
    assert images == []
