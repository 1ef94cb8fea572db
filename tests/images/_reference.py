# SPDX-License-Identifier: GPL-3.0-or-later
"""Reference images: EXR files with the mean and its standard error, both half floats; the bench's
with the manifold's and light tracing's share of the mean as well, and with the places that light
tracing reaches.

The standard error and not the variance, which would leave the range of half floats. What rounding
the mean leaves, more than the error of a good reference where it is smooth, is a layer of small
whole numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

FOLDER = Path(__file__).resolve().parent / "references"
CHANNELS = ("R", "G", "B", "error.R", "error.G", "error.B", "fine.R", "fine.G", "fine.B")
CAUSTICS_CHANNELS = ("caustics.R", "caustics.G", "caustics.B")
DIRECT_CHANNELS = ("direct",)
FINE = 16.0  # units of `fine` between a half float and the next
PREFIX = "specula:"  # of the file's attributes


@dataclass(frozen=True)
class Reference:
    """(H, W, 3) float64 arrays, bottom row first, and text about their making."""

    mean: np.ndarray
    variance: np.ndarray  # of the mean, that of rounding to half floats included
    about: dict[str, str]
    caustics: np.ndarray | None = None
    # (H, W), bool: where the camera sees caustics without mirrors or glass in between.
    direct: np.ndarray | None = None

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
    direct: np.ndarray | None = None,
) -> None:
    """Writes arrays as in `Reference`; `about` becomes attributes of the file."""
    for values in (mean, np.sqrt(variance)):
        if not (np.abs(values) < np.finfo(np.float16).max).all():
            raise ValueError(f"{path}: a pixel is too bright for half floats, or not finite")
    rounded = mean.astype(np.float16)
    unit = fine_unit(rounded)
    fine = np.round((mean - rounded) / unit)
    error = np.sqrt(variance + unit**2 / 12.0)
    layers, channels = [rounded, error, fine], CHANNELS
    if caustics is not None:
        layers.append(caustics)
        channels += CAUSTICS_CHANNELS
    if direct is not None:
        layers.append(direct[..., None])
        channels += DIRECT_CHANNELS
    pixels = np.ascontiguousarray(np.concatenate(layers, axis=2)[::-1], np.float16)
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
    known = {*CHANNELS, *CAUSTICS_CHANNELS, *DIRECT_CHANNELS}
    if not set(CHANNELS) <= set(found) <= known:
        raise OSError(f"{path}: channels {found}")
    pixels = np.asarray(file.read_image("float"), np.float64)[::-1]
    file.close()

    def layer(channels: tuple[str, ...]) -> np.ndarray | None:
        if not set(channels) <= set(found):
            return None
        return pixels[..., [found.index(channel) for channel in channels]]

    values, direct = layer(CHANNELS), layer(DIRECT_CHANNELS)
    about = {
        item.name.removeprefix(PREFIX): str(item.value)
        for item in spec.extra_attribs
        if item.name.startswith(PREFIX)
    }
    rounded, error, fine = np.split(values, 3, axis=-1)
    return Reference(
        rounded + fine * fine_unit(rounded.astype(np.float16)),
        error**2,
        about,
        layer(CAUSTICS_CHANNELS),
        None if direct is None else direct[..., 0] > 0.5,
    )


def fine_unit(rounded: np.ndarray) -> np.ndarray:
    """What 1 in `fine` is worth beside half floats."""
    return np.abs(np.spacing(rounded)).astype(np.float64) / FINE
