"""Chunks depend on the lines of the grid in use, not on the particles in them."""

import itertools

import numpy as np
import pytest
from particles_at import particles_at

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.chunks import CHUNKS, chunk_of_round, chunks_of_lines, chunks_of_nodes, sums_of_chunks
from mpmcli.core.grid import Grid
from mpmcli.core.order import CellOrder

KIND = {1: "uniaxial_strain", 2: "plane_strain", 3: "3d"}


def block(cells, per_cell, seed=0):
    """Particles at random places of the cells (n, d), in random order, and their order by cell."""
    rng = np.random.default_rng(seed)
    cells = np.repeat(np.asarray(cells), per_cell, axis=0)
    d = cells.shape[1]
    X = (cells + rng.uniform(0.01, 0.99, cells.shape))[rng.permutation(len(cells))].T
    p = particles_at(ANALYSES[KIND[d]](), X, 0.25)
    grid = Grid(np.zeros(d), np.full(d, 90.0 if d == 1 else 12.0), np.ones(d), 3, 3)
    order = CellOrder(p, grid)
    order.sort(False)
    return order


def lines_of(order):
    """Lines of cells of the particles of each chunk, as sets."""
    p = order.particles
    cell = np.floor(p.X).astype(int)
    lines = list(map(tuple, (cell[1:] if len(cell) > 1 else cell).T))
    edges = order.chunks.astype(int)
    return [set(lines[a:b]) for a, b in itertools.pairwise(edges)]


@pytest.mark.parametrize("d", [1, 2, 3])
def test_chunks_hold_the_same_lines_with_any_number_of_particles(d):
    rng = np.random.default_rng(d)
    cells = np.unique(rng.integers(0, 80 if d == 1 else 11, (200, d)), axis=0)
    few = block(cells, 1)
    many = block(cells, rng.integers(1, 9, len(cells)), seed=3)
    assert len(few.chunks) == len(many.chunks) == CHUNKS + 1
    assert lines_of(few) == lines_of(many)
    assert not set.intersection(*(set().union(*half) for half in (lines_of(few)[::2], lines_of(few)[1::2])))
    np.testing.assert_array_equal(few.grid.active_chunks, many.grid.active_chunks)


def test_lines_are_shared_evenly_and_few_lines_leave_chunks_empty():
    edges = chunks_of_lines(np.arange(0, 1000, 5), 1000)
    assert set(np.diff(edges.astype(int)) // 5) == {3, 4}
    edges = chunks_of_lines(np.array([0, 7, 9]), 12)
    assert sorted(n for n in np.diff(edges.astype(int)) if n) == [2, 3, 7]
    assert edges[0] == 0
    assert edges[-1] == 12


def test_without_lines_all_chunks_are_empty():
    assert not chunks_of_lines(np.zeros(0, dtype=np.int64), 0).any()
    assert not chunks_of_nodes(np.zeros(0, dtype=np.int64), 5).any()
    assert sums_of_chunks(np.zeros((2, 0)), chunks_of_lines(np.zeros(0, dtype=np.int64), 0)).shape == (2, 0)


def test_chunks_of_nodes_begin_with_lines():
    active = np.flatnonzero(np.random.default_rng(2).random(900) < 0.4)
    edges = chunks_of_nodes(active, 10).astype(int)
    for a, b in itertools.pairwise(edges):
        assert a == b or a == 0 or active[a] // 10 > active[a - 1] // 10


def test_rounds_take_every_chunk_once():
    assert sorted(int(chunk_of_round.py_func(c)) for c in range(CHUNKS)) == list(range(CHUNKS))
    half = [int(chunk_of_round.py_func(c)) for c in range(CHUNKS // 2)]
    assert abs(sum(c < CHUNKS // 2 for c in half) - CHUNKS // 4) <= 1


def test_sums_skip_empty_chunks():
    values = np.arange(12.0)
    edges = np.array([0, 0, 5, 5, 12, 12])
    np.testing.assert_array_equal(sums_of_chunks(values, edges), [values[:5].sum(), values[5:].sum()])
    np.testing.assert_array_equal(sums_of_chunks(np.stack([values, -values]), edges)[1], [-10.0, -56.0])


def test_chunks_follow_when_particles_are_dropped():
    order = block(np.argwhere(np.ones((9, 9))), 3)
    before = lines_of(order)
    kept = np.random.default_rng(5).random(order.particles.count) < 0.5
    kept[order.particles.X[1] > 7.0] = False
    order.drop(kept)
    order.particles.keep(kept)
    assert order.is_stale
    assert all(now <= then for now, then in zip(lines_of(order), before, strict=True))
    assert order.chunks[-1] == order.bands.first[-1] == kept.sum()
