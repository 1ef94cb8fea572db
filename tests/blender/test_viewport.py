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

# Runs in the window's Blender. After each edit, which artists make by operators or in panels, waits
# for the final picture, takes a screenshot, and renders as F12 does.
SCRIPT = """
import gc
import json
import os
import sys
import time
import traceback
import bpy
from specula import viewport
from specula.export.view import camera_frame

OUT = {out!r}
window = bpy.context.window_manager.windows[0]
area = max(window.screen.areas, key=lambda area: area.width * area.height)
area.type = "VIEW_3D"
space = area.spaces[0]
region = next(region for region in area.regions if region.type == "WINDOW")
space.overlay.show_overlays = space.show_gizmo = False
space.show_region_header = space.show_region_tool_header = space.show_region_toolbar = False
shown = []
make = viewport.Viewport.__init__


def recorded(self, engine):
    make(self, engine)
    shown.append(self)


viewport.Viewport.__init__ = recorded
here = dict(window=window, area=area, region=region)


def select(obj):
    bpy.ops.object.select_all(action="DESELECT")
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj


def edits():
    ball, floor = bpy.data.objects["Ball"], bpy.data.objects["Floor"]
    yield "start", lambda: None
    select(ball)
    yield "move", lambda: bpy.ops.transform.translate(value=(0.7, 0.0, 0.0))
    shader = ball.active_material.node_tree.nodes["Shader"]
    yield "node", lambda: setattr(shader.inputs[0], "default_value", (0.9, 0.1, 0.1, 1.0))
    yield "light", lambda: setattr(bpy.data.lights["Lamp"], "energy", 40.0)
    yield "mesh", lambda: raise_vertex(ball.data)
    yield "frame", lambda: bpy.context.scene.frame_set(2)
    yield "world", lambda: setattr(bpy.data.worlds["World"], "color", (0.4, 0.5, 0.8))
    yield "slot", lambda: ball.data.materials.__setitem__(0, bpy.data.materials["Other"])
    yield "hide", lambda: hide(floor, True)
    yield "unhide", lambda: hide(floor, False)
    yield "add", lambda: bpy.ops.mesh.primitive_cube_add(size=0.8, location=(-0.9, 0.2, 0.4))
    yield "delete", lambda: bpy.ops.object.delete()
    yield "camera", lambda: setattr(bpy.context.scene.camera, "location", (0.4, -0.5, 4.0))
    yield "exposure", lambda: setattr(bpy.context.scene.cycles, "film_exposure", 0.5)
    bpy.ops.ed.undo_push()
    bpy.data.objects["Floor"].location.z += 1.0
    bpy.ops.ed.undo_push()
    yield "undo", bpy.ops.ed.undo


def raise_vertex(mesh):
    mesh.vertices[0].co = (-2.0, -2.0, 0.5)
    mesh.update()


def hide(obj, hidden):
    obj.hide_set(hidden)
    obj.hide_render = hidden


def is_final():
    view = shown[-1] if shown else None
    if view is not None and view._problem:
        raise RuntimeError(view._problem)
    return view is not None and view._refinement is not None and view._refinement.is_final


def steps():
    space.region_3d.view_perspective = "CAMERA"
    space.shading.type = "RENDERED"
    for name, edit in edits():
        with bpy.context.temp_override(**here):
            edit()
        for _ in range(3):  # redraws, so that the viewport has heard of it
            area.tag_redraw()
            yield 0.1
        while not is_final():
            yield 0.05
        for _ in range(2):
            area.tag_redraw()
            yield 0.1
        with bpy.context.temp_override(**here):
            bpy.ops.screen.screenshot(filepath=f"{{OUT}}/{{name}}_view.png")
        scene = bpy.context.scene
        low, high = camera_frame(space.region_3d, scene, scene.camera)
        frame = [region.x + low[0] * region.width, region.y + low[1] * region.height,
                 region.x + high[0] * region.width, region.y + high[1] * region.height]
        print("frame", json.dumps([name, *map(float, frame)]), flush=True)
        scene.render.filepath = f"{{OUT}}/{{name}}_f12.png"
        bpy.ops.render.render(write_still=True)
    space.shading.type = "SOLID"
    yield 1.0
    gc.collect()
    print("left", sum(view._refinement is not None for view in shown), flush=True)
    os._exit(0)


def advance(run=steps()):
    try:
        return next(run)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(3)


bpy.app.timers.register(advance, first_interval=1.0, persistent=True)
"""


def make_scene(path: str) -> None:
    material = new_material("Ball")
    add_node(material, "ShaderNodeBsdfDiffuse", surface(material)).name = "Shader"
    add_mesh("Ball", material=material).location.z = 0.6
    floor = add_mesh("Floor")
    floor.scale = (3, 3, 1)
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
def test_the_viewport_shows_what_f12_renders_after_every_edit(tmp_path):
    blend = str(tmp_path / "scene.blend")
    make_scene(blend)
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(out=str(tmp_path)))
    result = subprocess.run(
        [*DISPLAY, str(ROOT / "dev"), "blender", *WINDOW, blend, "--python", str(script)],
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
    assert len(lines) == 15
    before = None
    for name, *frame in lines:
        view = blocks(f"{tmp_path}/{name}_view.png", frame)
        final = blocks(f"{tmp_path}/{name}_f12.png")
        assert np.abs(view - final).max() < CLOSE, name
        if name not in ("start", "undo"):
            assert np.abs(final - before).max() > CLOSE, f"{name} does not show"
        before = final
    assert "left 0" in output.splitlines()
