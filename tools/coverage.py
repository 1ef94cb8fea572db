# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev coverage`: which lines of native/ and addon/ the tests run."""

from __future__ import annotations

import argparse
import json
import os
import shutil
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tools import host, setup, testing, venvs
from tools.common import BUILD, PYTHON, ROOT, run, say
from tools.testing import Result, Selection, Tier

FOLDER = BUILD / "coverage-report"
DATA = FOLDER / "python.data"  # of all processes, with a suffix each
ADDON = ROOT / "addon"
MOST_FILES = 15  # that are named


@dataclass
class Lines:
    """Lines of code and how many of them ran."""

    total: int = 0
    run: int = 0

    def add(self, other: Lines) -> None:
        self.total += other.total
        self.run += other.run

    @property
    def percent(self) -> float:
        return 100.0 * self.run / self.total if self.total else 100.0


# --------------------------------------------------------------------------------- running tests


def python_environment(base: dict[str, str]) -> dict[str, str]:
    """`base`, in which coverage.py is found and knows where its counts go."""
    library = venvs.coverage_python().parent.parent / "lib"
    packages = next(library.glob("python3.*")) / "site-packages"
    path = [part for part in (base.get("PYTHONPATH"), str(packages)) if part]
    return base | {
        "PYTHONPATH": os.pathsep.join(path),
        "SPECULA_COVERAGE_PACKAGES": str(packages),
        "SPECULA_ADDON": str(ADDON),
        "COVERAGE_FILE": str(DATA),
    }


def run_native(log: Path, selection: Selection) -> Result:
    """GoogleTest; what was counted before is forgotten."""
    for counts in (BUILD / "coverage").rglob("*.gcda"):
        counts.unlink()
    return testing.run_ctest("coverage", log, selection)


def run_addon(log: Path, selection: Selection) -> Result:
    """What of the addon works without Blender."""
    command = [PYTHON, "-m", "coverage", "run", "--parallel-mode", f"--source={ADDON}"]
    env = python_environment(testing.addon_environment())
    return testing.run_pytest("tests/addon", log, selection, [*command, "-m", "pytest"], env)


def run_blender(log: Path, selection: Selection) -> Result:
    """The addon inside Debian's Blender."""
    program, *arguments = testing.blender_runner()
    runner = [program, "--python", str(host.TOOLS / "cover_in_blender.py"), *arguments]
    env = python_environment(host.blender_environment(host.library_folder(quiet=False)))
    return testing.run_pytest("tests/blender", log, selection, runner, env)


SUITES: dict[str, Callable[[Path, Selection], Result]] = {
    "native": run_native,
    "addon": run_addon,
    "blender": run_blender,
}


# --------------------------------------------------------------------------------- what they ran


def native_lines() -> dict[str, Lines]:
    """File -> its lines, by gcov; the pages go to FOLDER/native."""
    pages, summary = FOLDER / "native", FOLDER / "native.json"
    pages.mkdir(parents=True, exist_ok=True)
    command = [venvs.coverage_python().parent / "gcovr", "--root", ROOT, "--filter", "native/"]
    command += ["--object-directory", BUILD / "coverage", "-j", str(os.cpu_count() or 1)]
    command += ["--exclude-throw-branches", "--merge-mode-functions", "merge-use-line-min"]
    command += ["--json-summary", summary, "--html-details", pages / "index.html"]
    run([*command, BUILD / "coverage"], "gcovr", quiet=True)
    files = json.loads(summary.read_text())["files"]
    return {row["filename"]: Lines(row["line_total"], row["line_covered"]) for row in files}


def addon_lines() -> dict[str, Lines]:
    """File -> its lines, by coverage.py; the pages go to FOLDER/addon."""
    env = python_environment(dict(os.environ))
    summary = FOLDER / "addon.json"
    for command in (
        ["combine", "--quiet"],
        ["json", "--quiet", "-o", str(summary)],
        ["html", "--quiet", "-d", str(FOLDER / "addon")],
    ):
        run([PYTHON, "-m", "coverage", *command], f"coverage {command[0]}", env, quiet=True)
    files = json.loads(summary.read_text())["files"]
    return {
        name: Lines(row["summary"]["num_statements"], row["summary"]["covered_lines"])
        for name, row in files.items()
    }


def table(files: dict[str, Lines]) -> list[str]:
    """Rows of folders and a sum, then the files in which most lines did not run."""
    folders: dict[str, Lines] = defaultdict(Lines)
    whole = Lines()
    for name, lines in files.items():
        folders[str(Path(name).parent)].add(lines)
        whole.add(lines)
    rows = [
        f"{lines.percent:6.1f} %  {lines.run:6} of {lines.total:6}  {name}"
        for name, lines in [*sorted(folders.items()), ("together", whole)]
    ]
    left = sorted(files.items(), key=lambda item: item[1].run - item[1].total)[:MOST_FILES]
    rows += ["", "most lines that no test ran:"]
    rows += [
        f"{lines.total - lines.run:6} lines, {lines.percent:5.1f} % ran  {name}"
        for name, lines in left
        if lines.run < lines.total
    ]
    return rows


def main(argv: list[str]) -> int:
    """Entry of `./dev coverage`."""
    parser = argparse.ArgumentParser(
        prog="./dev coverage",
        description="Which lines of native/ and addon/ the tests run, those of --quick by default.",
    )
    parser.add_argument("suites", nargs="*", metavar="SUITE", help=" ".join(SUITES))
    parser.add_argument("--slow", action="store_true", help="the tests marked as slow, too")
    args = parser.parse_args(argv)
    for name in args.suites:
        if name not in SUITES:
            parser.error(f"no suite '{name}'; there are: {' '.join(SUITES)}")
    names = [name for name in SUITES if not args.suites or name in args.suites]
    setup.ensure("coverage")
    venvs.coverage_python()
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    selection = Selection(Tier.DAILY if args.slow else Tier.QUICK)
    results = [SUITES[name](FOLDER / f"{name}.log", selection) for name in names]
    files: dict[str, Lines] = {}
    if "native" in names:
        files |= native_lines()
    if {"addon", "blender"} & set(names):
        files |= addon_lines()
    print("\n".join(["", *table(files), "", f"line by line: {FOLDER}/native, {FOLDER}/addon"]))
    failed = [result.name for result in results if result.outcome != "passed"]
    if failed:
        say(f"tests failed: {' '.join(failed)}; the counts are of what ran")
    return 1 if failed else 0
