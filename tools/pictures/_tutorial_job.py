# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in the window of Debian's Blender: goes through a part of docs/tutorial.md.

Arguments after `--`: the part, the folder of screenshots, and the folder of the finished .blend. A
part is a generator: it does what the text says, and yields wherever the interface must be drawn.
"""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from specula.engine import SpeculaRenderEngine

PART, SHOTS, SCENES = sys.argv[-3], Path(sys.argv[-2]), Path(sys.argv[-1])
EXAMPLES = Path(__file__).resolve().parents[2] / "blend_scenes"
QUALITY = 85  # % of JPEG
SECONDS_BETWEEN = 0.6  # for the interface to draw
SAMPLES = 32
PERCENT = 33  # of 1920 x 1080
SKY = (0.16, 0.2, 0.28, 1.0)
VIEWPORT = 0.84  # of its width stays

shots = []  # (name, PNG of the window, part of it or None), in the order in which they were taken


# --------------------------------------------------------------------------------- the interface


def area(kind: str):
    return next(area for area in window().screen.areas if area.type == kind)


def window():
    return bpy.context.window_manager.windows[0]


def tab(context: str) -> None:
    """Show a tab of the properties editor."""
    area("PROPERTIES").spaces[0].context = context


def only(text: str) -> None:
    """What the search field of the properties editor holds: panels with that word are shown."""
    area("PROPERTIES").spaces[0].search_filter = text


def enlarge_properties() -> None:
    """A part of the viewport, and the outliner, become the properties editor's."""
    narrow_ones, viewport = [area("OUTLINER"), area("PROPERTIES")], area("VIEW_3D")
    with bpy.context.temp_override(window=window(), area=viewport):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=VIEWPORT)
    right = next(a for a in window().screen.areas if a.type == "VIEW_3D" and a != viewport)
    right.ui_type = "PROPERTIES"
    for narrow in narrow_ones:
        with bpy.context.temp_override(window=window(), area=narrow):
            bpy.ops.screen.area_close()


def look(distance: float, target=(0.0, 0.0, 0.0)) -> None:
    region = area("VIEW_3D").spaces[0].region_3d
    region.view_distance, region.view_location = distance, target


def screenshot(name: str, box: tuple[int, int, int, int] | None = None) -> None:
    """Of the window, or of a box [left, bottom, width, height]; `write_shots` makes it a JPEG."""
    path = SCENES / f"{name}.png"
    with bpy.context.temp_override(window=window()):
        bpy.ops.screen.screenshot(filepath=str(path))
    shots.append((name, path, box))


def write_shots() -> None:
    """SHOTS/name.jpg of each screenshot; at the end, as Blender forbids it while it draws."""
    bpy.context.scene.render.image_settings.quality = QUALITY
    for name, path, box in shots:
        image = bpy.data.images.load(str(path))
        columns, rows = image.size
        pixels = np.empty(4 * columns * rows, np.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(rows, columns, 4)
        if box:
            left, bottom, width, height = box
            pixels = pixels[bottom : bottom + height, left : left + width]
        picture = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0])
        picture.pixels.foreach_set(pixels.ravel())
        picture.filepath_raw, picture.file_format = str(SHOTS / f"{name}.jpg"), "JPEG"
        picture.save()
        bpy.data.images.remove(image)
        bpy.data.images.remove(picture)


def properties_only(name: str, share: float = 1.0) -> None:
    """A screenshot of the upper `share` of the properties editor."""
    shown = area("PROPERTIES")
    height = round(share * shown.height)
    screenshot(name, (shown.x, shown.y + shown.height - height, shown.width, height))


def render():
    """F12, in the place of the viewport."""
    with bpy.context.temp_override(window=window(), area=area("VIEW_3D")):
        bpy.ops.render.render("INVOKE_DEFAULT")
    yield
    fit = area("IMAGE_EDITOR")
    region = next(region for region in fit.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window(), area=fit, region=region):
        bpy.ops.image.view_all(fit_view=True)
    tab("RENDER")
    yield


def operator(kind: str = "VIEW_3D"):
    """Context of operators as if the mouse was over an editor."""
    place = area(kind)
    region = next(region for region in place.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=window(), area=place, region=region)


# ------------------------------------------------------------------------------------- the steps


def choose_specula() -> None:
    scene = bpy.context.scene
    scene.render.engine = "SPECULA"
    scene.specula.samples = SAMPLES
    scene.render.resolution_percentage = PERCENT
    tab("RENDER")


def brighten_world() -> None:
    world = bpy.context.scene.world.node_tree.nodes["Background"]
    world.inputs["Color"].default_value = SKY


def aim(obj, location, target=(0.0, 0.0, 0.0)) -> None:
    obj.location = location
    direction = Vector(target) - Vector(location)
    obj.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()


def select(obj) -> None:
    with operator():
        bpy.ops.object.select_all(action="DESELECT")
        obj.select_set(True)
        bpy.context.view_layer.objects.active = obj


def open_on_top(obj) -> None:
    """Edit mode: delete the face that looks up."""
    select(obj)
    with operator():
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_mode(type="FACE")
        bpy.ops.mesh.select_all(action="DESELECT")
        bpy.ops.object.mode_set(mode="OBJECT")
        for face in obj.data.polygons:
            face.select = face.normal.z > 0.9
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.delete(type="FACE")
        bpy.ops.object.mode_set(mode="OBJECT")


def add_plane(name: str, z: float, color: tuple[float, float, float], size: float = 40.0):
    with operator():
        bpy.ops.mesh.primitive_plane_add(size=size, location=(0.0, 0.0, z))
    plane = bpy.context.object
    plane.name = name
    plane.data.materials.append(principled(name, color))
    return plane


def principled(name: str, color: tuple[float, float, float], **inputs: float):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    node = material.node_tree.nodes["Principled BSDF"]
    node.inputs["Base Color"].default_value = (*color, 1.0)
    for socket, value in inputs.items():
        node.inputs[socket].default_value = value
    return material


def glass(name: str, ior: float):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.remove(nodes["Principled BSDF"])
    node = nodes.new("ShaderNodeBsdfGlass")
    node.inputs["Roughness"].default_value, node.inputs["IOR"].default_value = 0.0, ior
    material.node_tree.links.new(node.outputs[0], nodes["Material Output"].inputs["Surface"])
    return material


def smooth(obj) -> None:
    select(obj)
    with operator():
        bpy.ops.object.shade_smooth()


def tutorial_glass():
    choose_specula()
    look(11.0)
    yield
    screenshot("engine")

    cube, light = bpy.data.objects["Cube"], bpy.data.objects["Light"]
    open_on_top(cube)
    cube.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.3
    rounded = cube.modifiers.new("Subdivision", "SUBSURF")
    rounded.levels, rounded.render_levels = 3, 4
    smooth(cube)
    add_plane("Table", -0.84, (0.6, 0.42, 0.28))
    select(cube)
    tab("MODIFIER")
    yield
    screenshot("glass_shape")

    brighten_world()
    bpy.data.objects["Camera"].data.lens = 65.0
    cube.data.materials[0] = glass("Glass", 1.45)
    tab("MATERIAL")
    yield
    properties_only("glass_material")
    tab("OBJECT")
    only("Caustics")
    yield
    properties_only("glass_object", 0.82)
    only("")
    select(light)
    light.data.shadow_soft_size = 0.05
    tab("DATA")
    yield
    properties_only("glass_light", 0.46)
    yield from render()
    screenshot("glass_render")


def tutorial_pool():
    choose_specula()
    basin, light, camera = (bpy.data.objects[name] for name in ("Cube", "Light", "Camera"))
    open_on_top(basin)
    basin.name, basin.scale = "Basin", (4.0, 2.5, 1.0)
    basin.data.materials[0] = principled("Tiles", (0.35, 0.65, 0.7))
    add_plane("Lawn", -1.02, (0.12, 0.25, 0.06))
    with operator():
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=200, y_subdivisions=200, size=2.0)
    water = bpy.context.object
    water.name, water.location.z, water.scale = "Water", 0.75, (4.0, 2.5, 1.0)
    waves = bpy.data.textures.new("Waves", "CLOUDS")
    waves.noise_scale, waves.noise_depth = 0.35, 0
    displace = water.modifiers.new("Displace", "DISPLACE")
    displace.texture, displace.strength, displace.texture_coords = waves, 0.12, "GLOBAL"
    water.data.materials.append(glass("Water", 1.33))
    smooth(water)
    light.data.type, light.data.energy = "SUN", 4.0
    light.data.angle = 0.0092
    aim(camera, (10.5, -10.0, 11.5), (0.2, -0.2, -0.5))
    brighten_world()
    look(16.0)
    tab("MODIFIER")
    yield
    screenshot("pool_water")
    yield from render()
    screenshot("pool_render")


def tutorial_shoe():
    choose_specula()
    scene = bpy.context.scene
    with operator():
        bpy.ops.object.select_all(action="DESELECT")
        bpy.data.objects["Cube"].select_set(True)
        bpy.ops.object.delete()
        bpy.ops.wm.append(
            filename="Shoe, left",
            directory=str(EXAMPLES / "shoes.blend" / "Object") + "/",
        )
    shoe = next(obj for obj in scene.objects if obj.name.startswith("Shoe"))
    shoe.location, shoe.scale = (0.0, 0.0, 0.0), (15.0, 15.0, 15.0)
    add_plane("Floor", 0.0, (0.3, 0.22, 0.16))
    light, camera = bpy.data.objects["Light"], bpy.data.objects["Camera"]
    light.data.type, light.data.energy, light.data.angle = "SUN", 4.0, 0.0092
    aim(camera, (4.2, -5.2, 4.0), (0.0, -0.3, 0.4))
    camera.data.lens = 55.0
    brighten_world()
    select(shoe)
    tab("MATERIAL")
    only("Glints")
    editor = area("VIEW_3D")
    editor.ui_type = "ShaderNodeTree"
    editor.spaces[0].show_region_ui = False
    yield
    for _ in range(2):  # nodes have their size once they were drawn
        with operator("NODE_EDITOR"):
            bpy.ops.node.select_all(action="DESELECT")
            bpy.ops.node.view_all()
        yield
    with operator("NODE_EDITOR"):
        bpy.ops.view2d.zoom_in(zoomfacx=0.2, zoomfacy=0.2)
    yield
    screenshot("shoe_material")
    only("")
    editor.ui_type = "VIEW_3D"
    yield
    yield from render()
    screenshot("shoe_render")


# --------------------------------------------------------------------------------------- running

STEPS = {"glass": tutorial_glass, "pool": tutorial_pool, "shoe": tutorial_shoe}


def begin():
    """Lets the window come up before the first step."""
    yield
    enlarge_properties()
    yield
    yield from STEPS[PART]()
    yield
    write_shots()
    bpy.ops.wm.save_as_mainfile(filepath=str(SCENES / f"{PART}.blend"), compress=True)


class TutorialRun(bpy.types.Operator):
    """Takes a step at each tick."""

    bl_idname = "wm.tutorial_run"
    bl_label = "Tutorial"

    def invoke(self, context, event):
        self.story = begin()
        context.window_manager.event_timer_add(SECONDS_BETWEEN, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "TIMER" and not bpy.app.is_job_running("RENDER"):
            self.advance()
        return {"PASS_THROUGH"}

    def advance(self) -> None:
        try:
            next(self.story)
        except BaseException as error:
            code = 0 if isinstance(error, StopIteration) else 1
            if code:
                traceback.print_exc()
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)


def start() -> None:
    with bpy.context.temp_override(window=window()):
        bpy.ops.wm.tutorial_run("INVOKE_DEFAULT")


bpy.utils.unregister_class(SpeculaRenderEngine)
SpeculaRenderEngine.bl_use_preview = False  # while a preview is rendered nothing may be changed
bpy.utils.register_class(SpeculaRenderEngine)
bpy.context.preferences.view.show_splash = False
bpy.context.preferences.view.smooth_view = 0  # ms: screenshots would show the way
bpy.context.preferences.view.render_display_type = "AREA"  # a new window would hide the panels
bpy.utils.register_class(TutorialRun)
bpy.app.timers.register(start, first_interval=2.0)
