"""Node numbers and coordinates of the grid with its ghost layers."""

import mmap
import re
from pathlib import Path

import numpy as np
import pytest

import mpmcli
from mpmcli.core.dofs import dof_of, field_of, node_of, side_of
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


@pytest.mark.parametrize("of", [int, np.array])
def test_degrees_of_freedom_are_decoded_in_one_place(of):
    """dof = (side · fields + field) · nodes + node."""
    nodes, fields, seen = 7, 3, set()
    for side in range(4):
        for field in range(fields):
            for node in range(nodes):
                dof = of(dof_of(node, field, side, nodes, fields))
                assert (node_of(dof, nodes), field_of(dof, nodes, fields), side_of(dof, nodes, fields)) == (
                    node,
                    field,
                    side,
                )
                seen.add(int(dof))
    assert seen == set(range(4 * fields * nodes))


def test_no_other_code_decodes_degrees_of_freedom():
    package = Path(mpmcli.__file__).parent
    decoding = re.compile(r"(//|%)\s*\(?\s*[\w.]*node_count\b")
    found = {
        path.relative_to(package).as_posix()
        for path in package.rglob("*.py")
        if decoding.search(path.read_text())
    }
    assert found == {"core/dofs.py"}


def sided(sides=4, fields=2, cells=5):
    return Grid(np.zeros(2), np.full(2, float(cells)), np.ones(2), pad=2, width=3, fields=fields, sides=sides)


def test_side_0_keeps_its_numbers_and_further_sides_are_active_only_where_they_are_named():
    grid = sided()
    n = grid.node_count
    grid.active = np.array([3, 4, 9, n + 4, n + 5])
    version = grid.active_version
    grid.add_sides(np.array([4, 5, 8]))
    assert grid.active[:5].tolist() == [3, 4, 9, n + 4, n + 5]
    assert np.all(np.diff(grid.active) > 0)
    added = grid.active[5:]
    assert sorted(set(grid.side_of(added))) == [1, 2, 3]
    assert grid.node_of(added).tolist() == [4, 4, 5] * 3
    assert grid.field_of(added).tolist() == [0, 1, 1] * 3
    assert grid.active_version > version
    assert grid.used_dofs == 2 * n + 9
    values = np.zeros((grid.dof_count, 1))
    values[grid.active, 0] = 2.0 ** np.arange(len(grid.active))
    total = grid.sum_of_fields(values)
    assert total.shape == (n, 1)
    assert total.sum() == values.sum()
    assert total[4] == values[grid.active[grid.node_of(grid.active) == 4]].sum()
    second = grid.sum_of_fields(values, np.array([False, True]))
    assert second.sum() == values[grid.active[grid.field_of(grid.active) == 1]].sum()
    assert grid.sum_of_fields(values[:, 0]).sum() == values.sum()


@pytest.mark.skipif(
    not Path("/proc/self/statm").exists(), reason="the resident memory of the process is not known"
)
def test_sides_that_nobody_uses_cost_no_memory():
    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * mmap.PAGESIZE

    before = resident()
    grid = sided(sides=4, fields=1, cells=1500)
    grid.active = np.arange(1000)
    grid.add_sides(np.arange(500, 520))
    grid.mp[grid.active] = 1.0
    assert grid.mp.nbytes > 2e8
    assert resident() - before < 0.05 * grid.mp.nbytes
