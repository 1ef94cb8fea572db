# SPDX-License-Identifier: GPL-3.0-or-later
"""How cost grows with a scene: seconds per sample, memory, and seconds until it is ready to render.

From one small scene, a wavy mirror that throws a caustic on a floor, one thing at a time is
changed: triangles of the mirror, texels of its normal map, lamps, casters, pixels, threads. Path
tracing and unbiased manifold sampling render each; the difference is the manifold's own.

Each point is a process of its own; all take turns, in several rounds. The cost of a sample is the
slope of the render's time over two numbers of samples, N and 3 N. Through the medians goes a power
law, whose exponent says how fast a quantity grows. At the end it writes DIR/index.html,
scaling.json, scaling.csv and charts/.

The exit code is 0 if every point came to a number; how large it is does not matter.
"""

from __future__ import annotations

import argparse
import os
import shlex
import sys
import time
from pathlib import Path

from tests.instruments.bench import (
    _machine,
    _program,
    _scaling_plan,
    _scaling_report,
    _scaling_summary,
)
from tools.common import BUILD

FOLDER = BUILD / "bench" / "scaling-runs"
DEFAULT_OUT = BUILD / "bench" / "scaling"
ROUNDS, QUICK_ROUNDS = 3, 1
SECONDS, QUICK_SECONDS = 2.5, 0.5
PROCESSORS = len(os.sched_getaffinity(0))


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev bench scaling",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    names = ", ".join(_scaling_plan.dimensions(PROCESSORS))
    parser.add_argument(
        "--out", type=Path, default=DEFAULT_OUT, metavar="DIR", help="(%(default)s)"
    )
    parser.add_argument("--only", metavar="DIMENSIONS", help=f"of: {names} (default all)")
    parser.add_argument(
        "--rounds", type=int, help=f"turns of each point (default {ROUNDS}, quick {QUICK_ROUNDS})"
    )
    parser.add_argument(
        "--seconds",
        type=float,
        help=f"of sampling in each turn, by each method (default {SECONDS:g}, quick "
        f"{QUICK_SECONDS:g}); at least four samples are taken",
    )
    parser.add_argument(
        "--quick", action="store_true", help="the three smallest sizes: whether all works"
    )
    args = parser.parse_args()
    if args.rounds is None:
        args.rounds = QUICK_ROUNDS if args.quick else ROUNDS
    if args.seconds is None:
        args.seconds = QUICK_SECONDS if args.quick else SECONDS
    if args.rounds < 1:
        parser.error("--rounds must be at least 1")
    if args.seconds <= 0.0:
        parser.error("--seconds must be positive")
    return args


def main() -> int:
    args = arguments()
    dimensions = _scaling_plan.chosen(args.only, PROCESSORS, args.quick)
    load = _program.load_before("scaling")
    FOLDER.mkdir(parents=True, exist_ok=True)
    _program.freeze_library("scaling")
    started, before = time.time(), _machine.CpuTimes.now()
    points = _scaling_plan.points(dimensions, PROCESSORS, args.seconds)
    outcome = _scaling_plan.measure(points, args.rounds, FOLDER)
    others = before.others_share(_machine.CpuTimes.now())
    _program.warn_of_others("scaling", others)
    for why in outcome.failures.values():
        _program.warn("scaling", why)
    all_series = _scaling_summary.summarize(dimensions, outcome)
    about = {
        "date": time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(started)),
        "processor": _machine.processor(),
        "threads": PROCESSORS,
        "load_average": load,
        "others_share": others,
        "rounds": args.rounds,
        "seconds": args.seconds,
        "quick": args.quick,
        "command": f"./dev bench scaling {shlex.join(sys.argv[1:])}".strip(),
        "minutes": (time.time() - started) / 60.0,
    }
    page = _scaling_report.write(args.out, about, all_series, outcome)
    print(_scaling_summary.text(all_series))
    for remark in _scaling_summary.remarks(all_series):
        print(remark)
    print(page)
    return 1 if outcome.failures else 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
