# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of the difference between an image and its reference. NumPy alone.

Images are (H, W, 3) float64, linear.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

WORST = 1e-3  # share of the pixels that the trimmed figures leave out
# What the denominator of the relative error has beside the square, as a share of the reference's
# mean square: what is nearly black must not decide.
RELATIVE_FLOOR = 0.01
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
BLOCK = 8  # pixels along a side, within which errors may depend on each other
CAUSTICS_SHARE = 0.05  # of a pixel's light, from which on it belongs to the caustics


@dataclass(frozen=True)
class Errors:
    """Of one image, or one region. The reference's own variance is subtracted from `mse`, the
    relative one likewise; `mse_error` is the standard error of `mse` over the pixels. Biases are
    relative to the reference's mean, `bias_z` in standard deviations. `trimmed`: without the worst
    WORST of the pixels."""

    mse: float
    mse_error: float
    mse_trimmed: float
    rel_mse: float
    rel_mse_trimmed: float
    bias: float
    bias_z: float
    bias_trimmed: float
    bias_trimmed_z: float
    # The reference's own squared error, which was subtracted from `mse` and from `mse_trimmed`.
    reference_mse: float
    reference_mse_trimmed: float


def errors(
    image: np.ndarray, mean: np.ndarray, variance: np.ndarray, mask: np.ndarray | None = None
) -> Errors:
    """Of `image` against a reference with `mean` and `variance` of the mean; `mask` (H, W)."""
    inside = np.ones(image.shape[:2], bool) if mask is None else mask
    mean, variance = mean[inside], variance[inside]  # (N, 3)
    difference = image[inside] - mean
    floor = RELATIVE_FLOOR * (mean**2).mean()
    squares, kept = _less_noise(difference, variance, np.ones_like(mean))
    relative, kept_relative = _less_noise(difference, variance, 1.0 / (mean**2 + floor))
    signed = difference @ LUMINANCE
    kept_signed = _kept(signed**2 + variance @ LUMINANCE**2)
    brightness = (mean @ LUMINANCE).mean()
    block = _blocks(image.shape[:2])[inside]
    bias, z = _bias(signed, block, brightness)
    bias_trimmed, z_trimmed = _bias(signed[kept_signed], block[kept_signed], brightness)
    return Errors(
        mse=float(squares.mean()),
        mse_error=float(squares.std() / math.sqrt(len(squares))),
        mse_trimmed=float(squares[kept].mean()),
        rel_mse=float(relative.mean()),
        rel_mse_trimmed=float(relative[kept_relative].mean()),
        bias=bias,
        bias_z=z,
        bias_trimmed=bias_trimmed,
        bias_trimmed_z=z_trimmed,
        reference_mse=float(variance.mean()),
        reference_mse_trimmed=float(variance[kept].mean()),
    )


def _less_noise(
    difference: np.ndarray, variance: np.ndarray, weight: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Squared error of each pixel less the reference's variance, and which pixels trimming keeps:
    an outlier may be the image's or the reference's."""
    squares = ((difference**2 - variance) * weight).mean(axis=1)
    return squares, _kept(((difference**2 + variance) * weight).mean(axis=1))


def trimmed_mean(values: np.ndarray) -> float:
    """Of (H, W, 3) values, over the pixels but the worst."""
    of_pixels = values.mean(axis=-1).ravel()
    return float(of_pixels[_kept(of_pixels)].mean())


def _kept(badness: np.ndarray) -> np.ndarray:
    """Indices of all but the worst."""
    count = len(badness) - math.ceil(WORST * len(badness))
    return np.argpartition(badness, count - 1)[:count] if count > 0 else np.arange(len(badness))


def _blocks(shape: tuple[int, int]) -> np.ndarray:
    """Of each pixel, the number of the square of BLOCK x BLOCK that it is in."""
    row, column = (np.arange(length) // BLOCK for length in shape)
    return row[:, None] * (column[-1] + 1) + column


def _bias(signed: np.ndarray, block: np.ndarray, brightness: float) -> tuple[float, float]:
    """Mean difference, relative; and in its standard deviations.

    Blocks are nearly independent of each other, also where the pixel filter shares what light
    paths splat among neighbours, and, without bias, of mean zero: the sum of the squares of their
    sums is the variance of the whole sum, whatever the distribution, and the reference's noise is
    in it.
    """
    deviation = math.sqrt(float((np.bincount(block, signed) ** 2).sum()))
    z = float(signed.sum()) / deviation if deviation > 0.0 else 0.0
    return float(signed.mean()) / brightness if brightness > 0.0 else 0.0, z


@dataclass(frozen=True)
class Estimate:
    """Mean over seeds, and its standard error; one seed has none."""

    mean: float
    error: float | None
    count: int


def estimate(values: Sequence[float]) -> Estimate:
    """Of one value for each seed."""
    count = len(values)
    error = float(np.std(values, ddof=1) / math.sqrt(count)) if count > 1 else None
    return Estimate(float(np.mean(values)), error, count)


def cautious_z(block_z: float, biases: Sequence[float]) -> float | None:
    """z-score of a bias where pixels far from each other depend on each other, so that `block_z` is
    too large: the smaller of it and that of the mean of `biases`, one for each seed. None for a
    single one, which knows nothing of its spread."""
    found = estimate(biases)
    if not found.error:
        return None
    return min(block_z, found.mean / found.error, key=abs)


def shared_error(images: Sequence[np.ndarray], mean: np.ndarray) -> tuple[float, float]:
    """Mean product of different images' differences to the reference, and its standard error.

    Of images that are unbiased and independent of each other, as seeds should be, they share the
    reference's own squared error and nothing else: only then does the error of their mean fall as
    1 over their number, that is as 1/time.
    """
    count = len(images)
    together = sum(image - mean for image in images) ** 2
    alone = sum((image - mean) ** 2 for image in images)
    products = ((together - alone) / (count * (count - 1))).mean(axis=-1)
    return float(products.mean()), float(products.std() / math.sqrt(products.size))


@dataclass(frozen=True)
class Slope:
    """Exponent of a power law, and its standard error."""

    value: float
    error: float


def log_slope(x: Sequence[float], y: Sequence[float], y_error: Sequence[float]) -> Slope:
    """Of y ~ x^slope, by least squares over logarithms, weighted by the standard errors of y."""
    log_x, log_y = np.log(x), np.log(y)
    weight = (np.asarray(y) / np.asarray(y_error)) ** 2
    centred = log_x - np.average(log_x, weights=weight)
    spread = float((weight * centred**2).sum())
    return Slope(float((weight * centred * log_y).sum()) / spread, 1.0 / math.sqrt(spread))


def time_to_reach(target: float, times: Sequence[float], values: Sequence[float]) -> str:
    """When an error that falls over `times` is `target` > 0, in seconds: a number by interpolation
    of logarithms, or `> ` the last time if it is never reached; nothing is extrapolated. `< ` a
    time where that is all there is to say: it is the first one, or the error there, less that of
    the reference, is not positive and has no logarithm."""
    reached = next((i for i, value in enumerate(values) if value <= target), None)
    if reached is None:
        return f"> {times[-1]:.3g}"
    if reached == 0 or values[reached] <= 0.0:
        return f"< {times[reached]:.3g}"
    before = reached - 1
    share = math.log(values[before] / target) / math.log(values[before] / values[reached])
    return f"{times[before] * (times[reached] / times[before]) ** share:.3g}"


def caustics_mask(mean: np.ndarray, caustics: np.ndarray) -> np.ndarray:
    """(H, W): where caustics (H, W, 3) are more than CAUSTICS_SHARE of `mean`."""
    return (caustics @ LUMINANCE) > CAUSTICS_SHARE * (mean @ LUMINANCE)


def exposure(mean: np.ndarray) -> float:
    """Factor that brings all but the brightest of a reference below white."""
    bright = float(np.percentile(mean @ LUMINANCE, 97.0))
    return 0.9 / bright if bright > 0.0 else 1.0


def display(image: np.ndarray, factor: float) -> np.ndarray:
    """sRGB in [0, 1], float32, of a linear image times `factor`."""
    linear = np.clip(np.asarray(image, np.float64) * factor, 0.0, 1.0)
    curve = 1.055 * np.maximum(linear, 1e-12) ** (1.0 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, 12.92 * linear, curve).astype(np.float32)


def flip(image: np.ndarray, mean: np.ndarray, factor: float) -> float:
    """Mean of the FLIP error map of what `display` shows; 0 to 1."""
    import flip_evaluator

    reference, test = display(mean, factor), display(image, factor)
    return float(flip_evaluator.evaluate(reference, test, "LDR", applyMagma=False)[1])
