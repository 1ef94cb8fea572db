# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether two renderers' pictures of one scene are the same. NumPy alone."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tests.images import _statistics
from tests.instruments.bench._metrics import LUMINANCE

DARK = 0.02  # of a picture's mean: a block below it counts as if it had so much light
LIGHT_Z = 4.0  # standard deviations of the mean that chance may explain


@dataclass(frozen=True)
class Tolerance:
    """Up to which differences two pictures count as the same."""

    block: float  # of a block's light
    share: float  # of the blocks that differ by more, and beyond noise
    light: float  # of the mean


@dataclass(frozen=True)
class Picture:
    """The mean of renders with different seeds: (H, W, 3) float64, bottom row first."""

    mean: np.ndarray
    variance: np.ndarray | None  # of the mean; None of a single render
    caustics: np.ndarray  # share of `mean` that is not path traced
    stats: dict  # `splats`


def picture(renders: Sequence[dict[str, np.ndarray]], splats: int = 0) -> Picture:
    """Of the passes of renders with different seeds."""
    count = len(renders)
    combined = np.stack([passes["Combined"] for passes in renders])
    mean = combined.mean(axis=0)
    nothing = np.zeros_like(mean)
    caustics = sum(passes.get("Caustics", nothing) for passes in renders) / count
    variance = combined.var(axis=0, ddof=1) / count if count > 1 else None
    return Picture(mean, variance, caustics, {"splats": splats})


def noise(picture: Picture) -> float:
    """Standard deviation of a block, as a share of its light, that nine of ten blocks which are not
    dark do not exceed."""
    light = np.abs(_statistics.block_sums(picture.mean) @ LUMINANCE)
    deviation = np.sqrt(_statistics.block_sums(picture.variance)) @ LUMINANCE
    seen = light > DARK * light.mean()  # none of a black picture
    return float(np.quantile(deviation[seen] / light[seen], 0.9)) if seen.any() else 0.0


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
    differing: float  # share of the blocks that differ beyond noise and the tolerance
    caustics: float  # share of Specula's light
    not_finite: int  # values of Specula's picture
    tolerance: Tolerance

    @property
    def light_differs(self) -> bool:
        margin = max(self.tolerance.light, LIGHT_Z * self.ratio_error)
        return self.ratio < 1.0 - margin or self.bare_ratio > 1.0 + margin

    @property
    def differs(self) -> bool:
        return self.not_finite > 0 or self.differing > self.tolerance.share or self.light_differs

    @property
    def severity(self) -> float:
        """For sorting."""
        if self.not_finite:
            return math.inf
        brightness = abs(math.log(min(max(self.ratio, 1e-3), 1e3)))
        return self.differing + (brightness if self.light_differs else 0.0)


def compare(specula: Picture, cycles: Picture, tolerance: Tolerance) -> Comparison:
    """Both of at least two renders."""
    not_finite = int(np.count_nonzero(~np.isfinite(specula.mean)))
    if not_finite:
        nan = math.nan
        return Comparison(nan, nan, nan, nan, 1.0, nan, not_finite, tolerance)
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
        differing=float(differing_blocks(specula, cycles, tolerance.block).mean()),
        caustics=float(caustics.sum() / max(light.sum(), np.finfo(float).tiny)),
        not_finite=0,
        tolerance=tolerance,
    )


def light_error(*pictures: Picture) -> float:
    """Of the difference between sums of luminance, where the noise of a pixel has no colour."""
    deviations = [np.sqrt(picture.variance) @ LUMINANCE for picture in pictures]
    return float(np.sqrt(sum((deviation**2).sum() for deviation in deviations)))


def differing_blocks(specula: Picture, cycles: Picture, share: float) -> np.ndarray:
    """(rows, columns): in any channel beyond noise, Sidak over all, and by more than `share`."""
    height, width, _ = cycles.mean.shape
    bare = dataclasses.replace(specula, mean=specula.mean - specula.caustics)
    limit = _statistics.threshold(_statistics.block_count((width, height)))
    sums, pixels = (_statistics.block_sums(a) for a in (cycles.mean, np.ones_like(cycles.mean)))
    least = share * np.maximum(np.abs(sums), DARK * np.abs(cycles.mean).mean() * pixels)
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
