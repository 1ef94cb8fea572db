# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in the environment of PyPI's bpy: enables the addon, then runs a script with its arguments.

usage: python3 tools/bpy_bootstrap.py SCRIPT ARGS...
"""

import os
import runpy
import sys
import traceback

import bpy  # noqa: F401  must come first: it makes addon_utils importable
from enable_addon import start


def run_script(script: str, arguments: list[str]) -> int:
    """Run `script` as Python would; returns the exit code."""
    sys.argv = [script, *arguments]
    sys.path[0] = os.path.dirname(os.path.abspath(script))
    try:
        runpy.run_path(script, run_name="__main__")
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return end.code or 0
        print(end.code, file=sys.stderr)
        return 1
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


if __name__ == "__main__":
    start()
    code = run_script(sys.argv[1], sys.argv[2:])
    sys.stdout.flush()
    sys.stderr.flush()
    # Not sys.exit: bpy may crash while the interpreter takes it down, and hide the code.
    os._exit(code & 0xFF)
