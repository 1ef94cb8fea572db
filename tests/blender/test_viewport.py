# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered viewport in a window, beside F12 of the same state; PyPI's bpy has no window."""

import json
import os
import subprocess
from pathlib import Path

import bpy
import numpy as np
import pytest
from scenes import add_camera, add_light, add_mesh, add_node, new_material, surface

ROOT = Path(__file__).parents[2]
SECONDS = 600
DISPLAY = ("xvfb-run", "-a", "-s", "-screen 0 800x600x24")
WINDOW = ("--window-geometry", "0", "0", "640", "480")  # a few pixels, so that all are soon done
SIZE = (160, 120)
BLOCKS = 8  # along the frame's edges
MARGIN = 0.2  # of a block, left out on each side
CLOSE = 0.03  # of display values, mean of a block: noise of the samples


def make_scene(path: str) -> None:
    material = new_material("Ball")
    add_node(material, "ShaderNodeBsdfDiffuse", surface(material)).name = "Shader"
    ball = add_mesh("Ball", material=material)
    ball.location.z = 0.6
    ball.specula.caustics = "CASTER"  # which its material cannot be
    floor = add_mesh("Floor")
    floor.scale = (3, 3, 1)
    own = bpy.data.collections.new("Floors")
    bpy.context.scene.collection.children.link(own)
    own.objects.link(floor)
    bpy.context.scene.collection.objects.unlink(floor)
    layer = bpy.context.scene.view_layers.new("Without Floor")
    layer.layer_collection.children["Floors"].exclude = True
    layer.use = False
    add_camera((0, 0, 4.5))
    lamp = add_light(energy=120.0)
    lamp.data.name = "Lamp"
    lamp.location = (1, 1, 3)
    for frame, x in ((1, 1.0), (2, -1.5)):
        lamp.location.x = x
        lamp.keyframe_insert("location", frame=frame)
    other = new_material("Other")
    shader = add_node(other, "ShaderNodeBsdfDiffuse", surface(other))
    shader.inputs[0].default_value = (0.1, 0.2, 0.9, 1.0)
    other.use_fake_user = True
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.0, 0.0, 0.0)
    scene.frame_set(1)
    scene.render.engine = "SPECULA"
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.specula.samples = scene.specula.viewport_samples = 16
    scene.render.image_settings.file_format = "PNG"
    bpy.ops.wm.save_as_mainfile(filepath=path)


def blocks(path: str, frame=None) -> np.ndarray:
    """Means of the display values of `frame`, all by default, in the middles of BLOCKS x BLOCKS
    parts: the lines around a camera's frame lie on its edge."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.array(image.pixels[:]).reshape(height, width, -1)[:, :, :3]
    x0, y0, x1, y1 = frame or (0, 0, width, height)

    def part(low: float, high: float, i: int) -> slice:
        size = (high - low) / BLOCKS
        return slice(round(low + (i + MARGIN) * size), round(low + (i + 1 - MARGIN) * size))

    means = [
        pixels[part(y0, y1, j), part(x0, x1, i)].mean(axis=(0, 1))
        for j in range(BLOCKS)
        for i in range(BLOCKS)
    ]
    return np.array(means)


@pytest.mark.skipif(not bpy.app.binary_path, reason="PyPI's bpy has no window")
@pytest.mark.parametrize(
    "steps, unseen",
    [
        ("edits", {"select", "undo"}),
        ("states", {"large pixels", "small pixels", "second of two"}),
    ],
)
def test_the_viewport_shows_what_f12_renders(tmp_path, steps, unseen):
    """After each step, of which all but the `unseen` change the picture."""
    blend = str(tmp_path / "scene.blend")
    make_scene(blend)
    script = str(ROOT / "tests" / "blender" / "_window.py")
    command = [str(ROOT / "dev"), "blender", *WINDOW, blend, "--python", script]
    result = subprocess.run(
        [*DISPLAY, *command, "--", str(tmp_path), steps],
        cwd=ROOT,
        env=os.environ,
        capture_output=True,
        text=True,
        timeout=SECONDS,
    )
    output = result.stdout + result.stderr
    assert result.returncode == 0, output
    assert "Traceback" not in output
    lines = [json.loads(line[6:]) for line in output.splitlines() if line.startswith("frame ")]
    assert len(lines) == {"edits": 17, "states": 15}[steps]
    before = None
    for name, frame, part in lines:
        shown = inside(part)
        view = blocks(f"{tmp_path}/{name}_view.png", frame)[shown]
        final = blocks(f"{tmp_path}/{name}_f12.png")
        assert np.abs(view - final[shown]).max() < CLOSE, name
        if before is not None and name not in unseen:
            assert np.abs(final - before).max() > CLOSE, f"{name} does not show"
        before = final
    assert "left 0" in output.splitlines()
    if steps == "states":
        assert 'report ["marked as caster, but path traced: ' in output


def inside(part: list[float]) -> np.ndarray:
    """Which blocks of a frame lie in a part of it, x0, y0, x1, y1 as shares."""
    middle = (np.arange(BLOCKS) + 0.5) / BLOCKS
    across = (part[0] < middle) & (middle < part[2])
    up = (part[1] < middle) & (middle < part[3])
    return (up[:, None] & across[None, :]).ravel()
