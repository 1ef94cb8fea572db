# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference images: EXR files with the mean and its standard error, both half floats; the bench's
with the manifold's and light tracing's share of the mean as well.

The standard error and not the variance, which would leave the range of half floats.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

FOLDER = Path(__file__).resolve().parent / "references"
CHANNELS = ("R", "G", "B", "error.R", "error.G", "error.B")
CAUSTICS_CHANNELS = ("caustics.R", "caustics.G", "caustics.B")
DITHER_SEED = 0
PREFIX = "specula:"  # of the file's attributes


@dataclass(frozen=True)
class Reference:
    """(H, W, 3) float64 arrays, bottom row first, and text about their making."""

    mean: np.ndarray
    variance: np.ndarray  # of the mean, that of rounding to half floats included
    about: dict[str, str]
    caustics: np.ndarray | None = None

    @property
    def samples(self) -> int:
        """Per pixel."""
        return int(self.about["samples"])


def write(
    path: Path,
    mean: np.ndarray,
    variance: np.ndarray,
    about: dict[str, str],
    caustics: np.ndarray | None = None,
) -> None:
    """Writes arrays as in `Reference`; `about` becomes attributes of the file."""
    for values in (mean, np.sqrt(variance)):
        if not (np.abs(values) < np.finfo(np.float16).max).all():
            raise ValueError(f"{path}: a pixel is too bright for half floats, or not finite")
    rounded, rounding_variance = dithered(mean)
    error = np.sqrt(variance + rounding_variance)
    layers = [rounded, error] if caustics is None else [rounded, error, caustics]
    channels = CHANNELS if caustics is None else CHANNELS + CAUSTICS_CHANNELS
    pixels = np.concatenate(layers, axis=2)[::-1].astype(np.float16)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(channels), "half")
    spec.channelnames = channels
    spec.attribute("compression", "zip")
    for key, value in about.items():
        spec.attribute(PREFIX + key, value)
    output = oiio.ImageOutput.create(str(path))
    if not output or not output.open(str(path), spec) or not output.write_image(pixels):
        raise OSError(f"{path}: {output.geterror() if output else oiio.geterror()}")
    output.close()


def read(path: Path) -> Reference:
    file = oiio.ImageInput.open(str(path))
    if not file:
        raise OSError(f"{path}: {oiio.geterror()}")
    spec = file.spec()
    found = tuple(spec.channelnames)  # in the file's order
    if set(found) not in (set(CHANNELS), set(CHANNELS + CAUSTICS_CHANNELS)):
        raise OSError(f"{path}: channels {found}")
    channels = CHANNELS if len(found) == len(CHANNELS) else CHANNELS + CAUSTICS_CHANNELS
    pixels = np.asarray(file.read_image("float"), np.float64)[::-1]
    pixels = pixels[..., [found.index(channel) for channel in channels]]
    file.close()
    about = {
        item.name.removeprefix(PREFIX): str(item.value)
        for item in spec.extra_attribs
        if item.name.startswith(PREFIX)
    }
    caustics = pixels[..., 6:] if len(channels) > len(CHANNELS) else None
    return Reference(pixels[..., :3], pixels[..., 3:6] ** 2, about, caustics)


def dithered(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Half floats whose expectation is `values`, and the variance of that rounding.

    To the nearest, all pixels of an evenly lit surface would have the same error.
    """
    nearest = values.astype(np.float16)
    below = np.where(nearest > values, np.nextafter(nearest, np.float16(-np.inf)), nearest)
    above = np.nextafter(below, np.float16(np.inf))
    step = above.astype(np.float64) - below
    fraction = (values - below) / step
    draw = np.random.default_rng(DITHER_SEED).random(values.shape)
    return np.where(draw < fraction, above, below), fraction * (1.0 - fraction) * step**2
