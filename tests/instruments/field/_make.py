# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender 3.4: writes the made-up scenes into the folder that is the last argument."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy

from tests.instruments.field import _scenes_materials, _scenes_rooms, _scenes_shapes  # noqa: F401
from tests.instruments.field._stage import SCENES, fresh


def main(folder: Path) -> None:
    bpy.context.preferences.filepaths.save_version = 0
    for number, (name, build) in enumerate(SCENES.items(), 1):
        print(f"{number}/{len(SCENES)} {name}", flush=True)
        fresh(name)
        build()
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{name}.blend"), compress=True)


if __name__ == "__main__":
    main(Path(sys.argv[-1]))
    sys.stdout.flush()
    os._exit(0)
