# SPDX-License-Identifier: GPL-3.0-or-later
"""The addon's modules that need no Blender, as the package `specula`."""

import sys
import types
from pathlib import Path

ADDON = Path(__file__).parents[2] / "addon"

if "specula" not in sys.modules:
    package = types.ModuleType("specula")
    package.__path__ = [str(ADDON)]
    sys.modules["specula"] = package
sys.path.insert(0, str(Path(__file__).parent))
