# SPDX-License-Identifier: GPL-3.0-or-later
"""The addon's colour matching functions and the core's are the same numbers."""

import re
from pathlib import Path

import numpy as np

from specula.export import spectrum

HEADER = Path(__file__).parents[2] / "native/core/color_matching.h"


def test_matching_functions():
    table = re.search(r"kColorMatching\{\{(.*?)\n\}\};", HEADER.read_text(), re.DOTALL).group(1)
    rows = [[int(number) for number in row.split(",")] for row in re.findall(r"\{(.*?)\}", table)]
    assert np.allclose(1e-4 * np.array(rows), spectrum._MATCHING)


def test_wavelengths():
    first, step = (
        float(re.search(rf"{name} = ([\d.]+)f", HEADER.read_text()).group(1))
        for name in ("kFirstWavelength", "kWavelengthStep")
    )
    assert np.allclose(spectrum.WAVELENGTHS, first + step * np.arange(81))
