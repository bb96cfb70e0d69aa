"""CPDI stencils against the definition, written independently with numpy (Sadeghirad, Brannon and Burghardt 2011)."""

import itertools

import numpy as np
import pytest

from mpmcli.core.transfer.stencil import OUTSIDE_GRID
from mpmcli.shapes import SHAPES

CPDI = ("lcpdi", "qcpdi", "b2cpdi")


def hat(r):
    return np.maximum(1 - np.abs(r), 0)


def quadratic_spline(r):
    r = np.abs(r)
    return np.where(r < 0.5, 0.75 - r * r, np.where(r < 1.5, 0.5 * (1.5 - r) ** 2, 0.0))


def lagrange(points, i, xi):
    """Value and slope of the i-th Lagrange polynomial on ``points`` at ``xi``."""
    others = [q for j, q in enumerate(points) if j != i]
    poly = np.poly1d(others, r=True) / np.prod([points[i] - q for q in others])
    return poly(xi), poly.deriv()(xi)


def expected_stencil(name, x, A, nodes, cell):
    """Mean of the interpolated grid functions and of their gradients over the domain x + A ξ, by Gauss quadrature.

    ``x`` (d,), ``A`` (d, d) half-axes as columns, ``nodes`` (d, m).
    """
    d = len(x)
    points = (-1.0, 1.0) if name != "qcpdi" else (-1.0, 0.0, 1.0)
    function = quadratic_spline if name == "b2cpdi" else hat
    gauss, weight = np.polynomial.legendre.leggauss(3)
    means = [
        sum(w * np.array(lagrange(points, i, g)) for g, w in zip(gauss, weight, strict=True)) / 2
        for i in range(len(points))
    ]
    value, slope = np.array(means).T
    inverse_transposed = np.linalg.inv(A).T
    S, G = np.zeros(nodes.shape[1]), np.zeros(nodes.shape)
    for corner in itertools.product(range(len(points)), repeat=d):
        at = x + A @ np.array([points[i] for i in corner])
        N = np.prod(function((at[:, None] - nodes) / cell[:, None]), axis=0)
        S += np.prod(value[list(corner)]) * N
        direction = np.array(
            [np.prod([slope[i] if a == b else value[i] for b, i in enumerate(corner)]) for a in range(d)]
        )
        G += (inverse_transposed @ direction)[:, None] * N
    return S, G


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("name", CPDI)
def test_stencils_follow_the_definition(name, d, find_stencils, make_grid_for, undeformed):
    grid = make_grid_for(name, d)
    rng = np.random.default_rng(7)
    count = 6
    X = grid.lower[:, None] + rng.random((d, count)) * (grid.upper - grid.lower)[:, None]
    size = np.repeat(0.25 * grid.cell[:, None], count, axis=1)
    F = undeformed(d, count)
    F[: d * d] += rng.uniform(-0.2, 0.2, (d * d, count))
    found = find_stencils(name, grid, X, size, F)
    assert found.status[0] == 0
    for p in range(count):
        A = F[: d * d, p].reshape(d, d) * size[:, p]
        S, G = expected_stencil(name, X[:, p], A, found.x[:, p], grid.cell)
        np.testing.assert_allclose(found.S[p], S, rtol=0, atol=1e-13)
        np.testing.assert_allclose(found.G[p], G, rtol=0, atol=1e-12 / size.min())


@pytest.mark.parametrize("name", CPDI)
def test_wide_domains_follow_the_definition_too(name, find_stencils, make_grid_for, undeformed):
    """The plane stencil has a short form for narrow domains; the general one serves the others."""
    grid = make_grid_for(name, 2, SHAPES[name].width + 2)
    F = undeformed(2, 1)
    F[0], F[1], F[2] = 4.3, 0.9, -0.7
    X = grid.lower[:, None] + 0.5 * (grid.upper - grid.lower)[:, None]
    size = 0.25 * grid.cell[:, None]
    found = find_stencils(name, grid, X, size, F)
    assert found.status[0] == 0
    S, G = expected_stencil(name, X[:, 0], F[:4, 0].reshape(2, 2) * size[:, 0], found.x[:, 0], grid.cell)
    np.testing.assert_allclose(found.S[0], S, rtol=0, atol=1e-13)
    np.testing.assert_allclose(found.G[0], G, rtol=0, atol=1e-11)


def test_undeformed_lcpdi_on_whole_cells_equals_box_corners(find_stencils, make_grid_for):
    """In the middle of a cell, with a domain inside the cell, CPDI of linear functions is the point value."""
    grid = make_grid_for("lcpdi", 2)
    X = grid.lower[:, None] + 2.5 * grid.cell[:, None]
    size = 0.25 * grid.cell[:, None]
    S = find_stencils("lcpdi", grid, X, size).matrices()[0]
    point = find_stencils("linear", make_grid_for("linear", 2), X, size).matrices()[0]
    np.testing.assert_allclose(np.sort(S[S > 1e-14]), np.sort(point[point > 1e-14]), atol=1e-14)


def test_a_corner_beyond_the_ghost_layers_is_reported(find_stencils, make_grid_for, undeformed):
    grid = make_grid_for("lcpdi", 2, 8)
    F = undeformed(2, 1)
    F[0] = 13.0
    X = grid.upper[:, None] + 3.2 * grid.cell[:, None]
    found = find_stencils("lcpdi", grid, X, 0.25 * grid.cell[:, None], F)
    assert found.status[0] == OUTSIDE_GRID


@pytest.mark.parametrize("name", CPDI)
def test_one_particle_per_cell_needs_no_wider_stencil(name, find_stencils, make_grid_for):
    """Domains as wide as a cell whose ends meet nodes up to round-off count as meeting them."""
    grid = make_grid_for(name, 2)
    cells = np.array(
        [k + part + tiny for k in (0, 1, 2) for part in (0, 0.5) for tiny in (-2e-16, 0, 2e-16, 4e-16)]
    )
    X = grid.lower[:, None] + np.maximum(cells, 0) * grid.cell[:, None]
    X = np.concatenate([X, np.nextafter(X, X - 1), np.nextafter(X, X + 1)], axis=1)
    found = find_stencils(name, grid, X, np.repeat(0.5 * grid.cell[:, None], X.shape[1], axis=1))
    assert found.status[0] == 0
    np.testing.assert_allclose(found.S.sum(axis=1), 1.0, atol=1e-14)
