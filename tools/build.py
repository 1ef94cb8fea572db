# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev build`: configure and compile a CMake preset."""

from __future__ import annotations

import argparse
import os
import subprocess
from pathlib import Path

from tools import setup
from tools.common import BUILD, ROOT, locked, run, say

PRESETS = ("release", "portable", "bench", "dev", "asan", "tsan", "coverage")


# Keys of setup.COMMAND_NEEDS, beside "build".
NEEDS = {"bench": "bench kernels"} | dict.fromkeys(
    ("dev", "asan", "tsan", "coverage"), "test native"
)


def environment() -> dict[str, str]:
    """Environment for CMake.

    ccache takes paths relative to the root: checkouts share its cache. It caches what includes a
    precompiled header only if it may be careless about macros and time.
    """
    return {
        "CCACHE_BASEDIR": str(ROOT),
        "CCACHE_NOHASHDIR": "1",
        "CCACHE_SLOPPINESS": "pch_defines,time_macros",
    } | dict(os.environ)


def configure(preset: str, quiet: bool = False) -> None:
    """Make build/`preset` ready for ninja.

    Ninja itself runs CMake again when CMake's files change, but does not know of the presets.
    """
    ninja_file = BUILD / preset / "build.ninja"
    if (
        ninja_file.exists()
        and ninja_file.stat().st_mtime > (ROOT / "CMakePresets.json").stat().st_mtime
    ):
        return
    say(f"configuring {preset}")
    run(["cmake", "--preset", preset], f"configuring {preset}", environment(), quiet)


def steps(preset: str, target: str) -> int:
    """How many commands build() would run."""
    command = ["cmake", "--build", "--preset", preset, "--target", target, "--", "-n"]
    with locked(BUILD / f"{preset}.lock"):
        configure(preset, quiet=True)
        planned = subprocess.run(
            command, cwd=ROOT, env=environment(), capture_output=True, text=True
        ).stdout
    return sum(line.startswith("[") for line in planned.splitlines())


def build(preset: str, quiet: bool = False, target: str = "all") -> Path:
    """Compile `preset`; returns the folder with its libraries. `quiet`: output only on failure."""
    command = ["cmake", "--build", "--preset", preset, "--target", target]
    with locked(BUILD / f"{preset}.lock"):
        configure(preset, quiet)
        run(command, f"building {preset}", environment(), quiet)
    return BUILD / preset / "lib"


def main(argv: list[str]) -> int:
    """Entry of `./dev build`."""
    parser = argparse.ArgumentParser(prog="./dev build", description="Compile into build/PRESET.")
    parser.add_argument("--preset", choices=PRESETS, default="release")
    preset = parser.parse_args(argv).preset
    setup.ensure(NEEDS.get(preset, "build"))
    build(preset)
    return 0
