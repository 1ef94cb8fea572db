# SPDX-License-Identifier: GPL-3.0-or-later
"""Each method against Cycles, LuxCore and unbiased manifold sampling, over all scenes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from tests.instruments.bench._methods import CYCLES, SMS
from tests.instruments.bench._summary import SceneResult

BASELINES = {CYCLES: "Cycles PT", "luxcore": "LuxCore's best", SMS: "SMS unbiased"}


@dataclass(frozen=True)
class Standing:
    """Ratios of errors at equal time over the scenes: geometric mean and extremes."""

    mean: float
    low: float
    high: float
    scenes: int
    near_reference: int  # scenes where the reference's own error may be part of one of the two


def standing(
    scenes: Sequence[SceneResult], method: str, against: str, region: str, budget: float
) -> Standing | None:
    """Of `method` against a method, or against the best of a renderer ("luxcore")."""
    ratios, near = [], 0
    for scene in scenes:
        baseline = scene.baseline(against, region, budget)
        if baseline and (ratio := scene.equal_time(method, baseline, region, budget)):
            ratios.append(ratio)
            near += scene.near_reference((method, baseline), region, budget)
    if not ratios:
        return None
    mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
    return Standing(mean, min(ratios), max(ratios), len(ratios), near)
