# SPDX-License-Identifier: GPL-3.0-or-later
"""Virtual environments with pinned Python packages, cached outside the checkout."""

from __future__ import annotations

import hashlib
import os
import shutil
from pathlib import Path

from tools.common import CACHE, PYTHON, ROOT, DevError, locked, run, say

REQUIREMENTS = ROOT / "tools" / "requirements"
STAMP = "specula-complete"
BPY_VERSION = "5.0.1"
BPY_LTS_VERSION = "4.5.15"
# The same as Debian's, so that tests/blender meets one pytest in both Blenders.
PYTEST = "pytest==7.2.1"


def ensure(name: str, requirements: str) -> Path:
    """Python of the environment `name` with these requirements (pip's format), made if need be.

    A stamp with the requirements' hash is written last: an interrupted or outdated environment is
    made anew.
    """
    folder = CACHE / name
    python = folder / "bin" / "python3"
    stamp = folder / STAMP
    digest = hashlib.sha256(requirements.encode()).hexdigest()

    def complete() -> bool:
        return python.exists() and stamp.exists() and stamp.read_text() == digest

    if complete():
        return python
    with locked(CACHE / f"{name}.lock"):
        if complete():  # another ./dev made it while we waited
            return python
        say(f"making the virtual environment {folder} (once)")
        if folder.exists():
            shutil.rmtree(folder)
        run([PYTHON, "-m", "venv", folder], "python3 -m venv", quiet=True)
        listed = folder / "requirements.txt"
        listed.write_text(requirements)
        # A PYTHONPATH or a user's site-packages must not make pip believe that all is there.
        env = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        env["PYTHONNOUSERSITE"] = "1"
        pip = [
            python,
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "-r",
            listed,
        ]
        run(pip, f"installing {name}", env=env, quiet=True)
        stamp.write_text(digest)
    return python


def bpy_python(version: str = BPY_VERSION) -> Path:
    """Python with PyPI's bpy of this version, NumPy and pytest (pinned for BPY_VERSION only)."""
    pinned = REQUIREMENTS / f"bpy-{version}.txt"
    if not version or not all(part.isdigit() for part in version.split(".")):
        raise DevError(f"'{version}' is no version of bpy")
    requirements = pinned.read_text() if pinned.exists() else f"bpy=={version}\nnumpy\n{PYTEST}\n"
    return ensure(f"bpy-{version}", requirements)


def quality_python() -> Path:
    """Python of the environment that holds clang-format and ruff."""
    return ensure("quality", (REQUIREMENTS / "quality.txt").read_text())


def bench_python() -> Path:
    """Python of the environment in which ./dev bench draws and compares images."""
    return ensure("bench", (REQUIREMENTS / "bench.txt").read_text())


def luxcore_python() -> Path:
    """Python of the environment that holds LuxCore, which the bench compares with."""
    return ensure("luxcore", (REQUIREMENTS / "luxcore.txt").read_text())


def openjd_python() -> Path:
    """Python of the environment that holds the command `openjd`, which runs a farm's template."""
    return ensure("openjd", (REQUIREMENTS / "openjd.txt").read_text())


def coverage_python() -> Path:
    """Python of the environment that holds gcovr and coverage.py."""
    return ensure("coverage", (REQUIREMENTS / "coverage.txt").read_text())
