"""The gathers on ``Corners``: nodal values are interpolated at the corners of a particle's domain, then combined.

The values of the shape function are means over the corners, its gradients differences between them (``shapes.cpdi``):
no table of the nodes is needed, and the work does not grow with the cells over which a domain has stretched.
"""

from functools import partial

import numpy as np

from mpmcli.core.analysis import Axisymmetric, Solid
from mpmcli.core.compiled.compiler import compiled_as, compiled_too
from mpmcli.core.compiled.registers import each, pack, plus, read
from mpmcli.core.transfer.gather_scatter import (
    ALL,
    LINE,
    ONE,
    PLANE,
    for_each,
    gather_gradient,
    gather_gradient_around_axis,
    gather_scalar,
    gather_vector,
    put_rows,
)
from mpmcli.core.transfer.stencil import Corners

of_corners = partial(for_each, weights=Corners)


@compiled_too
def gradients_of_plane(axes, inverse_cell, factor):
    """Coefficients (x1, x2, y1, y2) of ∂/∂x = x1 ∂/∂ξ + x2 ∂/∂η …, for half-axes in cells, times ``factor``."""
    a, b, c, e = axes
    inverse = factor / (a * e - b * c)
    hx, hy = inverse * inverse_cell[0], inverse * inverse_cell[1]
    return e * hx, -c * hx, -b * hy, a * hy


@compiled_too
def gradients_of_space(axes, inverse_cell, factor):
    """The same (x1, x2, x3, y1 …) in space: the rows of the inverse transpose."""
    a, b, c, e, f, g, o, r, t = axes
    x1, x2, x3 = f * t - g * r, g * o - e * t, e * r - f * o
    inverse = factor / (a * x1 + b * x2 + c * x3)
    hx, hy, hz = inverse * inverse_cell[0], inverse * inverse_cell[1], inverse * inverse_cell[2]
    return (
        hx * x1, hx * x2, hx * x3,
        hy * (c * r - b * t), hy * (a * t - c * o), hy * (b * o - a * r),
        hz * (b * g - c * f), hz * (c * e - a * g), hz * (a * f - b * e),
    )  # fmt: skip


@compiled_too
def lower_node(x, last):
    """Lower node of the cell in which ``x`` lies (in cells, from the first node of the stencil), and the distance.

    The node is one of 0 … ``last``, also where round-off or what is not a number put ``x`` elsewhere.
    """
    i = min(np.uint64(np.int64(max(x, 0.0))), last)
    return i, x - np.float64(np.int64(i))


@compiled_too
def at_point_of_line(v, base, last, x):
    """``v`` at a point."""
    i, tx = lower_node(x, last)
    left = v[base + i]
    return left + tx * (v[base + i + ONE] - left)


@of_corners(gather_vector, *LINE)
def _(weights, analysis, zero, base, offsets, across, v):
    (x,), (a,), last = weights.middle, weights.axes, np.uint64(len(across) - 2)
    return means_of_line(v, zero, base, last, x - a, x + a)


def means_of_line(v, zero, base, last, left, right):
    """Mean of each component of ``v`` at two points; of velocities there is one component."""
    return tuple(
        0.5
        * (
            at_point_of_line(v[a :: len(zero)], base, last, left)
            + at_point_of_line(v[a :: len(zero)], base, last, right)
        )
        for a in range(len(zero))
    )


@compiled_as(means_of_line)
def _(v, zero, base, last, left, right):
    if len(zero) == 1:
        return lambda v, zero, base, last, left, right: (
            0.5 * (at_point_of_line(v, base, last, left) + at_point_of_line(v, base, last, right)),
        )

    def find(v, zero, base, last, left, right):
        one = values_at_point_of_line(v, zero, base, last, left)
        return each(0.5 * (one + values_at_point_of_line(v, zero, base, last, right)))

    return find


@compiled_too
def values_at_point_of_line(v, zero, base, last, x):
    """The components of ``v`` at a point."""
    i, tx = lower_node(x, last)
    c = np.uint64(len(zero))
    at = (base + i) * c
    left = read(v, at, zero)
    return plus(left, tx, read(v, at + c, zero) - left)


@of_corners(gather_gradient, *LINE)
def _(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    (x,), (a,), last = weights.middle, weights.axes, np.uint64(len(across) - 2)
    left, right = at_point_of_line(v, base, last, x - a), at_point_of_line(v, base, last, x + a)
    L[0, p] = (right - left) * (0.5 * weights.inverse_cell[0] / a)
    Sv = (0.5 * (left + right),)
    return Sv, Sv if w is None else gather_vector(weights, analysis, zero, base, offsets, across, w)


@compiled_too
def at_point_of_plane(v, zero, base, row, last, x, y):
    """The components of ``v`` at a point, each twice: shares of the nodes to its left and to its right."""
    i, tx = lower_node(x, last)
    j, ty = lower_node(y, last)
    c = np.uint64(len(zero))
    at, both = (base + i + j * row) * c, zero + zero
    lower, upper = read(v, at, both), read(v, at + row * c, both)
    return pack(alike(1.0 - tx, zero) + alike(tx, zero)) * plus(lower, ty, upper - lower)


def alike(number, like):
    """A tuple of as many times ``number`` as ``like`` has members."""
    return (number,) * len(like)


@compiled_as(alike)
def _(number, like):
    if len(like) == 1:
        return lambda number, like: (number,)
    if len(like) == 2:
        return lambda number, like: (number, number)
    return lambda number, like: (number, number, number)


def both_shares(value, like):
    """Components of what ``at_point_of_plane`` gives, or of its sums."""
    shares = each(value)
    return tuple(shares[a] + shares[a + len(like)] for a in range(len(like)))


@compiled_as(both_shares)
def _(value, like):
    if len(like) == 1:

        def add(value, like):
            a, d = each(value)
            return (a + d,)

    elif len(like) == 2:

        def add(value, like):
            a, b, d, e = each(value)
            return a + d, b + e

    else:

        def add(value, like):
            a, b, c, d, e, f = each(value)
            return a + d, b + e, c + f

    return add


@compiled_too
def at_corners_of_plane(weights, zero, base, offsets, across, v):
    """What ``at_point_of_plane`` gives for the four corners of the domain."""
    (x, y), (xx, xy, yx, yy) = weights.middle, weights.axes
    row, last = offsets[len(across)], np.uint64(len(across) - 2)
    return (
        at_point_of_plane(v, zero, base, row, last, x - xx - xy, y - yx - yy),
        at_point_of_plane(v, zero, base, row, last, x + xx - xy, y + yx - yy),
        at_point_of_plane(v, zero, base, row, last, x - xx + xy, y - yx + yy),
        at_point_of_plane(v, zero, base, row, last, x + xx + xy, y + yx + yy),
    )


@of_corners(gather_vector, *PLANE, Axisymmetric)
def _(weights, analysis, zero, base, offsets, across, v):
    v1, v2, v3, v4 = at_corners_of_plane(weights, zero, base, offsets, across, v)
    return both_shares(0.25 * (v1 + v2 + v3 + v4), zero)


@of_corners(gather_gradient, *PLANE)
def _(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    v1, v2, v3, v4 = at_corners_of_plane(weights, zero, base, offsets, across, v)
    below, above = v1 + v2, v3 + v4
    along_xi, along_eta = (v2 - v1) + (v4 - v3), above - below
    x1, x2, y1, y2 = gradients_of_plane(weights.axes, weights.inverse_cell, 0.25)
    put_rows(both_shares(x1 * along_xi + x2 * along_eta, zero), L, 0, 2, p)
    put_rows(both_shares(y1 * along_xi + y2 * along_eta, zero), L, 1, 2, p)
    Sv = both_shares(0.25 * (below + above), zero)
    return Sv, Sv if w is None else gather_vector(weights, analysis, zero, base, offsets, across, w)


of_corners(gather_gradient, Axisymmetric)(gather_gradient_around_axis)


@compiled_too
def at_point_of_space(v, zero, base, row, layer, last, x, y, z):
    """The components of ``v`` at a point."""
    i, tx = lower_node(x, last)
    j, ty = lower_node(y, last)
    k, tz = lower_node(z, last)
    n = np.uint64(len(zero))
    at = (base + i + j * row + k * layer) * n
    up, over = row * n, layer * n
    a, b = read(v, at, zero), read(v, at + up, zero)
    c, d = read(v, at + over, zero), read(v, at + over + up, zero)
    a = plus(a, tx, read(v, at + n, zero) - a)
    b = plus(b, tx, read(v, at + up + n, zero) - b)
    c = plus(c, tx, read(v, at + over + n, zero) - c)
    d = plus(d, tx, read(v, at + over + up + n, zero) - d)
    a, c = plus(a, ty, b - a), plus(c, ty, d - c)
    return plus(a, tz, c - a)


@compiled_too
def at_edge_of_space(v, zero, base, row, layer, last, x, y, z, e, f, g):
    """Sum and difference of ``v`` at the ends of an edge of the domain, middle (x, y, z) and half-axis (e, f, g)."""
    low = at_point_of_space(v, zero, base, row, layer, last, x - e, y - f, z - g)
    high = at_point_of_space(v, zero, base, row, layer, last, x + e, y + f, z + g)
    return low + high, high - low


@compiled_too
def at_edges_of_space(weights, zero, base, offsets, across, v):
    """What ``at_edge_of_space`` gives for the four edges of the domain along its first axis."""
    (x, y, z), (a, b, c, e, f, g, o, r, t) = weights.middle, weights.axes
    w = len(across)
    row, layer, last = offsets[w], offsets[w * w], np.uint64(w - 2)
    return (
        at_edge_of_space(v, zero, base, row, layer, last, x - b - c, y - f - g, z - r - t, a, e, o),
        at_edge_of_space(v, zero, base, row, layer, last, x + b - c, y + f - g, z + r - t, a, e, o),
        at_edge_of_space(v, zero, base, row, layer, last, x - b + c, y - f + g, z - r + t, a, e, o),
        at_edge_of_space(v, zero, base, row, layer, last, x + b + c, y + f + g, z + r + t, a, e, o),
    )


@of_corners(gather_vector, Solid)
def _(weights, analysis, zero, base, offsets, across, v):
    (s1, _), (s2, _), (s3, _), (s4, _) = at_edges_of_space(weights, zero, base, offsets, across, v)
    return each(0.125 * ((s1 + s2) + (s3 + s4)))


@of_corners(gather_gradient, Solid)
def _(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    (s1, d1), (s2, d2), (s3, d3), (s4, d4) = at_edges_of_space(weights, zero, base, offsets, across, v)
    below, above = s1 + s2, s3 + s4
    xi, eta, zeta = (d1 + d2) + (d3 + d4), (s2 - s1) + (s4 - s3), above - below
    x1, x2, x3, y1, y2, y3, z1, z2, z3 = gradients_of_space(weights.axes, weights.inverse_cell, 0.125)
    put_rows(each(x1 * xi + x2 * eta + x3 * zeta), L, 0, 3, p)
    put_rows(each(y1 * xi + y2 * eta + y3 * zeta), L, 1, 3, p)
    put_rows(each(z1 * xi + z2 * eta + z3 * zeta), L, 2, 3, p)
    Sv = each(0.125 * (below + above))
    return Sv, Sv if w is None else gather_vector(weights, analysis, zero, base, offsets, across, w)


@of_corners(gather_scalar, *ALL)
def _(weights, analysis, base, offsets, across, v):
    (found,) = gather_vector(weights, analysis, (0.0,), base, offsets, across, v)
    return found
