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
from mpmcli.core.kernel import inline
from mpmcli.core.stencil import DOMAIN_TOO_WIDE, fill, place
from mpmcli.shapes.base import add_shape

REFERENCE = "Sadeghirad, Brannon and Burghardt, Int. J. Numer. Meth. Eng. 86 (2011) 1435"


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
    follows_deformation=True,
    description="linear grid functions at the corners of deformed particle domains",
    reference=REFERENCE,
)
add_shape(
    "qcpdi",
    QuadraticCpdi(),
    width=3,
    follows_deformation=True,
    description="linear grid functions at three points per axis of deformed particle domains",
    reference=REFERENCE,
)
add_shape(
    "b2cpdi",
    SplineCpdi(),
    width=4,
    follows_deformation=True,
    description="quadratic B-splines at the corners of deformed particle domains",
    reference="Nairn and Hammerquist, Comput. Methods Appl. Mech. Eng. 377 (2021) 113667",
)


@generic
def grid_function(shape, r):
    """One-dimensional grid function at distance r (in cells) from its node."""


@grid_function.register(LinearCpdi)
@grid_function.register(QuadraticCpdi)
def _(shape, r):
    return max(1.0 - abs(r), 0.0)


@grid_function.register(SplineCpdi)
def _(shape, r):
    s = abs(r)
    outer = max(1.5 - s, 0.0)
    inner = max(0.5 - s, 0.0)
    return 0.5 * outer * outer - 1.5 * inner * inner


@inline
def half_axes(grid, F, size, first, n, W, axes):
    """Rows ``axes + a·d + b`` of W: component a of half-axis b of the domain, in cells (columns of F·size)."""
    d = len(grid.inverse_cell)
    for a in range(d):
        inverse = grid.inverse_cell[a]
        for b in range(d):
            row = axes + np.uint64(a * d + b)
            for k in range(n):
                W[row, k] = F[np.uint64(a * d + b), first + k] * size[b, first + k] * inverse


@inline
def span(grid, X, first, n, W, axes, lowest, reach, offset, status):
    """Lowest node of each stencil: floor(x − half-extent + offset) − reach; checks that ``width`` nodes suffice."""
    d = len(grid.inverse_cell)
    w = np.float64(grid.width)
    for a in range(d):
        origin, inverse = grid.origin[a], grid.inverse_cell[a]
        widest = 0.0
        for k in range(n):
            x = (X[a, first + k] - origin) * inverse
            extent = 0.0
            for b in range(d):
                extent += abs(W[axes + np.uint64(a * d + b), k])
            low = np.floor(x - extent + offset) - reach
            high = np.floor(x + extent + offset) + 1.0
            W[lowest + np.uint64(a), k] = low
            widest = max(widest, high - low + 1.0)
        if widest > w:
            for k in range(n):
                x = (X[a, first + k] - origin) * inverse
                extent = 0.0
                for b in range(d):
                    extent += abs(W[axes + np.uint64(a * d + b), k])
                if np.floor(x + extent + offset) + 2.0 - W[lowest + np.uint64(a), k] > w:
                    status[0] = DOMAIN_TOO_WIDE
                    status[1] = np.int64(first + k)


@inline
def clear(grid, m, n, S, G):
    """Zero the values (and gradients) of a block."""
    d = np.uint64(len(grid.inverse_cell))
    for j in range(m):
        for k in range(n):
            S[j, k] = 0.0
    if G is not None:
        for j in range(d * m):
            for k in range(n):
                G[j, k] = 0.0


@inline
def add_point(grid, n, W, S, G, s, gx, gy, gz):
    """Add one point's grid functions with weight s to S and slope weights (gx, gy, gz) to G (in ξ)."""
    d = len(grid.inverse_cell)
    w = grid.width
    zero = np.uint64(0)
    two = np.uint64(2)
    layers = w if d > 2 else np.uint64(1)
    rows = w if d > 1 else np.uint64(1)
    m = layers * rows * w
    for l in range(zero, layers):
        for j in range(zero, rows):
            for i in range(zero, w):
                row = (l * rows + j) * w + i
                for k in range(n):
                    N = W[i, k]
                    if d > 1:
                        N *= W[w + j, k]
                    if d > 2:
                        N *= W[two * w + l, k]
                    S[row, k] += s * N
                    if G is not None:
                        G[row, k] += gx * N
                        if d > 1:
                            G[m + row, k] += gy * N
                        if d > 2:
                            G[two * m + row, k] += gz * N


@inline
def to_spatial_gradient(grid, n, W, axes, m, G):
    """Turn slopes in ξ into gradients in space: G = (half axes)⁻ᵀ G_ξ, per axis divided by the cell size."""
    d = len(grid.inverse_cell)
    one, two, zero = np.uint64(1), np.uint64(2), np.uint64(0)
    if d == 1:
        for j in range(zero, m):
            for k in range(n):
                G[j, k] *= grid.inverse_cell[0] / W[axes, k]
    elif d == 2:
        hx, hy = grid.inverse_cell[0], grid.inverse_cell[d - 1]
        for k in range(n):
            a, b, c, e = W[axes, k], W[axes + one, k], W[axes + two, k], W[axes + two + one, k]
            det = 1.0 / (a * e - b * c)
            W[axes, k], W[axes + one, k] = e * det * hx, -c * det * hx
            W[axes + two, k], W[axes + two + one, k] = -b * det * hy, a * det * hy
        for j in range(zero, m):
            for k in range(n):
                g1, g2 = G[j, k], G[m + j, k]
                G[j, k] = W[axes, k] * g1 + W[axes + one, k] * g2
                G[m + j, k] = W[axes + two, k] * g1 + W[axes + two + one, k] * g2
    else:
        hx, hy, hz = grid.inverse_cell[0], grid.inverse_cell[d - 2], grid.inverse_cell[d - 1]
        r = axes
        for k in range(n):
            a, b, c = W[r, k], W[r + one, k], W[r + two, k]
            e, f, g = W[r + np.uint64(3), k], W[r + np.uint64(4), k], W[r + np.uint64(5), k]
            o, p, q = W[r + np.uint64(6), k], W[r + np.uint64(7), k], W[r + np.uint64(8), k]
            det = 1.0 / (a * (f * q - g * p) - b * (e * q - g * o) + c * (e * p - f * o))
            W[r, k], W[r + one, k] = (f * q - g * p) * det * hx, (g * o - e * q) * det * hx
            W[r + two, k], W[r + np.uint64(3), k] = (e * p - f * o) * det * hx, (c * p - b * q) * det * hy
            W[r + np.uint64(4), k], W[r + np.uint64(5), k] = (a * q - c * o) * det * hy, (b * o - a * p) * det * hy
            W[r + np.uint64(6), k], W[r + np.uint64(7), k] = (b * g - c * f) * det * hz, (c * e - a * g) * det * hz
            W[r + np.uint64(8), k] = (a * f - b * e) * det * hz
        for j in range(zero, m):
            for k in range(n):
                g1, g2, g3 = G[j, k], G[m + j, k], G[two * m + j, k]
                G[j, k] = W[r, k] * g1 + W[r + one, k] * g2 + W[r + two, k] * g3
                G[m + j, k] = (
                    W[r + np.uint64(3), k] * g1 + W[r + np.uint64(4), k] * g2 + W[r + np.uint64(5), k] * g3
                )
                G[two * m + j, k] = (
                    W[r + np.uint64(6), k] * g1 + W[r + np.uint64(7), k] * g2 + W[r + np.uint64(8), k] * g3
                )


@inline
def sum_over_points(shape, grid, q, X, F, size, field, first, n, base, S, G, W, status, reach, offset):
    """The CPDI sum over q points per axis of the shape's one-dimensional grid function."""
    d = len(grid.inverse_cell)
    w = grid.width
    zero = np.uint64(0)
    axes = np.uint64(2 * d) * w
    lowest = axes + np.uint64(d * d)
    m = w if d == 1 else (w * w if d == 2 else w * w * w)
    half_axes(grid, F, size, first, n, W, axes)
    span(grid, X, first, n, W, axes, lowest, reach, offset, status)
    clear(grid, m, n, S, G)
    points_y = q if d > 1 else 1
    points_z = q if d > 2 else 1
    for pz in range(points_z):
        for py in range(points_y):
            for px in range(q):
                x1, s1, g1 = interval_point(q, px)
                x2, s2, g2 = interval_point(q, py)
                x3, s3, g3 = interval_point(q, pz)
                if d < 2:
                    x2, s2, g2 = 0.0, 1.0, 0.0
                if d < 3:
                    x3, s3, g3 = 0.0, 1.0, 0.0
                for a in range(d):
                    origin, inverse = grid.origin[a], grid.inverse_cell[a]
                    for i in range(zero, w):
                        row = np.uint64(a) * w + i
                        for k in range(n):
                            r = (X[a, first + k] - origin) * inverse - (W[lowest + np.uint64(a), k] + np.float64(i))
                            r += W[axes + np.uint64(a * d), k] * x1
                            if d > 1:
                                r += W[axes + np.uint64(a * d + 1), k] * x2
                            if d > 2:
                                r += W[axes + np.uint64(a * d + 2), k] * x3
                            W[row, k] = grid_function(shape, r)
                add_point(grid, n, W, S, G, s1 * s2 * s3, g1 * s2 * s3, s1 * g2 * s3, s1 * s2 * g3)
    place(grid, first, n, lowest, field, base, W, status)
    if G is not None:
        to_spatial_gradient(grid, n, W, axes, m, G)


@inline
def interval_point(q, i):
    """Point i of q on [−1, 1]: its place, and the weights of its interpolation polynomial and of the slope's."""
    if q == 2:
        return 2.0 * i - 1.0, 0.5, i - 0.5
    weight = 4.0 / 6.0 if i == 1 else 1.0 / 6.0
    return i - 1.0, weight, 0.5 * (i - 1.0)


@fill.register(LinearCpdi)
def _(shape, grid, X, F, size, field, first, n, base, S, G, W, status):
    sum_over_points(shape, grid, 2, X, F, size, field, first, n, base, S, G, W, status, 0.0, 0.0)


@fill.register(QuadraticCpdi)
def _(shape, grid, X, F, size, field, first, n, base, S, G, W, status):
    sum_over_points(shape, grid, 3, X, F, size, field, first, n, base, S, G, W, status, 0.0, 0.0)


@fill.register(SplineCpdi)
def _(shape, grid, X, F, size, field, first, n, base, S, G, W, status):
    sum_over_points(shape, grid, 2, X, F, size, field, first, n, base, S, G, W, status, 1.0, 0.5)
