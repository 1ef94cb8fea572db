# SPDX-License-Identifier: GPL-3.0-or-later
"""A lamp's own limit of bounces takes away the light that it does in Cycles."""

import numpy as np
import pytest
import tiles
from scenes import add_camera, add_light, add_mesh, add_node, new_material, surface

SIZE, BLOCK = 16, 4  # pixels


def room():
    """A floor and a wall of matt white, and a lamp without size, which rays do not find."""
    white = new_material("White")
    add_node(white, "ShaderNodeBsdfDiffuse", surface(white))
    add_mesh("Floor", [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], material=white)
    add_mesh("Wall", [(-2, 2, 0), (2, 2, 0), (2, 2, 3), (-2, 2, 3)], material=white)
    lamp = add_light("POINT", energy=200, shadow_soft_size=0)
    lamp.location = (0.5, 0.8, 1.5)
    camera = add_camera((0, 0, 6))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 3.5
    return lamp


def blocks(engine: str, folder) -> np.ndarray:
    picture = tiles.render(engine, folder).mean(axis=-1)
    return picture.reshape(SIZE // BLOCK, BLOCK, -1, BLOCK).mean(axis=(1, 3))


@pytest.mark.parametrize("limit", [0, 1])
def test_light_of_more_bounces_is_missing(limit, tmp_path):
    lamp = room()
    scene = tiles.prepare(SIZE)
    scene.specula.samples = scene.cycles.samples = 1024
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = 4
    whole = blocks("SPECULA", tmp_path)
    lamp.data.cycles.max_bounces = limit
    ours, theirs = (blocks(engine, tmp_path) for engine in ("SPECULA", "CYCLES"))
    assert (ours < 0.99 * whole).mean() > 0.5  # it takes away some
    np.testing.assert_allclose(ours, theirs, rtol=0.01)
