# SPDX-License-Identifier: GPL-3.0-or-later
"""How much error is left after how much time, for every method on every scene.

Renders every scene by every method for every time, several times over; each render is a process of
its own. What is rendered is kept in build/bench/error (about 1 MB a render) and found again, so
that an interrupted bench goes on where it was. At the end it writes DIR/index.html, summary.json,
summary.csv and charts/.

The exit code is 0 if every render came to an image. It is 1 if one failed, or if a method that
--methods names cannot run here. What LuxCore cannot show of a scene is no failure: the page says
why it is not charted. Nor are the bench's checks of itself, which it prints and puts on the page.

`./dev bench reference SCENE` renders what a scene is held against; `./dev bench speed` measures
samples per second instead of errors.
"""

from __future__ import annotations

import argparse
import math
import os
import shlex
import sys
import time
from pathlib import Path

from tests.instruments.bench import (
    _checks,
    _machine,
    _methods,
    _program,
    _report,
    _scenes,
    _schedule,
    _summary,
)
from tools.common import BUILD, DevError

BUDGETS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0)
QUICK_BUDGETS = (1.0, 4.0)
SEEDS, QUICK_SEEDS = 3, 2
DEFAULT_OUT = BUILD / "bench" / "report"


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev bench",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--out", type=Path, default=DEFAULT_OUT, metavar="DIR", help="(%(default)s)"
    )
    parser.add_argument("--quick", action="store_true", help="a look, in less than ten minutes")
    parser.add_argument("--scenes", help="names, separated by commas (all with a reference)")
    own = {"type": Path, "action": "append", "default": []}
    parser.add_argument("--blend", metavar="FILE", help="a scene of your own, and", **own)
    parser.add_argument("--reference", metavar="EXR", help="what it is held against", **own)
    parser.add_argument("--methods", help=f"of: {' '.join(_methods.METHODS)}")
    parser.add_argument("--budgets", help="seconds of rendering, separated by commas")
    parser.add_argument("--seeds", type=int, help="renders of each (3, quick 2)")
    parser.add_argument(
        "--undisturbed",
        action="store_true",
        help="render again what other programs disturbed in an earlier run",
    )
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    args = parser.parse_args()
    if len(args.blend) != len(args.reference):
        parser.error("each --blend needs a --reference")
    if args.seeds is None:
        args.seeds = QUICK_SEEDS if args.quick else SEEDS
    if min(args.seeds, args.threads) < 1:
        parser.error("--seeds and --threads are 1 or more")
    args.budgets = budgets(parser, args)
    args.named = bool(args.methods)  # whether the user asked for just these
    args.methods = chosen_methods(parser, args)
    return args


def budgets(parser: argparse.ArgumentParser, args: argparse.Namespace) -> list[float]:
    if not args.budgets:
        return list(QUICK_BUDGETS if args.quick else BUDGETS)
    try:
        values = sorted({float(text) for text in args.budgets.split(",")})
    except ValueError:
        parser.error("--budgets are numbers, separated by commas")
    if not all(0.0 < value < math.inf for value in values):
        parser.error("--budgets are positive and finite")
    return values


def chosen_methods(parser: argparse.ArgumentParser, args: argparse.Namespace) -> list[str]:
    if args.methods:
        names = _program.split(args.methods)
        if not names:
            parser.error("--methods names none")
        for name in names:
            if name not in _methods.METHODS:
                parser.error(f"no method '{name}'; there are: {' '.join(_methods.METHODS)}")
        return names
    names = [name for name, method in _methods.METHODS.items() if not method.hidden]
    return [name for name in names if not args.quick or name in _methods.QUICK]


def chosen_scenes(args: argparse.Namespace) -> list[_scenes.Scene]:
    scenes = []
    for blend, reference in zip(args.blend, args.reference, strict=True):
        for path in (blend, reference):
            if not path.is_file():
                raise DevError(f"there is no file {path}")
        scenes.append(_scenes.Scene(blend.stem, blend.resolve(), reference))
    if args.scenes or not args.blend:
        available = _scenes.with_references()
        quick = [name for name in _scenes.QUICK if name in available]
        names = _program.split(args.scenes) if args.scenes else quick if args.quick else available
        scenes += [_scenes.named(name) for name in names]
    if not scenes:
        raise DevError("no scene has a reference; ./dev bench reference NAME makes one")
    if len({scene.name for scene in scenes}) < len(scenes):
        raise DevError("two scenes have the same name")
    return scenes


def main() -> int:
    args = arguments()
    scenes = chosen_scenes(args)
    _program.freeze_library("error")
    missing = _methods.missing(args.methods)
    methods = [name for name in args.methods if _methods.METHODS[name].family not in missing]
    for family, why in missing.items():
        _program.warn("bench", f"{_methods.FAMILIES[family].label} is left out: {why}")
    if not methods:
        raise DevError("none of the methods can run here")
    started = time.time()
    load = _program.load_before("bench")
    seeds = range(1, args.seeds + 1)
    tasks = _schedule.plan(scenes, methods, args.budgets, seeds, args.threads)
    outcome = _schedule.render_all(tasks, args.undisturbed)
    for (scene, method), why in outcome.failures.items():
        _program.warn("bench", f"{scene}, {method}: {why}")
    results = [
        _summary.scene_result(scene, _methods.suited(methods, scene), args.budgets, outcome)
        for scene in scenes
    ]
    longest = max(args.budgets)
    checks = _checks.checks(results, longest)
    about = {
        "date": time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(started)),
        "processor": _machine.processor(),
        "threads": args.threads,
        "load_average": load,
        "budgets": args.budgets,
        "seeds": args.seeds,
        "quick": args.quick,
        "command": f"./dev bench {shlex.join(sys.argv[1:])}".strip(),
        "missing": {_methods.FAMILIES[name].label: why for name, why in missing.items()},
        "minutes": (time.time() - started) / 60.0,
    }
    page = _report.write(args.out, about, scenes, results, outcome.records, checks)
    for check in checks:
        print(f"{'pass' if check.passed else 'FAIL'}  {check.name}: {check.text}")
    print(page)
    return 1 if outcome.failures or (args.named and missing) else 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
