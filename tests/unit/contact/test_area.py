"""Contact area: cell size along the normal, and areas of plane contacts summed over the nodes."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpmcli.contact.area import SMALLEST, contact_area, perpendicular_size
from mpmcli.contact.separation.base import UNKNOWN
from mpmcli.core.compiled.kernel import Kernel, kernel, prange
from mpmcli.core.grid import Grid
from mpmcli.shapes import SHAPES

UNSEEN = np.array([UNKNOWN, UNKNOWN])


def unit(angles):
    n = np.array(angles, dtype=float)
    return n / np.linalg.norm(n)


def size_along(cell, n):
    return perpendicular_size((0.0,) * len(cell), tuple(cell), np.asarray(n, dtype=float))


normals = st.integers(1, 3).flatmap(
    lambda d: st.lists(st.floats(-1, 1), min_size=d, max_size=d).filter(lambda n: np.linalg.norm(n) > 0.1)
)


# ------------------------------------------------------------------------------------------------- cell size


@given(normals, st.floats(0.1, 10))
def test_square_cells_have_one_size(angles, cell):
    assert size_along([cell] * len(angles), unit(angles)) == pytest.approx(cell, rel=1e-14)


def test_axes_give_the_sides():
    cell = (0.5, 0.8, 1.25)
    for d in (1, 2, 3):
        for a in range(d):
            assert size_along(cell[:d], -np.eye(d)[a]) == cell[a]


@given(st.floats(0, 6.3), st.floats(0.1, 10), st.floats(0.1, 10))
def test_two_dimensions_by_the_tangent(angle, dx, dy):
    tx, ty = -math.sin(angle), math.cos(angle)
    expected = dx * dy * math.hypot(tx / dx, ty / dy)
    assert size_along((dx, dy), [math.cos(angle), math.sin(angle)]) == pytest.approx(expected, rel=1e-13)


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda n: np.linalg.norm(n) > 0.1))
def test_three_dimensions_by_the_section_of_the_ellipsoid(angles):
    n, cell = unit(angles), np.array([0.5, 0.8, 1.25])
    tangents = np.linalg.svd(n[None])[2][1:]
    # the section's points r = T u satisfy uᵀ (T diag(4/cell²) Tᵀ) u = 1
    section = math.pi / math.sqrt(np.linalg.det(tangents @ np.diag(4 / cell**2) @ tangents.T))
    assert size_along(cell, n) == pytest.approx(cell.prod() / (4 / math.pi * section), rel=1e-12)


# ------------------------------------------------------------------------------------------------- plane contacts


def nodal_volumes(find_stencils, cell, axis, edge, gap=0.0, stretch=1.0):
    """Ω of two blocks that face each other, per node, and the nodes' positions; GIMP, two particles per axis."""
    d, cell = len(cell), np.array(cell)
    cells = np.array([5 if a == axis else 2 for a in range(d)])
    grid = Grid(np.zeros(d), cells * cell, cell, SHAPES["ugimp"].pad, SHAPES["ugimp"].width)
    l, steps = 0.25 * cell, 1 + 2 * np.arange(4)
    reach = stretch * l[axis]
    facing = np.concatenate([edge - reach * steps, edge + gap + reach * steps])
    X = np.stack(
        [
            x.ravel()
            for x in np.meshgrid(*[facing if a == axis else l[a] * steps for a in range(d)], indexing="ij")
        ]
    )
    S, _ = find_stencils("ugimp", grid, X, np.repeat(l[:, None], X.shape[1], axis=1)).matrices()
    volume = S * stretch * (2 * l).prod()
    alpha = X[axis] < edge + 0.5 * gap
    return volume[alpha].sum(axis=0), volume[~alpha].sum(axis=0), grid.coordinates(np.arange(grid.node_count))


def total_area(find_stencils, cell, axis, edge, gap=0.0, stretch=1.0, edges_known=True):
    a, b, x = nodal_volumes(find_stencils, cell, axis, edge, gap, stretch)
    total = 0.0
    for i in np.flatnonzero((a > 1e-12) & (b > 1e-12)):
        distances = np.array([edge - x[axis, i], edge + gap - x[axis, i]]) if edges_known else UNSEEN
        total += contact_area(a[i], b[i], cell[axis], distances)
    others = [a for a in range(len(cell)) if a != axis]
    return total / np.prod([2 * cell[a] for a in others])


@pytest.mark.parametrize("edges_known", [True, False], ids=["edges", "volumes"])
@pytest.mark.parametrize(
    ("cell", "axis"), [((0.5,), 0), ((0.5, 0.8), 0), ((0.5, 0.8), 1), ((0.5, 0.8, 1.25), 1)], ids=str
)
def test_plane_contact_along_the_grid_is_exact(find_stencils, cell, axis, edges_known):
    """Areas of all nodes sum to the true area wherever the contact lies in the cell."""
    for position in (2.0, 2.1, 2.37, 2.5, 2.9):
        total = total_area(find_stencils, cell, axis, position * cell[axis], edges_known=edges_known)
        assert total == pytest.approx(1.0, rel=1e-8)


@pytest.mark.parametrize(
    ("stretch", "gap", "edges_known", "lowest", "highest"),
    [
        (0.8, 0.0, True, 0.99, 1.01),
        (0.8, 0.0, False, 1.01, 1.10),
        (0.5, 0.0, True, 0.86, 1.00),
        (0.5, 0.0, False, 0.95, 1.12),
        (1.4, 0.0, True, 0.88, 1.02),
        (1.4, 0.0, False, 0.87, 0.97),
        (1.0, -0.1, True, 1.14, 1.20),
        (1.0, -0.1, False, 1.12, 1.20),
        (1.0, 0.1, True, 0.85, 1.05),
        (1.0, 0.1, False, 0.85, 0.91),
    ],
)
def test_plane_contact_of_deformed_or_overlapping_blocks(
    find_stencils, stretch, gap, edges_known, lowest, highest
):
    """Stated errors where GIMP keeps undeformed domains, and where sides overlap or stand apart by 0.1 cells."""
    totals = [
        total_area(find_stencils, (1.0,), 0, position, gap, stretch, edges_known)
        for position in np.linspace(2.0, 3.0, 21)
    ]
    assert lowest <= min(totals) <= max(totals) <= highest


def oblique_area(angle, cell, place, edges_known):
    """Sum of nodal areas along a long straight contact over its length; volumes by 16 × 16 points per cell."""
    n, cell = np.array([math.cos(angle), math.sin(angle)]), np.array(cell)
    points = (np.arange(-16, 16) + 0.5) / 16
    hats = np.outer(1 - np.abs(points), 1 - np.abs(points)) * cell.prod() / 256
    beyond = points[:, None] * cell[0] * n[0] + points[None, :] * cell[1] * n[1]
    h, rows = size_along(cell, n), 24
    long = int(abs(n[0]) > abs(n[1]))  # the axis along which the line is followed over 24 cells
    index = np.meshgrid(
        *[np.arange(rows) if a == long else np.arange(-80, 80) for a in (0, 1)], indexing="ij"
    )
    total = 0.0
    for d in place - (index[0] * cell[0] * n[0] + index[1] * cell[1] * n[1]).ravel():
        alpha, beta = hats[beyond < d].sum(), hats[beyond >= d].sum()
        if min(alpha, beta) > 1e-9:
            total += contact_area(alpha, beta, h, np.array([d, d]) if edges_known else UNSEEN)
    return total / (rows * cell[long] / abs(n[1 - long]))


@pytest.mark.parametrize("cell", [(1.0, 1.0), (1.0, 2.0)], ids=str)
@pytest.mark.parametrize(
    ("degrees", "edges_known", "single", "mean"),
    [
        (45, True, 0.122, 0.007),
        (45, False, 0.102, 0.045),
        (60, True, 0.005, 0.001),
        (60, False, 0.036, 0.034),
        (15, True, 0.005, 0.001),
        (15, False, 0.034, 0.032),
    ],
)
def test_oblique_contact(cell, degrees, edges_known, single, mean):
    """Errors at a single place of the contact (45°: the nodes lie in rows along it) and in the mean over places."""
    totals = [oblique_area(math.radians(degrees), cell, place, edges_known) for place in np.linspace(0, 1, 9)]
    assert max(abs(total - 1) for total in totals) < single
    assert abs(np.mean(totals) - 1) < mean


# ------------------------------------------------------------------------------------------------- one node

volumes = st.floats(1e-6, 1.0)


@given(volumes, volumes, st.floats(0.1, 10), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.booleans())
def test_sides_are_equal_and_the_area_is_never_zero(alpha, beta, h, first, second, known):
    distances = np.array([first, second]) if known else UNSEEN
    area = contact_area(alpha, beta, h, distances)
    assert area == contact_area(beta, alpha, h, -distances[::-1] if known else UNSEEN)
    assert SMALLEST * (alpha + beta) / h <= area <= (alpha + beta) / h * (1 + 1e-15)


def test_areas_of_one_node():
    assert contact_area(0.5, 0.5, 1.0, UNSEEN) == pytest.approx(1.0)
    assert contact_area(0.125, 0.875, 1.0, UNSEEN) == pytest.approx(0.5)
    assert contact_area(0.125, 0.875, 2.0, UNSEEN) == pytest.approx(0.25)
    assert contact_area(0.5, 0.5, 2.0, np.array([-0.5, 0.6])) == pytest.approx(0.375)
    assert contact_area(0.5, 0.5, 1.0, np.array([1.2, 1.3])) == pytest.approx(SMALLEST)
    assert contact_area(1.0, 0.0, 1.0, UNSEEN) == pytest.approx(SMALLEST)


def measure_nodes(axes, cell, n, volume, distances, h, area):
    """Cell size along each normal, and the contact area there."""
    for j in prange(area.shape[0]):
        h[j] = perpendicular_size(axes, cell, n[j])
        area[j] = contact_area(volume[0, j], volume[1, j], h[j], distances[j])


@pytest.mark.parametrize("parallel", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_kernels_compute_what_python_does(parallel):
    random = np.random.default_rng(1)
    cell, n = (0.5, 0.8), np.array([unit(row) for row in random.normal(size=(6, 2))])
    volume, distances = random.uniform(0, 1, (2, 6)), random.uniform(-1, 1, (6, 2))
    distances[::2] = UNKNOWN
    h, area = np.zeros(6), np.zeros(6)
    made = kernel(measure_nodes)
    try:
        made[parallel]((0.0, 0.0), cell, n, volume, distances, h, area)
    finally:
        Kernel.registered.remove(made)
    for j in range(6):
        assert h[j] == pytest.approx(size_along(cell, n[j]), rel=1e-15)
        assert area[j] == pytest.approx(contact_area(*volume[:, j], h[j], distances[j]), rel=1e-14)
