# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the reference images by brute-force path tracing; about half an hour.

usage, in the project's root: /usr/bin/python3 -m tests.images.make_references [NAME ...]

NAME is a scene, or cornell_cycles, which Cycles renders in today's Blender; all by default. A
reference is to be made anew only if a scene, or what Blender's features mean, has changed: it is
what the estimators are held against.
"""

from __future__ import annotations

import argparse
import dataclasses
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.images import _cases, _children, _reference, _statistics
from tests.images._cases import AUTOMATIC, CASES, CORNELL, GLITTERING, Case

PARTS = 8  # of a render, each with a line of progress
LIMIT = 100_000  # bytes of a file


@dataclass(frozen=True)
class Recipe:
    case: Case
    host: str
    settings: dict
    version: str


RECIPES = {
    case.name: Recipe(
        dataclasses.replace(case, glints="OFF"),
        "blender",
        {
            "method": "PT",
            "samples": case.reference_samples,
            "seed": _cases.REFERENCE_SEED,
            "parts": PARTS,
            "max_bounces": case.max_bounces,
        },
        "Specula, path tracing, Blender 3.4.1",
    )
    for case in (*CASES.values(), *GLITTERING.values(), AUTOMATIC)
} | {
    "cornell_cycles": Recipe(
        CORNELL,
        "bpy",
        {
            "engine": "CYCLES",
            "samples": _cases.CYCLES_SAMPLES,
            "seed": _cases.REFERENCE_SEED,
            "parts": _cases.CYCLES_PARTS,
        },
        "Cycles, path tracing, Blender 5.0.1",
    )
}


def make(name: str, recipe: Recipe, scale: float, target: Path) -> None:
    """Renders one reference and says how good it is."""
    settings = dict(recipe.settings)
    parts = settings["parts"]
    settings["samples"] = max(2, round(settings["samples"] * scale / parts)) * parts
    with tempfile.TemporaryDirectory() as folder:
        result = _children.render(
            recipe.host, recipe.case, {name: settings}, Path(folder), show=True
        )
    image = result.images[name]
    about = {
        "scene": recipe.case.name,
        "samples": str(settings["samples"]),
        "seed": str(settings["seed"]),
        "lightFactor": f"{recipe.case.light_factor:g}",
        "worldTexels": str(recipe.case.texels),
        "maxBounces": str(recipe.case.max_bounces),
        "renderer": recipe.version,
        "seconds": f"{image.stats['seconds']:.0f}",
        "date": time.strftime("%Y-%m-%d"),
    }
    path = target / f"{name}.exr"
    _reference.write(path, image.mean, image.variance, about)
    stored = _reference.read(path)
    error = _statistics.total_error(stored) / _statistics.total(stored.mean)
    print(f"{path.name}: {path.stat().st_size} bytes, {image.stats['seconds']:.0f} s")
    print(f"  mean {np.round(stored.mean.mean(axis=(0, 1)), 5)}, relative error {error}")
    if path.stat().st_size > LIMIT:
        raise SystemExit(f"{path} is larger than {LIMIT} bytes")


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="make_references", description="Render the reference images anew."
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=" ".join(RECIPES))
    parser.add_argument(
        "--scale", type=float, default=1.0, help="factor on the samples, for trials"
    )
    parser.add_argument(
        "--target", type=Path, default=_reference.FOLDER, help="folder of the files"
    )
    args = parser.parse_args()
    for name in args.names:
        if name not in RECIPES:
            parser.error(f"no reference '{name}'; there are: {' '.join(RECIPES)}")
    args.target.mkdir(parents=True, exist_ok=True)
    for name in args.names or RECIPES:
        make(name, RECIPES[name], args.scale, args.target)


if __name__ == "__main__":
    main()
