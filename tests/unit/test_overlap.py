"""Particle centres inside the domains of other bodies."""

import numpy as np
import pytest
from overlap import find_overlapping


def identity(d, count):
    return np.repeat(np.eye(d)[:, :, None], count, axis=2)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_a_centre_is_inside_or_not(d):
    X = np.zeros((d, 4))
    X[0] = [0.0, 0.49, 2.0, 2.51]
    size = np.full((d, 4), 0.5)
    inside = find_overlapping(X, identity(d, 4), size, np.array([0, 1, 0, 1]))
    assert inside.tolist() == [True, True, False, False]


def test_particles_of_one_body_may_overlap():
    X = np.zeros((2, 3))
    assert not find_overlapping(X, identity(2, 3), np.full((2, 3), 0.5), np.zeros(3, dtype=int)).any()


def test_domains_turn_and_stretch_with_the_material():
    """A particle four times as long along the diagonal, and another beside or on its axis."""
    turn = np.array([[1.0, -1.0], [1.0, 1.0]]) / np.sqrt(2.0)
    F = identity(2, 3)
    F[:, :, 0] = turn @ np.diag([4.0, 0.5])
    X = np.array([[0.0, 1.3, 0.6], [0.0, 1.3, -0.6]])
    inside = find_overlapping(X, F, np.full((2, 3), 0.5), np.array([0, 1, 2]))
    assert inside.tolist() == [False, True, False]


def test_the_same_as_all_pairs_one_by_one():
    rng = np.random.default_rng(7)
    count = 60
    X, body = rng.random((2, count)), rng.integers(0, 4, count)
    F = identity(2, count) + 0.5 * rng.standard_normal((2, 2, count))
    size = rng.uniform(0.01, 0.1, (2, count))
    wanted = np.zeros(count, dtype=bool)
    for p in range(count):
        for q in range(count):
            local = np.linalg.solve(F[:, :, q], X[:, p] - X[:, q]) / size[:, q]
            wanted[p] |= body[p] != body[q] and np.abs(local).max() < 1.0
    assert wanted.any()
    assert not wanted.all()
    np.testing.assert_array_equal(find_overlapping(X, F, size, body), wanted)
