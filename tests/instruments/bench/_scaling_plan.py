# SPDX-License-Identifier: GPL-3.0-or-later
"""What `./dev bench scaling` changes, what it measures of each point, and measuring it in turns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import isqrt
from pathlib import Path

from tests.instruments.bench import _children, _program
from tests.instruments.bench._children import Progress, Run
from tests.instruments.bench._methods import BLACK, BLUE, GREEN, PURPLE, VERMILLION
from tests.instruments.bench._ratios import MeasurementError, seconds_per_sample
from tools.common import DevError

METHODS = ("PT", "SMS_UNBIASED")
SCRIPT = "_scaling_job.py"
# For the expected end: seconds of a child beside sampling, and of a sample of a pixel.
OVERHEAD, PIXEL_SECONDS = 4.0, 6e-6

# The scene from which one dimension at a time departs; all threads.
BASE = {"size": [128, 128], "quads": 30, "pieces": 1, "texels": 0, "lights": 1}
QUADS = (7, 22, 71, 224, 707)  # along an edge: 1e2, 1e3, ... 1e6 triangles, as near as can be
TEXELS = (128, 256, 512, 1024, 2048, 4096)  # along an edge
LIGHTS = (1, 3, 10, 30, 100, 300, 1000)
PIECES = (1, 2, 3, 5, 10)  # along an edge; they divide the base's quads
PIXELS = (64, 128, 256, 512, 1024)  # along an edge


@dataclass(frozen=True)
class Dimension:
    """What is changed. A value is a count; where it is that of a square, its edge tells it."""

    name: str
    what: str
    unit: str  # of the values
    values: tuple[int, ...]
    change: Callable[[int], dict]  # of BASE
    square: bool = False

    def label(self, value: int) -> str:
        return f"{isqrt(value)} x {isqrt(value)}" if self.square else f"{value:,}"

    def tick(self, value: int) -> str:
        """A shorter label."""
        return f"{isqrt(value)}²" if self.square else f"{value:,}"


def dimensions(processors: int) -> dict[str, Dimension]:
    """All, by name."""
    threads = sorted({*(2**i for i in range(processors.bit_length())), processors})
    found = (
        Dimension(
            "triangles",
            "Triangles of the mirror",
            "triangles",
            tuple(2 * quads**2 for quads in QUADS),
            lambda value: {"quads": isqrt(value // 2)},
        ),
        Dimension(
            "map",
            "Normal map that makes a flat mirror wavy",
            "texels",
            tuple(texels**2 for texels in TEXELS),
            lambda value: {"texels": isqrt(value)},
            square=True,
        ),
        Dimension(
            "lights",
            "Lamps that share the same power",
            "lamps",
            LIGHTS,
            lambda value: {"lights": value},
        ),
        Dimension(
            "casters",
            "Objects into which the mirror is cut",
            "casters",
            tuple(pieces**2 for pieces in PIECES),
            lambda value: {"pieces": isqrt(value)},
        ),
        Dimension(
            "image",
            "Size of the picture",
            "pixels",
            tuple(edge**2 for edge in PIXELS),
            lambda value: {"size": [isqrt(value)] * 2},
            square=True,
        ),
        Dimension(
            "threads",
            "Threads",
            "threads",
            tuple(value for value in threads if value <= processors),
            lambda value: {"threads": value},
        ),
    )
    return {dimension.name: dimension for dimension in found}


def chosen(text: str | None, processors: int, quick: bool) -> list[Dimension]:
    """Of names separated by commas, each once; None: all. Where it is quick the first three values
    of each. DevError if there is no such dimension, or none is named."""
    known = dimensions(processors)
    names = list(known) if text is None else _program.split(text)
    for name in names:
        if name not in known:
            raise DevError(f"no dimension '{name}'; there are: {' '.join(known)}")
    if not names:
        raise DevError("--only names no dimension")
    found = [known[name] for name in names]
    return [shortened(dimension) for dimension in found] if quick else found


def shortened(dimension: Dimension) -> Dimension:
    """The first three values."""
    values = dimension.values[:3]
    return Dimension(**{**vars(dimension), "values": values})


# -------------------------------------------------------------------------------------- quantities


@dataclass(frozen=True)
class Quantity:
    """What is read off a run, and how it is drawn."""

    name: str
    label: str
    unit: str
    panel: str  # of the chart; those that PANELS does not have stand in tables alone
    value: Callable[[Run], float]
    color: str = ""
    marker: str = ""


def cost(method: str, clock: str = "seconds") -> Callable[[Run], float]:
    """Seconds by `clock` for one more sample of every pixel."""

    def value(run: Run) -> float:
        rows = run.report["renders"][method]
        return seconds_per_sample([(row["samples"], row[clock]) for row in rows])

    return value


def own_cost(run: Run) -> float:
    """What the manifold adds to path tracing, in the same process."""
    plain, manifold = (cost(method)(run) for method in METHODS)
    if manifold <= plain:
        raise MeasurementError(
            f"a sample of {METHODS[1]} took {manifold:.3g} s, no longer than the {plain:.3g} s of "
            f"{METHODS[0]}: the machine is too busy"
        )
    return manifold - plain


def preparation(run: Run) -> float:
    return run.report["export_seconds"] + run.report["commit_seconds"]


def found_share(run: Run) -> float:
    """Of the manifold's estimates: found light."""
    stats = run.report["renders"][METHODS[1]][-1]["stats"]
    return stats["trial_estimates"] / stats["estimates"]


def peak_memory(run: Run) -> float:
    return run.report["peak_memory"]


COST, MEMORY, PREPARATION = "cost", "memory", "preparation"
PROCESSOR, SUCCESS = "processor", "success"
PANELS = {
    COST: "seconds for one sample of the whole picture",
    MEMORY: "peak memory, bytes above an empty process",
    PREPARATION: "seconds of export and commit",
}
PT_CPU, SMS_CPU = (cost(method, "cpu_seconds") for method in METHODS)
QUANTITIES = {
    quantity.name: quantity
    for quantity in (
        Quantity("pt", "path tracing", "s", COST, cost(METHODS[0]), BLACK, "o"),
        Quantity("sms", "SMS unbiased", "s", COST, cost(METHODS[1]), VERMILLION, "s"),
        Quantity("manifold", "the manifold's own", "s", COST, own_cost, PURPLE, "^"),
        Quantity("memory", "peak memory", "B", MEMORY, peak_memory, BLUE, "D"),
        Quantity("preparation", "ready to render", "s", PREPARATION, preparation, GREEN, "v"),
        Quantity("pt_cpu", "CPU time, path tracing", "s", PROCESSOR, PT_CPU),
        Quantity("sms_cpu", "CPU time, SMS", "s", PROCESSOR, SMS_CPU),
        Quantity("found", "estimates that find light", "", SUCCESS, found_share),
    )
}


# --------------------------------------------------------------------------------------- measuring


@dataclass(frozen=True)
class Point:
    """One value of one dimension."""

    dimension: Dimension
    value: int
    job: dict = field(hash=False)

    @property
    def title(self) -> str:
        return f"{self.dimension.name} {self.dimension.label(self.value)}"

    @property
    def guess(self) -> float:
        """Seconds of the child; at least four samples are taken."""
        width, height = self.job["size"]
        return OVERHEAD + max(
            len(METHODS) * self.job["seconds"], 4 * width * height * PIXEL_SECONDS
        )

    @property
    def name(self) -> str:
        """Of files."""
        return f"{self.dimension.name}_{self.value}"


def points(chosen_dimensions: Sequence[Dimension], threads: int, seconds: float) -> list[Point]:
    common = {"threads": threads, "seconds": seconds, "methods": list(METHODS)}
    return [
        Point(dimension, value, BASE | common | dimension.change(value))
        for dimension in chosen_dimensions
        for value in dimension.values
    ]


@dataclass
class Outcome:
    """The runs of each point, one for each round; and of those that failed why."""

    runs: dict[Point, list[Run]]
    failures: dict[Point, str] = field(default_factory=dict)


def measure(todo: Sequence[Point], rounds: int, folder: Path) -> Outcome:
    """All points take turns, each round starting at another one: what else the machine does hits
    all of them. What failed once is not tried again."""
    outcome = Outcome({point: [] for point in todo})
    progress = Progress("scaling", [rounds * sum(point.guess for point in todo)])
    for number in range(rounds):
        first = number * len(todo) // rounds
        for point in (*todo[first:], *todo[:first]):
            if point in outcome.failures:
                progress.skip(point.guess)
                continue
            progress.show(f"round {number + 1} of {rounds}, {point.title}")
            try:
                run = _children.run(point.name, "specula in bpy", SCRIPT, point.job, folder)
                for quantity in QUANTITIES.values():
                    quantity.value(run)  # a run that has no number for each is none
                outcome.runs[point].append(run)
            except MeasurementError as error:
                outcome.failures[point] = f"{point.title}: {error}"
            progress.advance(point.guess)
    progress.clear()
    return outcome
