# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts what moves Blender's data about, such as an undo: what was kept of it before is void."""

from __future__ import annotations

import bpy

_number = 0


def number() -> int:
    """Of the epoch that lasts."""
    return _number


@bpy.app.handlers.persistent
def _begin(*_) -> None:
    global _number
    _number += 1


def _occasions() -> list:
    handlers = bpy.app.handlers
    return [handlers.load_post, handlers.undo_post, handlers.redo_post]


def register() -> None:
    for handlers in _occasions():
        handlers.append(_begin)


def unregister() -> None:
    for handlers in _occasions():
        handlers.remove(_begin)
