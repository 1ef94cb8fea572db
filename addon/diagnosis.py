# SPDX-License-Identifier: GPL-3.0-or-later
"""What keeps Specula from rendering here, and how an error is told to the user."""

from __future__ import annotations

import traceback


def installation_problem() -> str | None:
    """Why nothing can be rendered with this installation, or None."""
    try:
        import numpy  # noqa: F401

        from . import native

        native.library()
    except Exception as error:
        return describe(error)
    return None


def describe(error: Exception) -> str:
    """One line for the user."""
    if isinstance(error, ImportError) and error.name == "numpy":
        return "Blender's Python has no NumPy; on Debian install python3-numpy"
    if _is_expected(error):
        return str(error)
    return f"{type(error).__name__}: {error}"


def details(error: Exception) -> str:
    """The traceback of an error that its message does not explain, else ''."""
    if _is_expected(error) and error.__cause__ is None:
        return ""
    return "".join(traceback.format_exception(type(error), error, error.__traceback__))


def _is_expected(error: Exception) -> bool:
    """Errors that tell what is wrong with the scene or the installation.

    By name: their modules may be what cannot be imported.
    """
    return type(error).__name__ in ("ExportError", "NativeError")
