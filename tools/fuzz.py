# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev fuzz`: random scenes, mutated through the C interface or rendered by every method."""

from __future__ import annotations

import argparse
import os
import subprocess
import time

from tools import setup
from tools.build import build
from tools.common import BUILD, ROOT

SEEDS_APART = 10**9  # of processes that run side by side


def main(argv: list[str]) -> int:
    """Entry of `./dev fuzz`."""
    parser = argparse.ArgumentParser(
        prog="./dev fuzz",
        description="Send mutated scenes through the C interface, under the sanitizers, or hold "
        "what methods make of random scenes against each other; prints what fails.",
    )
    parser.add_argument(
        "--scenes", action="store_true", help="the latter: weights, means, times, cancelling"
    )
    parser.add_argument("--minutes", type=float, default=10.0, help="how long (default: 10)")
    parser.add_argument("--seed", type=int, help="of the first scene (default: the time)")
    parser.add_argument("--count", type=int, help="so many scenes, whatever the time")
    parser.add_argument("--jobs", type=int, help="processes (default: one for each processor)")
    parser.add_argument(
        "--quiet",
        action="store_true",
        help="with --scenes: nothing else runs here, times are held against what is promised",
    )
    args = parser.parse_args(argv)
    if args.quiet and not args.scenes:
        parser.error("--quiet is for --scenes")
    preset, program = ("dev", "specula_scenes") if args.scenes else ("asan", "specula_fuzz")
    setup.ensure("test native" if args.scenes else "test asan")
    build(preset, target=program)
    seed = int(time.time()) if args.seed is None else args.seed
    # Renders of a scene have two threads already.
    side_by_side = 1 if args.count or args.scenes else os.cpu_count() or 1
    extent = ["--count", str(args.count)] if args.count else ["--minutes", str(args.minutes)]
    if args.quiet:
        extent += ["--quiet", "1"]
    path = str(BUILD / preset / "bin" / program)
    commands = [
        [path, "--seed", str(seed + i * SEEDS_APART), *extent]
        for i in range(args.jobs or side_by_side)
    ]
    for command in commands:
        print(" ".join(command), flush=True)
    processes = [subprocess.Popen(command, cwd=ROOT) for command in commands]
    return max(process.wait() for process in processes)
