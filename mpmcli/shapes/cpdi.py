"""CPDI: grid functions evaluated at points of the deformed particle domain.

The domain is the parallelepiped spanned by F·size. Between q points per axis the grid function is interpolated by
polynomials Q, whose integrals over the domain are exact: with q = 2 (corners) the weights per axis are (½, ½) for
values and (−½, ½) for slopes, with q = 3 (corners, edges, faces, middle) they are Simpson's (1/6, 4/6, 1/6) and
(−½, 0, ½); ∇S = (F·diag(size))⁻ᵀ ∇_ξ S (Sadeghirad, Brannon and Burghardt 2011).
"""

from typing import NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.compiled.registers import load, offsets, plus, store
from mpmcli.core.functions import hat, quadratic_spline
from mpmcli.core.grid import LineGeometry, PlaneGeometry, SpaceGeometry
from mpmcli.core.transfer.corner_sums import gradients_of_plane, gradients_of_space
from mpmcli.core.transfer.stencil import (
    DOMAIN_TOO_WIDE,
    Corners,
    fill,
    first_node,
    weigh_by_table,
    weigh_gathers,
)
from mpmcli.shapes.base import add_shape

REFERENCE = "Sadeghirad, Brannon and Burghardt, Int. J. Numer. Meth. Eng. 86 (2011) 1435"


ZERO, TWO, THREE, FOUR = np.uint64(0), np.uint64(2), np.uint64(3), np.uint64(4)

ROUND_OFF = 1e-11
"""Cells by which a domain may reach past a node without counting as wider: its value there is no larger."""


class LinearCpdi(NamedTuple):
    """Corner points, linear grid functions."""

    points: int = 2


class QuadraticCpdi(NamedTuple):
    """Three points per axis, linear grid functions."""

    points: int = 3


class SplineCpdi(NamedTuple):
    """Corner points, quadratic B-spline grid functions."""

    points: int = 2


add_shape(
    "lcpdi",
    LinearCpdi(),
    width=3,
    grid_functions="linear",
    domain="corners",
    description="linear grid functions at the corners of deformed particle domains",
    reference=REFERENCE,
)
add_shape(
    "qcpdi",
    QuadraticCpdi(),
    width=3,
    grid_functions="linear",
    domain="corners_and_middles",
    description="linear grid functions at three points per axis of deformed particle domains",
    reference=REFERENCE,
)
add_shape(
    "b2cpdi",
    SplineCpdi(),
    width=4,
    grid_functions="quadratic",
    domain="corners",
    description="quadratic B-splines at the corners of deformed particle domains",
    reference="Nairn and Hammerquist, Comput. Methods Appl. Mech. Eng. 377 (2021) 113667",
)


@generic
def grid_functions(shape, r, across):
    """One-dimensional grid functions of the nodes of an axis, the lowest of which is at distance r (in cells)."""


@grid_functions.register(LinearCpdi)
@grid_functions.register(QuadraticCpdi)
def _(shape, r, across):
    return hat(offsets(r, across))


@grid_functions.register(SplineCpdi)
def _(shape, r, across):
    return quadratic_spline(offsets(r, across))


@inline
def place_of_point(q, i):
    """Point i of q on [−1, 1]."""
    return 2.0 * np.int64(i) - 1.0 if q == 2 else np.int64(i) - 1.0


@inline
def lowest_node(x, extent, reach, offset, w, p, status):
    """Lowest node of an axis: floor(x − extent + offset) − reach; checks that ``w`` nodes suffice."""
    low = np.floor(x - extent + offset) - reach
    if np.floor(x + extent + offset - ROUND_OFF) + 2.0 - low > w:
        status[0] = DOMAIN_TOO_WIDE
        status[1] = np.int64(p)
    return low


@inline
def interval_weights(q):
    """Factors of what ``sum_of_interval`` returns."""
    return 0.5 if q == 2 else 1.0 / 6.0, 0.5


@compiled_too
def sum_of_interval(q, first, middle, last):
    """Sum over the points of an interval for the mean, and that for the slope, but for ``interval_weights``."""
    if q == 2:
        return first + last, last - first
    return first + last + 4.0 * middle, last - first


@compiled_too
def product(W, at, front, j, across):
    """Grid functions of a point in row ``j``: those along x (times z), ``front`` from ``at``, times that along y."""
    return W[at + np.uint64(len(across)) + j] * load(W, at + front, across)


@compiled_too
def sum_of_line(q, W, at, step, front, j, across):
    """``sum_of_interval`` of the products at q points, the first of which begins at ``at`` in ``W``."""
    first = product(W, at, front, j, across)
    if q == 2:
        return sum_of_interval(q, first, first, product(W, at + step, front, j, across))
    middle = product(W, at + step, front, j, across)
    return sum_of_interval(q, first, middle, product(W, at + step + step, front, j, across))


@compiled_too
def sum_of_square(q, W, at, step, front, j, across):
    """Sums over q² points for the mean and for the slopes along xi and eta."""
    over = np.uint64(q) * step
    s1, d1 = sum_of_line(q, W, at, step, front, j, across)
    s2, d2 = s1, d1
    if q == 3:
        s2, d2 = sum_of_line(q, W, at + over, step, front, j, across)
    s3, d3 = sum_of_line(q, W, at + np.uint64(q - 1) * over, step, front, j, across)
    value, along_eta = sum_of_interval(q, s1, s2, s3)
    along_xi, _ = sum_of_interval(q, d1, d2, d3)
    return value, along_xi, along_eta


@compiled_too
def sum_of_cube(q, W, at, step, front, j, across):
    """Sums over q³ points for the mean and for the slopes along xi, eta and zeta."""
    over = np.uint64(q * q) * step
    s1, d1, e1 = sum_of_square(q, W, at, step, front, j, across)
    s2, d2, e2 = s1, d1, e1
    if q == 3:
        s2, d2, e2 = sum_of_square(q, W, at + over, step, front, j, across)
    s3, d3, e3 = sum_of_square(q, W, at + np.uint64(q - 1) * over, step, front, j, across)
    value, along_zeta = sum_of_interval(q, s1, s2, s3)
    along_xi, _ = sum_of_interval(q, d1, d2, d3)
    along_eta, _ = sum_of_interval(q, e1, e2, e3)
    return value, along_xi, along_eta, along_zeta


@generic
def place_domain(grid, across, X, F, size, p, status, reach, offset):
    """Where the domain of particle ``p`` lies, in cells, by number of axes (the class of ``grid``).

    Returns the lowest node, the middle from there, and the half-axes as columns.
    """


@place_domain.register(LineGeometry)
def _(grid, across, X, F, size, p, status, reach, offset):
    h = grid.inverse_cell[0]
    x, a = (X[0, p] - grid.origin[0]) * h, F[0, p] * size[0, p] * h
    low = lowest_node(x, abs(a), reach, offset, len(across), p, status)
    return (low,), (x - low,), (a,)


@place_domain.register(PlaneGeometry)
def _(grid, across, X, F, size, p, status, reach, offset):
    w = len(across)
    hx, hy = grid.inverse_cell
    x, y = (X[0, p] - grid.origin[0]) * hx, (X[1, p] - grid.origin[1]) * hy
    a, b = F[0, p] * size[0, p] * hx, F[1, p] * size[1, p] * hx
    c, e = F[2, p] * size[0, p] * hy, F[3, p] * size[1, p] * hy
    low_x = lowest_node(x, abs(a) + abs(b), reach, offset, w, p, status)
    low_y = lowest_node(y, abs(c) + abs(e), reach, offset, w, p, status)
    return (low_x, low_y), (x - low_x, y - low_y), (a, b, c, e)


@place_domain.register(SpaceGeometry)
def _(grid, across, X, F, size, p, status, reach, offset):
    w = len(across)
    hx, hy, hz = grid.inverse_cell
    x, y = (X[0, p] - grid.origin[0]) * hx, (X[1, p] - grid.origin[1]) * hy
    z = (X[2, p] - grid.origin[2]) * hz
    s0, s1, s2 = size[0, p], size[1, p], size[2, p]
    a, b, c = F[0, p] * s0 * hx, F[1, p] * s1 * hx, F[2, p] * s2 * hx
    e, f, g = F[3, p] * s0 * hy, F[4, p] * s1 * hy, F[5, p] * s2 * hy
    o, r, t = F[6, p] * s0 * hz, F[7, p] * s1 * hz, F[8, p] * s2 * hz
    low_x = lowest_node(x, abs(a) + abs(b) + abs(c), reach, offset, w, p, status)
    low_y = lowest_node(y, abs(e) + abs(f) + abs(g), reach, offset, w, p, status)
    low_z = lowest_node(z, abs(o) + abs(r) + abs(t), reach, offset, w, p, status)
    return (low_x, low_y, low_z), (x - low_x, y - low_y, z - low_z), (a, b, c, e, f, g, o, r, t)


@generic
def fill_domain(grid, shape, across, q, X, F, size, p, S, G, W, status, reach, offset):
    """The CPDI sum over q points per axis, by number of axes (the class of ``grid``)."""


@fill_domain.register(LineGeometry)
def _(grid, shape, across, q, X, F, size, p, S, G, W, status, reach, offset):
    """One axis."""
    w = np.uint64(len(across))
    low, (x,), (a,) = place_domain(grid, across, X, F, size, p, status, reach, offset)
    for u in range(np.uint64(q)):
        store(W, u * w, grid_functions(shape, x + a * place_of_point(q, u), across))
    mean, slope = interval_weights(q)
    for i in range(w):
        value, along = sum_of_interval(q, W[i], W[w + i], W[np.uint64(q - 1) * w + i])
        S[i] = mean * value
        if G is not None:
            G[i] = slope * along * grid.inverse_cell[0] / a
    return first_node(grid, low, p, status)


@fill_domain.register(PlaneGeometry)
def _(grid, shape, across, q, X, F, size, p, S, G, W, status, reach, offset):
    """Two axes; of each point the grid functions along x and along y."""
    w = np.uint64(len(across))
    low, (x, y), axes = place_domain(grid, across, X, F, size, p, status, reach, offset)
    a, b, c, e = axes
    for v in range(np.uint64(q)):
        for u in range(np.uint64(q)):
            xi, eta = place_of_point(q, u), place_of_point(q, v)
            at = TWO * (v * np.uint64(q) + u) * w
            store(W, at, grid_functions(shape, x + a * xi + b * eta, across))
            store(W, at + w, grid_functions(shape, y + c * xi + e * eta, across))
    mean, slope = interval_weights(q)
    x1, x2, y1, y2 = gradients_of_plane(axes, grid.inverse_cell, mean * slope)
    m = w * w
    for j in range(w):
        value, g1, g2 = sum_of_square(q, W, ZERO, TWO * w, ZERO, j, across)
        store(S, j * w, (mean * mean) * value)
        if G is not None:
            store(G, j * w, plus(x1 * g1, x2, g2))
            store(G, m + j * w, plus(y1 * g1, y2, g2))
    return first_node(grid, low, p, status)


@fill_domain.register(SpaceGeometry)
def _(grid, shape, across, q, X, F, size, p, S, G, W, status, reach, offset):
    """Three axes; of each point the grid functions along x, y and z, and of one layer the product of x and z."""
    w = np.uint64(len(across))
    low, (x, y, z), axes = place_domain(grid, across, X, F, size, p, status, reach, offset)
    a, b, c, e, f, g, o, r, t = axes
    for k in range(np.uint64(q)):
        for v in range(np.uint64(q)):
            for u in range(np.uint64(q)):
                xi, eta, zeta = place_of_point(q, u), place_of_point(q, v), place_of_point(q, k)
                at = FOUR * ((k * np.uint64(q) + v) * np.uint64(q) + u) * w
                store(W, at, grid_functions(shape, x + a * xi + b * eta + c * zeta, across))
                store(W, at + w, grid_functions(shape, y + e * xi + f * eta + g * zeta, across))
                store(W, at + w + w, grid_functions(shape, z + o * xi + r * eta + t * zeta, across))
    mean, slope = interval_weights(q)
    x1, x2, x3, y1, y2, y3, z1, z2, z3 = gradients_of_space(axes, grid.inverse_cell, mean * mean * slope)
    m = w * w * w
    for n in range(w):
        for i in range(np.uint64(q * q * q)):
            at = FOUR * i * w
            store(W, at + THREE * w, W[at + w + w + n] * load(W, at, across))
        for j in range(w):
            value, g1, g2, g3 = sum_of_cube(q, W, ZERO, FOUR * w, THREE * w, j, across)
            row = (n * w + j) * w
            store(S, row, (mean * mean * mean) * value)
            if G is not None:
                store(G, row, plus(plus(x1 * g1, x2, g2), x3, g3))
                store(G, m + row, plus(plus(y1 * g1, y2, g2), y3, g3))
                store(G, m + m + row, plus(plus(z1 * g1, z2, g2), z3, g3))
    return first_node(grid, low, p, status)


@fill.register(LinearCpdi)
def _(shape, grid, across, X, F, size, p, S, G, W, status):
    return fill_domain(grid, shape, across, 2, X, F, size, p, S, G, W, status, 0.0, 0.0)


@fill.register(QuadraticCpdi)
def _(shape, grid, across, X, F, size, p, S, G, W, status):
    return fill_domain(grid, shape, across, 3, X, F, size, p, S, G, W, status, 0.0, 0.0)


@fill.register(SplineCpdi)
def _(shape, grid, across, X, F, size, p, S, G, W, status):
    return fill_domain(grid, shape, across, 2, X, F, size, p, S, G, W, status, 1.0, 0.5)


weigh_by_table(LinearCpdi, QuadraticCpdi, SplineCpdi)


@weigh_gathers.register(LinearCpdi)
def _(shape, grid, across, X, F, size, p, S, G, W, status):
    low, middle, axes = place_domain(grid, across, X, F, size, p, status, 0.0, 0.0)
    return first_node(grid, low, p, status), Corners(middle, axes, grid.inverse_cell)
