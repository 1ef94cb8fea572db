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
    """Exports and builds of each state what the one before did not have; free it with `close`."""

    def __init__(self):
        self._cache = ExportCache()
        self._last: Snapshot | None = None
        self.crypto_names: dict = {}  # of the last state, as SceneDesc has them

    def next(
        self, depsgraph, log: ExportLog, view=None, threads: int = 0
    ) -> tuple[native.Scene, CameraDesc]:
        """The core's scene of the state that `depsgraph` is in, and the camera that it has; `view`
        as for `export_scene`.

        It lasts until the next call, before which its sessions must be closed. To be called after
        each of the depsgraph's updates that says more than that the camera has moved. Raises
        ExportError or NativeError; the next call then begins anew.
        """
        before = self._last
        try:
            scene_desc = export_scene(
                depsgraph, log, not native.reads_image_files(), view, self._cache
            )
            camera = scene_desc.camera
            self.crypto_names = scene_desc.crypto_names
            self._last = snapshot(scene_desc, log, before, threads)
            if self._last is before:
                before.scene.set("camera", camera_struct(camera))
            elif before is not None:
                before.close()
        except BaseException:
            self.close()
            raise
        return self._last.scene, camera

    def close(self) -> None:
        """Frees what is kept; a later state is built anew."""
        self._cache = ExportCache()
        if self._last is not None:
            self._last.close()
            self._last = None
