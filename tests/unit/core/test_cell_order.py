"""Sorting by cell: bands that never share a node, nodes in use, chunks."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from particles_at import particles_at

from mpmcli.core.analysis import PlaneStrain, Solid, UniaxialStress
from mpmcli.core.grid import Grid
from mpmcli.core.order import (
    CHUNKS,
    MAX_DRIFT,
    CellOrder,
    band_height,
    locate_cells,
    sort_by_key,
    tile_height,
)
from mpmcli.core.particles import Particles
from mpmcli.shapes import SHAPES

ANALYSES = {1: UniaxialStress(), 2: PlaneStrain(), 3: Solid()}


def scattered(shape: str, d: int, count: int, seed: int, cells) -> tuple[Particles, Grid]:
    """Particles anywhere on a grid, some on nodes and walls, with deformations that the stencil can span."""
    rng = np.random.default_rng(seed)
    entry = SHAPES[shape]
    cell = np.array([0.5, 0.7, 1.1])[:d]
    lower = np.array([0.1, -2.0, 0.3])[:d]
    upper = lower + np.array(cells)[:d] * cell
    grid = Grid(lower, upper, cell, entry.pad, entry.width)
    X = rng.random((d, count)) * np.array(cells)[:d, None]
    snapped = rng.random((d, count)) < 0.2
    X = lower[:, None] + np.where(snapped, np.rint(X), X) * cell[:, None]
    particles = particles_at(ANALYSES[d], X, 0.5 * cell)
    if entry.follows_deformation:
        particles.F[: d * d] *= rng.uniform(0.3, 0.99, count)
    return particles, grid


@given(rows=st.integers(1, 5000), width=st.integers(2, 8))
def test_bands_are_high_enough_and_not_needlessly_many(rows, width):
    least = 2 * width - 1
    height = band_height(rows, least)
    assert least <= height < max(2 * least, 10)
    assert -(-rows // tile_height(rows, least)) <= max(1, rows // least)
    assert tile_height(rows, least) >= min(rows, least)


@pytest.mark.parametrize("shape", ["linear", "ugimp", "lcpdi", "b2cpdi", "b2gimp"])
def test_bands_of_a_colour_never_share_a_node(shape, find_stencils):
    """Even after particles drifted as far as they may, in any direction; and every node seen is in use."""

    cells = st.one_of(
        st.tuples(st.integers(3, 60)),
        st.tuples(st.integers(3, 8), st.integers(3, 60)),
        st.tuples(st.integers(3, 5), st.integers(3, 25), st.integers(3, 25)),
    )

    @given(seed=st.integers(0, 10**6), cells=cells, drift=st.sampled_from([0.0, 0.5, 1.0]))
    def check(seed, cells, drift):
        particles, grid = scattered(shape, len(cells), 150, seed, cells)
        order = CellOrder(particles, grid)
        order.sort(False)
        rng = np.random.default_rng(seed)
        wander = rng.choice([-1.0, 1.0, 0.3], particles.X.shape) * drift * MAX_DRIFT * grid.cell[:, None]
        X = np.clip(particles.X + wander, grid.lower[:, None], grid.upper[:, None])
        found = find_stencils(shape, grid, X, particles.size, particles.F)
        assert found.status[0] == 0
        assert np.isin(found.nodes, grid.active).all()
        first, turn, colours = (array.astype(np.int64) for array in order.bands)
        assert len(colours) - 1 == (4 if len(cells) == 3 else 2)
        assert sorted(turn) == list(range(len(first) - 1))
        owner = np.full(grid.node_count, -1)
        for begin, end in itertools.pairwise(colours):
            owner[:] = -1
            for b in turn[begin:end]:
                touched = np.unique(found.nodes[first[b] : first[b + 1]])
                assert np.all(owner[touched] == -1)
                owner[touched] = b

    check()


@pytest.mark.parametrize("width", [3, 5, 8])
def test_bands_suit_widened_stencils(width, find_stencils):
    particles, grid = scattered("lcpdi", 2, 400, width, (5, 90))
    grid.width = width
    order = CellOrder(particles, grid)
    order.sort(False)
    edges = [particles.X[1, int(i)] for i in order.bands.first[:-1] if i < particles.count]
    rows = np.floor((np.array(edges) - grid.lower[1]) / grid.cell[1])
    assert np.all(np.diff(rows) >= 1)
    assert len(order.bands.turn) <= -(-90 // (2 * width - 1))


@pytest.mark.parametrize("d", [1, 2, 3])
def test_particles_are_sorted_by_cell_with_all_their_arrays(d):
    particles, grid = scattered("ugimp", d, 500, d, (6, 7, 5))
    before = {name: array.copy() for name, array in particles.arrays().items()}
    order = CellOrder(particles, grid)
    order.sort(False)
    cell = np.empty((d, 500), dtype=np.int64)
    locate_cells[False](particles.X, grid.lower, 1 / grid.cell, grid.cells, cell)
    place = np.ravel_multi_index(cell[::-1], tuple(grid.cells[::-1]))
    edges = order.bands.first.astype(np.int64)
    key = np.repeat(np.arange(len(edges) - 1), np.diff(edges)) * np.prod(grid.cells) + place
    assert np.all(np.diff(key) >= 0), "band by band, and x fastest in each"
    assert np.all(np.diff(particles.id)[np.diff(key) == 0] > 0), "the sort is stable"
    for name, array in particles.arrays().items():
        np.testing.assert_array_equal(array, before[name][..., particles.id])
        assert array.flags.c_contiguous


def test_sorting_twice_changes_nothing():
    particles, grid = scattered("ugimp", 2, 100, 3, (6, 7))
    order = CellOrder(particles, grid)
    order.sort(False)
    X = particles.X
    bands, active = order.bands, grid.active.copy()
    order.drift = 0.7
    order.sort(False)
    assert particles.X is X, "arrays in order are not copied"
    for new, old in zip(order.bands, bands, strict=True):
        np.testing.assert_array_equal(new, old)
    np.testing.assert_array_equal(grid.active, active)
    assert order.drift == 0
    assert order.version == 2


@pytest.mark.parametrize(
    ("cells", "cut"), [((9,), [0]), ((9, 4), [1]), ((9, 4, 6), [0, 2]), ((4, 4, 4), [1, 2])]
)
def test_jumps_by_periods_break_the_order_along_cut_axes(cells, cut):
    particles, grid = scattered("ugimp", len(cells), 300, 1, cells)
    order = CellOrder(particles, grid)
    order.sort(False)
    assert list(order.cut) == cut
    order.jumped([])
    assert not order.is_stale
    for axis in range(len(cells)):
        order.drift = 0.0
        order.jumped([axis])
        assert order.is_stale == (axis in cut)
        grid.width += 2
        order.jumped([axis])
        assert order.is_stale, "stencils end with the grid"
        grid.width -= 2


@given(count=st.integers(1, 300), rows=st.integers(1, 200))
def test_bands_and_chunks_cover_every_particle_once(count, rows):
    particles, grid = scattered("ugimp", 2, count, count, (3, rows))
    order = CellOrder(particles, grid)
    order.sort(False)
    for ranges in (order.bands.first, order.chunks):
        assert ranges[0] == 0
        assert ranges[-1] == count
        assert np.all(ranges[1:] >= ranges[:-1])
    assert len(order.chunks) - 1 == CHUNKS
    assert order.slots == max(len(order.bands.turn), CHUNKS)


def test_a_particle_on_the_upper_wall_belongs_to_the_last_cell():
    particles, grid = scattered("ugimp", 2, 3, 1, (4, 4))
    particles.X[:, 0] = grid.upper
    particles.X[:, 1] = grid.lower
    particles.X[:, 2] = grid.upper + 5
    cell = np.empty((2, 3), dtype=np.int64)
    locate_cells[False](particles.X, grid.lower, 1 / grid.cell, grid.cells, cell)
    assert cell.T.tolist() == [[3, 3], [0, 0], [3, 3]]


def test_drift_makes_an_order_stale():
    particles, grid = scattered("ugimp", 2, 10, 1, (4, 4))
    order = CellOrder(particles, grid)
    order.sort(False)
    order.drift = MAX_DRIFT
    assert not order.is_stale
    order.drift = 1.0
    assert order.is_stale


def test_nodes_in_use_are_sorted_and_few():
    """The grid may be much larger than the bodies: nodes far away are not listed."""
    particles, grid = scattered("ugimp", 2, 50, 1, (200, 300))
    particles.X[:] = np.array([[5.0], [6.0]]) + np.random.default_rng(1).random((2, 50))
    order = CellOrder(particles, grid)
    order.sort(False)
    assert np.all(np.diff(grid.active) > 0)
    assert len(grid.active) < 100


@pytest.mark.parametrize(
    "parallel", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["serial", "parallel"]
)
@given(
    count=st.integers(0, 300),
    keys=st.sampled_from([1, 2, 63, 64, 65, 128, 129, 5000]),
    seed=st.integers(0, 9),
)
def test_sorting_is_stable_and_finds_where_keys_start(parallel, count, keys, seed):
    key = np.random.default_rng(seed).integers(0, keys, count)
    starts, order = sort_by_key(key, keys, parallel)
    np.testing.assert_array_equal(order, np.argsort(key, kind="stable"))
    np.testing.assert_array_equal(starts, np.concatenate([[0], np.bincount(key, minlength=keys).cumsum()]))
