# SPDX-License-Identifier: GPL-3.0-or-later
"""Light tracing against the manifold, and both together, where path tracing is blind: lights of no
size.

Hypothesis: all pictures have the same expectation, in every block of pixels, in every channel and
in all.
"""

from __future__ import annotations

import dataclasses

import pytest

from tests.images import _children
from tests.images import _statistics as statistics
from tests.images._cases import DELTA_LIGHTS, JOINT, LIGHT_TRACING, SEED_STEP, VARIANTS

MANIFOLD = VARIANTS[-1].name
WITH_LIGHT = [LIGHT_TRACING, JOINT.name]
BLOCKS = sum(statistics.block_count(case.size) for case in DELTA_LIGHTS.values())
BLOCK_Z = statistics.threshold(BLOCKS * len(WITH_LIGHT))
TOTAL_Z = statistics.threshold(3 * len(DELTA_LIGHTS) * len(WITH_LIGHT))

with_light = pytest.mark.parametrize("name", WITH_LIGHT)


@pytest.fixture(scope="module", params=DELTA_LIGHTS)
def case(request):
    return DELTA_LIGHTS[request.param]


@pytest.fixture(scope="module")
def images(case, seed, tmp_path_factory):
    """Renders by name."""
    renders = {
        MANIFOLD: VARIANTS[-1].settings(case),
        JOINT.name: JOINT.settings(case),
        LIGHT_TRACING: {"method": "LT", "samples": case.samples},
        "path tracing": {"method": "PT", "samples": case.samples},
    }
    for index, settings in enumerate(renders.values()):
        settings |= {"seed": seed + SEED_STEP * index, "max_bounces": case.max_bounces}
    folder = tmp_path_factory.mktemp(case.name)
    found = _children.render("blender", case, renders, folder).images
    return {name: statistics.with_shared_splats(image) for name, image in found.items()}


def weighed_z(image, other):
    """z of the caustics' energy, most of it where there are caustics."""
    weights = statistics.caustics_weights([other], other)
    excess, error = statistics.caustics_excess([image], [weights], other)
    return excess / error


@with_light
def test_means_agree_with_the_manifold(images, name):
    blocks = statistics.block_z(images[name], images[MANIFOLD])
    total = weighed_z(images[name], images[MANIFOLD])
    assert abs(blocks).max() < BLOCK_Z, statistics.strongest(blocks)
    assert abs(total).max() < TOTAL_Z, statistics.strongest(total)


@with_light
@pytest.mark.parametrize("sign", [1, -1], ids=["too bright", "too dark"])
def test_a_wrong_factor_on_all_caustics_is_found(case, images, name, sign):
    """The power of the test above."""
    image = images[name]
    mean = image.mean + sign * case.detects * image.caustics
    total = weighed_z(dataclasses.replace(image, mean=mean), images[MANIFOLD])
    assert abs(total).max() > TOTAL_Z, statistics.strongest(total)


def test_path_tracing_is_blind(images):
    z = weighed_z(images["path tracing"], images[MANIFOLD])
    assert z.max() < -TOTAL_Z, statistics.strongest(z)
