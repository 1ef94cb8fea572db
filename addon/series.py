# SPDX-License-Identifier: GPL-3.0-or-later
"""The states of a scene that is rendered again and again: in a viewport, or frame after frame."""

from __future__ import annotations

from . import native
from .export.cache import ExportCache
from .export.desc import CameraDesc
from .export.log import ExportLog
from .export.scene import export_scene
from .upload import Snapshot, camera_struct, snapshot


class Series:
    """Exports and builds of each state what the last one that was built did not have; free it with
    `close`."""

    def __init__(self):
        self._cache = ExportCache()
        self._last: Snapshot | None = None  # that was built
        self._next: Snapshot | None = None  # that is being built
        self.crypto_names: dict = {}  # of the last state, as SceneDesc has them

    def begin(self, depsgraph, log: ExportLog, view=None, threads: int = 0) -> CameraDesc:
        """Exports the state that `depsgraph` is in and begins to build it, in place of one that is
        being built; returns the camera that it has. `view` as for `export_scene`.

        To be called, without sessions, after each of the depsgraph's updates that says more than
        that the camera has moved. Raises ExportError or NativeError; the next call then begins
        anew.
        """
        try:
            if self._next is not None:
                self._next.cancel()
            scene_desc = export_scene(
                depsgraph, log, not native.reads_image_files(), view, self._cache
            )
            camera = scene_desc.camera
            self.crypto_names = scene_desc.crypto_names
            self.cancel()
            made = snapshot(scene_desc, log, self._last, threads)
            if made is self._last:
                made.scene.set("camera", camera_struct(camera))
            else:
                self._next = made
        except BaseException:
            self.close()
            raise
        return camera

    def built(self, milliseconds: int = 0) -> native.Scene | None:
        """The core's scene of the last state; None if it is not built within that time.

        It lasts until that of a later state is built, or until `close`: before these its sessions
        must be closed. Raises NativeError; the next state is then begun anew.
        """
        if self._next is not None:
            try:
                if not self._next.builds(milliseconds):
                    return None
            except BaseException:
                self.close()
                raise
            if self._last is not None:
                self._last.close()
            self._last, self._next = self._next, None
        return self._last.scene if self._last is not None else None

    @property
    def is_building(self) -> bool:
        return self._next is not None

    def cancel(self) -> None:
        """Gives up what is being built; the next state is begun from the last that was."""
        if self._next is not None:
            self._next.close()
            self._next = None

    def close(self) -> None:
        """Frees what is kept; a later state is built anew."""
        self.cancel()
        self._cache = ExportCache()
        if self._last is not None:
            self._last.close()
            self._last = None
