# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev bench`, `./dev stability`, `./dev field` and `./dev parity`: programs that measure."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NoReturn

from tools import host, setup, venvs
from tools.common import BUILD, PYTHON, ROOT, DevError

BENCHES = ROOT / "tests" / "instruments" / "bench"
STABILITY = ROOT / "tests" / "instruments" / "stability" / "stability.py"
FIELD = ROOT / "tests" / "instruments" / "field" / "field.py"
PARITY = ROOT / "tests" / "instruments" / "parity" / "parity.py"
DEFAULT_BENCH = "error"
# They need the environment with Matplotlib, FLIP and EXR files.
WITH_FIGURES = ("animation", "error", "figures", "reference", "scaling")
NATIVE = ("kernels",)  # they build their own programs, and need no Blender


def bench(argv: list[str]) -> NoReturn:
    """Becomes the program of `./dev bench [NAME] ARGS...`; without a name DEFAULT_BENCH."""
    names = sorted(path.stem for path in BENCHES.glob("[!_]*.py"))
    name, arguments = (argv[0], argv[1:]) if argv[:1] and argv[0] in names else (None, argv)
    if name is None and arguments[:1] and not arguments[0].startswith("-"):
        raise DevError(f"no benchmark '{arguments[0]}'; there are: {' '.join(names)}")
    name = name or DEFAULT_BENCH
    # The environment is made by pip and needs python3-venv, which setup installs.
    setup.ensure(f"bench {name}" if name in NATIVE else "bench")
    python = venvs.bench_python() if name in WITH_FIGURES else PYTHON
    env = dict(os.environ)
    env["PYTHONPATH"] = str(ROOT)  # it imports tools and tests
    if name not in NATIVE:
        env["SPECULA_LIBRARY_DIR"] = str(host.library_folder())
    os.execve(python, [str(python), str(BENCHES / f"{name}.py"), *arguments], env)


def stability(argv: list[str]) -> NoReturn:
    """Becomes the program of `./dev stability ARGS...`."""
    setup.ensure("stability")
    env = dict(os.environ)
    addons = host.scripts_folder(BUILD / "python") / "addons"  # where it imports specula from
    env["PYTHONPATH"] = os.pathsep.join([str(ROOT), str(addons)])
    env["SPECULA_LIBRARY_DIR"] = str(host.library_folder())
    os.execve(PYTHON, [str(PYTHON), str(STABILITY), *argv], env)


def field(argv: list[str]) -> NoReturn:
    """Becomes the program of `./dev field ARGS...`."""
    _with_blender("field", FIELD, argv)


def parity(argv: list[str]) -> NoReturn:
    """Becomes the program of `./dev parity ARGS...`."""
    _with_blender("parity", PARITY, argv)


def _with_blender(command: str, program: Path, argv: list[str]) -> NoReturn:
    setup.ensure(command)
    env = dict(os.environ)
    env["PYTHONPATH"] = str(ROOT)
    env["SPECULA_LIBRARY_DIR"] = str(host.library_folder())
    os.execve(PYTHON, [str(PYTHON), str(program), *argv], env)
