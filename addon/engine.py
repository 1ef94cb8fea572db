# SPDX-License-Identifier: GPL-3.0-or-later
"""Specula as Blender sees it: callbacks, none of which fails in silence."""

from contextlib import contextmanager

import bpy

from . import diagnosis, passes, statistics, ui


class SpeculaRenderEngine(bpy.types.RenderEngine):
    """What Blender calls; the work is done in `rendering` and `viewport`."""

    bl_idname = "SPECULA"
    bl_label = "Specula"
    bl_use_preview = True
    bl_use_postprocess = True
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False  # True hides Cycles' nodes

    _viewport = None  # once Blender asks for one
    series = None  # of final renders with Persistent Data, once there is one

    # -------------------------------------------------------------------------- final render

    def update_render_passes(self, scene=None, view_layer=None):
        with self.failures_reported():
            passes.register_passes(self, scene, view_layer)

    def render(self, depsgraph):
        """Renders one view layer; Blender calls this for each."""
        with self.failures_reported():
            # Not above: without NumPy the addon still registers, and this says what is missing.
            from .rendering import render_view_layer

            stats = render_view_layer(self, depsgraph)
            if stats and not self.is_preview:
                self._publish(stats, several_layers=len(depsgraph.scene.view_layers) > 1)

    def _publish(self, stats: statistics.Statistics, several_layers: bool) -> None:
        for warning in stats.warnings:
            self.report({"WARNING"}, f"Specula: {warning}")
        print(stats.block(), flush=True)
        prefix = statistics.STAMP_PREFIX + (f"{stats.view_layer}." if several_layers else "")
        result = self.get_result()
        for key, value in (stats.stamp(prefix) | stats.metadata).items():
            result.stamp_data_add_field(key, value)
        statistics.last[stats.scene, stats.view_layer] = stats
        if not bpy.app.background:
            # Not here: this thread renders, windows belong to the main one, which runs timers.
            bpy.app.timers.register(ui.redraw_properties)

    @contextmanager
    def failures_reported(self):
        """Turns an exception into Blender's error: a message, and exit code 1 for `-f`.

        For every callback. (Not a decorator: Blender counts a callback's arguments.)
        """
        try:
            yield
        except Exception as error:
            print(diagnosis.details(error), end="", flush=True)
            message = f"Specula: {diagnosis.describe(error)}"
            self.report({"ERROR"}, message)
            self.error_set(message)

    # ------------------------------------------------------------------------------ viewport

    def view_update(self, context, depsgraph):
        """Called when rendered mode begins, and whenever something in the scene has changed."""
        with self.failures_reported():
            self._viewport_of().update(context, depsgraph)

    def view_draw(self, context, depsgraph):
        """Called for each redraw of the view."""
        with self.failures_reported():
            self._viewport_of().draw(context, depsgraph)

    def _viewport_of(self):
        if self._viewport is None:
            # Not above: without NumPy the addon still registers, and this says what is missing.
            from .viewport import Viewport

            self._viewport = Viewport(self)
        return self._viewport

    def __del__(self):
        if self._viewport is not None:
            self._viewport.close()
            self._viewport = None
        if self.series is not None:
            self.series.close()
            self.series = None


@bpy.app.handlers.persistent
def forget_statistics(*_) -> None:
    """After a load: scenes of another file may have the same names."""
    statistics.last.clear()


def register() -> None:
    bpy.utils.register_class(SpeculaRenderEngine)
    bpy.app.handlers.load_post.append(forget_statistics)


def unregister() -> None:
    bpy.app.handlers.load_post.remove(forget_statistics)
    bpy.utils.unregister_class(SpeculaRenderEngine)
