# SPDX-License-Identifier: GPL-3.0-or-later
"""How long an artist waits for the rendered viewport, beside Cycles in the same Blender.

A window of 1280 x 720 pixels of Debian's Blender, on a display without graphics card. Both engines
take turns, each in a process of its own, which edits the scene and watches what is drawn:

    enter      rendered mode is chosen; the export counts
    camera     the camera moves
    material   a colour changes
    object     an object moves
    interrupt  an object moves while a picture is refined

`first` is the time from the edit to the end of the first redraw that shows another picture, coarse
as it may be. `held` is the longest call of the engine until then: Blender stands still meanwhile.
Medians over all rounds, in ms, and Specula's over Cycles'. It writes DIR/live.json. The exit code
is 0 if all was measured, whether or not it meets the targets.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
from pathlib import Path

from tests.instruments.bench import _children, _program
from tools.common import BUILD, ROOT

FOLDER = BUILD / "bench" / "live-runs"
DEFAULT_OUT = BUILD / "bench" / "live"
SCRIPT = "_live_job.py"
ENGINES = ("SPECULA", "CYCLES")

# Name -> what the job edits.
SCENES = {
    "pool": {
        "scene": str(ROOT / "blend_scenes" / "swimming_pool.blend"),
        "material": "Coping stone",
        "object": "Coping front",
    },
    "hills": {"scene": None, "triangles": 500_000, "material": "Hills", "object": "Block"},
}
# Most ms that Specula should take until there is a picture, and hold Blender.
TARGETS = {
    ("enter", "first"): 700.0,
    ("camera", "first"): 100.0,
    ("material", "first"): 200.0,
    ("object", "first"): 250.0,
    ("interrupt", "held"): 50.0,
}


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev bench live",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--out", type=Path, default=DEFAULT_OUT, metavar="DIR", help="(%(default)s)"
    )
    parser.add_argument("--only", default=",".join(SCENES), help="scenes, of: %(default)s")
    parser.add_argument("--turns", type=int, default=2, help="processes of each (%(default)s)")
    parser.add_argument("--rounds", type=int, default=3, help="in each process (%(default)s)")
    args = parser.parse_args()
    unknown = set(_program.split(args.only)) - set(SCENES)
    if unknown:
        parser.error(f"unknown: {', '.join(sorted(unknown))}; there are: {', '.join(SCENES)}")
    if min(args.turns, args.rounds) < 1:
        parser.error("--turns and --rounds are at least 1")
    return args


def measured(scene: str, args: argparse.Namespace) -> dict[str, dict]:
    """Engine -> step -> `first` and `held` -> ms, of all rounds."""
    found: dict[str, dict] = {engine: {} for engine in ENGINES}
    for turn in range(args.turns):
        for engine in ENGINES:
            job = SCENES[scene] | {"engine": engine, "rounds": args.rounds}
            name = f"{scene}-{engine.lower()}-{turn}"
            run = _children.run(name, "debian window", SCRIPT, job, FOLDER)
            for step, values in run.report.items():
                for what, seconds in values.items():
                    known = found[engine].setdefault(step, {}).setdefault(what, [])
                    known += [1000.0 * value for value in seconds]
    return found


def rows(scene: str, found: dict[str, dict]) -> list[str]:
    lines = []
    for step, values in found["SPECULA"].items():
        for what in values:
            ours, theirs = (statistics.median(found[engine][step][what]) for engine in ENGINES)
            target = TARGETS.get((step, what))
            wanted = f", wanted {target:.0f}" if target else ""
            ratio = f", ratio {ours / theirs:.2f}" if theirs > 0.0 else ""
            lines.append(
                f"{scene:6} {step:9} {what:5} {ours:7.1f} ms, Cycles {theirs:7.1f}{ratio}{wanted}"
            )
    return lines


def main() -> int:
    args = arguments()
    load = _program.load_before("live")
    for folder in (FOLDER, args.out):
        folder.mkdir(parents=True, exist_ok=True)
    _program.freeze_library("live")
    found = {}
    for scene in _program.split(args.only):
        found[scene] = measured(scene, args)
        print("\n".join(rows(scene, found[scene])), flush=True)
    about = {"turns": args.turns, "rounds": args.rounds, "load": load}
    path = args.out / "live.json"
    path.write_text(json.dumps({"about": about, "ms": found}, indent=1) + "\n")
    print(path)
    return 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
