"""CPDI: grid functions evaluated at points of the deformed particle domain.

The domain is the parallelepiped spanned by F·size. Between q points per axis the grid function is interpolated by
polynomials Q, whose integrals over the domain are exact: with q = 2 (corners) the weights per axis are (½, ½) for
values and (−½, ½) for slopes, with q = 3 (corners, edges, faces, middle) they are Simpson's (1/6, 4/6, 1/6) and
(−½, 0, ½); ∇S = (F·diag(size))⁻ᵀ ∇_ξ S (Sadeghirad, Brannon and Burghardt 2011).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcli.core.dispatch import generic
from mpmcli.core.grid import LineGeometry, PlaneGeometry, SpaceGeometry
from mpmcli.core.kernel import inline
from mpmcli.core.lanes import distances, load, plus, ramp_down, store, zeros
from mpmcli.core.stencil import DOMAIN_TOO_WIDE, fill, first_node, weigh_by_table
from mpmcli.shapes.base import add_shape

REFERENCE = "Sadeghirad, Brannon and Burghardt, Int. J. Numer. Meth. Eng. 86 (2011) 1435"


TWO, THREE = np.uint64(2), np.uint64(3)

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
    return ramp_down(1.0, distances(r, across))


@grid_functions.register(SplineCpdi)
def _(shape, r, across):
    away = distances(r, across)
    wide, narrow = ramp_down(1.5, away), ramp_down(0.5, away)
    return 0.5 * (wide * wide) - 1.5 * (narrow * narrow)


@inline
def interval_point(q, i):
    """Point i of q on [−1, 1]: its place, and the weights of its interpolation polynomial and of the slope's."""
    if q == 2:
        return 2.0 * np.int64(i) - 1.0, 0.5, np.int64(i) - 0.5
    return np.int64(i) - 1.0, 4.0 / 6.0 if i == 1 else 1.0 / 6.0, 0.5 * (np.int64(i) - 1.0)


@inline
def lowest_node(x, extent, reach, offset, w, p, status):
    """Lowest node of an axis: floor(x − extent + offset) − reach; checks that ``w`` nodes suffice."""
    low = np.floor(x - extent + offset) - reach
    if np.floor(x + extent + offset - ROUND_OFF) + 2.0 - low > w:
        status[0] = DOMAIN_TOO_WIDE
        status[1] = np.int64(p)
    return low


@generic
def fill_domain(grid, shape, across, q, X, F, size, p, S, G, W, status, reach, offset):
    """The CPDI sum over q points per axis, by number of axes (the class of ``grid``)."""


@fill_domain.register(LineGeometry)
def _(grid, shape, across, q, X, F, size, p, S, G, W, status, reach, offset):
    """One axis."""
    w = np.uint64(len(across))
    h = grid.inverse_cell[0]
    x, a = (X[0, p] - grid.origin[0]) * h, F[0, p] * size[0, p] * h
    low = lowest_node(x, abs(a), reach, offset, w, p, status)
    for c in range(np.uint64(q)):
        store(W, c * w, grid_functions(shape, x - low + a * interval_point(q, c)[0], across))
    for i in range(w):
        value, slope = 0.0, 0.0
        for c in range(np.uint64(q)):
            _, s, g = interval_point(q, c)
            value += s * W[c * w + i]
            slope += g * W[c * w + i]
        S[i] = value
        if G is not None:
            G[i] = slope * h / a
    return first_node(grid, (low,), p, status)


@fill_domain.register(PlaneGeometry)
def _(grid, shape, across, q, X, F, size, p, S, G, W, status, reach, offset):
    """Two axes; (a, c) and (b, e) are the half-axes of the domain in cells."""
    w = np.uint64(len(across))
    hx, hy = grid.inverse_cell[0], grid.inverse_cell[1]
    x, y = (X[0, p] - grid.origin[0]) * hx, (X[1, p] - grid.origin[1]) * hy
    a, b = F[0, p] * size[0, p] * hx, F[1, p] * size[1, p] * hx
    c, e = F[2, p] * size[0, p] * hy, F[3, p] * size[1, p] * hy
    low_x = lowest_node(x, abs(a) + abs(b), reach, offset, w, p, status)
    low_y = lowest_node(y, abs(c) + abs(e), reach, offset, w, p, status)
    x, y = x - low_x, y - low_y
    for v in range(np.uint64(q)):
        for u in range(np.uint64(q)):
            xi, eta = interval_point(q, u)[0], interval_point(q, v)[0]
            at = TWO * (v * np.uint64(q) + u) * w
            store(W, at, grid_functions(shape, x + a * xi + b * eta, across))
            store(W, at + w, grid_functions(shape, y + c * xi + e * eta, across))
    inverse = 1.0 / (a * e - b * c)
    m = w * w
    zero = zeros(across)
    for j in range(w):
        value, g1, g2 = zero, zero, zero
        for v in range(np.uint64(q)):
            for u in range(np.uint64(q)):
                _, s1, d1 = interval_point(q, u)
                _, s2, d2 = interval_point(q, v)
                at = TWO * (v * np.uint64(q) + u) * w
                N = W[at + w + j] * load(W, at, across)
                value = plus(value, s1 * s2, N)
                if G is not None:
                    g1 = plus(g1, d1 * s2, N)
                    g2 = plus(g2, s1 * d2, N)
        store(S, j * w, value)
        if G is not None:
            store(G, j * w, plus((e * inverse * hx) * g1, -c * inverse * hx, g2))
            store(G, m + j * w, plus((a * inverse * hy) * g2, -b * inverse * hy, g1))
    return first_node(grid, (low_x, low_y), p, status)


@fill_domain.register(SpaceGeometry)
def _(grid, shape, across, q, X, F, size, p, S, G, W, status, reach, offset):
    """Three axes; the columns of A are the half-axes of the domain in cells."""
    w = np.uint64(len(across))
    hx, hy, hz = grid.inverse_cell[0], grid.inverse_cell[1], grid.inverse_cell[2]
    x, y = (X[0, p] - grid.origin[0]) * hx, (X[1, p] - grid.origin[1]) * hy
    z = (X[2, p] - grid.origin[2]) * hz
    s0, s1, s2 = size[0, p], size[1, p], size[2, p]
    a, b, c = F[0, p] * s0 * hx, F[1, p] * s1 * hx, F[2, p] * s2 * hx
    e, f, g = F[3, p] * s0 * hy, F[4, p] * s1 * hy, F[5, p] * s2 * hy
    o, r, t = F[6, p] * s0 * hz, F[7, p] * s1 * hz, F[8, p] * s2 * hz
    low_x = lowest_node(x, abs(a) + abs(b) + abs(c), reach, offset, w, p, status)
    low_y = lowest_node(y, abs(e) + abs(f) + abs(g), reach, offset, w, p, status)
    low_z = lowest_node(z, abs(o) + abs(r) + abs(t), reach, offset, w, p, status)
    for k in range(np.uint64(q)):
        for v in range(np.uint64(q)):
            for u in range(np.uint64(q)):
                xi, eta, zeta = interval_point(q, u)[0], interval_point(q, v)[0], interval_point(q, k)[0]
                at = THREE * ((k * np.uint64(q) + v) * np.uint64(q) + u) * w
                store(W, at, grid_functions(shape, x - low_x + a * xi + b * eta + c * zeta, across))
                store(W, at + w, grid_functions(shape, y - low_y + e * xi + f * eta + g * zeta, across))
                store(W, at + w + w, grid_functions(shape, z - low_z + o * xi + r * eta + t * zeta, across))
    # rows of the inverse transpose of A
    x1, x2, x3 = f * t - g * r, g * o - e * t, e * r - f * o
    y1, y2, y3 = c * r - b * t, a * t - c * o, b * o - a * r
    z1, z2, z3 = b * g - c * f, c * e - a * g, a * f - b * e
    inverse = 1.0 / (a * x1 + b * x2 + c * x3)
    m = w * w * w
    zero = zeros(across)
    for n in range(w):
        for j in range(w):
            value, g1, g2, g3 = zero, zero, zero, zero
            for k in range(np.uint64(q)):
                for v in range(np.uint64(q)):
                    for u in range(np.uint64(q)):
                        _, s1, d1 = interval_point(q, u)
                        _, s2, d2 = interval_point(q, v)
                        _, s3, d3 = interval_point(q, k)
                        at = THREE * ((k * np.uint64(q) + v) * np.uint64(q) + u) * w
                        N = (W[at + w + j] * W[at + w + w + n]) * load(W, at, across)
                        value = plus(value, s1 * s2 * s3, N)
                        if G is not None:
                            g1 = plus(g1, d1 * s2 * s3, N)
                            g2 = plus(g2, s1 * d2 * s3, N)
                            g3 = plus(g3, s1 * s2 * d3, N)
            row = (n * w + j) * w
            store(S, row, value)
            if G is not None:
                store(G, row, (inverse * hx) * (x1 * g1 + x2 * g2 + x3 * g3))
                store(G, m + row, (inverse * hy) * (y1 * g1 + y2 * g2 + y3 * g3))
                store(G, m + m + row, (inverse * hz) * (z1 * g1 + z2 * g2 + z3 * g3))
    return first_node(grid, (low_x, low_y, low_z), p, status)


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
