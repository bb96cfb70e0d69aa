"""Overlap of bodies: what counts as full."""

import numpy as np
import pytest

from mpmcli.contact.geometry import Surroundings
from mpmcli.contact.overlap import volume_of_node
from mpmcli.core.grid import Grid
from mpmcli.shapes import SHAPES


@pytest.mark.parametrize(("dimensions", "ring"), [(2, False), (2, True), (3, False)])
def test_particles_that_fill_space_have_the_volume_of_the_node(dimensions, ring, find_stencils):
    """Also where the grid does not start at zero; rings count by their radius, the axis is never overfull."""
    cell = np.array([0.5, 0.25, 0.125])[:dimensions]
    lower = np.array([0.0, -0.5, 1.0])[:dimensions]
    grid = Grid(lower, lower + 4 * cell, cell, SHAPES["lcpdi"].pad, SHAPES["lcpdi"].width)
    centres = [lower[a] + cell[a] * (0.25 + 0.5 * np.arange(8)) for a in range(dimensions)]
    X = np.stack([x.ravel() for x in np.meshgrid(*centres, indexing="ij")])
    size = np.repeat(cell[:, None] / 4, X.shape[1], axis=1)
    stencils = find_stencils("lcpdi", grid, X, size)
    volume = np.full(X.shape[1], np.prod(cell / 2)) * (X[0] if ring else 1.0)
    there = np.zeros(grid.node_count)
    np.add.at(there, stencils.nodes, stencils.S * volume[:, None])
    origin = grid.lower - grid.pad * grid.cell
    none = np.zeros((0, dimensions))
    period = np.zeros(dimensions, dtype=np.int64)
    around = Surroundings(np.array(grid.shape), origin, cell, none, none, grid.pad, period, 1.0, ring)
    x = grid.coordinates(np.arange(grid.node_count))
    whole = np.array([volume_of_node.py_func((0.0,) * dimensions, i, around) for i in range(grid.node_count)])
    above, below = x - lower[:, None], (lower + 4 * cell)[:, None] - x
    middle = ((above > 1e-9) & (below > 1e-9)).all(axis=0)
    assert middle.sum() == 3**dimensions
    np.testing.assert_allclose(there[middle], whole[middle], rtol=1e-14)
    axis = (np.abs(x[0]) < 1e-9) & (above[1:] > 1e-9).all(axis=0) & (below[1:] > 1e-9).all(axis=0)
    if ring:  # with the mirror image
        assert axis.sum() == 3
        assert (2 * there[axis] < whole[axis]).all()
