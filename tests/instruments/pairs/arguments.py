# SPDX-License-Identifier: GPL-3.0-or-later
"""What the programs that render pairs are all asked for."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from tools.common import BUILD

BLENDERS = {  # of _children.HOSTS
    "3.4": "debian",
    "4.5": "specula in bpy 4.5",
    "5.0": "specula in bpy",
}


def add_shared(
    parser: argparse.ArgumentParser, folder: str, blender: str, samples: int, only: str
) -> None:
    """--blender, --samples, --threads, --out, which is `folder` of the build, and --only, with the
    help `only`."""
    parser.add_argument("--only", metavar="PATTERNS", help=only)
    parser.add_argument("--blender", choices=BLENDERS, default=blender, help="(%(default)s)")
    parser.add_argument("--samples", type=int, default=samples, help="of each render (%(default)s)")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument(
        "--out", type=Path, default=BUILD / folder, metavar="DIR", help="(%(default)s)"
    )
