# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders small scenes by Specula and by Cycles, one for each node, mode, light and setting, and
says which differ.

Many rows share a process; one that crashes or stands still is told, and the next process goes on
after it. DIR/index.html and DIR/results.json are there from the first process on. The exit code is
1 if a row crashed, stood still, failed, or differs without a warning and without being listed.
"""

from __future__ import annotations

import argparse
import shlex
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from tests.instruments.bench import _children, _machine, _program
from tests.instruments.bench._children import Ended, Progress
from tests.instruments.pairs import files
from tests.instruments.pairs.arguments import BLENDERS, add_shared
from tests.instruments.pairs.comparison import Picture, compare
from tests.instruments.parity import _page, _verdict
from tests.instruments.parity._page import Result
from tests.instruments.parity._rows import ROWS
from tests.instruments.parity._verdict import Outcome
from tools.common import DevError

JOB = Path(__file__).resolve().parent / "_job.py"
CHUNK = 40  # rows of a process
START_SECONDS = 120.0  # of a process, beside its rows
GUESS = 1.0  # seconds for a row, for the progress bar alone
TIMED_OUT = "Timeout ("  # what faulthandler writes into the log


@dataclass(frozen=True)
class Options:
    where: str  # of _children.HOSTS
    method: str
    samples: int
    noise: float
    most: int
    seconds: float
    threads: int
    out: Path


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev parity",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_shared(
        parser,
        "parity",
        blender="5.0",
        samples=16,
        only="rows with one of these names; else those whose name contains it, or matches it where "
        "it has * or ?",
    )
    parser.add_argument("--list", action="store_true", help="print the names of the rows")
    parser.add_argument("--method", default="PT", help="Specula's (%(default)s)")
    parser.add_argument(
        "--noise", type=float, default=0.005, help="of a block, that is asked for (%(default)g)"
    )
    parser.add_argument(
        "--most", type=int, default=16, help="renders of each, at most, for that (%(default)s)"
    )
    parser.add_argument(
        "--seconds", type=float, default=300.0, help="that a row may take (%(default)g)"
    )
    return parser.parse_args()


def select(only: str | None) -> list[str]:
    """Names of rows, in the order of the table."""
    if only is None:
        return list(ROWS)

    def fits(name: str, pattern: str) -> bool:
        if pattern in ROWS:
            return name == pattern
        return fnmatchcase(name, pattern) if set("*?") & set(pattern) else pattern in name

    patterns = _program.split(only)
    return [name for name in ROWS if any(fits(name, pattern) for pattern in patterns)]


# ---------------------------------------------------------------------------------------- processes


def stem(name: str) -> str:
    """Of a row's files: '/' and what else a name holds is no part of a path."""
    return "".join(letter if letter.isalnum() or letter in "-_=." else "-" for letter in name)


def run(names: Sequence[str], options: Options) -> list[Outcome]:
    """One process; those of `names` that it came to, at least the first."""
    work = options.out / "work"
    job = {
        "rows": [(name, str(work / f"{stem(name)}.npz")) for name in names],
        "method": options.method,
        "samples": options.samples,
        "noise": options.noise,
        "most": options.most,
        "seconds": options.seconds,
        "threads": options.threads,
    }
    limit = START_SECONDS + options.seconds * len(names)
    return outcomes(_children.execute(stem(names[0]), options.where, JOB, job, work, limit))


def outcomes(ended: Ended) -> list[Outcome]:
    """What a process tells of its rows. The one that was begun and not ended is to blame."""
    if not ended.report:
        words = _children.last_words(ended.log.read_text(errors="replace"))
        raise DevError(f"Blender did not begin: {words}; its log: {ended.log}")
    *done, last = ended.report
    if last["outcome"] == "begun":
        last = last | blame(ended)
    return [Outcome(**row) for row in (*done, last)]


def blame(ended: Ended) -> dict[str, str]:
    """`outcome` and `why` of the row with which a process ended."""
    log = ended.log.read_text(errors="replace")
    if ended.code is None or TIMED_OUT in log:
        return {"outcome": _verdict.STILL, "why": f"its log: {ended.log}"}
    words = _children.last_words(log)
    return {"outcome": _verdict.CRASHED, "why": f"exit code {ended.code}: {words}"}


def result(row: Outcome, options: Options) -> Result:
    path = options.out / "work" / f"{stem(row.name)}.npz"
    if row.outcome != "done":
        return Result(row, _verdict.verdict(row, None), None, {})
    specula, cycles = pictures(path)
    path.unlink()
    comparison = compare(specula, cycles, _verdict.TOLERANCE)
    shown = files.draw(options.out, stem(row.name), specula, cycles)
    return Result(row, _verdict.verdict(row, comparison), comparison, shown)


def pictures(path: Path) -> tuple[Picture, Picture]:
    """Specula's and Cycles', of the file that _job.py writes."""
    with np.load(path) as arrays:
        return tuple(
            Picture(
                arrays[f"{engine}/mean"],
                arrays[f"{engine}/variance"],
                np.zeros_like(arrays[f"{engine}/mean"]),
                {"splats": int(arrays[f"{engine}/splats"])},
            )
            for engine in ("SPECULA", "CYCLES")
        )


def examine(names: Sequence[str], options: Options, about: str) -> list[Result]:
    """All rows, in as many processes as it takes; the page is there after each."""
    results: list[Result] = []
    progress = Progress("parity", [GUESS] * len(names))
    while len(results) < len(names):
        rest = names[len(results) :]
        progress.show(f"{len(results)}/{len(names)} {rest[0]}")
        for row in run(rest[:CHUNK], options):
            results.append(result(row, options))
            progress.clear()
            print(f"{results[-1].verdict}: {row.name}", flush=True)
            progress.advance(GUESS)
        _page.write(options.out, about, results)
    return results


def main() -> int:
    args = arguments()
    names = select(args.only)
    if not names:
        raise DevError("there is no such row; ./dev parity --list has them all")
    if args.list:
        print("\n".join(names))
        return 0
    _program.freeze_library("parity")
    options = Options(
        BLENDERS[args.blender],
        args.method,
        args.samples,
        args.noise,
        args.most,
        args.seconds,
        args.threads,
        args.out.resolve(),
    )
    (options.out / "work").mkdir(parents=True, exist_ok=True)
    about = (
        f"{time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime())}, Blender {args.blender}, "
        f"{_machine.processor()}; Specula's method is {args.method}. {args.samples} samples for "
        f"each render, 2 to {args.most} of them, until a block's noise is {args.noise:.2%}. "
        f"Command: ./dev parity {shlex.join(sys.argv[1:])}"
    )
    results = examine(names, options, about)
    print("; ".join(f"{name}: {n}" for name, n in _page.counts(results).items() if n))
    print(options.out / "index.html")
    return 1 if any(found.verdict in _verdict.BAD for found in results) else 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
