# SPDX-License-Identifier: GPL-3.0-or-later
"""`./dev fuzz`: mutated scenes through the C interface, under the sanitizers."""

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
        description="Send mutated scenes through the C interface; prints the seeds that fail.",
    )
    parser.add_argument("--minutes", type=float, default=10.0, help="how long (default: 10)")
    parser.add_argument("--seed", type=int, help="of the first scene (default: the time)")
    parser.add_argument("--count", type=int, help="so many scenes, whatever the time")
    parser.add_argument("--jobs", type=int, help="processes (default: one for each processor)")
    args = parser.parse_args(argv)
    setup.ensure("test asan")
    build("asan", target="specula_fuzz")
    seed = int(time.time()) if args.seed is None else args.seed
    jobs = args.jobs or (1 if args.count else os.cpu_count() or 1)
    extent = ["--count", str(args.count)] if args.count else ["--minutes", str(args.minutes)]
    program = BUILD / "asan" / "bin" / "specula_fuzz"
    commands = [[str(program), "--seed", str(seed + i * SEEDS_APART), *extent] for i in range(jobs)]
    for command in commands:
        print(" ".join(command), flush=True)
    processes = [subprocess.Popen(command, cwd=ROOT) for command in commands]
    return max(process.wait() for process in processes)
