# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs pytest inside Blender, or beside bpy, and ends the process with pytest's exit code.

usage: blender --background --python-exit-code 1 --python tools/pytest_in_blender.py -- PYTEST_ARGS
       ./dev bpy tools/pytest_in_blender.py PYTEST_ARGS
"""

import os
import sys

import bpy
import pytest


def save_coverage() -> None:
    """What tools/cover_in_blender.py has counted, if `./dev coverage` had it run."""
    coverage = sys.modules.get("coverage")
    if coverage is not None and (measured := coverage.Coverage.current()) is not None:
        measured.stop()
        measured.save()


def main() -> None:
    """Never returns."""
    first = sys.argv.index("--") + 1 if "--" in sys.argv else 1
    print(f"pytest {pytest.__version__} in Blender {bpy.app.version_string}", flush=True)
    code = int(pytest.main(sys.argv[first:]))
    save_coverage()
    sys.stdout.flush()
    sys.stderr.flush()
    # Not sys.exit: Blender would first take itself down, and a crash there would hide the result.
    os._exit(code)


main()
