# SPDX-License-Identifier: GPL-3.0-or-later
"""Debian's Blender and today's export the same scene and render the same image."""

from __future__ import annotations

import ast

import numpy as np
import pytest

from tests.images import _children
from tests.images import _statistics as statistics
from tests.images._cases import CASES

SCENES = ("ring", "cornell")
SAMPLES = 16
# What may differ in its last bits, relative to its largest value.
TOLERANCES = {
    "normals": 1e-5,  # from 4.1 on corner normals are computed in another way
    "power": 1e-6,  # of lights: a factor of old files is multiplied in by today's loader
}
# By what of materials and their nodes the core is told what today's Blender does otherwise.
BY_VERSION = {"bump_correction", "multiple_scattering"}
TOTAL_Z = statistics.threshold(3 * len(SCENES))
BLOCK_Z = statistics.threshold(sum(statistics.block_count(CASES[name].size) for name in SCENES))


@pytest.fixture(scope="module", params=SCENES)
def results(request, tmp_path_factory, seed):
    """(Debian's, today's) results of one scene."""
    folder = tmp_path_factory.mktemp("versions")
    settings = {"image": {"method": "SMS_UNBIASED", "samples": SAMPLES, "seed": seed}}
    return [
        _children.render(host, CASES[request.param], settings, folder, scene_arrays=True)
        for host in ("blender", "bpy")
    ]


def differing(old: dict, new: dict) -> list[str]:
    return [path for path in old if not np.array_equal(old[path], new[path])]


def of_both(old: np.ndarray, new: np.ndarray) -> list[dict]:
    """The dicts whose texts they hold, of the names in both, but for what goes by version. A socket
    or an option that one Blender lacks stands at its default in the other."""
    said = [ast.literal_eval(text.item()) for text in (old, new)]
    names = said[0].keys() & said[1].keys() - BY_VERSION
    return [{name: one[name] for name in names} for one in said]


def test_exported_scenes_are_equal_but_for_last_bits(results):
    old, new = (result.scene_arrays for result in results)
    assert old.keys() == new.keys()
    for path in differing(old, new):
        kind = path.rpartition("/")[2]
        if kind in BY_VERSION:
            continue
        if kind in ("options", "inputs"):
            ours, todays = of_both(old[path], new[path])
            assert ours == todays, path
            continue
        assert kind in TOLERANCES, f"{path}: {old[path]} in 3.4, {new[path]} today"
        tolerance = TOLERANCES[kind] * abs(old[path]).max()
        np.testing.assert_allclose(new[path], old[path], rtol=0, atol=tolerance, err_msg=path)


def test_images_are_equal(results):
    """To the bit if the exported scenes are; else up to noise."""
    old, new = (result.images["image"] for result in results)
    if not differing(*(result.scene_arrays for result in results)):
        np.testing.assert_array_equal(old.mean, new.mean)
        np.testing.assert_array_equal(old.variance, new.variance)
    assert abs(statistics.total_z(old, new)).max() < TOTAL_Z
    assert abs(statistics.block_z(old, new)).max() < BLOCK_Z
