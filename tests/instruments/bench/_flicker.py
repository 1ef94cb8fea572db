# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of what changes between the frames of an animation is noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
LEAST_CAUSTICS = 0.1  # of the mean luminance: pixels with less in every frame are not looked at


@dataclass(frozen=True)
class Flicker:
    """Of one method in one animation."""

    # Standard deviation over time of what is not in the references, from one frame to the next, by
    # the references' mean: noise that stands still does not count.
    noise: float
    # Variance over time of the pixels, by that of the references: 1 is as steady as the truth.
    variance_ratio: float
    # Largest deviation of a frame's mean from its reference's, less the mean deviation, by the
    # references' mean: frames that are darker or brighter than their neighbours.
    pops: float


def caustics_mask(caustics: np.ndarray, pictures: np.ndarray) -> np.ndarray:
    """Pixels (H, W) with caustics in some frame; all, if there are none. Both (F, H, W, 3)."""
    least = LEAST_CAUSTICS * (pictures @ LUMINANCE).mean()
    mask = ((caustics @ LUMINANCE) > least).any(axis=0)
    return mask if mask.any() else np.ones_like(mask)


def measure(frames: np.ndarray, references: np.ndarray, mask: np.ndarray) -> Flicker:
    """Of pictures (F, H, W, 3) against references of the same frames, in the pixels of `mask`."""
    seen, truth = ((pictures @ LUMINANCE)[:, mask] for pictures in (frames, references))
    error, mean = seen - truth, truth.mean()
    changes = np.diff(error, axis=0)
    offsets = error.mean(axis=1)
    still = truth.var(axis=0).mean()
    return Flicker(
        noise=float(np.sqrt(0.5 * (changes**2).mean()) / mean),
        variance_ratio=float(seen.var(axis=0).mean() / still) if still > 0.0 else float("inf"),
        pops=float(np.abs(offsets - offsets.mean()).max() / mean),
    )
