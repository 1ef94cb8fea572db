# SPDX-License-Identifier: GPL-3.0-or-later
"""How caustics and glints flicker: frames of moving scenes, beside references of the same frames.

The scenes are the examples, moved by a script: a turning slab of glass, waves in the pool, a lamp
that moves around a glass ball, a camera around the ring and around the shoes. Each method renders
each frame for as long as the others. In the pixels that see caustics in some frame (of the shoes in
all) it tells

    noise     standard deviation from frame to frame of what the references do not have
    variance  over time, by that of the references
    pops      largest deviation of a frame's brightness from the mean deviation

the first and the last by the mean of the references, which are renders of many samples with other
seeds; their own noise counts. It writes DIR/animation.json and a strip of each animation.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
from pathlib import Path

import numpy as np

from tests.instruments.bench import _children, _flicker, _program
from tools.common import BUILD, ROOT

FOLDER = BUILD / "bench" / "animation-runs"
DEFAULT_OUT = BUILD / "bench" / "animation"
SCRIPT = "_animation_job.py"

# Name -> example scene and motion of _animation_job.py.
SCENES = {
    "glass": ("slab", "turning_glass"),
    "waves": ("swimming_pool", "waves"),
    "lamp": ("refractive_sphere", "moving_lamp"),
    "camera": ("ring", "moving_camera"),
    "shoes": ("shoes", "moving_camera"),
}
# Name -> engine and fields of spc_render_settings.
METHODS = {
    "specula": ("SPECULA", {"method": "AUTO"}),
    "specula-lt": ("SPECULA", {"method": "LT"}),
    "cycles": ("CYCLES", {}),
}
REFERENCE_SEED, SEED = 1_000_000, 1
MOST_SAMPLES = 1 << 16


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev bench animation",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--out", type=Path, default=DEFAULT_OUT, metavar="DIR", help="(%(default)s)"
    )
    parser.add_argument("--only", default=",".join(SCENES), help="scenes, of: %(default)s")
    parser.add_argument("--methods", default=",".join(METHODS), help="of: %(default)s")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--size", type=int, default=128, help="pixels along an edge (%(default)s)")
    parser.add_argument("--seconds", type=float, default=4.0, help="for a frame (%(default)s)")
    parser.add_argument(
        "--reference-samples", type=int, default=1024, metavar="N", help="(%(default)s)"
    )
    parser.add_argument(
        "--changing-seeds", action="store_true", help="a seed for each frame, not one for all"
    )
    args = parser.parse_args()
    for names, known in ((args.only, SCENES), (args.methods, METHODS)):
        unknown = set(_program.split(names)) - set(known)
        if unknown:
            parser.error(f"unknown: {', '.join(sorted(unknown))}; there are: {', '.join(known)}")
    if args.frames < 2:
        parser.error("--frames must be at least 2")
    return args


def rendered(name: str, scene: str, args: argparse.Namespace, **job) -> dict[str, np.ndarray]:
    blend, motion = SCENES[scene]
    pictures = FOLDER / f"{name}.npz"
    job |= {
        "scene": str(ROOT / "blend_scenes" / f"{blend}.blend"),
        "motion": motion,
        "frames": args.frames,
        "size": [args.size, args.size],
        "pictures": str(pictures),
        "strip": str(args.out / f"{name}.png"),
    }
    _children.run(name, "specula in bpy", SCRIPT, job, FOLDER, limit=6 * 3600.0)
    with np.load(pictures) as arrays:
        return {key: arrays[key].astype(np.float64) for key in arrays}


def flicker_of(scene: str, args: argparse.Namespace) -> dict[str, _flicker.Flicker]:
    """By method."""
    reference = rendered(
        f"{scene}-reference",
        scene,
        args,
        engine="SPECULA",
        settings={"method": "AUTO"},
        samples=args.reference_samples,
        seconds=0.0,
        seed=REFERENCE_SEED,
        changing=True,
    )
    mask = _flicker.caustics_mask(reference["caustics"], reference["combined"])
    found = {}
    for method in _program.split(args.methods):
        engine, settings = METHODS[method]
        frames = rendered(
            f"{scene}-{method}",
            scene,
            args,
            engine=engine,
            settings=settings,
            samples=MOST_SAMPLES,
            seconds=args.seconds,
            seed=SEED,
            changing=args.changing_seeds,
        )
        found[method] = _flicker.measure(frames["combined"], reference["combined"], mask)
        told = found[method]
        print(
            f"{scene:8} {method:12} noise {told.noise:.4f}  variance {told.variance_ratio:.3f}"
            f"  pops {told.pops:.4f}",
            flush=True,
        )
    return found


def main() -> int:
    args = arguments()
    _program.load_before("animation")
    for folder in (FOLDER, args.out):
        folder.mkdir(parents=True, exist_ok=True)
    _program.freeze_library("animation")
    found = {scene: flicker_of(scene, args) for scene in _program.split(args.only)}
    about = {name: value for name, value in vars(args).items() if name != "out"}
    rows = {
        scene: {method: dataclasses.asdict(told) for method, told in methods.items()}
        for scene, methods in found.items()
    }
    path = args.out / "animation.json"
    path.write_text(json.dumps({"about": about, "flicker": rows}, indent=1) + "\n")
    print(path)
    return 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
