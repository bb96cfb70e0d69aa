"""Node numbers and coordinates of the grid with its ghost layers."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcli.core.grid import Grid, unfold


@pytest.fixture
def grid():
    return Grid(
        np.array([-1.0, 0.0, 2.0]), np.array([1.0, 3.0, 4.0]), np.array([0.5, 1.0, 2.0]), pad=2, width=3
    )


def test_shape_counts_ghosts(grid):
    assert grid.shape == (9, 8, 6)
    assert grid.node_count == 432
    assert grid.mp.shape == (432, 4)
    assert grid.f.shape == (432, 3)


def test_x_runs_fastest(grid):
    index = 3 + 9 * (4 + 8 * 5)
    np.testing.assert_allclose(grid.coordinates(np.array([index]))[:, 0], [-1 + 0.5, 2.0, 2 + 3 * 2.0])


def test_interior_nodes_are_those_of_the_user(grid):
    x = grid.coordinates(grid.interior())
    assert x.shape == (3, 5 * 4 * 2)
    np.testing.assert_allclose(x.min(axis=1), grid.lower)
    np.testing.assert_allclose(x.max(axis=1), grid.upper)
    assert np.all(np.diff(x[0, :5]) == 0.5)


def test_offsets_lead_from_the_first_node_to_all_of_a_stencil(grid):
    offsets = grid.offsets()
    assert offsets.dtype == np.uint64
    x = grid.coordinates(offsets.astype(np.int64)).reshape(3, 3, 3, 3)
    first = grid.lower - 2 * grid.cell
    for axis in range(3):
        along = np.moveaxis(x[axis], 2 - axis, 0)
        np.testing.assert_allclose(along[2] - along[0], 2 * grid.cell[axis])
        np.testing.assert_allclose(along[0], first[axis])


@pytest.mark.parametrize("d", [1, 2, 3])
def test_compiled_code_sees_the_same_geometry(d):
    grid = Grid(np.arange(d) * 1.0, np.arange(d) + 4.0, np.full(d, 0.5), pad=2, width=3)
    g = unfold(grid.geometry)
    np.testing.assert_allclose(g.origin, grid.lower - 1.0)
    np.testing.assert_allclose(g.inverse_cell, 2.0)
    assert tuple(int(s) for s in g.stride) == grid.stride
    # the last stencil ends at the last node
    last = sum(int(b) * s for b, s in zip(g.last_base, grid.stride, strict=True))
    assert last + int(grid.offsets()[-1]) == grid.node_count - 1
    assert int(g.field_stride) == grid.node_count
