# SPDX-License-Identifier: GPL-3.0-or-later
"""One view layer's final render: export, upload, commit, then poll until it is done."""

from __future__ import annotations

import time
from contextlib import contextmanager

from . import native, passes, statistics
from .abi import Method, RenderState
from .export.log import ExportLog
from .export.scene import export_scene
from .export.settings import export_settings, film_exposure, method_label
from .progress import progress_text
from .series import Series
from .upload import upload

POLL_MILLISECONDS = 100
SHOW_SECONDS = 1.0  # between partial results


def render_view_layer(engine, depsgraph) -> statistics.Statistics | None:
    """Renders `depsgraph`'s view layer into the engine's result; None if the user cancelled.

    Raises ExportError or NativeError, whose message names the object.
    """
    scene, view_layer = depsgraph.scene_eval, depsgraph.view_layer_eval
    settings = export_settings(scene, engine.is_preview, view_layer)
    stats = statistics.Statistics(
        scene.name,
        view_layer.name,
        native.version(),
        Method(settings.method).name,
        method_label(scene),
    )

    engine.update_stats("", "Specula: exporting")
    log = ExportLog()
    with _scene_of(engine, depsgraph, settings.threads, log, stats) as (native_scene, camera):
        stats.warnings = log.warnings
        if native_scene is None or engine.test_break():
            return None
        stats.scene_stats = native_scene.stats()
        stats.report = native_scene.report()
        with (
            Film(engine, view_layer, camera.crop, film_exposure(scene)) as film,
            native.Session(native_scene, settings) as session,
        ):
            completed = _poll(engine, session, settings, film)
            film.write(session)
            stats.samples_done = completed.samples_done
            stats.pixels = film.pixel_count
            stats.render_seconds = completed.seconds
            stats.render_stats = session.stats()
            stats.report += session.report()
            if stats.first_sample_seconds is None:
                stats.warnings.append(
                    "the time limit ended before every pixel had a sample; those without show a "
                    "coarse preview"
                )
    return None if completed.state == RenderState.CANCELLED else stats


@contextmanager
def _scene_of(engine, depsgraph, threads: int, log: ExportLog, stats: statistics.Statistics):
    """The core's committed scene, None if the user cancelled, and its camera.

    With *Persistent Data* it is of a series that the engine keeps, as Blender keeps the engine.
    """
    start = time.perf_counter()
    if depsgraph.scene_eval.render.use_persistent_data and not engine.is_preview:
        engine.series = engine.series or Series()
        scene_and_camera = engine.series.next(depsgraph, log, threads=threads)
        stats.export_seconds = time.perf_counter() - start
        yield scene_and_camera
        return
    scene_desc = export_scene(depsgraph, log, images_as_pixels=not native.reads_image_files())
    camera = scene_desc.camera
    with upload(scene_desc, log) as native_scene:
        stats.export_seconds = time.perf_counter() - start
        if engine.test_break():
            yield None, camera
            return
        engine.update_stats("", "Specula: building the scene")
        native_scene.commit(threads)
        yield native_scene, camera


def _poll(engine, session, settings, film: Film):
    """Shows progress until the render is over; passes on the user's wish to stop."""
    shown = time.monotonic()
    while True:
        progress = session.wait(POLL_MILLISECONDS)
        engine.update_progress(progress.fraction)
        if progress.state != RenderState.RUNNING:
            return progress
        if engine.test_break():
            session.cancel()
        if time.monotonic() - shown >= SHOW_SECONDS:
            samples = session.stats()["samples"] / film.pixel_count
            engine.update_stats(
                "", "Specula: " + progress_text(progress, samples, settings.samples)
            )
            film.show(session)
            shown = time.monotonic()


class Film:
    """Blender's render result for one view layer and the rendered part of the frame.

    Handed over at the end of its with-block, or given up if that fails.
    """

    def __init__(self, engine, view_layer, crop: tuple[int, int, int, int], exposure: float):
        self._engine = engine
        self._layer_name = view_layer.name
        self._size = crop[2:]
        self.pixel_count = crop[2] * crop[3]
        self._passes = passes.enabled(view_layer)
        self._exposure = exposure

    def __enter__(self) -> Film:
        # With a render border (0, 0) is the border's corner.
        self._result = self._engine.begin_result(0, 0, *self._size, layer=self._layer_name)
        return self

    def __exit__(self, error_type, *_) -> None:
        self._engine.end_result(self._result, cancel=error_type is not None)

    def show(self, session) -> None:
        """Shows Combined as it stands."""
        self._write(session, self._passes[:1])
        self._engine.update_result(self._result)

    def write(self, session) -> None:
        """Writes every pass as it stands."""
        self._write(session, self._passes)

    def _write(self, session, rows: list[passes.RenderPass]) -> None:
        passes.write(session, self._result.layers[0], rows, self._size, self._exposure)
