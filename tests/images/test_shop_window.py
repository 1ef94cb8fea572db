# SPDX-License-Identifier: GPL-3.0-or-later
"""All methods at once, chosen by the defaults: glints, and caustics by mirrors and glass, seen
directly, in a mirror and through glass. Path tracing of the same scene without glints is the truth.
"""

from __future__ import annotations

import dataclasses

import pytest

from tests.images import _children
from tests.images import _statistics as statistics
from tests.images._cases import AUTOMATIC

BLOCK_Z = statistics.threshold(statistics.block_count(AUTOMATIC.size))
TOTAL_Z = statistics.threshold(3)
DETECTED = 1.12  # a factor on the image that must be found


@pytest.fixture(scope="module")
def image(tmp_path_factory, seed, reference):
    settings = {
        "samples": AUTOMATIC.samples,
        "seed": seed,
        "max_bounces": AUTOMATIC.max_bounces,
    }
    folder = tmp_path_factory.mktemp("shop_window")
    rendered = _children.render("blender", AUTOMATIC, {"image": settings}, folder).images["image"]
    return statistics.with_rare_paths(
        statistics.with_shared_splats(rendered), reference(AUTOMATIC.name)
    )


def test_every_method_has_its_part(image):
    for key in ("walks", "splats", "glint_estimates"):
        assert image.stats[key] > 0, key
    assert image.stats["nan_samples"] == 0
    assert image.stats["capped_energy"] <= 1e-3 * image.stats["manifold_energy"]


def test_means_agree_with_path_tracing(image, reference):
    truth = reference(AUTOMATIC.name)
    blocks, total = statistics.block_z(image, truth), statistics.weighted_z(image, truth)
    assert abs(blocks).max() < BLOCK_Z, statistics.strongest(blocks)
    assert abs(total).max() < TOTAL_Z, statistics.strongest(total)


@pytest.mark.parametrize("factor", [DETECTED, 1.0 / DETECTED])
def test_a_wrong_factor_is_found(image, reference, factor):
    scaled = dataclasses.replace(image, mean=image.mean * factor)
    total = statistics.weighted_z(scaled, reference(AUTOMATIC.name))
    assert abs(total).max() > TOTAL_Z, statistics.strongest(total)
