# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders every .blend in folders by Specula and by Cycles, and shows the pairs on a page.

Each file is rendered in a process of its own for each renderer, twice with different seeds, which
tell noise from difference. Whatever a file does, the next one follows: what stands still is killed,
what crashes shows its last lines. DIR/index.html and DIR/results.json are there from the first file
on. The exit code is 1 if Specula crashed, stood still, failed, was late, or differs from Cycles
without a warning.
"""

from __future__ import annotations

import argparse
import shlex
import subprocess
import sys
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.instruments.bench import _children, _machine, _program
from tests.instruments.bench._children import Progress
from tests.instruments.bench._machine import CpuTimes
from tests.instruments.field import _measure, _page
from tests.instruments.field._measure import TOLERANCE, Child
from tests.instruments.pairs import files as pictures
from tests.instruments.pairs.arguments import BLENDERS, add_shared
from tests.instruments.pairs.comparison import Picture, compare, picture
from tools import host
from tools.common import DevError

HERE = Path(__file__).resolve().parent
JOB, MAKER = HERE / "_job.py", HERE / "_make.py"
SEEDS = (1, 2)
# Seconds of a whole process, beside so many times what its renders may take: Blender's start, what
# modifiers take, and a machine that others use as well.
PATIENCE, PATIENCE_FACTOR = 60.0, 3.0
GUESS = 10.0  # seconds for each process, for the progress bar alone


@dataclass(frozen=True)
class Options:
    where: str  # of _children.HOSTS
    seconds: float
    size: int
    samples: int
    threads: int
    hard_limit: float
    out: Path


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev field",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "dirs", nargs="*", type=Path, metavar="DIR", help="folders, or .blend files"
    )
    parser.add_argument("--make", type=Path, metavar="DIR", help="write made-up scenes there")
    add_shared(parser, "field", blender="3.4", samples=64, only="paths that contain one of these")
    parser.add_argument(
        "--seconds", type=float, default=10.0, help="limit of each render (%(default)g)"
    )
    parser.add_argument(
        "--size", type=int, default=256, help="pixels along the longer side (%(default)s)"
    )
    parser.add_argument(
        "--hard-limit",
        type=float,
        help="seconds after which a process, of two renders, is killed "
        f"(default {PATIENCE:g} + {PATIENCE_FACTOR:g} times both limits)",
    )
    args = parser.parse_args()
    if not args.dirs and not args.make:
        parser.error("no folder")
    if args.seconds <= 0.0 or args.size < 8 or args.samples < 1:
        parser.error("--seconds, --size (at least 8) and --samples must be positive")
    return args


def files(places: Sequence[Path], only: str | None) -> list[Path]:
    """Every .blend, each once, by path."""
    found: dict[Path, None] = {}
    for place in places:
        if not place.exists():
            raise DevError(f"there is no {place}")
        blends = [place] if place.is_file() else sorted(place.rglob("*.blend"))
        found |= dict.fromkeys(blend.resolve() for blend in blends)
    if only is not None:
        names = _program.split(only)
        return [blend for blend in found if any(name in str(blend) for name in names)]
    return list(found)


def render(blend: Path, stem: str, engine: str, options: Options) -> tuple[Child, Picture | None]:
    """One process; the picture is there as far as it came."""
    work = options.out / "work"
    name = f"{stem}-{engine.lower()}"
    images = [work / f"{name}-{seed}.exr" for seed in SEEDS]
    for image in images:
        image.unlink(missing_ok=True)
    job = {
        "scene": str(blend),
        "engine": engine,
        "size": options.size,
        "samples": options.samples,
        "seconds": options.seconds,
        "seeds": SEEDS,
        "threads": options.threads,
        "images": [str(image) for image in images],
    }
    before = CpuTimes.now()
    ended = _children.execute(name, options.where, JOB, job, work, options.hard_limit)
    child = _measure.child(ended, before.others_share(CpuTimes.now()))
    done = images[: len(child.renders)]
    splats = sum(row["splats"] for row in child.renders)
    found = picture([pictures.read(image) for image in done], splats) if done else None
    for image in images:
        image.unlink(missing_ok=True)
    return child, found


def examine(blend: Path, stem: str, options: Options) -> _page.Scene:
    specula, found = render(blend, stem, "SPECULA", options)
    cycles, expected = render(blend, stem, "CYCLES", options)
    complete = len(specula.renders) == len(cycles.renders) == len(SEEDS)
    comparison = compare(found, expected, TOLERANCE) if complete else None
    verdict = _measure.verdict(specula, cycles, comparison, options.seconds)
    shown = pictures.draw(options.out, stem, found, expected)
    return _page.Scene(str(blend), verdict, specula, cycles, comparison, shown)


def not_examined(blend: Path, error: Exception) -> _page.Scene:
    """Of a file on which this program itself failed."""
    lines = "".join(traceback.format_exception(error)).splitlines()
    why = f"{type(error).__name__}: {error}"
    child = Child(_measure.FAILED, why, 1, "measuring", 0.0, 0.0, 0, [], lines, 0.0)
    return _page.Scene(str(blend), _measure.FAILED, child, child, None, {})


def make(folder: Path, names: Sequence[str] = ()) -> None:
    """Writes made-up scenes, all or these, in Debian's Blender: every later one opens them."""
    folder.mkdir(parents=True, exist_ok=True)
    arguments = ["--background", "--python-exit-code", "1", "--python", str(MAKER)]
    command = host.blender_command([*arguments, "--", str(folder.resolve()), *names])
    environment = host.blender_environment(host.library_folder())
    result = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL)
    if result.returncode != 0:
        raise DevError(f"the scenes were not made: exit code {result.returncode}")


def main() -> int:
    args = arguments()
    if args.make:
        make(args.make)
        if not args.dirs:
            return 0
    blends = files(args.dirs, args.only)
    if not blends:
        raise DevError("there is no .blend in these folders")
    _program.freeze_library("field")
    hard_limit = args.hard_limit or PATIENCE + PATIENCE_FACTOR * len(SEEDS) * args.seconds
    options = Options(
        BLENDERS[args.blender],
        args.seconds,
        args.size,
        args.samples,
        args.threads,
        hard_limit,
        args.out.resolve(),
    )
    (options.out / "work").mkdir(parents=True, exist_ok=True)
    about = (
        f"{time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime())}, Blender {args.blender}, "
        f"{_machine.processor()}, {args.threads} threads; limit {args.seconds:g} s and "
        f"{args.samples} samples for each render, a process is killed after {hard_limit:g} s. "
        f"Command: ./dev field {shlex.join(sys.argv[1:])}"
    )
    scenes = []
    progress = Progress("field", [2.0 * GUESS] * len(blends))
    for number, blend in enumerate(blends, 1):
        progress.show(f"{number}/{len(blends)} {blend.name}")
        try:
            scene = examine(blend, f"{number:03}-{blend.stem}", options)
        except Exception as error:  # whatever a file brings, the next one follows
            scene = not_examined(blend, error)
        scenes.append(scene)
        _page.write(options.out, about, args.seconds, scenes)
        progress.clear()
        print(f"{scene.verdict}: {blend}", flush=True)
        progress.advance(2.0 * GUESS)
    others = [child.others_share for s in scenes for child in (s.specula, s.cycles)]
    _program.warn_of_others("field", max(others))
    counts = _page.verdict_counts(scenes)
    print("; ".join(f"{name}: {count}" for name, count in counts.items() if count))
    print(options.out / "index.html")
    return 1 if any(scene.verdict in _measure.BAD for scene in scenes) else 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
