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
from .export.desc import CameraDesc
from .progress import progress_text
from .upload import camera_struct

COARSE_SECONDS = 0.05  # that one sample of the moving picture may take
REST_SECONDS = 0.15  # without a change, before the full picture begins
LEAST_COARSE, MOST_COARSE = 2.0, 16.0  # pixels along the edge of a coarse one


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
        self._camera: CameraDesc | None = None
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
    ) -> None:
        """Begins anew from there; what was under way is cancelled. `settings.samples` is how far
        the picture gets, `exposure` a factor on it, `shown` the pass that it is."""
        settings = native.changed(settings, passes=1 << shown)
        self._camera, self._settings, self._exposure = camera, settings, exposure
        self._pass = shown
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
        if self._factor > 1 and self._render.ended:
            slower = np.sqrt(max(self._render.seconds, 1e-4) / COARSE_SECONDS)
            self._fast_factor = float(np.clip(self._factor * slower, LEAST_COARSE, MOST_COARSE))
            if time.monotonic() - self._moved > REST_SECONDS:
                self._begin(self._factor // 2)
        return picture

    @property
    def is_final(self) -> bool:
        """Whether nothing better will come."""
        return self._render is not None and self._factor == 1 and self._render.ended

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

    def _begin(self, factor: int) -> None:
        self.stop()
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
        self._render = _Render(self._scene, camera, self._camera.crop, wanted)


class _Render:
    """Sessions of one camera: of path tracing alone, or until the method has a sample, too."""

    def __init__(self, scene, camera: CameraDesc, shown: tuple, wanted: list):
        self._crop, self._shown = camera.crop, shown
        self.seconds, self.samples, self.ended = 0.0, 0.0, False
        self.progress: RenderProgress | None = None  # of the method, at the last look
        self._read = (-1, 0.0)  # sessions and samples of the last picture
        self._sessions: list[native.Session] = []
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
        whole = [
            (session, of["samples"])
            for session, of in zip(self._sessions, stats, strict=True)
            if of["first_sample_seconds"] > 0.0 and of["samples"] > 0  # not all at one moment
        ]
        total = sum(samples for _, samples in whole)
        if not whole or (len(whole), total) == self._read:
            return None
        self._read = (len(whole), total)
        blend = sum(
            np.float32(samples / total) * session.read(wanted, *self._crop[2:])
            for session, samples in whole
        )
        if blend.shape[1] == 3:
            blend = np.column_stack([blend, np.ones(len(blend), np.float32)])
        return Picture(blend.reshape(self._crop[3], self._crop[2], 4), self._shown)

    def close(self) -> None:
        for session in self._sessions:
            session.close()
        self._sessions = []


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
