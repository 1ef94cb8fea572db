# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev format` and `./dev lint`: how the sources look, and what static analysis says of them.

What is generated from other sources is written by the former, too.
"""

from __future__ import annotations

import argparse
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tools import setup, venvs
from tools.build import configure
from tools.common import BUILD, ROOT, DevError, run, say

CPP_FOLDERS = ("native", "tests/native", "tests/fuzz", "tests/instruments/bench/native")
PYTHON_FOLDERS = ("tools", "addon", "tests", "blend_scenes")


def cpp_files(*suffixes: str) -> list[Path]:
    """The project's C++ files with these suffixes, sorted."""
    found = (path for folder in CPP_FOLDERS for path in (ROOT / folder).rglob("*"))
    return sorted(path for path in found if path.suffix in suffixes)


def python_folders() -> list[Path]:
    """The folders with Python in them that are there."""
    return [ROOT / folder for folder in PYTHON_FOLDERS if (ROOT / folder).is_dir()]


def format_sources(argv: list[str]) -> int:
    """Entry of `./dev format`."""
    argparse.ArgumentParser(prog="./dev format", description="Rewrite the sources.").parse_args(
        argv
    )
    setup.ensure("format")
    from tools import abi  # not above: it needs a package that is there only now

    tool = venvs.quality_python().parent
    files = cpp_files(".cpp", ".h")
    if files:
        run([tool / "clang-format", "-i", *files], "clang-format")
    abi.MODULE.write_text(abi.module_text())
    run([tool / "ruff", "check", "--fix-only", "--quiet", *python_folders()], "ruff check --fix")
    run([tool / "ruff", "format", "--quiet", *python_folders()], "ruff format")
    return 0


def run_clang_tidy(files: list[Path]) -> bool:
    """clang-tidy with the dev preset's flags, one file per processor; whether all are clean."""
    database = BUILD / "dev"
    configure("dev")

    def check(path: Path) -> bool:
        command = [
            "clang-tidy",
            "--quiet",
            "--warnings-as-errors=*",
            "-p",
            str(database),
            str(path),
        ]
        result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if result.returncode != 0:  # one write per file: findings of two files must not mix
            print(f"{path.relative_to(ROOT)}:\n{result.stdout}{result.stderr}", flush=True)
        return result.returncode == 0

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return all(list(pool.map(check, files)))


def lint(argv: list[str]) -> int:
    """Entry of `./dev lint`: all checks run, then one exit code."""
    parser = argparse.ArgumentParser(
        prog="./dev lint", description="Check the sources, change nothing."
    )
    parser.add_argument(
        "--no-tidy", action="store_true", help="leave out clang-tidy, which takes minutes"
    )
    parser.add_argument(
        "files", nargs="*", type=Path, help="C++ files for clang-tidy (default: all)"
    )
    args = parser.parse_args(argv)
    setup.ensure("lint")
    tool = venvs.quality_python().parent
    cpp = cpp_files(".cpp", ".h")
    checks = [
        ("ruff check", [tool / "ruff", "check", *python_folders()]),
        ("ruff format", [tool / "ruff", "format", "--check", *python_folders()]),
    ]
    if cpp:
        checks.insert(0, ("clang-format", [tool / "clang-format", "--dry-run", "-Werror", *cpp]))
    failed = []
    for name, command in checks:
        say(name)
        try:
            run(command, name)
        except DevError:
            failed.append(name)
    if not args.no_tidy:
        say("clang-tidy")
        if not run_clang_tidy([path.resolve() for path in args.files] or cpp_files(".cpp")):
            failed.append("clang-tidy")
    if failed:
        raise DevError(f"lint: findings of {', '.join(failed)}")
    return 0
