# SPDX-License-Identifier: GPL-3.0-or-later
"""Regenerate the example scenes, all or those named.

    blender --background --factory-startup --python blend_scenes/generate.py -- [--check] [NAME ...]

Run it with Blender 3.4, so that this and every later version opens the files. `--check` writes
nothing: it builds each scene, opens the stored file and exits with 1 if the two differ or the
stored one is incomplete.
"""

import argparse
import importlib
import os
import shutil
import sys
import tempfile
import traceback

import bpy

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, FOLDER)

from generators import SCENES, digest, stage  # noqa: E402

SIZE_LIMIT = 2 << 20  # bytes of a stored scene


def build(name):
    """Build one scene in memory."""
    importlib.import_module("generators." + name).build()
    stage.tidy_screens()
    bpy.context.view_layer.update()  # so that matrices are those of a loaded file


def stored_path(name):
    """Path of the stored scene."""
    return os.path.join(FOLDER, name + ".blend")


def save(name):
    """Save the scene in memory, compressed.

    It is saved in a temporary folder first, since a .blend records its own path.
    """
    bpy.context.preferences.filepaths.save_version = 0
    path = os.path.join(tempfile.gettempdir(), name + ".blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, compress=True)
    shutil.move(path, stored_path(name))
    size = os.path.getsize(stored_path(name))
    if size > SIZE_LIMIT:
        raise RuntimeError(f"{name}.blend has {size} bytes, more than {SIZE_LIMIT}")
    print(f"{name}.blend: {size / 1024:.0f} KiB")


def check(name):
    """Compare the stored scene with a fresh build; returns a list of differences."""
    build(name)
    fresh = digest.describe()
    bpy.ops.wm.open_mainfile(filepath=stored_path(name))
    differences = digest.missing_data() + digest.compare(fresh, digest.describe())
    print(f"{name}: {'differs' if differences else 'matches'}")
    for line in differences[:20]:
        print("  " + line)
    return differences


def main(arguments):
    """Entry point; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="generate.py", description="Regenerate the example scenes."
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(SCENES))
    parser.add_argument("--check", action="store_true", help="compare instead of write")
    options = parser.parse_args(arguments)
    names = options.names or SCENES
    for name in names:
        if name not in SCENES:
            parser.error(f"unknown scene '{name}' (choose from {', '.join(SCENES)})")
    if options.check:
        failures = [name for name in names if check(name)]
        return 1 if failures else 0
    for name in names:
        build(name)
        save(name)
    return 0


if __name__ == "__main__":
    try:
        code = main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    except Exception:  # Blender itself would print the error and exit with 0
        traceback.print_exc()
        code = 1
    sys.exit(code)
