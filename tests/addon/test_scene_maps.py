# SPDX-License-Identifier: GPL-3.0-or-later
"""The relief of blend_scenes/displaced.blend, as a mesh and as a normal map."""

import numpy as np

from blend_scenes.generators import maps


def refined(heights):
    """The next finer control points of a periodic uniform cubic spline along the first axis:
    even ones where the old ones are, odd ones in between."""
    before, after = np.roll(heights, 1, axis=0), np.roll(heights, -1, axis=0)
    fine = np.empty((2 * len(heights), *heights.shape[1:]))
    fine[0::2], fine[1::2] = (before + 6.0 * heights + after) / 8.0, (heights + after) / 2.0
    return fine


def test_normal_map_has_the_slopes_of_the_subdivided_mesh():
    controls, texels, side, levels = 6, 4, 1.7, 5
    heights = np.random.default_rng(3).standard_normal((controls, controls))
    fine = heights
    for _ in range(levels):
        fine = refined(refined(fine).T).T

    def limit(values):
        return (np.roll(values, 1, axis=0) + 4.0 * values + np.roll(values, -1, axis=0)) / 6.0

    def difference(values):
        return (np.roll(values, -1, axis=0) - np.roll(values, 1, axis=0)) / 2.0

    spacing = side / len(fine)
    along_v = limit(difference(fine).T).T / spacing
    along_u = difference(limit(fine).T).T / spacing
    # Texel centres among the fine control points, which begin at the middle of the first cell.
    step = 2**levels // texels
    centres = (np.arange(controls * texels) * step + step // 2 - 2**levels // 2) % len(fine)
    slope_u, slope_v = maps.spline_slopes(heights, side, texels)
    np.testing.assert_allclose(slope_u, along_u[np.ix_(centres, centres)], atol=1e-12)
    np.testing.assert_allclose(slope_v, along_v[np.ix_(centres, centres)], atol=1e-12)
