# SPDX-License-Identifier: GPL-3.0-or-later
"""`specula merge`: adds up part files, without Blender.

    python3 -m specula.merge PARTS... -o OUT.exr [--part OUT.part]

Exit codes: 0 all samples are there; 1 a part cannot be used, nothing is written; 3 samples are
missing, the picture is of those that are there.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from . import native, parts

INCOMPLETE = 3


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="specula merge", description="Adds up part files.")
    parser.add_argument("parts", nargs="+", type=Path, metavar="PART")
    parser.add_argument("-o", "--out", type=Path, help="the picture, a multilayer EXR")
    parser.add_argument("--part", type=Path, help="the sum, as a part file")
    arguments = parser.parse_args(argv)
    try:
        whole = parts.merge(arguments.parts)
        if arguments.part:
            whole.write(arguments.part)
        if arguments.out:
            parts.write_picture(whole, arguments.out)
    except (parts.PartError, native.NativeError, OSError) as error:
        print(f"specula merge: {error}", file=sys.stderr)
        return 1
    header = whole.header
    if header.is_complete():
        return 0
    there = ", ".join(f"{first}:{end}" for first, end in header.ranges)
    print(f"specula merge: {there} of {header.total_samples} samples are there", file=sys.stderr)
    return INCOMPLETE


if __name__ == "__main__":
    sys.exit(main())
