# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference images: EXR files with the mean and its standard error, both half floats.

The standard error and not the variance, which would leave the range of half floats.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

FOLDER = Path(__file__).resolve().parent / "references"
CHANNELS = ("R", "G", "B", "error.R", "error.G", "error.B")
PREFIX = "specula:"  # of the file's attributes


@dataclass(frozen=True)
class Reference:
    """(H, W, 3) float64 arrays, bottom row first, and text about their making."""

    mean: np.ndarray
    variance: np.ndarray  # of the mean, that of rounding to half floats included
    about: dict[str, str]


def write(path: Path, mean: np.ndarray, variance: np.ndarray, about: dict[str, str]) -> None:
    """Writes arrays as in `Reference`; `about` becomes attributes of the file."""
    error = np.sqrt(variance + rounding_variance(mean))
    pixels = np.concatenate([mean, error], axis=2)[::-1].astype(np.float16)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(CHANNELS), "half")
    spec.channelnames = CHANNELS
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
    if spec.channelnames != CHANNELS:
        raise OSError(f"{path}: channels {spec.channelnames}")
    pixels = np.asarray(file.read_image("float"), np.float64)[::-1]
    file.close()
    about = {
        item.name.removeprefix(PREFIX): str(item.value)
        for item in spec.extra_attribs
        if item.name.startswith(PREFIX)
    }
    return Reference(pixels[..., :3], pixels[..., 3:] ** 2, about)


def rounding_variance(mean: np.ndarray) -> np.ndarray:
    """Variance of an error that is uniform over the spacing of half floats."""
    return np.spacing(mean.astype(np.float16)).astype(np.float64) ** 2 / 12.0
