# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between noisy images in units of their standard deviation.

Images are (H, W, 3); whatever has `mean` and `variance` (of the mean) will do. Pixels and images
are independent of each other; the channels of a pixel are not, so each is compared on its own.
"""

from __future__ import annotations

import dataclasses
from statistics import NormalDist

import numpy as np

BLOCK = 8  # pixels: sums over 64 pixels are close to normal where single pixels are not
PATH_TRACED = 0.1  # below this share of caustics a block or a pixel counts as path traced
# A light path's splat is shared by all pixels in reach of the filter, a Blackman-Harris of 1.5
# pixels in all scenes: the sum over a block varies up to 1 / (integral of its square)^2 as much as
# the sum of its pixels' variances says.
SPLAT_SPREAD = 2.241
FALSE_ALARMS = 1e-3  # probability that any comparison of a family fails though all is well


def block_sums(image: np.ndarray) -> np.ndarray:
    """Sums over squares of BLOCK pixels, smaller ones at the upper and right edge."""
    height, width, _ = image.shape
    rows = np.add.reduceat(image, np.arange(0, height, BLOCK), axis=0)
    return np.add.reduceat(rows, np.arange(0, width, BLOCK), axis=1)


def block_count(size: tuple[int, int]) -> int:
    """Comparisons in block_z() of an image of (width, height) pixels."""
    return 3 * (-(-size[0] // BLOCK)) * (-(-size[1] // BLOCK))


def block_z(image, reference) -> np.ndarray:
    """(rows, columns, 3): positive where `image` is brighter. 0 where both are exact and equal."""
    difference = block_sums(image.mean - reference.mean)
    variance = block_sums(image.variance + reference.variance)
    z = difference / np.sqrt(np.maximum(variance, np.finfo(np.float64).tiny))
    return np.where(difference == 0.0, 0.0, z)


def total_z(image, reference) -> np.ndarray:
    """(3,): the same for the sum of all pixels."""
    return total(image.mean - reference.mean) / total_error(image, reference)


def weighted_z(image, reference) -> np.ndarray:
    """(3,): of the sum over all blocks, those with little noise in the reference counting most."""
    weights = block_sums(reference.mean) / block_sums(reference.variance)
    difference = block_sums(image.mean - reference.mean)
    variance = block_sums(image.variance + reference.variance)
    return total(weights * difference) / np.sqrt(total(weights**2 * variance))


def total(image: np.ndarray) -> np.ndarray:
    return image.sum(axis=(0, 1))


def total_error(*images) -> np.ndarray:
    """(3,): standard deviation of the difference between the sums of two images."""
    return np.sqrt(sum(total(image.variance) for image in images))


def with_rare_paths(image, reference):
    """`image` with a better variance where both were path traced.

    A lamp seen in a polished ring, in a corner of a pixel: `image` may have missed it, and its own
    variance then knows nothing of it. Where the manifold adds next to nothing, to a block or beside
    a pixel that outshines its block's caustics, both have the same samples, of which the reference
    has many more.
    """
    height, width, _ = image.mean.shape

    def of_block(picture):  # to its pixels, mean
        means = block_sums(picture) / block_sums(np.ones_like(picture))
        return np.kron(means, np.ones((BLOCK, BLOCK, 1)))[:height, :width]

    light = np.maximum(of_block(image.mean), reference.mean)
    path_traced = of_block(image.caustics) < PATH_TRACED * light
    expected = reference.variance * (reference.samples / image.samples)
    variance = np.where(path_traced, np.maximum(image.variance, expected), image.variance)
    return dataclasses.replace(image, variance=variance)


def with_shared_splats(image):
    """`image` with variances of which sums are right, if light paths had part in it.

    Too large where path tracing's noise is mixed in, never too small.
    """
    if not image.stats["splats"]:
        return image
    return dataclasses.replace(image, variance=image.variance * SPLAT_SPREAD)


def caustics_weights(others, reference) -> np.ndarray:
    """Weights of blocks by which a wrong factor on all caustics shows best: signal over variance.

    (rows, columns, 3); from renders and a reference that are independent of the image to be
    tested, so that no outlier in it hides itself. Normalised: the weighted sum of the caustics
    is 1.
    """
    caustics = sum(block_sums(image.caustics) for image in others) / len(others)
    variance = sum(block_sums(image.variance) for image in others) / len(others)
    variance = variance + block_sums(reference.variance)
    weights = caustics / np.maximum(variance, np.finfo(np.float64).tiny)
    return weights / total(weights * caustics)


def caustics_excess(images, weights, reference) -> tuple[np.ndarray, np.ndarray]:
    """By which share the caustics are too bright, (3,), and the standard deviation of that.

    The mean over `images`, which are independent of each other, each with its `weights`.
    """
    excess, variance = np.zeros(3), np.zeros(3)
    for image, weight in zip(images, weights, strict=True):
        excess += total(weight * block_sums(image.mean - reference.mean))
        variance += total(weight**2 * block_sums(image.variance))
    variance += total(sum(weights) ** 2 * block_sums(reference.variance))
    return excess / len(images), np.sqrt(variance) / len(images)


def threshold(comparisons: int, sides: int = 2) -> float:
    """z that none of so many comparisons exceeds, but for FALSE_ALARMS; by Sidak."""
    each = -np.expm1(np.log1p(-FALSE_ALARMS) / comparisons)
    return NormalDist().inv_cdf(1.0 - each / sides)


def strongest(z: np.ndarray) -> str:
    """The z that is farthest from 0, for messages."""
    index = np.unravel_index(np.argmax(np.abs(z)), z.shape)
    return f"z = {z[index]:.2f} at {tuple(int(i) for i in index)}"
