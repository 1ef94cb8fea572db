# SPDX-License-Identifier: GPL-3.0-or-later
"""A render and the panels in a window, as an artist sees them; PyPI's bpy has none."""

import os
import subprocess
from pathlib import Path

import bpy
import numpy as np
import pytest
from scenes import add_camera, add_light, add_mesh, add_node, new_material, surface

ROOT = Path(__file__).parents[2]
SECONDS = 120
DISPLAY = ("xvfb-run", "-a", "-s", "-screen 0 1280x1024x24")
TABS = ("RENDER", "VIEW_LAYER", "OBJECT", "MATERIAL", "WORLD", "DATA")

# Runs in the window's Blender: renders as F12 does, then shows each tab of the properties.
SCRIPT = """
import os
import bpy
from specula import statistics, ui

TABS = {tabs!r}
bpy.context.preferences.view.render_display_type = "AREA"  # a new window would redraw all others
window = bpy.context.window_manager.windows[0]
area = max(window.screen.areas, key=lambda area: area.width * area.height)
properties = next(area for area in window.screen.areas if area.type == "PROPERTIES")
drawn = set()
steps = iter(("before", "render", "after", "properties", *TABS, "end"))
column, draw_statistics = ui.panel.SpeculaPanel.column, bpy.types.SPECULA_PT_statistics.draw


def recorded(panel):
    drawn.add(type(panel).__name__)
    return column(panel)


def recorded_statistics(panel, context):
    if statistics.last and area.type != "PROPERTIES":
        drawn.add("statistics_after_the_render")
    draw_statistics(panel, context)


def advance():
    if bpy.app.is_job_running("RENDER"):
        return 0.2
    step = next(steps)
    with bpy.context.temp_override(window=window, area=area):
        if step == "before":
            properties.spaces[0].context = "RENDER"
        elif step == "render":
            bpy.ops.render.render("INVOKE_DEFAULT")
        elif step == "properties":
            bpy.data.images["Render Result"].save_render({image!r})
            area.type = "PROPERTIES"
        elif step in TABS:
            area.spaces[0].context = step
    if step == "end":
        print("drawn", *drawn, flush=True)
        os._exit(0)
    return 0.5


ui.panel.SpeculaPanel.column = recorded
bpy.types.SPECULA_PT_statistics.draw = recorded_statistics
bpy.app.timers.register(advance, first_interval=1.0, persistent=True)
"""


@pytest.mark.skipif(not bpy.app.binary_path, reason="PyPI's bpy has no window")
def test_a_render_and_the_panels_in_a_window(tmp_path):
    material = new_material()
    add_node(material, "ShaderNodeBsdfGlass", surface(material)).inputs[0].default_value[0] = 0.5
    obj = add_mesh("Quad", material=material)
    add_mesh("Floor").location.z = -1
    add_camera()
    add_light(energy=1000.0).location = (1, 1, 3)
    bpy.context.view_layer.objects.active = obj
    bpy.context.scene.render.image_settings.file_format = "PNG"
    blend, image = str(tmp_path / "scene.blend"), str(tmp_path / "image.png")
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(tabs=TABS, image=image))
    result = subprocess.run(
        [*DISPLAY, str(ROOT / "dev"), "blender", blend, "--python", str(script)],
        cwd=ROOT,
        env=os.environ,
        capture_output=True,
        text=True,
        timeout=SECONDS,
    )
    output = result.stdout + result.stderr
    assert result.returncode == 0, output
    assert "Traceback" not in output
    assert np.array(bpy.data.images.load(image).pixels[:]).reshape(-1, 4)[:, :3].max() > 0.1
    (line,) = [line for line in output.splitlines() if line.startswith("drawn ")]
    assert set(line.split()[1:]) >= {
        "statistics_after_the_render",  # nobody touched a window meanwhile
        "SPECULA_PT_sampling",
        "SPECULA_PT_passes",
        "SPECULA_PT_object_caustics",
        "SPECULA_PT_material_caustics",
        "SPECULA_PT_material_glints",
    }
