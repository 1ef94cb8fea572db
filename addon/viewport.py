# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered viewport: what Blender tells of changes goes to a `Refinement`, whose pictures it
draws."""

from __future__ import annotations

import weakref
from contextlib import contextmanager

import blf
import bpy
import gpu
from gpu_extras.presets import draw_texture_2d

from . import diagnosis, native
from .abi import Pass
from .denoising import Denoising, DenoisingError
from .denoising_settings import viewport_denoising
from .export import compat
from .export.log import ExportLog
from .export.settings import film_exposure, viewport_settings
from .export.view import export_view, is_shown
from .refinement import Picture, Refinement
from .series import Series

BACKGROUND = (0.04, 0.04, 0.04, 1.0)  # linear
TEXT_COLOR = (0.9, 0.9, 0.9, 1.0)
TEXT_SIZE = 14  # points
MARGIN = 60  # pixels between text and lower edge: clear of the scene's usual middle
FONT = 0  # Blender's default

FAST_TICK, SLOW_TICK = 0.03, 0.25  # s between looks at a picture that is new, and an old one
NEW_TICKS = 60


def draw_note(region, text: str) -> None:
    """Clears `region` (bpy.types.Region) to grey and writes `text` at its lower edge."""
    gpu.state.active_framebuffer_get().clear(color=BACKGROUND)
    blf.size(FONT, TEXT_SIZE)
    blf.color(FONT, *TEXT_COLOR)
    width, _ = blf.dimensions(FONT, text)
    blf.position(FONT, (region.width - width) / 2, MARGIN, 0)
    blf.draw(FONT, text)


_alive: weakref.WeakSet[Viewport] = weakref.WeakSet()


def live_report(scene, name: str) -> list[str]:
    """What a viewport that shows `scene` has found of the object of that name, for the panels."""
    lines = [line for view in _alive if view.shows(scene) for line in view.report()]
    own = [line.removeprefix(f"{name}: ") for line in lines if line.startswith(f"{name}: ")]
    return list(dict.fromkeys(own))


class Viewport:
    """What one 3D view in rendered mode shows; its engine keeps it until the mode is left.

    Scenes are exported here, and built by a thread of the core meanwhile.
    """

    def __init__(self, engine):
        self._engine = weakref.ref(engine)
        self._series = Series()
        self._refinement: Refinement | None = None
        self._awaits_scene = False  # that is being built; until then the picture before it stays
        self._problem: str | None = None
        self._warnings: list[str] = []  # of the scene as it is
        self._not_denoised = ""  # why, if it should be
        self._is_paused = False
        self._shown = None  # `shown` of the scene that is rendered
        self._seen = None  # `seen` of the picture under way
        self._picture: Picture | None = None
        self._texture = None
        self._ticks = 0
        self._timer = None
        _alive.add(self)

    def shows(self, scene) -> bool:
        """Whether it renders `scene` now."""
        return self._refinement is not None and self._shown[0] == scene.name

    def report(self) -> list[str]:
        return self._refinement.report()

    def update(self, context, depsgraph) -> None:
        """Takes over the scene as it is now, if it has changed."""
        shown_now = shown(context, depsgraph)
        if self._refinement and shown_now == self._shown:
            changes = {kind_of(update) for update in depsgraph.updates}
            if changes and changes <= {"CAMERA", "NOTHING"}:
                self._seen = None if "CAMERA" in changes else self._seen
                return
        with self._problems_noted():
            refinement = self._refinement or Refinement()
            refinement.stop()
            log = ExportLog()
            self._series.begin(depsgraph, log, view=context)
            self._awaits_scene = True
            self._refinement = refinement
            self._tell(log.warnings)
        self._shown, self._seen = shown_now, None
        self._tick_soon()

    def draw(self, context, depsgraph) -> None:
        """Draws the best picture there is of what the view shows, or a note of what is wrong."""
        with self._problems_noted():
            self._look(context, depsgraph)
        if self._problem or self._refinement is None:
            draw_note(context.region, self._problem or "")
            return
        if self._texture is not None:
            gpu.state.blend_set("ALPHA_PREMULT")
            x0, y0, width, height = self._picture.crop
            draw_texture_2d(self._texture, (x0, y0), width, height)
            gpu.state.blend_set("NONE")
        self._engine().update_stats("", self._status())

    def close(self) -> None:
        """Ends what runs. The picture may stay longer than its owner."""
        if self._timer is not None and bpy.app.timers.is_registered(self._timer):
            bpy.app.timers.unregister(self._timer)
        self._close_refinement()

    def _look(self, context, depsgraph) -> None:
        scene, refinement = context.scene, self._refinement
        if refinement is None:
            return
        if is_paused(scene) != self._is_paused:
            self._is_paused = not self._is_paused
            refinement.pause(self._is_paused)
            self._tick_soon()
        if self._is_paused:  # what changes meanwhile is taken over afterwards
            return
        if self._awaits_scene:
            built = self._series.built()
            if built is None:
                return
            self._awaits_scene = False
            refinement.show(built)
        settings = viewport_settings(scene, context.view_layer)
        shown_pass = Pass[context.space_data.shading.specula.render_pass]
        wanted = (
            film_exposure(scene),
            shown_pass,
            self._denoising(scene) if shown_pass == Pass.COMBINED else None,
            int(self._engine().get_preview_pixel_size(scene)),
        )
        seen_now = (seen(context), native.struct_fields(settings), wanted)
        if seen_now != self._seen:
            self._seen = seen_now
            refinement.look(export_view(context, depsgraph), settings, *wanted)
            self._tick_soon()
        picture = refinement.picture()
        if picture is not None:
            self._picture, self._texture = picture, texture_of(picture)

    def _denoising(self, scene) -> Denoising | None:
        self._not_denoised = ""
        try:
            return viewport_denoising(scene)
        except DenoisingError as error:
            self._not_denoised = f"not denoised: {error}"
            return None

    def _tell(self, warnings: list[str]) -> None:
        """Prints those that are new."""
        for warning in warnings:
            if warning not in self._warnings:
                print(f"Specula: {warning}", flush=True)
        self._warnings = warnings

    def _status(self) -> str:
        """A line for the view's header."""
        count = len(self._warnings)
        parts = (
            "paused" if self._is_paused else "",
            "building the scene" if self._series.is_building else self._refinement.progress(),
            self._not_denoised,
            f"{count} warning{'s' if count > 1 else ''}, see the console" if count else "",
        )
        return " | ".join(part for part in parts if part)

    @contextmanager
    def _problems_noted(self):
        """The view tells of a failure until the scene changes."""
        try:
            yield
            self._problem = self._problem if self._refinement is None else None
        except Exception as error:
            self._close_refinement()
            self._problem = f"Specula: {diagnosis.describe(error)}"
            print(diagnosis.details(error), end="", flush=True)

    def _close_refinement(self) -> None:
        if self._refinement is not None:
            self._refinement.stop()
            self._refinement = None
        self._series.close()

    def _tick_soon(self) -> None:
        self._ticks = 0
        if self._timer is None or not bpy.app.timers.is_registered(self._timer):
            self._timer = ticker(weakref.ref(self))
            bpy.app.timers.register(self._timer, first_interval=FAST_TICK)

    def tick(self) -> float | None:
        """Asks for a redraw, which notices the end of a pause, too; returns seconds until the next,
        None at the end."""
        engine = self._engine()
        if engine is None or self._refinement is None:
            return None
        engine.tag_redraw()
        if self._refinement.is_final:
            return None
        self._ticks += 1
        return FAST_TICK if self._ticks < NEW_TICKS else SLOW_TICK


def kind_of(update) -> str:
    """What a depsgraph update says of the picture: NOTHING (such as a selection), CAMERA, SCENE."""
    if isinstance(update.id, bpy.types.Scene) and not (
        update.is_updated_geometry or update.is_updated_transform or update.is_updated_shading
    ):
        return "NOTHING"  # what a scene's own settings change is seen in `shown` and `seen`
    is_camera = isinstance(update.id, bpy.types.Camera) or (
        isinstance(update.id, bpy.types.Object) and update.id.type == "CAMERA"
    )
    return "CAMERA" if is_camera else "SCENE"


def shown(context, depsgraph) -> tuple:
    """What is visible, to compare with: hiding an object looks to Blender like selecting it."""
    scene, layer, space = context.scene, context.view_layer, context.space_data
    objects = tuple(
        instance.object.name for instance in depsgraph.object_instances if is_shown(instance, space)
    )
    override = layer.material_override
    return (
        scene.name,
        scene.frame_current,
        scene.world.name if scene.world else None,
        layer.name,
        override.name if override else None,
        objects,
    )


def is_paused(scene) -> bool:
    """Whether the pause button, which is Cycles' own, is pressed."""
    return bool(compat.cycles_value(scene, "preview_pause", False))


def ticker(viewport: weakref.ref):
    """A timer that does not keep its viewport alive."""

    def tick():
        alive = viewport()
        return alive.tick() if alive else None

    return tick


def seen(context) -> tuple:
    """What the camera of a 3D view follows from, to compare with."""
    region, space, view = context.region, context.space_data, context.region_data
    render = context.scene.render
    borders = [
        tuple(getattr(owner, prefix + name) for name in ("min_x", "min_y", "max_x", "max_y"))
        for owner, prefix in ((space, "render_border_"), (render, "border_"))
    ]
    return (
        region.width,
        region.height,
        view.view_perspective,
        *(tuple(row) for row in view.window_matrix),
        *(tuple(row) for row in view.view_matrix),
        space.clip_start,
        space.clip_end,
        space.use_render_border,
        render.use_border,
        *borders,
    )


def texture_of(picture: Picture):
    """For the graphics card."""
    height, width, _ = picture.pixels.shape
    data = gpu.types.Buffer("FLOAT", picture.pixels.size, picture.pixels.ravel())
    return gpu.types.GPUTexture((width, height), format="RGBA16F", data=data)
