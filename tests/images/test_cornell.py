# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene without casters: any method is path tracing, and path tracing is what Cycles does."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from tests.images import _children
from tests.images import _statistics as statistics
from tests.images._cases import CORNELL

METHODS = ("PT", "SMS_UNBIASED", "SMS_BIASED", "SHEETS", "LT")
REFERENCES = ("cornell", "cornell_cycles")
BLOCK_Z = statistics.threshold(statistics.block_count(CORNELL.size) * len(REFERENCES))
TOTAL_Z = statistics.threshold(3 * len(REFERENCES))
MEAN_TOLERANCE = 0.01  # between two renderers, whatever the noise
DETECTED = 1.005  # a factor on the image that must be found


@pytest.fixture(scope="module")
def images(tmp_path_factory, seed):
    """Renders by method."""
    settings = {
        method: {"method": method, "samples": CORNELL.samples, "seed": seed} for method in METHODS
    }
    return _children.render("blender", CORNELL, settings, tmp_path_factory.mktemp("cornell")).images


@pytest.mark.parametrize("method", METHODS[1:])
def test_without_casters_manifold_sampling_is_path_tracing(images, method):
    for item in ("mean", "variance"):
        np.testing.assert_array_equal(getattr(images[method], item), getattr(images["PT"], item))
    assert images[method].stats["estimates"] == 0


@pytest.mark.parametrize("name", REFERENCES)
def test_means_agree(images, reference, name):
    image, truth = images["PT"], reference(name)
    blocks, total = statistics.block_z(image, truth), statistics.total_z(image, truth)
    np.testing.assert_allclose(
        statistics.total(image.mean), statistics.total(truth.mean), rtol=MEAN_TOLERANCE
    )
    assert abs(total).max() < TOTAL_Z, statistics.strongest(total)
    assert abs(blocks).max() < BLOCK_Z, statistics.strongest(blocks)


@pytest.mark.parametrize("name", REFERENCES)
@pytest.mark.parametrize("factor", [DETECTED, 1.0 / DETECTED])
def test_a_wrong_factor_is_found(images, reference, name, factor):
    image = dataclasses.replace(images["PT"], mean=images["PT"].mean * factor)
    total = statistics.total_z(image, reference(name))
    assert abs(total).max() > TOTAL_Z, statistics.strongest(total)
