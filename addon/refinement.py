# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture that is there at once and gets better: the renders behind a rendered viewport.

Knows nothing of Blender. While the camera moves, one path-traced sample of a coarser picture is
taken from each place. Once it rests, finer ones follow; then path tracing shows the full picture
while the scene's method prepares, which takes over when it has a sample of each pixel.
"""

from __future__ import annotations

import dataclasses
import time

import numpy as np

from . import native
from .abi import Method, Pass, RenderProgress, RenderSettings, RenderState
from .denoising import Denoising, DenoisingTask
from .export.desc import CameraDesc
from .progress import progress_text
from .upload import camera_struct

COARSE_SECONDS = 0.05  # that one sample of the moving picture may take
REST_SECONDS = 0.15  # without a change, before the full picture begins
LEAST_COARSE, MOST_COARSE = 2.0, 16.0  # pixels along the edge of a coarse one
DENOISING_SHARE = 0.25  # of the time that may go to denoising, but for the last picture


@dataclasses.dataclass(frozen=True)
class Picture:
    """A part of a region as it stands."""

    pixels: np.ndarray  # (height, width, 4) float32, premultiplied, scene linear, bottom row first
    crop: tuple[int, int, int, int]  # of the region that it covers: x0, y0, width, height


class Refinement:
    """Renders of one committed scene at a time, from one place; `stop` ends them."""

    def __init__(self):
        self._scene: native.Scene | None = None
        self._settings: RenderSettings | None = None
        self._exposure = 1.0
        self._pass = Pass.COMBINED
        self._denoiser: _Denoiser | None = None
        self._noisy: Picture | None = None  # the latest of the full size
        self._is_paused = False
        self._camera: CameraDesc | None = None  # of the full picture
        self._shown = (0, 0, 0, 0)  # crop of the region that it covers
        self._render: _Render | None = None
        self._factor = 1  # pixels along the edge of one that is rendered
        self._fast_factor = 4.0  # with which a sample of the picture takes COARSE_SECONDS
        self._moved = 0.0  # when the camera did last, s

    def show(self, scene: native.Scene) -> None:
        """Takes another scene, which must live until `stop`; `look` begins to render it."""
        self.stop()
        self._scene = scene

    def look(
        self,
        camera: CameraDesc,
        settings: RenderSettings,
        exposure: float,
        shown: Pass = Pass.COMBINED,
        denoising: Denoising | None = None,
        pixel_size: int = 1,
    ) -> None:
        """Begins anew from there; what was under way is cancelled. `settings.samples` is how far
        the picture gets, `exposure` a factor on it, `shown` the pass that it is, `denoising` how
        that is denoised, `pixel_size` how many pixels of the region one of it covers, each way."""
        guides = denoising.guides if denoising else ()
        settings = native.changed(
            settings,
            passes=sum(1 << source for source in (shown, *guides)),
            for_denoiser=denoising is not None,
        )
        self._camera = coarser(camera, pixel_size) if pixel_size > 1 else camera
        self._shown = camera.crop
        self._settings, self._exposure = settings, exposure
        self._pass = shown
        self._forget_denoiser()
        self._denoiser = _Denoiser(denoising) if denoising else None
        self._moved = time.monotonic()
        self._begin(max(1, round(self._fast_factor)))

    def picture(self) -> Picture | None:
        """What there is to show, None if that is no more than before; begins what comes next.

        Raises NativeError if a render failed.
        """
        if self._render is None:
            return None
        picture = self._render.picture(self._pass)
        if picture is not None and self._pass != Pass.NORMAL:
            picture.pixels[:, :, :3] *= self._exposure
        if self._denoiser is not None and self._factor == 1:
            picture = self._denoised(picture)
        if self._factor > 1 and self._render.ended:
            slower = np.sqrt(max(self._render.seconds, 1e-4) / COARSE_SECONDS)
            self._fast_factor = float(np.clip(self._factor * slower, LEAST_COARSE, MOST_COARSE))
            if time.monotonic() - self._moved > REST_SECONDS:
                self._begin(self._factor // 2)
        return picture

    @property
    def is_final(self) -> bool:
        """Whether nothing better will come."""
        if self._render is None or self._factor > 1 or not self._render.ended:
            return False
        return self._denoiser is None or self._denoiser.is_done_with(self._noisy)

    def report(self) -> list[str]:
        """What the core says of the scene, and what the method has chosen so far."""
        if self._render is None:
            return []
        return [*self._scene.report(), *self._render.report()]

    def pause(self, paused: bool) -> None:
        """Holds the samples of the full picture back, or lets them go on."""
        self._is_paused = paused
        if self._render is not None and self._factor == 1:
            self._render.pause(paused)

    def progress(self) -> str:
        """Such as "sample 12.3/256 | 0:05, 0:21 left"; empty while a coarse picture is shown."""
        if self._render is None or self._factor > 1 or self._render.progress is None:
            return ""
        return progress_text(self._render.progress, self._render.samples, self._settings.samples)

    def stop(self) -> None:
        """Ends what is under way."""
        if self._render is not None:
            self._render.close()
            self._render = None
        self._forget_denoiser()

    def _denoised(self, picture: Picture | None) -> Picture | None:
        """What there is to show, given what is new before denoising."""
        self._noisy = picture or self._noisy
        denoiser = self._denoiser
        ended, first = self._render.ended, denoiser.denoising.first_sample
        if self._noisy is None or (self._render.shown_samples < first and not ended):
            return picture
        if denoiser.wants(self._noisy, ended):
            denoiser.begin(self._noisy, self._render.read)
        return denoiser.picture()

    def _forget_denoiser(self) -> None:
        if self._denoiser is not None:
            self._denoiser.close()
        self._denoiser = self._noisy = None

    def _begin(self, factor: int) -> None:
        if self._render is not None:
            self._render.close()
        self._factor = factor
        quick = self._settings
        if self._pass != Pass.CAUSTICS:  # of which path tracing tells nothing
            quick = native.changed(quick, method=Method.PT)
        if factor > 1:
            wanted = [native.changed(quick, samples=1)]
        elif quick.method == self._settings.method:
            wanted = [quick]
        else:
            wanted = [quick, self._settings]
        camera = coarser(self._camera, factor) if factor > 1 else self._camera
        self._render = _Render(self._scene, camera, self._shown, wanted)
        self.pause(self._is_paused)


class _Render:
    """Sessions of one camera: of path tracing alone, or until the method has a sample, too."""

    def __init__(self, scene, camera: CameraDesc, shown: tuple, wanted: list):
        self._crop, self._shown = camera.crop, shown
        self.seconds, self.ended = 0.0, False
        self.samples = self.shown_samples = 0.0  # of the method, and of the last picture
        self.progress: RenderProgress | None = None  # of the method, at the last look
        self._read = (-1, 0.0)  # sessions and samples of the last picture
        self._sessions: list[native.Session] = []
        self._whole: list[tuple[native.Session, int]] = []  # those in the last picture
        scene.set("camera", camera_struct(camera))
        try:
            for settings in wanted:
                self._sessions.append(native.Session(scene, settings))
        except BaseException:
            self.close()
            raise

    def picture(self, wanted: Pass) -> Picture | None:
        """A pass as it stands; None until each pixel has a sample."""
        progress = self.progress = self._sessions[-1].wait(0)
        self.seconds = progress.seconds
        self.ended = progress.state != RenderState.RUNNING
        stats = [session.stats() for session in self._sessions]
        pixels = self._crop[2] * self._crop[3]
        self.samples = stats[-1]["samples"] / pixels
        if len(stats) == 2 and stats[1]["first_sample_seconds"] > 0.0:
            self._sessions[0].cancel()
            if self.ended or stats[1]["samples"] >= stats[0]["samples"]:
                # Path tracing does not find all light: it has served its turn.
                self._sessions.pop(0).close()
                stats.pop(0)
        self._whole = [
            (session, of["samples"])
            for session, of in zip(self._sessions, stats, strict=True)
            if of["first_sample_seconds"] > 0.0 and of["samples"] > 0  # not all at one moment
        ]
        total = sum(samples for _, samples in self._whole)
        if not self._whole or (len(self._whole), total) == self._read:
            return None
        self._read = (len(self._whole), total)
        self.shown_samples = total / pixels
        blend = self.read(wanted)
        if blend.shape[2] == 3:
            blend = np.dstack([blend, np.ones(blend.shape[:2], np.float32)])
        return Picture(blend, self._shown)

    def read(self, wanted: Pass) -> np.ndarray:
        """A pass (H, W, C), each session's by its samples at the last picture."""
        total = sum(samples for _, samples in self._whole)
        blend = sum(
            np.float32(samples / total) * session.read(wanted, *self._crop[2:])
            for session, samples in self._whole
        )
        return blend.reshape(self._crop[3], self._crop[2], -1)

    def report(self) -> list[str]:
        return self._sessions[-1].report()

    def pause(self, paused: bool) -> None:
        for session in self._sessions:
            session.pause(paused)

    def close(self) -> None:
        for session in self._sessions:
            session.close()
        self._sessions = []


class _Denoiser:
    """Denoises one picture after the other while it is rendered."""

    def __init__(self, denoising: Denoising):
        self.denoising = denoising
        self._source: Picture | None = None  # of what is under way, or else of the last result
        self._task: DenoisingTask | None = None
        self._begun = 0.0  # s
        self._next = 0.0  # when another may begin, s

    def wants(self, picture: Picture, is_last: bool) -> bool:
        """Whether `picture` is to be begun now."""
        if self._task is not None or picture is self._source:
            return False
        return is_last or time.monotonic() >= self._next

    def begin(self, picture: Picture, read) -> None:
        """`read` gives the guides. Raises DenoisingError."""
        self._source, self._begun = picture, time.monotonic()
        self._task = self.denoising.begin(picture.pixels, read)

    def picture(self) -> Picture | None:
        """The latest result, once. Raises DenoisingError."""
        pixels = self._task.result() if self._task is not None else None
        if pixels is None:
            return None
        self._task = None
        now = time.monotonic()
        self._next = now + (now - self._begun) * (1.0 / DENOISING_SHARE - 1.0)
        return Picture(pixels, self._source.crop)

    def is_done_with(self, picture: Picture | None) -> bool:
        return self._task is None and picture is self._source

    def close(self) -> None:
        if self._task is not None:
            self._task.close()


def coarser(camera: CameraDesc, factor: int) -> CameraDesc:
    """The crop of `camera` as a whole frame of pixels `factor` times as large."""
    x0, y0, width, height = camera.crop
    left, right, bottom, top = camera.viewplane
    across, up = (right - left) / camera.width, (top - bottom) / camera.height
    fewer = (max(1, -(-width // factor)), max(1, -(-height // factor)))
    return dataclasses.replace(
        camera,
        width=fewer[0],
        height=fewer[1],
        crop=(0, 0, *fewer),
        viewplane=(
            left + across * x0,
            left + across * (x0 + width),
            bottom + up * y0,
            bottom + up * (y0 + height),
        ),
    )
