# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender 3.4: writes made-up scenes into a folder. Arguments after `--`: the folder,
and the names of scenes unless it shall be all."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy

from tests.instruments.field import (  # noqa: F401
    _scenes_large,
    _scenes_materials,
    _scenes_nodes,
    _scenes_rooms,
    _scenes_shapes,
)
from tests.instruments.field._stage import SCENES, fresh


def main(folder: Path, names: list[str]) -> None:
    bpy.context.preferences.filepaths.save_version = 0
    for number, name in enumerate(names, 1):
        print(f"{number}/{len(names)} {name}", flush=True)
        fresh(name)
        SCENES[name]()
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{name}.blend"), compress=True)


if __name__ == "__main__":
    folder, *names = sys.argv[sys.argv.index("--") + 1 :]
    main(Path(folder), names or list(SCENES))
    sys.stdout.flush()
    os._exit(0)
