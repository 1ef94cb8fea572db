# SPDX-License-Identifier: GPL-3.0-or-later
"""One view layer's final render: export, upload, commit, then poll until it is done."""

from __future__ import annotations

import time
from contextlib import contextmanager
from dataclasses import dataclass, replace

from . import cryptomatte, divided, native, passes, statistics
from .abi import Method, RenderState
from .denoising_settings import denoising_of
from .export.desc import CameraDesc
from .export.log import ExportLog
from .export.scene import export_scene
from .export.settings import export_settings, film_exposure, method_label
from .parts import PartError
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
    log = ExportLog()
    order = None if engine.is_preview else divided.order()
    # Parts are as they were rendered; what is left to denoise is their sum.
    is_final = not (engine.is_preview or order)
    denoise = denoising_of(scene, view_layer, log) if is_final else None
    settings = export_settings(scene, engine.is_preview, view_layer, denoises=denoise is not None)
    stats = statistics.Statistics(
        scene.name,
        view_layer.name,
        native.version(),
        Method(settings.method).name,
        method_label(scene),
    )

    engine.update_stats("", "Specula: exporting")
    passes.warn_of_missing(view_layer, log)
    with _scene_of(engine, depsgraph, settings, log, stats, order) as prepared:
        native_scene, camera, part = prepared.scene, prepared.camera, prepared.part
        if part and settings.samples == 0:
            with Film(engine, scene, view_layer, camera.crop) as film:
                film.write(part.before)
            return None
        stats.warnings = log.warnings
        if native_scene is None or engine.test_break():
            return None
        stats.scene_stats = native_scene.stats()
        stats.report = native_scene.report()
        with (
            Film(engine, scene, view_layer, camera.crop, denoise) as film,
            native.Session(native_scene, settings) as session,
        ):
            completed = _poll(engine, session, settings, film, part, log)
            ended = completed.state == RenderState.DONE
            film.write(part.keep(session) if part and ended else session)
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


@dataclass
class Prepared:
    """What a render of a view layer begins with."""

    scene: native.Scene | None  # committed; None if the user cancelled, or if nothing is left to do
    camera: CameraDesc
    part: divided.DividedRender | None = None


@contextmanager
def _scene_of(engine, depsgraph, settings, log: ExportLog, stats: statistics.Statistics, order):
    """Yields Prepared. `order`: of a part, to whose samples `settings` are changed, or None.

    With *Persistent Data* the scene is of a series that the engine keeps, as Blender keeps the
    engine.
    """
    start = time.perf_counter()
    scene, view_layer = depsgraph.scene_eval, depsgraph.view_layer_eval
    if scene.render.use_persistent_data and not (engine.is_preview or order):
        engine.series = engine.series or Series()
        series = engine.series
        camera = series.begin(depsgraph, log, threads=settings.threads)
        stats.metadata = cryptomatte.metadata(view_layer.name, series.crypto_names)
        stats.export_seconds = time.perf_counter() - start
        if _builds(engine, series.built):
            yield Prepared(series.built(), camera)
        else:
            series.cancel()
            yield Prepared(None, camera)
        return
    scene_desc = export_scene(depsgraph, log, images_as_pixels=not native.reads_image_files())
    camera = scene_desc.camera
    stats.metadata = cryptomatte.metadata(view_layer.name, scene_desc.crypto_names)
    part = _begin_part(order, scene, view_layer, scene_desc, settings, log) if order else None
    if part and settings.samples == 0:
        yield Prepared(None, camera, part)
        return
    with upload(scene_desc, log) as native_scene:
        stats.export_seconds = time.perf_counter() - start
        native_scene.begin_commit(settings.threads)
        is_built = _builds(engine, native_scene.ends_commit)
        yield Prepared(native_scene if is_built else None, camera, part)


def _builds(engine, ended) -> bool:
    """Whether the scene is built, of which `ended` tells whether it is within some milliseconds;
    False if the user cancelled."""
    engine.update_stats("", "Specula: building the scene")
    while not engine.test_break():
        if ended(POLL_MILLISECONDS):
            return True
    return False


def _begin_part(order, scene, view_layer, scene_desc, settings, log) -> divided.DividedRender:
    """Changes `settings` to the samples that are still to be taken. Raises PartError."""
    if settings.time_limit > 0.0:
        log.warn("scene", "a part of a render has no time limit, it takes all of its samples")
        settings.time_limit = 0.0
    rows = passes.enabled(scene, view_layer)
    header = divided.header_of(scene_desc, settings, rows, view_layer, film_exposure(scene))
    path = order.path_of(scene.frame_current, view_layer.name)
    part = divided.DividedRender(order, path, header)
    part.limit(settings)
    return part


def _poll(engine, session, settings, film: Film, part, log):
    """Shows progress until the render is over; passes on the user's wish to stop.

    Keeps a part's sums from time to time; where that fails, the file is as before, and `log` is
    told.
    """
    shown = time.monotonic()
    while True:
        progress = session.wait(POLL_MILLISECONDS)
        engine.update_progress(progress.fraction)
        if progress.state != RenderState.RUNNING:
            return progress
        if engine.test_break():
            session.cancel()
        if part and part.is_due():
            try:
                part.keep(session)
            except (PartError, native.NativeError) as error:
                log.warn("part", f"not kept for now: {error}")
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

    def __init__(self, engine, scene, view_layer, crop: tuple[int, int, int, int], denoise=None):
        self._engine = engine
        self._layer_name = view_layer.name
        self._size = crop[2:]
        self.pixel_count = crop[2] * crop[3]
        self._passes = passes.enabled(scene, view_layer)
        self._exposure = film_exposure(scene)
        self._denoise = denoise

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
        """Writes every pass as it stands, Combined denoised if the scene asks for that."""
        combined, *others = self._passes
        if self._denoise:
            self._engine.update_stats("", "Specula: denoising")
            combined = replace(combined, read=self._denoise)
        self._write(session, [combined, *others])

    def _write(self, session, rows: list[passes.RenderPass]) -> None:
        passes.write(session, self._result.layers[0], rows, self._size, self._exposure)
