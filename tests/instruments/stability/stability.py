# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders scenes in which methods fail by every method, and says which of them hold.

Each picture is compared, block by block, with an independent truth: brute-force path tracing of a
light with some size, light paths where path tracing is blind, or a closed form. Methods that
Specula renders with by default must hold everywhere; the others may fail where it is known why, and
the table says so. The exit code is 0 unless a method fails that has no excuse.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from tests.instruments.stability import _report
from tests.instruments.stability._cases import CASES
from tests.instruments.stability._measure import METHODS, compare, measure, measure_truth
from tools.common import BUILD


def main(argv: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="./dev stability",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--out", type=Path, default=BUILD / "stability", metavar="DIR")
    parser.add_argument("--cases", help="names that contain one of these, separated by commas")
    parser.add_argument("--methods", help="the same of methods")
    args = parser.parse_args(argv)
    cases, methods = chosen(CASES, args.cases), chosen(METHODS, args.methods)
    if not cases or not methods:
        names = ", ".join(item.name for item in (*CASES, *METHODS))
        parser.error(f"nothing of that name; there are: {names}")

    rows, start = [], time.monotonic()
    for done, case in enumerate(cases):
        truth = measure_truth(case)
        results = {}
        for method in methods:
            if method.name == case.truth:
                continue
            pictures = measure(case, method, 2)
            comparison = compare(pictures, truth, len(cases) * len(methods))
            results[method.name] = _report.Result(case, method, pictures, comparison)
        rows.append((case, results))
        seconds = time.monotonic() - start
        left = seconds / (done + 1) * (len(cases) - done - 1)
        marks = ", ".join(f"{name}: {result.verdict}" for name, result in results.items())
        print(f"{case.name}: {marks}\n[{done + 1}/{len(cases)}, {left:.0f} s left]", flush=True)
    names = [method.name for method in methods]
    _report.write(args.out, rows, names)
    print(_report.text(rows, names))
    print(f"{args.out}/index.html")
    failed = [r for _, results in rows for r in results.values() if r.verdict == _report.FAILS]
    return 1 if failed else 0


def chosen(items, names: str | None):
    if names is None:
        return items
    return [item for item in items if any(name in item.name for name in names.split(","))]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
