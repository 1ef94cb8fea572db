# SPDX-License-Identifier: GPL-3.0-or-later
"""How fast the core's hot kernels are, one by one, on one core.

Builds the programs of tests/instruments/bench/native (preset bench) and runs the one for this
processor: Google Benchmark times each kernel over a batch of inputs drawn with fixed random
numbers, in several repetitions. Rates count processor time, so that they are per core; the spread
is that of the repetitions. A kernel first proves that it does what its name says, or fails.

newton    Newton iterations of walks from seeds that stand ready, success and failure as it comes
walk      whole random walks, seeds included
seed      candidates for seeds
surface   from a hit to closures; geometry: to the local shape with derivatives, as walks ask for it
sample    of a material's closures; eval: their value and density
closest   ray casts, from a hundred to a million triangles; occluded: shadow rays
glints    light averaged over a footprint: by search, random walks, and Gaussians; prepare: what a
          map needs for it beforehand

The exit code is 0 if every kernel came to a number, whether or not the promised ones meet their
targets.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from tests.instruments.bench import _children, _machine, _program, _ratios
from tests.instruments.bench._ratios import MeasurementError, Spread, Target
from tools import host
from tools.build import build
from tools.common import BUILD

FOLDER = BUILD / "bench" / "kernels"
SECONDS = 0.5  # of each repetition, at least
REPETITIONS = 5
# What Google Benchmark says of each run; everything else is a counter of the kernel's own.
KNOWN_KEYS = {
    *("name", "run_name", "run_type", "label", "error_occurred", "error_message", "time_unit"),
    *("family_index", "per_family_instance_index", "repetitions", "repetition_index", "threads"),
    *("iterations", "real_time", "cpu_time", "items_per_second"),
}


@dataclass(frozen=True)
class Promise:
    """A number that Specula promises of a kernel."""

    kernel: str
    what: str
    target: Target
    items: int | None = None  # seconds for so many, else millions of items per second

    @property
    def unit(self) -> str:
        return " s" if self.items else " M/s"

    def value(self, rate: float) -> float:
        """Of items per second."""
        return self.items / rate if self.items else rate / 1e6


PROMISES = (
    Promise(
        "newton/reflective_plane/angle_difference",  # by the constraint that renders use
        "Newton iterations per second and core on reflective_plane",
        Target(1.0, at_least=True),
    ),
    *(
        Promise(
            f"glints/prepare_{kind}_4096",
            f"Preparing a map of 4096 x 4096 {kind} for glints, on one core",
            Target(2.0, at_least=False),
            items=4096 * 4096,
        )
        for kind in ("normals", "heights")
    ),
)


@dataclass(frozen=True)
class Kernel:
    """What came of one kernel: rates, or an error."""

    name: str
    item: str = ""  # what is counted
    per_second: Spread | None = None  # items per second and core
    counters: dict[str, float] = field(default_factory=dict)
    error: str = ""

    @property
    def nanoseconds(self) -> float:
        """For one item."""
        return 1e9 / self.per_second.median


def read(document: dict, names: Sequence[str]) -> list[Kernel]:
    """A kernel for each of `names` from Google Benchmark's JSON."""
    runs = {name: [] for name in names}
    for run in document.get("benchmarks", []):
        # Aggregates repeat what the repetitions say.
        if run.get("run_type") == "iteration" and run["run_name"] in runs:
            runs[run["run_name"]].append(run)
    return [_kernel(name, found) for name, found in runs.items()]


def _kernel(name: str, runs: Sequence[dict]) -> Kernel:
    if not runs:
        return Kernel(name, error="is missing in the program's output")
    for run in runs:
        if run.get("error_occurred"):
            return Kernel(name, error=run.get("error_message", "failed without a message"))
        if not run.get("items_per_second", 0.0) > 0.0:
            return Kernel(name, error="counted nothing")
    counters = {key: value for key, value in runs[0].items() if key not in KNOWN_KEYS}
    rates = _ratios.spread([run["items_per_second"] for run in runs])
    return Kernel(name, runs[0].get("label", ""), rates, counters)


# ----------------------------------------------------------------------------------- reporting


def table(kernels: Sequence[Kernel]) -> str:
    """A line for each kernel."""
    width = max(len(kernel.name) for kernel in kernels)
    head = f"{'kernel':{width}}  {'item':10}  {'ns':>8}  {'M/s':>8}  {'low to high':>17}"
    return "\n".join([head, *(_line(kernel, width) for kernel in kernels)])


def _line(kernel: Kernel, width: int) -> str:
    head = f"{kernel.name:{width}}  "
    if kernel.error:
        return f"{head}FAILED: {kernel.error}"
    rate = kernel.per_second
    spread = f"{rate.low / 1e6:.4g} to {rate.high / 1e6:.4g}"
    counters = ", ".join(
        f"{name.replace('_', ' ')} {value:.3g}" for name, value in kernel.counters.items()
    )
    numbers = f"{kernel.nanoseconds:8.1f}  {rate.median / 1e6:8.4g}  {spread:>17}"
    return f"{head}{kernel.item:10}  {numbers}  {counters}".rstrip()


def promises(kernels: Sequence[Kernel]) -> list[str]:
    """A line on each number that Specula promises and that was asked for."""
    found = {kernel.name: kernel for kernel in kernels}
    return [
        f"{promise.what}: {_held(promise, found[promise.kernel])}"
        for promise in PROMISES
        if promise.kernel in found
    ]


def _held(promise: Promise, kernel: Kernel) -> str:
    if kernel.error:
        return "FAILED"
    rate = kernel.per_second
    low, high = sorted((promise.value(rate.low), promise.value(rate.high)))
    value = Spread(promise.value(rate.median), low, high, rate.rounds)
    verdict = "met" if promise.target.met(value.median) else "not met"
    return f"{value.text(promise.unit)}, target {promise.target.text(promise.unit)}: {verdict}"


# ----------------------------------------------------------------------------------- measuring


def build_program() -> Path:
    """The program for this processor."""
    program = f"specula_kernels-{host.instruction_level()}"
    return build("bench", quiet=True, target=program).parent / "bin" / program


def run(program: str | Path, *arguments: str) -> str:
    """What the program prints; raises MeasurementError if it fails."""
    result = subprocess.run([program, *arguments], capture_output=True, text=True)
    if result.returncode != 0:
        words = _children.last_words(result.stderr)
        raise MeasurementError(f"{Path(program).name}: exit code {result.returncode}: {words}")
    return result.stdout


def choose(names: Sequence[str], only: re.Pattern) -> list[str]:
    """Those of `names` in which `only` is found."""
    chosen = [name for name in names if only.search(name)]
    if not chosen:
        raise MeasurementError(f"no kernel matches '{only.pattern}'; there are: {' '.join(names)}")
    return chosen


def measure(program: Path, names: Sequence[str], repetitions: int) -> list[Kernel]:
    output = run(
        program,
        f"--benchmark_filter=^({'|'.join(names)})$",
        f"--benchmark_repetitions={repetitions}",
        f"--benchmark_min_time={SECONDS}",
        "--benchmark_format=json",
    )
    return read(json.loads(output), names)


# ---------------------------------------------------------------------------------- command line


def regular_expression(text: str) -> re.Pattern:
    try:
        return re.compile(text)
    except re.error as error:
        raise argparse.ArgumentTypeError(f"no regular expression: {error}") from None


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="./dev bench kernels",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--only",
        type=regular_expression,
        default=re.compile(""),
        metavar="REGEX",
        help="kernels in whose names it is found (default all)",
    )
    parser.add_argument("--repetitions", type=int, default=REPETITIONS, metavar="N")
    parser.add_argument(
        "--out", type=Path, default=FOLDER, metavar="DIR", help="where kernels.json goes"
    )
    args = parser.parse_args()
    if args.repetitions < 1:
        parser.error("--repetitions must be at least 1")
    return args


def main() -> int:
    args = arguments()
    program = build_program()
    names = choose(run(program, "--benchmark_list_tests").split(), args.only)
    load = _program.load_before("kernels")
    minutes = len(names) * args.repetitions * SECONDS / 60.0
    print(
        f"{len(names)} kernels on one core of {_machine.processor()}, {program.name}, "
        f"{args.repetitions} repetitions, {minutes:.1f} minutes or more",
        flush=True,
    )
    started, before = time.time(), _machine.CpuTimes.now()
    kernels = measure(program, names, args.repetitions)
    others = before.others_share(_machine.CpuTimes.now())
    _program.warn_of_others("kernels", others)
    print(table(kernels))
    for line in promises(kernels):
        print(line)
    document = {
        "started": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(started)),
        "processor": _machine.processor(),
        "program": program.name,
        "load_average": load,
        "others_share": others,
        "repetitions": args.repetitions,
        "promised": [asdict(promise) for promise in PROMISES],
        "kernels": [asdict(kernel) for kernel in kernels],
    }
    args.out.mkdir(parents=True, exist_ok=True)
    file = args.out / "kernels.json"
    file.write_text(json.dumps(document, indent=1) + "\n")
    print(f"written: {file}")
    return 1 if any(kernel.error for kernel in kernels) else 0


if __name__ == "__main__":
    sys.exit(_program.run(main))
