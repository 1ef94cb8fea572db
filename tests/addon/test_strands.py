# SPDX-License-Identifier: GPL-3.0-or-later
"""Strands as tubes and points as balls: where their surfaces are, and which way they face."""

import numpy as np
import pytest

from specula.export.desc import AttributeKind, AttributeNeed
from specula.export.hashes import hash_with_to_unit
from specula.export.strands import INFO, SIDES, TANGENT, ball, particle_hair, tubes


def face_normals(mesh):
    a, b, c = np.moveaxis(mesh.positions[mesh.triangles].astype(float), 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(lengths > 0, lengths, 1), 0.5 * lengths[:, 0]


def bent(count=9):
    """A strand of a quarter of a circle of radius 1, and a straight one of two points."""
    t = np.linspace(0, np.pi / 2, count)
    arc = np.stack([np.sin(t), np.zeros(count), 1 - np.cos(t)], axis=1)
    return np.concatenate([arc, [(3, 0, 0), (3, 0, 2)]]), np.array([count, 2])


def test_a_tube_is_around_its_strand():
    points, counts = bent()
    mesh = tubes("Hair", points, np.full(len(points), 0.05), counts)
    rings = mesh.positions.reshape(-1, SIDES, 3).astype(float)
    middles = {tuple(middle) for middle in rings.mean(axis=1).round(4) + 0.0}
    assert middles == {tuple(point) for point in points.round(4) + 0.0}
    distances = np.linalg.norm(rings - rings.mean(axis=1, keepdims=True), axis=2)
    np.testing.assert_allclose(distances, distances[0, 0], rtol=1e-4)


def test_a_tube_is_as_wide_as_a_round_one_on_average():
    points, counts = np.array([(0, 0, 0), (0, 0, 1.0)]), np.array([2])
    mesh = tubes("Hair", points, np.full(2, 0.5), counts)
    angles = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
    across = mesh.positions[:, :2] @ np.stack([np.cos(angles), np.sin(angles)])
    assert np.ptp(across, axis=0).mean() == pytest.approx(1.0, rel=1e-4)


@pytest.mark.parametrize("mesh", [tubes("Hair", bent()[0], np.full(11, 0.05), bent()[1]), ball()])
def test_faces_look_outwards_as_their_normals_do(mesh):
    normals, areas = face_normals(mesh)
    agreement = (mesh.normals * normals[:, None]).sum(axis=2)
    assert agreement[areas > 0].min() > 0.6
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=2), 1, atol=1e-5)


def test_a_ball_is_round():
    mesh = ball()
    np.testing.assert_allclose(np.linalg.norm(mesh.positions, axis=1), 1, atol=1e-5)
    assert face_normals(mesh)[1].sum() == pytest.approx(4 * np.pi, rel=0.02)
    edges = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()  # it is closed


def test_uv_is_that_of_the_strand():
    points, counts = bent()
    uv = np.array([(0.1, 0.2), (0.7, 0.9)])
    (layer,) = tubes("Hair", points, np.full(11, 0.05), counts, {"UVMap": uv}).attributes
    assert layer.name == "UVMap" and {tuple(at) for at in layer.values.reshape(-1, 2).round(3)} == {
        (np.float32(0.1).round(3), np.float32(0.2).round(3)),
        (np.float32(0.7).round(3), np.float32(0.9).round(3)),
    }


def test_single_points_are_no_strands():
    assert tubes("Hair", np.zeros((2, 3)), np.ones(2), np.array([1, 1])) is None


class Particles:
    """Two parents, shown only without children, of three keys each; the object is moved."""

    def __init__(self, children):
        self.name, self.particles, self.child_particles = "Fur", [0, 1], range(children)
        self.settings = self
        self.render_step, self.display_step = 1, 0
        self.shape, self.root_radius, self.tip_radius = 0.0, 1.0, 0.5
        self.radius_scale, self.use_close_tip = 0.2, False

    def co_hair(self, obj, particle_no, step):
        return (particle_no + 5, 0, step)


class Emitter:
    name, modifiers, data = "Ball", (), None
    matrix_world = np.array([(1, 0, 0, 5), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)], float)


@pytest.mark.parametrize(("children", "strands"), [(0, [0, 1]), (3, [2, 3, 4])])
def test_hair_is_in_object_space_and_children_stand_for_their_parents(children, strands):
    mesh = particle_hair(Emitter(), Particles(children), frozenset(), is_render=True)
    rings = mesh.positions.reshape(len(strands), 3, SIDES, 3).mean(axis=2)
    np.testing.assert_allclose(rings[:, 0, 0], strands, atol=1e-5)
    np.testing.assert_allclose(rings[0, :, 2], (0, 1, 2), atol=1e-5)
    across = np.linalg.norm(
        mesh.positions.reshape(len(strands), 3, SIDES, 3) - rings[:, :, None], axis=3
    )
    widths = across[0, :, 0] / across[0, 0, 0]
    np.testing.assert_allclose(widths, (1, 0.75, 0.5), atol=1e-5)


def test_tubes_tell_of_their_strands():
    points, counts = bent()
    needs = frozenset(AttributeNeed(AttributeKind.NAMED, name) for name in (TANGENT, INFO))
    mesh = tubes("Hair", points, np.full(len(points), 0.05), counts, needs=needs)
    found = {attribute.name: attribute.values for attribute in mesh.attributes}
    assert set(found) == {TANGENT, INFO}
    positions = mesh.positions.reshape(-1, SIDES, 3)
    middles = positions.mean(axis=1)
    along, info = (found[name].reshape(len(middles), SIDES, -1) for name in (TANGENT, INFO))
    assert (along == along[:, :1]).all() and (info == info[:, :1]).all()
    straight = middles[:, 0] > 2.0
    np.testing.assert_allclose(along[straight, 0], [(0, 0, 1)] * 2, atol=1e-6)
    np.testing.assert_allclose(info[straight, 0, :3], [(0, 2, 0.1), (1, 2, 0.1)], rtol=1e-5)
    # Of an arc: the angle tells how far along a place is; its chords are a little shorter.
    angles = np.arcsin(np.clip(middles[~straight, 0], 0, 1)) / (np.pi / 2)
    np.testing.assert_allclose(info[~straight, 0, 0], angles, atol=1e-3)
    np.testing.assert_allclose(info[~straight, 0, 1], np.pi / 2, rtol=0.01)
    inner = np.flatnonzero(~straight)[1:-1]
    angles *= np.pi / 2
    tangents = np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)[1:-1]
    np.testing.assert_allclose(along[inner, 0], tangents, atol=0.01)
    random = hash_with_to_unit(np.array([0, 1], np.uint32), 0)
    np.testing.assert_allclose(sorted(set(info[:, 0, 3])), sorted(random), rtol=1e-6)
