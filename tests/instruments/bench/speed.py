# SPDX-License-Identifier: GPL-3.0-or-later
"""How fast Specula is: ratios to Cycles and to itself, both sides measured in one run.

Each measurement has one or two sides. Each side is a child process; the two take turns (A B A B
...), and the ratio is taken round by round, so that whatever else the machine does hits both. The
median over the rounds is held against the target; the extremes tell how far it can be trusted. The
exit code is 0 if every measurement came to a number, whether or not that number meets its target.

a  Samples per second of path tracing. A render's fixed costs cancel in the slope of its time over
   two numbers of samples, N and 3 N, taken in the same way from both engines.
b  Wall time of a small render from the start of the process to its end: importing bpy, opening the
   file, export, render, PNG. Cycles' process does not load the addon, Specula's does. Cycles' own
   manifold walks are off, as it renders the same path tracing.
c  Two threads against one, by that slope.
d  Seconds from a mesh of a million triangles in Blender to a scene that is ready to render.
e  What the automatic method costs beside path tracing where there are no casters, likewise.
f  Samples that walks without light paths make in half a minute, beside path tracing. The targets
   are what the authors' code of [Zeltner20] made of its own scenes of the kind, on two threads of
   another machine: a yardstick, not a comparison.
g  Scenes as large as artists' are, by path tracing, beside Cycles: samples per second as in a,
   seconds from the call to the end of a first picture of one sample, and the process's peak memory.
   An interior of twenty materials, and ten thousand instances of leaves that an image cuts out.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

from tests.instruments.bench import _children, _machine, _program, _ratios
from tests.instruments.bench._children import Progress, Run
from tests.instruments.bench._ratios import MeasurementError, Target
from tests.instruments.field.field import make as make_scenes
from tools import venvs
from tools.common import BUILD, ROOT

FOLDER = BUILD / "bench" / "speed"
SCENES = ROOT / "blend_scenes"
PARTS = "abcdefg"
CYCLES = f"Cycles {venvs.BPY_VERSION}"
THREADS = 2
SMALL = {"size": [480, 270], "samples": [16]}
# Two engines that render the same scene agree far better than this, even with few samples.
SAME_MEAN = 0.02


@dataclass(frozen=True)
class Side:
    """One kind of child process."""

    label: str
    where: str  # of _children.HOSTS
    script: str
    job: dict
    guess: float  # seconds of the child, for the expected end


@dataclass(frozen=True)
class Measurement:
    """`value` of each side; with two sides the result is the first's over the second's."""

    part: str
    name: str  # of files
    what: str
    sides: tuple[Side, ...]
    value: Callable[[Run], float]
    unit: str  # of the value; a ratio has none
    target: Target
    of_first: bool = False  # the target is for the first side's value, not for the ratio
    information: bool = False  # the target is not one that Specula promises for this scene
    warm_up: bool = False  # a round that does not count comes first

    def guess(self, rounds: int) -> float:
        return (rounds + self.warm_up) * sum(side.guess for side in self.sides)


@dataclass
class Result:
    """What came of a measurement. `values` has a list for each side, `runs` likewise."""

    measurement: Measurement
    values: list[list[float]] = field(default_factory=list)
    runs: list[list[Run]] = field(default_factory=list)
    spread: _ratios.Spread | None = None
    notes: list[str] = field(default_factory=list)
    error: str = ""


# ------------------------------------------------------------------------------- what to measure


def sample_rate(run: Run) -> float:
    """Millions of pixel samples per second."""
    return run.report["pixels"] / slope(run, "seconds") / 1e6


def processor_time(run: Run) -> float:
    """Of all threads in seconds, for one sample of every pixel."""
    return slope(run, "cpu_seconds")


def slope(run: Run, clock: str) -> float:
    """Seconds by `clock` for one more sample of every pixel."""
    return _ratios.seconds_per_sample(
        [(row["samples"], row[clock]) for row in run.report["renders"]]
    )


def wall_time(run: Run) -> float:
    return run.wall_seconds


def samples_in_half_a_minute(run: Run) -> float:
    return 30.0 / slope(run, "seconds")


def export_and_commit(run: Run) -> float:
    return run.report["export_seconds"] + run.report["commit_seconds"]


def first_picture(run: Run) -> float:
    return run.report["first"]["seconds"]


def peak_memory(run: Run) -> float:
    return run.peak_memory / 1e6


def render_side(label: str, name: str, guess: float, /, **job) -> Side:
    """A render with Specula if `job` names a method, else with Cycles. `name` is of one of
    blend_scenes/ unless `job` says where it is."""
    engine, where = ("SPECULA", "specula in bpy") if "method" in job else ("CYCLES", "bpy")
    job = {"scene": str(SCENES / f"{name}.blend"), "engine": engine, "threads": THREADS} | job
    return Side(label, where, "_render_job.py", job, guess)


def tripled(samples: int) -> list[int]:
    """Two numbers of samples for a slope."""
    return [samples, 3 * samples]


def rates(samples: int) -> Iterator[Measurement]:
    job = {"size": [512, 512], "samples": tripled(samples), "mean": True}
    yield Measurement(
        "a",
        "samples",
        f"samples per second, path tracing, cornell 512x512, {THREADS} threads, Specula / {CYCLES}",
        (
            render_side("Specula", "cornell", 2 + 0.8 * samples, method="PT", **job),
            render_side("Cycles", "cornell", 2 + 1.2 * samples, **job),
        ),
        sample_rate,
        " M/s",
        Target(1.3, at_least=True),
    )


def walls(_: int) -> Iterator[Measurement]:
    for scene, information in (("cornell", False), ("swimming_pool", True)):
        picture = str(FOLDER / f"wall_{scene}_")
        yield Measurement(
            "b",
            f"wall_{scene}",
            f"wall time of a whole process, path tracing, {scene} 480x270, 16 samples, "
            f"{THREADS} threads, Specula / {CYCLES}",
            (
                render_side(
                    "Specula", scene, 4, method="PT", picture=f"{picture}specula.png", **SMALL
                ),
                render_side("Cycles", scene, 4, picture=f"{picture}cycles.png", **SMALL),
            ),
            wall_time,
            " s",
            Target(1.0, at_least=False),
            information,
            warm_up=True,  # the first process of all waits for the disk
        )


def scaling(samples: int) -> Iterator[Measurement]:
    # The plane's pixels cost far more each: fewer of them, and fewer samples.
    plane = {"size": [270, 270], "method": "SMS_UNBIASED", "samples": tripled(samples // 4)}
    box = {"size": [512, 512], "method": "PT", "samples": tripled(samples)}
    for scene, job in (("cornell", box), ("reflective_plane", plane)):
        yield Measurement(
            "c",
            f"threads_{scene}",
            f"samples per second, {job['method']}, {scene} {job['size'][0]}x{job['size'][1]}, "
            "Specula with 2 threads / with 1",
            (
                render_side("2 threads", scene, 2 + 0.8 * samples, **job, threads=2),
                render_side("1 thread", scene, 2 + 1.6 * samples, **job, threads=1),
            ),
            sample_rate,
            " M/s",
            Target(1.85, at_least=True),
        )


def grids(_: int) -> Iterator[Measurement]:
    for where, version in (("specula in bpy", venvs.BPY_VERSION), ("debian", "3.4.1")):
        for tangents in (False, True):
            job = {"tangents": tangents, "threads": THREADS}
            yield Measurement(
                "d",
                f"grid_{version}{'_tangents' * tangents}",
                f"export and commit of a million triangles, UVs {'and' if tangents else 'without'} "
                f"tangents, Blender {version}",
                (Side("Specula", where, "_grid_job.py", job, 8),),
                export_and_commit,
                " s",
                Target(4.0, at_least=False),
                information=True,
            )


def without_casters(samples: int) -> Iterator[Measurement]:
    job = {"size": [512, 512], "samples": tripled(samples), "mean": True}
    guess = 2 + 0.8 * samples
    yield Measurement(
        "e",
        "without_casters",
        f"time of a sample without casters, cornell 512x512, {THREADS} threads, AUTO / PT",
        (
            render_side("automatic", "cornell", guess, method="AUTO", **job),
            render_side("path tracing", "cornell", guess, method="PT", **job),
        ),
        lambda run: slope(run, "seconds"),
        " s",
        Target(1.02, at_least=False),
    )


# Scene: size, the chains that its caustic has, samples of the authors' code.
YARDSTICKS = {
    "reflective_plane": ([270, 270], "R", 4),
    "refractive_sphere": ([270, 270], "T", 52),
    "slab": ([270, 270], "TT", 38),
    "swimming_pool": ([480, 270], "T", 17),
}


def yardsticks(samples: int) -> Iterator[Measurement]:
    for scene, (size, family, theirs) in YARDSTICKS.items():
        job = {"size": size, "samples": tripled(samples)}
        walks = {"light_tracing": "OFF", "chain_family": family}
        yield Measurement(
            "f",
            f"yardstick_{scene}",
            f"samples in 30 s, {scene} {size[0]}x{size[1]}, {THREADS} threads, "
            f"SMS_UNBIASED of chains {family} / PT",
            (
                render_side("SMS", scene, 4 * samples, method="SMS_UNBIASED", specula=walks, **job),
                render_side("PT", scene, 2 + samples, method="PT", **job),
            ),
            samples_in_half_a_minute,
            "",
            Target(theirs, at_least=True),
            of_first=True,
        )


LARGE = ("interior_of_many_materials", "meadow_of_leaves")


def large(samples: int) -> Iterator[Measurement]:
    names = [name for name in LARGE if not (FOLDER / f"{name}.blend").exists()]
    if names:
        make_scenes(FOLDER, names)
    kinds = (
        ("samples", "samples per second", tripled(samples), sample_rate, " M/s", Target(1.3, True)),
        ("first", "time of a first picture", [], first_picture, " s", Target(1.0, False)),
        ("memory", "peak memory", [], peak_memory, " MB", Target(1.0, False)),
    )
    for name in LARGE:
        for kind, what, counts, value, unit, target in kinds:
            job = {"scene": str(FOLDER / f"{name}.blend"), "size": [480, 480], "samples": counts}
            job |= {"mean": True}
            guess = 8 + 2 * sum(counts)
            yield Measurement(
                "g",
                f"{kind}_{name}",
                f"{what}, path tracing, {name} 480x480, {THREADS} threads, Specula / {CYCLES}",
                (
                    render_side("Specula", name, guess, method="PT", **job),
                    render_side("Cycles", name, guess, **job),
                ),
                value,
                unit,
                target,
            )


MAKERS = {
    "a": rates,
    "b": walls,
    "c": scaling,
    "d": grids,
    "e": without_casters,
    "f": yardsticks,
    "g": large,
}
# Samples that take a few seconds each, so that the slope is not noise.
SAMPLES = {"a": 20, "b": 0, "c": 16, "d": 0, "e": 20, "f": 4, "g": 6}
QUICK_SAMPLES = {"a": 4, "b": 0, "c": 4, "d": 0, "e": 4, "f": 1, "g": 1}


# ----------------------------------------------------------------------------------- measuring


def measure(measurement: Measurement, rounds: int, progress: Progress) -> Result:
    """All rounds; an error ends this measurement, not the program."""
    sides = measurement.sides
    result = Result(measurement, [[] for _ in sides], [[] for _ in sides])
    todo = measurement.guess(rounds)
    try:
        for number in range(1 - measurement.warm_up, rounds + 1):
            for i, side in enumerate(sides):
                title = f"round {number} of {rounds}" if number else "warming up"
                progress.show(f"{measurement.part} {measurement.name}, {side.label}, {title}")
                name = f"{measurement.name}_{side.label}".replace(" ", "_").lower()
                run = _children.run(name, side.where, side.script, side.job, FOLDER)
                progress.advance(side.guess)
                todo -= side.guess
                if number:
                    result.values[i].append(measurement.value(run))
                    result.runs[i].append(run)
        ratios = _ratios.round_ratios(*result.values) if len(sides) == 2 else result.values[0]
        result.spread = _ratios.spread(ratios)
        result.notes = notes(result)
    except MeasurementError as error:
        result.error = str(error)
        progress.skip(todo)
    return result


def notes(result: Result) -> list[str]:
    """What the reader should know beside the number."""
    reports = [runs[-1].report for runs in result.runs]
    found = []
    if all("renders" in report for report in reports):
        costs = [[processor_time(run) for run in runs] for runs in result.runs]
        ratio = _ratios.spread(_ratios.round_ratios(*costs)).text()
        first, second = (side.label for side in result.measurement.sides)
        found.append(
            f"processor time per sample, which suffers less from others: {first} / {second} {ratio}"
        )
    if all("mean" in report for report in reports):
        means = [report["mean"] for report in reports]
        difference = _ratios.relative_difference(*means)
        same = "the same picture" if difference <= SAME_MEAN else "NOT THE SAME PICTURE"
        found.append(f"means of the two pictures differ by {difference:.2%}: {same}")
    for report in reports:
        if report.get("renders") and report["renders"][-1].get("trials"):
            row = report["renders"][-1]
            found.append(
                f"{row['success']:.1%} of the walks succeed, {row['trials']:.1f} trials a solution"
            )
        if "export_seconds" in report:
            found.append(
                f"last round: {report['triangles']} triangles, {report['export_seconds']:.2f} s "
                f"export, {report['commit_seconds']:.2f} s commit"
            )
        found += [f"warning: {warning}" for warning in report.get("warnings", [])]
    return found


# ----------------------------------------------------------------------------------- reporting


def targeted(result: Result) -> float:
    """What is held against the target."""
    if result.measurement.of_first:
        return _ratios.spread(result.values[0]).median
    return result.spread.median


def verdict(result: Result) -> str:
    """Target, and whether the median meets it."""
    measurement = result.measurement
    unit = measurement.unit if len(measurement.sides) == 1 else ""
    met = "met" if measurement.target.met(targeted(result)) else "MISSED"
    aim = "for information, aim" if measurement.information else "target"
    if measurement.of_first:
        aim += f" of {measurement.sides[0].label}"
    return f"{aim} {measurement.target.text(unit)}: {met}"


def text(result: Result) -> str:
    """The measurement's line, and indented what it comes from."""
    measurement = result.measurement
    head = f"{measurement.part}  {measurement.what}: "
    if result.error:
        return f"{head}FAILED\n   {result.error}"
    single = len(measurement.sides) == 1
    number = result.spread.text(measurement.unit if single else "")
    lines = [f"{head}{number}, {verdict(result)}"]
    if not single:
        parts = (
            f"{side.label} {_ratios.spread(values).text(measurement.unit)}"
            for side, values in zip(measurement.sides, result.values, strict=True)
        )
        lines.append(f"   {'; '.join(parts)}")
    return "\n".join(lines + [f"   {note}" for note in result.notes])


def record(result: Result) -> dict:
    """For the JSON file."""
    measurement, spread = result.measurement, result.spread
    sides = zip(measurement.sides, result.values, result.runs, strict=True)
    return {
        "part": measurement.part,
        "name": measurement.name,
        "what": measurement.what,
        "is_ratio": len(measurement.sides) == 2,
        "unit": measurement.unit.strip(),
        "result": asdict(spread) if spread else None,
        "target": asdict(measurement.target),
        "met": measurement.target.met(targeted(result)) if spread else None,
        "information": measurement.information,
        "error": result.error or None,
        "notes": result.notes,
        "sides": [
            {
                "label": side.label,
                "job": side.job,
                "values": values,
                "runs": [asdict(run) for run in runs],
            }
            for side, values, runs in sides
        ],
    }


def summary(results: list[Result]) -> str:
    """How many targets are met; what failed."""
    promised = [r for r in results if r.spread and not r.measurement.information]
    met = sum(r.measurement.target.met(targeted(r)) for r in promised)
    failed = [r.measurement.name for r in results if r.error]
    line = f"{met} of {len(promised)} targets met"
    return f"{line}; failed: {' '.join(failed)}" if failed else line


# ---------------------------------------------------------------------------------- command line


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev bench speed",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--rounds", type=int, help="turns of each side (default 3, quick 1)")
    parser.add_argument(
        "--quick", action="store_true", help="few samples: whether all works, not how fast it is"
    )
    parser.add_argument("--only", default=",".join(PARTS), help="parts, such as a,c (default all)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write everything as JSON")
    args = parser.parse_args()
    args.only = [part.strip() for part in args.only.split(",") if part.strip()]
    for part in args.only:
        if part not in MAKERS:
            parser.error(f"no part '{part}'; there are: {' '.join(MAKERS)}")
    if not args.only:
        parser.error("--only names no part")
    if args.rounds is None:
        args.rounds = 1 if args.quick else 3
    if args.rounds < 1:
        parser.error("--rounds must be at least 1")
    if args.out and not args.out.parent.is_dir():
        parser.error(f"there is no folder {args.out.parent}")
    return args


def main() -> int:
    args = arguments()
    load = _program.load_before("speed")
    samples = QUICK_SAMPLES if args.quick else SAMPLES
    measurements = [
        measurement
        for part in PARTS
        if part in args.only
        for measurement in MAKERS[part](samples[part])
    ]
    FOLDER.mkdir(parents=True, exist_ok=True)
    _program.freeze_library("speed")
    print(
        f"Specula's speed on {_machine.processor()}, load average {load:.2f} at the start"
        f"{'; QUICK: not a measurement' if args.quick else ''}",
        flush=True,
    )
    results, started, before = [], time.time(), _machine.CpuTimes.now()
    progress = Progress("speed", (measurement.guess(args.rounds) for measurement in measurements))
    for measurement in measurements:
        results.append(measure(measurement, args.rounds, progress))
        progress.clear()
        print(text(results[-1]), flush=True)
    others = before.others_share(_machine.CpuTimes.now())
    _program.warn_of_others("speed", others)
    print(summary(results))
    if args.out:
        document = {
            "started": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(started)),
            "processor": _machine.processor(),
            "load_average": load,
            "others_share": others,
            "rounds": args.rounds,
            "quick": args.quick,
            "measurements": [record(result) for result in results],
        }
        args.out.write_text(json.dumps(document, indent=1) + "\n")
        print(f"written: {args.out}")
    return 1 if any(result.error for result in results) else 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
