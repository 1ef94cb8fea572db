# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a row."""

from __future__ import annotations

from dataclasses import dataclass, field

from tests.instruments.pairs.comparison import Comparison, Tolerance
from tests.instruments.parity import _known

# Best last.
CRASHED, STILL, FAILED = "crashed", "stood still", "failed"
DIFFERS, LISTED = "differs, without a warning", "differs, listed as failing"
DESIGN, WARNED, ABSENT = "differs by design", "not supported: warned", "not in this Blender"
ALIKE = "alike"
VERDICTS = (CRASHED, STILL, FAILED, DIFFERS, LISTED, DESIGN, WARNED, ABSENT, ALIKE)
BAD = (CRASHED, STILL, FAILED, DIFFERS)

# Of light that is seen directly little shows, and the noise of a block is about half a percent.
TOLERANCE = Tolerance(block=0.02, share=0.02, light=0.01)
REFUSED = "not supported"  # in an error, or in the core's report, that names what Specula lacks


@dataclass(frozen=True)
class Outcome:
    """What _job.py tells of a row, and how the process ended that began it."""

    name: str
    outcome: str  # crashed, stood still, failed, absent, done
    why: str = ""
    warnings: list[str] = field(default_factory=list)
    renders: dict[str, int] = field(default_factory=dict)  # by engine
    noise: dict[str, float] = field(default_factory=dict)  # of a block, relative, by engine


def verdict(row: Outcome, comparison: Comparison | None) -> str:
    """Of VERDICTS."""
    if row.outcome == FAILED and REFUSED in row.why:
        return WARNED
    if row.outcome != "done":
        return ABSENT if row.outcome == "absent" else row.outcome
    if not comparison.differs:
        return ALIKE
    if row.warnings:
        return WARNED
    if _known.reason(row.name, _known.BY_DESIGN):
        return DESIGN
    return LISTED if _known.reason(row.name, _known.FAILING) else DIFFERS


def remark(row: Outcome, said: str) -> str:
    """Why, in a line: of what is listed, or that the list is out of date."""
    why = _known.reason(row.name, _known.BY_DESIGN) or _known.reason(row.name, _known.FAILING)
    if why and said == ALIKE:
        return f"listed as different ({why}), and is not"
    return why if why and said in (DESIGN, LISTED) else row.why
