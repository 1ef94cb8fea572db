# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps' brightness by direction, from IES files [LM-63], as Cycles reads them."""

from __future__ import annotations

import numpy as np

# Candela -> watts over the sphere, by the luminous efficacy of D65 (177.83 lm/W).
WATTS = 4 * np.pi / 177.83
NOT_READ = 100.0  # what Cycles shows of a file that it cannot read

TYPE_C, TYPE_B = 1, 2  # photometric types: around the vertical axis, around a horizontal one


class IesError(Exception):
    """The text is no table of a lamp that could be used; the message says why."""


def constant_profile(value: float = NOT_READ) -> np.ndarray:
    return _packed(np.array([0.0, 360.0]), np.array([0.0, 180.0]), np.full((2, 2), value))


def profile(text: str) -> np.ndarray:
    """The array "Profile" (N, 1) float32 of the core's IES Texture. Raises IesError."""
    numbers = _numbers(text)
    _, _, factor, polar_count, azimuth_count, kind = numbers.take(6)
    if kind not in (TYPE_B, TYPE_C):
        raise IesError(f"photometric type {kind:g} is not supported")
    numbers.take(4)  # the lamp's unit and size
    factor *= np.prod(numbers.take(2)) * WATTS  # of the ballast
    numbers.take(1)  # input power
    polars, azimuths = numbers.take(int(polar_count)), numbers.take(int(azimuth_count))
    values = factor * numbers.take(polars.size * azimuths.size)
    values = values.reshape(azimuths.size, polars.size)
    if min(polars.size, azimuths.size) == 0:
        raise IesError("has no angles")
    around = _around_horizontal if kind == TYPE_B else _around_vertical
    return _packed(*around(azimuths, polars, values))


class _Numbers:
    def __init__(self, words: list[str]):
        self._words = words

    def take(self, count: int) -> np.ndarray:
        words, self._words = self._words[:count], self._words[count:]
        if count < 0 or len(words) < count:
            raise IesError("ends too early")
        try:
            numbers = np.array([float(word) for word in words])
        except ValueError as error:
            raise IesError(str(error)) from None
        if not np.isfinite(numbers).all():
            raise IesError("a number is not finite")
        return numbers


def _numbers(text: str) -> _Numbers:
    """What follows the line TILT=, and the table that may come with that."""
    lines = text.replace(",", " ").splitlines()
    tilt = next((i for i, line in enumerate(lines) if i and line.startswith("TILT=")), None)
    if tilt is None:
        raise IesError("has no line TILT=")
    numbers = _Numbers(" ".join(lines[tilt + 1 :]).split())
    if lines[tilt].startswith("TILT=INCLUDE"):
        _, count = numbers.take(2)
        numbers.take(2 * int(count))
    return numbers


def _around_vertical(azimuths, polars, values):
    if azimuths[0] == 90.0:
        azimuths = azimuths - 90.0
    if azimuths[0] != 0.0 or polars[0] not in (0.0, 90.0):
        raise IesError("its angles do not start at 0")
    if polars[0] == 90.0 and polars[-1] != 180.0:
        raise IesError("its angles end before 180")
    if azimuths.size == 1:
        azimuths, values = np.array([0.0, 360.0]), np.repeat(values, 2, axis=0)
    for half in (90.0, 180.0):  # of which the rest is the mirror image
        if azimuths[-1] == half:
            azimuths = np.r_[azimuths, 2.0 * half - azimuths[-2::-1]]
            values = np.r_[values, values[-2::-1]]
    if azimuths[-1] != 360.0:  # left out, as it repeats the first
        if 360.0 - azimuths[-1] not in (azimuths[1] - azimuths[0], azimuths[-1] - azimuths[-2]):
            raise IesError("its azimuths end before 360")
        azimuths, values = np.r_[azimuths, 360.0], np.r_[values, values[:1]]
    return azimuths, polars, values


def _around_horizontal(azimuths, polars, values):
    azimuths, polars, values = polars, azimuths, values.T
    azimuths, values = _half_turn(azimuths, values)
    polars, by_polar = _half_turn(polars, values.T)
    return azimuths, polars, by_polar.T


def _half_turn(angles, values):
    """Angles up to 90, of a half or all of the rest, as 0 to 180."""
    if angles[-1] != 90.0 or angles[0] not in (0.0, -90.0):
        raise IesError("its angles are not those of type B")
    if angles[0] == -90.0:
        return angles + 90.0, values
    return np.r_[90.0 - angles[:0:-1], 90.0 + angles], np.r_[values[:0:-1], values]


def _packed(azimuths, polars, values) -> np.ndarray:
    if (
        (np.diff(azimuths) < 0).any()
        or (np.diff(polars) < 0).any()
        or min(polars.size, azimuths.size) < 2
    ):
        raise IesError("its angles do not grow")
    angles = np.radians(np.r_[azimuths, polars])
    packed = np.r_[azimuths.size, polars.size, angles, values.ravel()]
    return packed.astype(np.float32)[:, None]
