# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender: enables the addon and keeps it enabled, or ends the process.

`blender --addons specula` would go on without the addon and exit with 0 when it cannot be enabled.
"""

import os
import sys

import addon_utils
import bpy

MODULE = "specula"


def enable() -> None:
    """Enable the addon if it is not; without it there is nothing left to do in this Blender."""
    if addon_utils.check(MODULE)[1]:
        return
    # default_set makes the entry in the preferences that an addon's own preferences live in.
    if addon_utils.enable(MODULE, default_set=True, persistent=True) is None:
        print("dev: error: the addon could not be enabled, see above", file=sys.stderr)
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(1)


@bpy.app.handlers.persistent
def keep_enabled(*_: object) -> None:
    """After a load: read_factory_settings disables every addon, persistent or not."""
    enable()


def start() -> None:
    """Enable the addon for the whole session."""
    enable()
    bpy.app.handlers.load_post.append(keep_enabled)


if __name__ == "__main__":
    start()
