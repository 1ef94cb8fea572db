# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev bench` and `./dev stability`: programs in tests/ that measure."""

from __future__ import annotations

import os
from pathlib import Path

from tools import host, setup, venvs
from tools.common import PYTHON, ROOT, DevError

BENCHES = ROOT / "tests" / "bench"
DEFAULT_BENCH = "error"
WITH_FIGURES = ("error", "reference")  # they need the environment with FLIP and EXR files
STABILITY = ROOT / "tests" / "stability" / "run.py"


def become(command: str, script: Path, arguments: list[str], python: str | Path = PYTHON) -> int:
    """Become the program `script`; it can import tools and tests and finds the native library."""
    setup.ensure(command)
    env = dict(os.environ)
    env["PYTHONPATH"] = str(ROOT)
    env["SPECULA_LIBRARY_DIR"] = str(host.library_folder())
    os.execve(python, [str(python), str(script), *arguments], env)


def bench(argv: list[str]) -> int:
    """Entry of `./dev bench [NAME] ARGS...`; without a name it is DEFAULT_BENCH."""
    names = sorted(path.stem for path in BENCHES.glob("[!_]*.py"))
    name, arguments = (argv[0], argv[1:]) if argv[:1] and argv[0] in names else (None, argv)
    if name is None and arguments[:1] and not arguments[0].startswith("-"):
        raise DevError(f"no benchmark '{arguments[0]}'; there are: {' '.join(names)}")
    name = name or DEFAULT_BENCH
    # The environment is made by pip and needs python3-venv, which setup installs.
    setup.ensure("bench")
    python = venvs.bench_python() if name in WITH_FIGURES else PYTHON
    return become("bench", BENCHES / f"{name}.py", arguments, python)


def stability(argv: list[str]) -> int:
    """Entry of `./dev stability ARGS...`."""
    if not STABILITY.exists():
        raise DevError(f"there is no {STABILITY.relative_to(ROOT)}")
    return become("stability", STABILITY, argv)
