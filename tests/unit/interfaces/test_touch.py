"""Which matter touches at the start: gaps between the boxes of particles, against trying all pairs."""

import time

import numpy as np
import pytest

from mpmcli.interfaces.touch import gaps_at_nodes, gaps_of_particles


def lattice(lower, upper, spacing: float = 0.5) -> np.ndarray:
    """Centres of the boxes that fill a box."""
    axes = [np.arange(low + 0.5 * spacing, high, spacing) for low, high in zip(lower, upper, strict=True)]
    return np.stack([grid.ravel() for grid in np.meshgrid(*axes, indexing="ij")])


def two(first: np.ndarray, second: np.ndarray, spacing: float = 0.5):
    """Positions, half sizes and fields of two bodies."""
    X = np.concatenate([first, second], axis=1)
    return X, np.full_like(X, 0.5 * spacing), np.repeat([0, 1], [first.shape[1], second.shape[1]])


def gap_of_all_pairs(X, half, one, other) -> np.ndarray:
    """(one, other) gap between the boxes of any two particles."""
    apart = np.abs(X[:, one, None] - X[:, None, other]) - (half[:, one, None] + half[:, None, other])
    return np.sqrt((np.maximum(apart, 0.0) ** 2).sum(axis=0))


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("within", [0.1, 0.7, 1.0])
def test_gaps_of_particles_are_those_of_all_pairs(d, within):
    random = np.random.default_rng(d)
    n, cell = 120, np.array([1.0, 0.8, 1.3])[:d]
    X = random.uniform(-3.0, 3.0, (d, n)) - 100.0
    half = random.uniform(0.05, 0.4, (d, n))
    field = random.integers(0, 3, n)
    found = gaps_of_particles(X, half, field, (2, 0), cell, within)
    for mine, theirs in ((0, 2), (2, 0)):
        one, other = np.flatnonzero(field == mine), np.flatnonzero(field == theirs)
        expected = gap_of_all_pairs(X, half, one, other).min(axis=1)
        known = expected <= within * cell.max()
        certain = expected <= within * cell.min()
        assert np.isfinite(found[one][certain]).all()
        near = known & np.isfinite(found[one])
        assert found[one][near] == pytest.approx(expected[near], abs=1e-12)
        assert np.isinf(found[one][~known]).all()
    assert np.isinf(found[field == 1]).all()


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("gap", [0.0, 0.05, 0.3])
def test_faces_have_the_gap_between_them_at_every_node_that_sees_both(d, gap):
    lower, upper = [0.0] * d, [3.0] * d
    X, half, field = two(lattice(lower, upper), lattice(lower, upper))
    X[0, field == 1] += 3.0 + gap
    shape = (12,) * d
    nodes, found = gaps_at_nodes(X, half, field, (0, 1), np.full(d, -2.0), np.ones(d), shape)
    assert found == pytest.approx(np.full(len(nodes), gap), abs=1e-12)
    places = np.stack(np.unravel_index(nodes, shape, order="F")) - 2.0
    assert set(places[0]) == {3.0}
    assert (np.diff(nodes) > 0).all()
    assert len(nodes) == 4 ** (d - 1)


def test_a_joint_that_closes_only_in_part():
    """Two blocks that touch over half of their length, above a step of 0.4 cells."""
    low = lattice([0, 0], [12, 3])
    high = np.concatenate([lattice([0, 3], [6, 5]), lattice([6, 3.5], [12, 5.5])], axis=1)
    X, half, field = two(low, high)
    nodes, gap = gaps_at_nodes(X, half, field, (0, 1), np.zeros(2), np.ones(2), (13, 8))
    x = nodes % 13
    assert (gap[x <= 6] == 0.0).all()
    assert gap[x >= 8] == pytest.approx(0.5)
    assert (gap[x >= 8] > 0.1).all()


def test_fields_that_never_meet_share_no_node():
    X, half, field = two(lattice([0, 0], [2, 2]), lattice([6, 0], [8, 2]))
    nodes, gap = gaps_at_nodes(X, half, field, (0, 1), np.zeros(2), np.ones(2), (9, 3))
    assert len(nodes) == len(gap) == 0
    nodes, gap = gaps_at_nodes(X, half, field, (0, 5), np.zeros(2), np.ones(2), (9, 3))
    assert len(nodes) == 0


def test_nodes_off_the_grid_are_left_out():
    X, half, field = two(lattice([0, 0], [1, 1]), lattice([1, 0], [2, 1]))
    nodes, gap = gaps_at_nodes(X, half, field, (0, 1), np.zeros(2), np.ones(2), (3, 2))
    assert nodes.tolist() == [1, 4]
    assert (gap == 0.0).all()


def test_large_scenes_are_searched_in_a_moment():
    X, half, field = two(lattice([0, 0, 0], [24, 24, 11]), lattice([0, 0, 11], [24, 24, 22]))
    assert X.shape[1] > 100_000
    begin = time.process_time()
    nodes, gap = gaps_at_nodes(X, half, field, (0, 1), np.full(3, -2.0), np.ones(3), (29, 29, 27), within=0.1)
    assert time.process_time() - begin < 1.0  # 0.1 s on a quiet machine
    assert (gap == 0.0).all()
    assert len(nodes) == 25 * 25
