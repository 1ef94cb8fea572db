# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of one scene: how both renderers ended, and whether their pictures are the same."""

from __future__ import annotations

import re
import signal
from dataclasses import dataclass

from tests.instruments.bench._children import Ended, last_words
from tests.instruments.pairs.comparison import Comparison, Tolerance

# Best last. The first four and LATE are of Specula alone; the page says how Cycles ended.
CRASHED, STILL, FAILED, LATE = "crashed", "stood still", "failed", "late"
DIFFERS, TOLD = "differs, without a warning", "differs, with warnings"
ALONE, NEITHER, WELL = "Cycles does not end well", "neither renders it", "ended well"
VERDICTS = (CRASHED, STILL, FAILED, LATE, DIFFERS, TOLD, ALONE, NEITHER, WELL)
BAD = (CRASHED, STILL, FAILED, LATE, DIFFERS)

# The end may come so much later than the limit: a quarter of it, and a second, which other programs
# on the machine may take.
LATE_FACTOR, LATE_SECONDS = 1.25, 1.0
# What is less shows to nobody, and models differ by so much (README, *Known differences from
# Cycles*).
TOLERANCE = Tolerance(block=0.02, share=0.05, light=0.05)
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
