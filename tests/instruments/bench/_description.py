# SPDX-License-Identifier: GPL-3.0-or-later
"""The addon's scene descriptions and the core's enumerations in a Python without Blender."""

from __future__ import annotations

import pickle
import sys
import types
from importlib import import_module
from pathlib import Path

ADDON = Path(__file__).resolve().parents[3] / "addon"


def _description_module() -> types.ModuleType:
    """`specula.export.desc`, without running the packages around it, which import bpy."""
    for name, folder in (("specula", ADDON), ("specula.export", ADDON / "export")):
        if name not in sys.modules:
            package = types.ModuleType(name)
            package.__path__ = [str(folder)]
            sys.modules[name] = package
    return import_module("specula.export.desc")


desc = _description_module()
abi = import_module("specula.abi")


def load(path: str | Path):
    """The `SceneDesc` that _export_job.py has written."""
    with open(path, "rb") as file:
        return pickle.load(file)
