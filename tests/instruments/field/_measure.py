# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of one scene: how both renderers ended, and whether their pictures are the same."""

from __future__ import annotations

import dataclasses
import math
import re
import signal
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from tests.images import _statistics
from tests.instruments.bench._children import Ended, last_words
from tests.instruments.bench._metrics import LUMINANCE

# Best last. The first four and LATE are of Specula alone; the page says how Cycles ended.
CRASHED, STILL, FAILED, LATE = "crashed", "stood still", "failed", "late"
DIFFERS, TOLD = "differs, without a warning", "differs, with warnings"
ALONE, NEITHER, WELL = "Cycles does not end well", "neither renders it", "ended well"
VERDICTS = (CRASHED, STILL, FAILED, LATE, DIFFERS, TOLD, ALONE, NEITHER, WELL)
BAD = (CRASHED, STILL, FAILED, LATE, DIFFERS)

# The end may come so much later than the limit: a quarter of it, and a second, which other programs
# on the machine may take.
LATE_FACTOR, LATE_SECONDS = 1.25, 1.0
# Of a block's light: what is less shows to nobody, and models differ by so much (README, *Known
# differences from Cycles*). Where a block is dark, of DARK of the picture's mean.
DIFFERENCE, DARK = 0.02, 0.02
# From which on the picture counts as another: share of its blocks, and of its light.
SHARE, LIGHT = 0.05, 0.05
LIGHT_Z = 4.0  # standard deviations of the mean that chance may explain
OPENING = "opening"  # the first stage of _job.py
SHOWN_LINES = 8  # of the log of a child that did not end well
PROGRESS = re.compile(r"^Fra:|\bSample \d+/\d+")
SPECULA_SAMPLE = re.compile(r"Specula: sample ([\d.]+)/\d+ \| ([\d:]+)")


@dataclass(frozen=True)
class Child:
    """How a renderer ended."""

    outcome: str  # CRASHED, STILL, FAILED or WELL
    why: str  # in a line; empty where it ended well
    code: int | None
    stage: str
    wall_seconds: float
    cpu_seconds: float
    peak_memory: int
    renders: list[dict]  # see _job.py
    last_lines: list[str]
    others_share: float  # of the processors' time that other programs took meanwhile

    def worst(self, key: str) -> float | None:
        """Of all renders; None if one has none."""
        values = [row[key] for row in self.renders]
        return max(values) if values and None not in values else None

    @property
    def warnings(self) -> list[str]:
        return list(dict.fromkeys(text for row in self.renders for text in row["warnings"]))


def child(ended: Ended, others_share: float = 0.0) -> Child:
    report = ended.report or {"stage": "starting", "renders": [], "error": None}
    log = ended.log.read_text(errors="replace")
    outcome, why = WELL, ""
    if ended.code is None:
        outcome, why = STILL, f"killed at {report['stage']} after {ended.wall_seconds:.0f} s"
        if samples := SPECULA_SAMPLE.findall(log):
            why += f"; it told of {samples[-1][0]} samples after {samples[-1][1]}"
    elif ended.code < 0:
        outcome, why = CRASHED, f"{signal_name(-ended.code)} at {report['stage']}"
    elif ended.code > 0 or report["stage"] != "done":
        outcome, why = FAILED, report["error"] or f"exit code {ended.code}: {last_words(log)}"
    return Child(
        outcome,
        why,
        ended.code,
        report["stage"],
        ended.wall_seconds,
        ended.cpu_seconds,
        ended.peak_memory,
        report["renders"],
        [] if outcome == WELL else last_lines(log),
        others_share,
    )


def signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def last_lines(log: str) -> list[str]:
    """Those that tell more than progress."""
    lines = [line.rstrip() for line in log.splitlines() if line.strip()]
    return [line for line in lines if not PROGRESS.search(line)][-SHOWN_LINES:]


# ----------------------------------------------------------------------------------------- pictures


@dataclass(frozen=True)
class Picture:
    """The mean of two renders with different seeds: (H, W, 3) float64, bottom row first."""

    mean: np.ndarray
    variance: np.ndarray | None  # of the mean; None of a single render
    caustics: np.ndarray  # share of `mean` that is not path traced
    stats: dict  # `splats`


def read(path: Path) -> dict[str, np.ndarray]:
    """`Combined`, and `Caustics` if it is there, of a multilayer EXR file of Blender's."""
    file = oiio.ImageInput.open(str(path))
    if not file:
        raise OSError(f"{path}: {oiio.geterror()}")
    passes: dict[str, np.ndarray] = {}
    part = 0
    while file.seek_subimage(part, 0):  # Blender 5.0 gives every pass a part of its own
        names = file.spec().channelnames
        pixels = np.asarray(file.read_image("float"), np.float64)[::-1]
        for name in ("Combined", "Caustics"):
            found = [names.index(n) for n in names if re.search(rf"\b{name}\.[RGBXYZ]$", n)]
            if len(found) >= 3:
                passes.setdefault(name, ordered(pixels, names, found))
        part += 1
    file.close()
    if "Combined" not in passes:
        raise OSError(f"{path}: no pass Combined")
    return passes


def ordered(pixels: np.ndarray, names: list[str], found: list[int]) -> np.ndarray:
    """(H, W, 3): red first, whatever the order in the file."""
    by_letter = {names[index][-1]: index for index in found}
    letters = "RGB" if "R" in by_letter else "XYZ"
    return pixels[..., [by_letter[letter] for letter in letters]]


def picture(renders: list[dict[str, np.ndarray]], splats: int = 0) -> Picture:
    """Of the passes of one or two renders with different seeds."""
    mean = sum(passes["Combined"] for passes in renders) / len(renders)
    nothing = np.zeros_like(mean)
    caustics = sum(passes.get("Caustics", nothing) for passes in renders) / len(renders)
    variance = None
    if len(renders) == 2:
        variance = ((renders[0]["Combined"] - renders[1]["Combined"]) / 2.0) ** 2
    return Picture(mean, variance, caustics, {"splats": splats})


# --------------------------------------------------------------------------------------- comparison


@dataclass(frozen=True)
class Comparison:
    """Specula's picture against that of Cycles. Blocks are 8 x 8 pixels. A caustic that both
    renders of Cycles missed has no variance: Cycles may show anything from Specula's picture
    without what its pass Caustics holds up to the whole of it, give or take the noise."""

    ratio: float  # of means
    ratio_error: float  # standard error
    bare_ratio: float  # of means, Specula's without its caustics
    median_ratio: float  # of blocks that are not black
    differing: float  # share of the blocks that differ beyond noise and DIFFERENCE
    caustics: float  # share of Specula's light
    not_finite: int  # values of Specula's picture

    @property
    def light_differs(self) -> bool:
        margin = max(LIGHT, LIGHT_Z * self.ratio_error)
        return self.ratio < 1.0 - margin or self.bare_ratio > 1.0 + margin

    @property
    def differs(self) -> bool:
        return self.not_finite > 0 or self.differing > SHARE or self.light_differs

    @property
    def severity(self) -> float:
        """For sorting."""
        if self.not_finite:
            return math.inf
        brightness = abs(math.log(min(max(self.ratio, 1e-3), 1e3)))
        return self.differing + (brightness if self.light_differs else 0.0)


def compare(specula: Picture, cycles: Picture) -> Comparison:
    """Both of two renders."""
    not_finite = int(np.count_nonzero(~np.isfinite(specula.mean)))
    if not_finite:
        return Comparison(math.nan, math.nan, math.nan, math.nan, 1.0, math.nan, not_finite)
    specula = _statistics.with_shared_splats(specula)
    light, expected, caustics = (
        _statistics.block_sums(image) @ LUMINANCE
        for image in (specula.mean, cycles.mean, specula.caustics)
    )
    return Comparison(
        ratio=quotient(light.sum(), expected.sum()),
        ratio_error=light_error(specula, cycles) / max(expected.sum(), np.finfo(float).tiny),
        bare_ratio=quotient((light - caustics).sum(), expected.sum()),
        median_ratio=median_ratio(light, expected),
        differing=float(differing_blocks(specula, cycles).mean()),
        caustics=float(caustics.sum() / max(light.sum(), np.finfo(float).tiny)),
        not_finite=0,
    )


def light_error(*pictures: Picture) -> float:
    """Of the difference between sums of luminance, where the noise of a pixel has no colour."""
    deviations = [np.sqrt(picture.variance) @ LUMINANCE for picture in pictures]
    return float(np.sqrt(sum((deviation**2).sum() for deviation in deviations)))


def differing_blocks(specula: Picture, cycles: Picture) -> np.ndarray:
    """(rows, columns): in any channel beyond noise, Sidak over all, and more than DIFFERENCE."""
    height, width, _ = cycles.mean.shape
    bare = dataclasses.replace(specula, mean=specula.mean - specula.caustics)
    limit = _statistics.threshold(_statistics.block_count((width, height)))
    sums, pixels = (_statistics.block_sums(a) for a in (cycles.mean, np.ones_like(cycles.mean)))
    least = DIFFERENCE * np.maximum(np.abs(sums), DARK * np.abs(cycles.mean).mean() * pixels)
    darker = (_statistics.block_z(specula, cycles) < -limit) & (
        sums - _statistics.block_sums(specula.mean) > least
    )
    brighter = (_statistics.block_z(bare, cycles) > limit) & (
        _statistics.block_sums(bare.mean) - sums > least
    )
    return (darker | brighter).any(axis=2)


def median_ratio(light: np.ndarray, expected: np.ndarray) -> float:
    seen = expected > DARK * expected.mean()
    return float(np.median(light[seen] / expected[seen])) if seen.any() else 1.0


def quotient(light: float, expected: float) -> float:
    """1 where both are black."""
    if expected > 0.0:
        return float(light / expected)
    return 1.0 if light == expected else float("inf")


# ------------------------------------------------------------------------------------------ verdict


def is_late(specula: Child, limit: float) -> bool:
    """A render that ended after its limit, or at its end lacked a sample of some pixel."""
    if not specula.renders:
        return False
    slowest = specula.worst("render_seconds")
    return slowest > LATE_FACTOR * limit + LATE_SECONDS or (
        specula.worst("first_sample_seconds") is None
    )


def fail_alike(specula: Child, cycles: Child) -> bool:
    """Whether the file, or Blender, is to blame. Long renders of both are not: each has a limit."""
    rendering = specula.outcome == STILL and specula.stage != OPENING
    return specula.outcome == cycles.outcome and not specula.renders and not rendering


def verdict(specula: Child, cycles: Child, comparison: Comparison | None, limit: float) -> str:
    """Of VERDICTS, the worst that holds."""
    if specula.outcome != WELL:
        return NEITHER if fail_alike(specula, cycles) else specula.outcome
    if is_late(specula, limit):
        return LATE
    if comparison and comparison.differs:
        return TOLD if specula.warnings else DIFFERS
    return WELL if cycles.outcome == WELL else ALONE


def kind(warning: str) -> str:
    """What a warning of the form `OWNER: WHAT IS WRONG, WHAT IS DONE` says is wrong, whoever it is
    about."""
    wrong = warning.rpartition(": ")[2].partition(", ")[0]
    if wrong.endswith(" is missing"):
        return "an image is missing"
    return re.sub(r"\.\d{3}\b", "", wrong)  # as Blender counts nodes of one kind
