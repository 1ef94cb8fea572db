# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in the window's Blender for test_viewport.py, with a folder and the name of a list of steps
after "--".

After each step, which artists make by operators or in panels, waits for the final picture, takes a
screenshot, renders as F12 does, and prints where the frame is: the step's name, then x0, y0, x1, y1
in pixels of the window, and which part of the frame is shown.
"""

import gc
import json
import os
import sys
import traceback

import bpy

from specula import viewport
from specula.export.view import camera_frame

FOLDER, STEPS = sys.argv[sys.argv.index("--") + 1 :]
WHOLE = (0.0, 0.0, 1.0, 1.0)

shown = []  # viewports, in the order in which they came
make = viewport.Viewport.__init__


def recorded(self, engine):
    make(self, engine)
    shown.append(self)


viewport.Viewport.__init__ = recorded


class View:
    """The 3D view, wherever a file that was loaded has put it."""

    def __init__(self, number: int = 0):
        self.window = bpy.context.window_manager.windows[0]
        areas = [area for area in self.window.screen.areas if area.type == "VIEW_3D"]
        self.area = sorted(areas, key=lambda area: -area.width * area.height)[number]
        self.space = self.area.spaces[0]
        regions = self.area.regions
        self.region = next(region for region in regions if region.type == "WINDOW")

    def override(self):
        return bpy.context.temp_override(window=self.window, area=self.area, region=self.region)

    def frame(self) -> list[float]:
        scene, region = bpy.context.scene, self.region
        low, high = camera_frame(self.space.region_3d, scene, scene.camera)
        return [
            float(x)
            for share in (low, high)
            for x in (region.x + share[0] * region.width, region.y + share[1] * region.height)
        ]


def only_a_view() -> None:
    """Makes the largest area a 3D view without overlays, which looks through the camera."""
    window = bpy.context.window_manager.windows[0]
    max(window.screen.areas, key=lambda area: area.width * area.height).type = "VIEW_3D"
    space = View().space
    space.overlay.show_overlays = space.show_gizmo = False
    space.show_region_header = space.show_region_tool_header = space.show_region_toolbar = False
    space.region_3d.view_perspective = "CAMERA"
    space.shading.type = "RENDERED"


def select(*objects) -> None:
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]


def hide(obj, hidden) -> None:
    obj.hide_set(hidden)
    obj.hide_render = hidden


def raise_vertex(mesh) -> None:
    mesh.vertices[0].co = (-2.0, -2.0, 0.5)
    mesh.update()


def edits():
    """Each step is a name, what to do, and which part of the frame then shows it."""
    ball, floor = bpy.data.objects["Ball"], bpy.data.objects["Floor"]
    yield "start", lambda: None
    yield "select", lambda: select(ball)
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
    yield "redo", bpy.ops.ed.redo


def states():
    """What a view shows of a scene, and what else goes on. F12 knows nothing of a local view:
    there it leaves out what that does not show."""
    scene, window = bpy.context.scene, View().window
    ball, floor, lamp = (bpy.data.objects[name] for name in ("Ball", "Floor", "Light"))
    yield "start", lambda: None

    def local_view():
        select(ball, lamp)
        bpy.ops.view3d.localview(frame_selected=False)
        floor.hide_render = True

    def global_view():
        bpy.ops.view3d.localview(frame_selected=False)
        floor.hide_render = False

    yield "local", local_view
    yield "global", global_view
    yield "clipping", lambda: setattr(scene.camera.data, "clip_start", 4.2)
    yield "unclipped", lambda: setattr(scene.camera.data, "clip_start", 0.1)

    def border(used):
        scene.render.use_border = used
        scene.render.border_min_x, scene.render.border_max_x = 0.25, 0.75
        scene.render.border_min_y, scene.render.border_max_y = 0.25, 0.75

    yield "border", lambda: border(True), (0.25, 0.25, 0.75, 0.75)
    yield "whole", lambda: border(False)

    def other_layer(used):
        layers = scene.view_layers
        window.view_layer = layers["Without Floor" if used else "ViewLayer"]
        for layer in layers:
            layer.use = layer == window.view_layer

    yield "layer", lambda: other_layer(True)
    yield "first layer", lambda: other_layer(False)
    pixel_size = scene.render.preview_pixel_size
    yield "large pixels", lambda: setattr(scene.render, "preview_pixel_size", "2")
    yield "small pixels", lambda: setattr(scene.render, "preview_pixel_size", pixel_size)

    def pause(paused):
        scene.cycles.preview_pause = paused

    def while_paused():
        pause(True)
        bpy.data.lights["Lamp"].energy *= 0.3
        bpy.app.timers.register(lambda: pause(False), first_interval=0.5)

    yield "paused", while_paused

    def reload():
        bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath, load_ui=False)

    yield "reload", reload


def is_final() -> bool:
    alive = [view for view in shown if view._refinement is not None]
    for view in shown:
        if view._problem:
            raise RuntimeError(view._problem)
    return bool(alive) and all(view._refinement.is_final and not view._is_paused for view in alive)


def screenshot(name: str) -> None:
    with View().override():
        bpy.ops.screen.screenshot(filepath=f"{FOLDER}/{name}_view.png")


def redraw() -> None:
    for area in View().window.screen.areas:
        area.tag_redraw()


def settled():
    """Waits until all views show their final pictures."""
    for _ in range(3):  # so that they have heard of what has changed
        redraw()
        yield 0.1
    while not is_final():
        yield 0.05
    for _ in range(2):
        redraw()
        yield 0.1


def tell(name: str, frame: list[float], part=WHOLE) -> None:
    print("frame", json.dumps([name, frame, part]), flush=True)


def run():
    only_a_view()
    for name, step, *part in globals()[STEPS]():
        with View().override():
            step()
        yield from settled()
        screenshot(name)
        tell(name, View().frame(), *part)
        bpy.context.scene.render.filepath = f"{FOLDER}/{name}_f12.png"
        bpy.ops.render.render(write_still=True)
    if STEPS == "states":
        yield from two_views_and_f12()
        report = viewport.live_report(bpy.context.scene, "Ball")
        print("report", json.dumps(report), flush=True)
    for area in View().window.screen.areas:
        if area.type == "VIEW_3D":
            area.spaces[0].shading.type = "SOLID"
    yield 1.0
    gc.collect()
    print("left", sum(view._refinement is not None for view in shown), flush=True)
    os._exit(0)


def two_views_and_f12():
    """Another view beside the first, while F12 renders in the background."""
    bpy.context.preferences.view.render_display_type = "NONE"
    with View().override():
        bpy.ops.screen.area_split(direction="HORIZONTAL", factor=0.5)
    yield 0.2
    for number in (0, 1):  # the new one is solid
        View(number).space.shading.type = "RENDERED"
    yield from settled()
    bpy.data.objects["Ball"].location.x += 0.5
    with View().override():
        bpy.ops.render.render("INVOKE_DEFAULT")
    while bpy.app.is_job_running("RENDER"):
        redraw()
        yield 0.05
    yield from settled()
    for number, name in enumerate(("first of two", "second of two")):
        screenshot(name)
        tell(name, View(number).frame())
        bpy.data.images["Render Result"].save_render(f"{FOLDER}/{name}_f12.png")


running = run()


def advance():
    try:
        return next(running)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(3)


bpy.app.timers.register(advance, first_interval=1.0, persistent=True)
