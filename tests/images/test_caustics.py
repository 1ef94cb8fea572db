# SPDX-License-Identifier: GPL-3.0-or-later
"""Manifold sampling and light tracing against path tracing of the same scenes, with lights that all
can handle.

Hypothesis: an unbiased image and its reference have the same expectation, in every block of pixels,
in every channel and in all; a biased one is nowhere brighter. Thresholds are shared by all
comparisons of a family over all scenes and variants.

Light tracing alone leaves what is seen in mirrors and through glass to path tracing, which finds
much of it by rare bright samples; where it finds next to all, the block has the variance that the
reference knows (`with_rare_paths`).
"""

from __future__ import annotations

import dataclasses

import pytest

from tests.images import _statistics as statistics
from tests.images._cases import (
    JOINT,
    LIGHT_TRACING,
    MNEE_SEEDS,
    SET_SIZES,
    SHEETS,
    VARIANTS,
    WITH_CASTERS,
    biased_name,
)

ALL_VARIANTS = [variant.name for variant in VARIANTS]
WITH_LIGHT = [JOINT.name, LIGHT_TRACING]
SPLATTED = [*WITH_LIGHT, *(name for name, light_tracing in SHEETS.items() if light_tracing == "ON")]
UNBIASED = [*ALL_VARIANTS, *WITH_LIGHT, *SHEETS, MNEE_SEEDS]
BLOCKS = sum(statistics.block_count(case.size) for case in WITH_CASTERS)
UNBIASED_BLOCK_Z = statistics.threshold(BLOCKS * len(UNBIASED))
UNBIASED_TOTAL_Z = statistics.threshold(3 * len(WITH_CASTERS) * len(UNBIASED))
EXCESS_Z = statistics.threshold(3 * len(WITH_CASTERS) * (len(UNBIASED) + 1))
BIASED_BLOCK_Z = statistics.threshold(BLOCKS * len(SET_SIZES), sides=1)
BIASED_TOTAL_Z = statistics.threshold(3 * len(WITH_CASTERS) * len(SET_SIZES), sides=1)

every_scene = pytest.mark.parametrize("case", WITH_CASTERS, ids=lambda case: case.name)
every_unbiased = pytest.mark.parametrize("name", UNBIASED)
every_set_size = pytest.mark.parametrize("set_size", SET_SIZES)


def scaled(image, factor: float):
    """The image that an estimator with a wrong factor on all caustics would give."""
    return dataclasses.replace(image, mean=image.mean + (factor - 1.0) * image.caustics)


def excess_z(images: dict, names: list[str], truth, factor: float = 1.0):
    """z of the caustics' energy over the renders `names` together, scaled by `factor`.

    Light tracing alone has its noise elsewhere than walks: it is weighed by what it adds to them.
    """
    others = [[images[v] for v in ALL_VARIANTS if v != name] for name in names]
    if names == [LIGHT_TRACING]:
        others = [[images[JOINT.name]]]
    weights = [statistics.caustics_weights(group, truth) for group in others]
    tested = [scaled(images[name], factor) for name in names]
    excess, error = statistics.caustics_excess(tested, weights, truth)
    return excess / error


LEFT_TO_PATH_TRACING = 0.1  # of the caustics, where light tracing alone is hardly tested

together = pytest.mark.parametrize(
    "names",
    [*([name] for name in [*ALL_VARIANTS, *WITH_LIGHT]), ALL_VARIANTS, [*SHEETS]],
    ids=[*ALL_VARIANTS, *WITH_LIGHT, "all variants", "light sheets"],
)


@every_scene
@every_unbiased
def test_unbiased_means_agree_with_path_tracing(case, name, rendered, reference):
    image, truth = rendered(case)[name], reference(case.name)
    blocks, total = statistics.block_z(image, truth), statistics.total_z(image, truth)
    assert abs(blocks).max() < UNBIASED_BLOCK_Z, statistics.strongest(blocks)
    assert abs(total).max() < UNBIASED_TOTAL_Z, statistics.strongest(total)


def detected(case, names: list[str]) -> float | None:
    if names == [LIGHT_TRACING]:
        return case.detects_light
    if names == [JOINT.name]:
        return case.detects_joint
    if names == [*SHEETS]:
        return case.detects_sheets  # the walks beside them are rare, and bright
    return case.detects_together if len(names) > 1 else case.detects


@every_scene
@together
def test_caustics_carry_the_energy_of_path_traced_ones(case, names, rendered, reference):
    z = excess_z(rendered(case), names, reference(case.name))
    assert abs(z).max() < EXCESS_Z, statistics.strongest(z)


@every_scene
@together
@pytest.mark.parametrize("sign", [1, -1], ids=["too bright", "too dark"])
def test_a_wrong_factor_on_all_caustics_is_found(case, names, sign, rendered, reference):
    """The power of the test above."""
    error = detected(case, names)
    if error is None:
        assert names == [LIGHT_TRACING]
        caustics = [statistics.total(rendered(case)[name].caustics) for name in WITH_LIGHT]
        assert (caustics[1] < LEFT_TO_PATH_TRACING * caustics[0]).all()
        return
    z = excess_z(rendered(case), names, reference(case.name), 1.0 + sign * error)
    assert abs(z).max() > EXCESS_Z, statistics.strongest(z)


@every_scene
@every_unbiased
def test_no_energy_is_given_up(case, name, rendered):
    stats = rendered(case)[name].stats
    assert stats["nan_samples"] == 0
    assert (stats["splats"] > 0) == (name in SPLATTED)
    assert (stats["walks"] > 0) == (name != LIGHT_TRACING)
    assert stats["capped_energy"] <= 1e-3 * stats["manifold_energy"]


@every_scene
@every_set_size
def test_biased_is_nowhere_brighter_than_path_tracing(case, set_size, rendered, reference):
    image, truth = rendered(case)[biased_name(set_size)], reference(case.name)
    blocks, total = statistics.block_z(image, truth), statistics.total_z(image, truth)
    assert blocks.max() < BIASED_BLOCK_Z, statistics.strongest(blocks)
    assert total.max() < BIASED_TOTAL_Z, statistics.strongest(total)


@every_scene
def test_larger_sets_lose_less(case, rendered):
    """Up to noise; and what is left is not nothing."""
    small, large = (rendered(case)[biased_name(set_size)] for set_size in SET_SIZES)
    assert statistics.total_z(small, large).max() < BIASED_TOTAL_Z
    assert (statistics.total(small.caustics) > 0.0).all()
