# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in the window's Blender, with the addon: how long an artist waits for the rendered viewport.

The last argument is a JSON file, the job: `engine` (SPECULA or CYCLES), `scene` (path of a file;
null for hills of `triangles`), `material` and `object` (names of what is edited; the material has
one closure with a colour), `rounds`, and `result` (the JSON file to write): for each of STEPS
`first`, seconds from the edit to the end of the first redraw that shows another picture, and
`held`, the longest call of the engine until then, during which Blender stands still. An edit comes
when the picture before it is final; `interrupt` comes while one is refined.
"""

from __future__ import annotations

import json
import os
import sys
import time
import traceback

import bpy
import gpu
import numpy as np

STEPS = ("enter", "camera", "material", "object", "interrupt")
SETTLED_SECONDS = 1.0  # without another picture
SAMPLES, MANY_SAMPLES = 4, 4096
TICK_SECONDS = 0.005
WARM_UP = 1  # rounds that do not count
PART = 0.5  # of the view's edges that is looked at: its middle, which no text covers

with open(sys.argv[-1]) as job_file:
    JOB = json.load(job_file)


class Watch:
    """What the engine draws, and how long it takes."""

    def __init__(self):
        self.picture = b""
        self.changed = 0.0  # when it did last, s
        self.begun = 0.0  # when the edit was made, s
        self.first: float | None = None  # s from then to the first other picture
        self.held = 0.0  # s

    def begin(self) -> None:
        self.begun, self.first, self.held = time.perf_counter(), None, 0.0

    def call(self, function, *arguments) -> None:
        start = time.perf_counter()
        function(*arguments)
        if self.first is None:
            self.held = max(self.held, time.perf_counter() - start)

    def look(self) -> None:
        """After a redraw, whose end this waits for."""
        picture = middle_of_view()
        now = time.perf_counter()
        if picture is None or picture == self.picture:
            return
        self.picture, self.changed = picture, now
        if self.first is None:
            self.first = now - self.begun


WATCH = Watch()


def middle_of_view() -> bytes | None:
    """The pixels in the middle of what is being drawn; None if they are all the same."""
    region = bpy.context.region
    width, height = int(PART * region.width), int(PART * region.height)
    corner = (region.width - width) // 2, (region.height - height) // 2
    buffer = gpu.types.Buffer("FLOAT", width * height * 4)
    framebuffer = gpu.state.active_framebuffer_get()
    framebuffer.read_color(*corner, width, height, 4, 0, "FLOAT", data=buffer)
    pixels = np.array(buffer, np.float32).reshape(-1, 4)[:, :3]
    return pixels.tobytes() if np.ptp(pixels, axis=0).any() else None


def watch_engine() -> None:
    if JOB["engine"] == "CYCLES":
        from cycles import CyclesRender as Engine
    else:
        from specula.engine import SpeculaRenderEngine as Engine
    update, draw = Engine.view_update, Engine.view_draw

    def view_update(self, context, depsgraph):
        WATCH.call(update, self, context, depsgraph)

    def view_draw(self, context, depsgraph):
        WATCH.call(draw, self, context, depsgraph)
        WATCH.look()

    Engine.view_update, Engine.view_draw = view_update, view_draw


def make_hills(triangles: int) -> None:
    """A grid of hills with a block on it, in place of what the scene has."""
    scene = bpy.context.scene
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    side = int((triangles / 2) ** 0.5) + 1
    x, y = np.meshgrid(*2 * [np.linspace(-4.0, 4.0, side, dtype=np.float32)])
    z = 0.2 * np.sin(3.0 * x) * np.cos(2.0 * y)
    first = np.arange(side * (side - 1)).reshape(-1, side)[:, :-1].ravel()
    quads = np.stack([first, first + 1, first + side + 1, first + side], axis=1)
    corners = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    hills = bpy.data.meshes.new("Hills")
    hills.vertices.add(side * side)
    hills.vertices.foreach_set("co", np.stack([x, y, z], axis=-1).ravel())
    hills.loops.add(corners.size)
    hills.loops.foreach_set("vertex_index", corners.ravel())
    hills.polygons.add(len(corners))
    hills.polygons.foreach_set("loop_start", np.arange(0, corners.size, 3, dtype=np.int32))
    hills.polygons.foreach_set("loop_total", np.full(len(corners), 3, np.int32))
    hills.update(calc_edges=True)
    block = bpy.data.meshes.new("Block")
    ends = [(a, b, c) for a in (-0.4, 0.4) for b in (-0.4, 0.4) for c in (0.3, 1.1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    block.from_pydata(ends, [], faces)
    for mesh in (hills, block):
        material = bpy.data.materials.new(mesh.name)
        material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.remove(nodes["Principled BSDF"])
        shader = nodes.new("ShaderNodeBsdfDiffuse")
        shader.inputs["Color"].default_value = (0.7, 0.4, 0.2, 1.0)
        output = nodes["Material Output"].inputs["Surface"]
        material.node_tree.links.new(shader.outputs["BSDF"], output)
        mesh.materials.append(material)
        scene.collection.objects.link(bpy.data.objects.new(mesh.name, mesh))
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "SUN"))
    lamp.rotation_euler = (0.6, 0.3, 0.0)
    lamp.data.energy = 3.0
    camera = scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0.0, -7.0, 5.0), (0.95, 0.0, 0.0)
    for obj in (lamp, camera):
        scene.collection.objects.link(obj)


def prepare() -> None:
    """One 3D view, through the camera."""
    if JOB["scene"] is None:
        make_hills(JOB["triangles"])
    scene = bpy.context.scene
    scene.render.engine = JOB["engine"]
    scene.cycles.use_preview_denoising = scene.cycles.use_preview_adaptive_sampling = False
    set_samples(SAMPLES)
    window = bpy.context.window_manager.windows[0]
    max(window.screen.areas, key=lambda area: area.width * area.height).type = "VIEW_3D"
    space = view().spaces[0]
    space.overlay.show_overlays = space.show_gizmo = False
    space.show_region_header = space.show_region_tool_header = space.show_region_toolbar = False
    space.region_3d.view_perspective = "CAMERA"


def view():
    areas = bpy.context.window_manager.windows[0].screen.areas
    return max(
        (area for area in areas if area.type == "VIEW_3D"),
        key=lambda area: area.width * area.height,
    )


def set_samples(samples: int) -> None:
    scene = bpy.context.scene
    scene.cycles.preview_samples = scene.specula.viewport_samples = samples


def enter() -> None:
    view().spaces[0].shading.type = "RENDERED"


def move_camera() -> None:
    bpy.context.scene.camera.location.x += 0.05


def change_material() -> None:
    nodes = bpy.data.materials[JOB["material"]].node_tree.nodes
    color = next(node for node in nodes if node.type.startswith("BSDF")).inputs["Color"]
    color.default_value = (*(1.0 - c for c in color.default_value[:3]), 1.0)


def move_object() -> None:
    bpy.data.objects[JOB["object"]].location.x += 0.1


EDITS = dict(
    zip(STEPS, (enter, move_camera, change_material, move_object, move_object), strict=True)
)


def settled():
    """Waits until there is a picture that does not change any more."""
    while WATCH.first is None or time.perf_counter() - WATCH.changed < SETTLED_SECONDS:
        yield TICK_SECONDS


def measured(name: str, found: dict):
    WATCH.begin()
    EDITS[name]()
    while WATCH.first is None:
        yield TICK_SECONDS
    found[name]["first"].append(WATCH.first)
    found[name]["held"].append(WATCH.held)


def one_round(found: dict):
    WATCH.picture = b""
    for name in STEPS[:-1]:
        yield from measured(name, found)
        yield from settled()
    set_samples(MANY_SAMPLES)
    WATCH.begin()
    move_camera()
    while WATCH.first is None:
        yield TICK_SECONDS
    yield SETTLED_SECONDS
    yield from measured(STEPS[-1], found)
    set_samples(SAMPLES)
    view().spaces[0].shading.type = "SOLID"
    yield SETTLED_SECONDS


def nothing_found() -> dict:
    return {name: {"first": [], "held": []} for name in STEPS}


def run():
    prepare()
    watch_engine()
    yield SETTLED_SECONDS
    for _ in range(WARM_UP):
        yield from one_round(nothing_found())
    found = nothing_found()
    for _ in range(JOB["rounds"]):
        yield from one_round(found)
    with open(JOB["result"], "w") as file:
        json.dump(found, file)
    os._exit(0)


RUNNING = run()


def advance():
    try:
        return next(RUNNING)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(3)


bpy.app.timers.register(advance, first_interval=1.0, persistent=True)
