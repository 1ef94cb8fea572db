# SPDX-License-Identifier: GPL-3.0-or-later
"""Rough metal under normal maps finer than a pixel: glints, and the light that it throws on, by
light paths, against path tracing of the same scenes without either.

Walks have no part in these scenes. Hypothesis: all pictures have the reference's expectation, in
every block of pixels, in every channel and in all.
"""

from __future__ import annotations

import dataclasses

import pytest

from tests.images import _children
from tests.images import _statistics as statistics
from tests.images._cases import GLITTERING, SEED_STEP

GLINTS, LIGHT_TRACING, AUTOMATIC = "glints", "glints, light tracing", "all defaults"
WITH_LIGHT = [LIGHT_TRACING, AUTOMATIC]
RENDERS = {GLINTS: {"method": "PT"}, LIGHT_TRACING: {"method": "LT"}, AUTOMATIC: {}}
BLOCK_Z = statistics.threshold(
    len(RENDERS) * sum(statistics.block_count(case.size) for case in GLITTERING.values())
)
TOTAL_Z = statistics.threshold(3 * len(GLITTERING) * len(RENDERS))
CAUSTICS_Z = statistics.threshold(3 * len(GLITTERING))
DETECTED = 1.03  # a factor on the image that must be found

every_render = pytest.mark.parametrize("name", RENDERS)


@pytest.fixture(scope="module", params=GLITTERING)
def case(request):
    return GLITTERING[request.param]


@pytest.fixture(scope="module")
def images(case, seed, reference, tmp_path_factory):
    """Renders by name, ready to be compared."""
    common = {"samples": case.samples, "max_bounces": case.max_bounces}
    renders = {
        name: settings | common | {"seed": seed + SEED_STEP * index}
        for index, (name, settings) in enumerate(RENDERS.items())
    }
    folder = tmp_path_factory.mktemp(case.name)
    found = _children.render("blender", case, renders, folder).images
    ready = {name: statistics.with_shared_splats(image) for name, image in found.items()}
    ready[GLINTS] = statistics.with_rare_paths(ready[GLINTS], reference(case.name))
    return ready


def excess_z(images, truth, factor: float = 1.0):
    """z of the energy of caustics in both renders with light paths, scaled by `factor`.

    Weights of each are of the other.
    """
    pair = [images[name] for name in WITH_LIGHT]
    weights = [statistics.caustics_weights([other], truth) for other in reversed(pair)]
    scaled = [
        dataclasses.replace(image, mean=image.mean + (factor - 1.0) * image.caustics)
        for image in pair
    ]
    excess, error = statistics.caustics_excess(scaled, weights, truth)
    return excess / error


@every_render
def test_every_method_has_its_part(images, name):
    stats = images[name].stats
    assert stats["nan_samples"] == 0
    assert stats["glint_estimates"] > 0
    assert stats["walks"] == 0
    assert (stats["splats"] > 0) == (name in WITH_LIGHT)


@every_render
def test_means_agree_with_path_tracing(case, images, name, reference):
    truth = reference(case.name)
    blocks, total = statistics.block_z(images[name], truth), statistics.total_z(images[name], truth)
    assert abs(blocks).max() < BLOCK_Z, statistics.strongest(blocks)
    assert abs(total).max() < TOTAL_Z, statistics.strongest(total)


@every_render
@pytest.mark.parametrize("factor", [DETECTED, 1.0 / DETECTED])
def test_a_wrong_factor_is_found(case, images, name, factor, reference):
    image, truth = images[name], reference(case.name)
    scaled = dataclasses.replace(image, mean=image.mean * factor)
    total = statistics.weighted_z(scaled, truth)
    assert abs(total).max() > TOTAL_Z, statistics.strongest(total)


def test_caustics_carry_the_energy_of_path_traced_ones(case, images, reference):
    z = excess_z(images, reference(case.name))
    assert abs(z).max() < CAUSTICS_Z, statistics.strongest(z)


@pytest.mark.parametrize("sign", [1, -1], ids=["too bright", "too dark"])
def test_a_wrong_factor_on_all_caustics_is_found(case, images, sign, reference):
    """The power of the test above."""
    z = excess_z(images, reference(case.name), 1.0 + sign * case.detects_light)
    assert abs(z).max() > CAUSTICS_Z, statistics.strongest(z)
