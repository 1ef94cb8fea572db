# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev bench` and `./dev stability`: programs in tests/ that measure."""

from __future__ import annotations

import os
from pathlib import Path

from tools import host, setup
from tools.common import PYTHON, ROOT, DevError

BENCHES = ROOT / "tests" / "bench"
STABILITY = ROOT / "tests" / "stability" / "run.py"


def become(command: str, script: Path, arguments: list[str]) -> int:
    """Become the program `script`; it can import tools and tests and finds the native library."""
    setup.ensure(command)
    env = dict(os.environ)
    env["PYTHONPATH"] = str(ROOT)
    env["SPECULA_LIBRARY_DIR"] = str(host.library_folder())
    os.execve(PYTHON, [PYTHON, str(script), *arguments], env)


def bench(argv: list[str]) -> int:
    """Entry of `./dev bench NAME ARGS...`."""
    names = sorted(path.stem for path in BENCHES.glob("[!_]*.py"))
    listed = f"there are: {' '.join(names)}" if names else "there are none in tests/bench/"
    if not argv or argv[0] in ("-h", "--help"):
        print(f"usage: ./dev bench NAME ARGS...\nBenchmarks: {listed}")
        return 0 if argv else 2
    if argv[0] not in names:
        raise DevError(f"no benchmark '{argv[0]}'; {listed}")
    return become("bench", BENCHES / f"{argv[0]}.py", argv[1:])


def stability(argv: list[str]) -> int:
    """Entry of `./dev stability ARGS...`."""
    if not STABILITY.exists():
        raise DevError(f"there is no {STABILITY.relative_to(ROOT)}")
    return become("stability", STABILITY, argv)
