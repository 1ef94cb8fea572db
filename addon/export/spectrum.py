# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of single wavelengths and of black bodies, as tables that nodes look up."""

from __future__ import annotations

from functools import cache

import numpy as np

# The CIE's colour matching functions of 1931 for each 5 nm from 380 nm on, in units of 1e-4.
_MATCHING_TEXT = """
    14 0 65, 22 1 105, 42 1 201, 76 2 362, 143 4 679, 232 6 1102, 435 12 2074, 776 22 3713,
    1344 40 6456, 2148 73 10391, 2839 116 13856, 3285 168 16230, 3483 230 17471, 3481 298 17826,
    3362 380 17721, 3187 480 17441, 2908 600 16692, 2511 739 15281, 1954 910 12876,
    1421 1126 10419, 956 1390 8130, 580 1693 6162, 320 2080 4652, 147 2586 3533, 49 3230 2720,
    24 4073 2123, 93 5030 1582, 291 6082 1117, 633 7100 782, 1096 7932 573, 1655 8620 422,
    2257 9149 298, 2904 9540 203, 3597 9803 134, 4334 9950 87, 5121 10000 57, 5945 9950 39,
    6784 9786 27, 7621 9520 21, 8425 9154 18, 9163 8700 17, 9786 8163 14, 10263 7570 11,
    10567 6949 10, 10622 6310 8, 10456 5668 6, 10026 5030 3, 9384 4412 2, 8544 3810 2,
    7514 3210 1, 6424 2650 0, 5419 2170 0, 4479 1750 0, 3608 1382 0, 2835 1070 0, 2187 816 0,
    1649 610 0, 1212 446 0, 874 320 0, 636 232 0, 468 170 0, 329 119 0, 227 82 0, 158 57 0,
    114 41 0, 81 29 0, 58 21 0, 41 15 0, 29 10 0, 20 7 0, 14 5 0, 10 4 0, 7 2 0, 5 2 0, 3 1 0,
    2 1 0, 2 1 0, 1 0 0, 1 0 0, 1 0 0, 0 0 0
"""
_MATCHING = 1e-4 * np.array(
    [[float(number) for number in row.split()] for row in _MATCHING_TEXT.split(",")]
)
WAVELENGTHS = 380.0 + 5.0 * np.arange(len(_MATCHING))  # nm
TEMPERATURES = (800.0, 12000.0)  # K
_XYZ_TO_REC709 = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)
_BRIGHTEST = 2.52  # channel of a wavelength, which Cycles calls 1


def _table(xyz: np.ndarray) -> np.ndarray:
    """Rows (N, 4) of colours and an alpha of 1; what is outside of Rec.709 is moved in."""
    colors = np.maximum(xyz @ _XYZ_TO_REC709.T, 0.0)
    return np.concatenate((colors, np.ones((len(colors), 1))), axis=1).astype(np.float32)


@cache
def wavelengths() -> np.ndarray:
    """(81, 4): even in the wavelength, from the first of WAVELENGTHS to the last."""
    return _table(_MATCHING / _BRIGHTEST)


@cache
def blackbodies() -> np.ndarray:
    """(1024, 4) of luminance 1, even in the inverse temperature: the hottest first."""
    coldest, hottest = TEMPERATURES
    inverse = np.linspace(1.0 / hottest, 1.0 / coldest, 1024)[:, None]
    meters = WAVELENGTHS * 1e-9
    radiance = meters**-5 / np.expm1(1.4388e-2 * inverse / meters)  # Planck, but for a factor
    xyz = radiance @ _MATCHING
    return _table(xyz / xyz[:, 1:2])
