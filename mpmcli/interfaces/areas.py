"""The area over which an interface transmits tractions at a node."""

import numpy as np

from mpmcli.contact.area import SMALLEST, perpendicular_size
from mpmcli.contact.laws.impulse import dot
from mpmcli.contact.separation.base import UNKNOWN
from mpmcli.core.compiled.kernel import inline, kernel, prange

Array = np.ndarray


@inline
def bend(x, r):
    """(|x + r|⁵ − 2 |x|⁵ + |x − r|⁵)/(240 r²), without differences of near equals; |x|³/12 for r = 0."""
    x = abs(x)
    if x >= r:
        return x * (2.0 * x * x + r * r) / 24.0
    u = x / r
    return r * r * r * (1.0 + u * u * (10.0 + u * u * (5.0 - u))) / 120.0


@inline
def kink(x, r, s):
    """(``bend(x + r, s)`` − 2 ``bend(x, s)`` + ``bend(x − r, s)``)/r² for r ≥ s, likewise; |x|/2 for r = 0."""
    x = abs(x)
    if x >= r + s:
        return 0.5 * x
    u, of = x / r, s / r
    return r * (bend(u + 1.0, of) - 2.0 * bend(u, of) + bend(u - 1.0, of))


@inline
def part_of_plane(axes, cell, n, h, d):
    """h⊥ times the integral of a node's linear grid function over the plane at the distance ``d``, over the cell.

    The sum over all nodes of a plane is 1 in every direction: 1 − d/h⊥ along an axis, smoother beside. Along the unit
    normal ``n`` the function is the convolution of tents of half widths r_a = Δx_a |n_a|: divided differences of the
    order 2m of |x|^(2m−1)/(2 (2m−1)!) over m axes. Those over the two smaller widths have closed forms, which lose no
    digit where the normal is nearly along an axis.
    """
    widest, middle, least = 0.0, 0.0, 0.0
    for a in range(len(axes)):
        r = cell[a] * abs(n[a])
        least = max(least, min(middle, r))
        middle = max(middle, min(widest, r))
        widest = max(widest, r)
    change = kink(d + widest, middle, least) - 2.0 * kink(d, middle, least) + kink(d - widest, middle, least)
    return h * change / (widest * widest)


@inline
def share_of_node(axes, cell, n, a, b, h):
    """Share of an interface that is this node's, of all nodes across it; ``a``, ``b`` are the distances of its edges.

    That is the smaller of ``part_of_plane`` at both edges, over the sum of these at all nodes: where the edge of one
    side hardly reaches the node, the traction is as small as the forces of the stresses there.
    """
    farther = max(abs(a), abs(b)) if a * b > 0.0 else abs(a - b)
    return max(part_of_plane(axes, cell, n, h, farther), SMALLEST) / max(1.0 - abs(a - b) / h, 0.5)


@inline
def open_area(axes, node, around, area, distances, jump, normal, h):
    """Return the ``area`` such that it neither shrinks where interfaces open, since the gap has no volume, nor grows
    where they are pressed.

    A = (Ω_α + Ω_β) w/(h⊥ − δ_n N), with w of ``share_of_node`` and N = 1 − d/h⊥ the linear grid function of the middle
    of the gap. Where a method does not know the edges, w keeps the share of the area by volumes, and N is 1. Nodes
    beyond the axis of a ring have none: what is there is the image of what counts already.
    """
    column = node % around.shape[0]
    if around.ring and around.origin[0] + column * around.cell[0] < -0.5 * around.cell[0]:
        return 0.0
    opening = dot(axes, jump, normal)
    first, second = distances[0], distances[1]
    share, middle = 1.0, 1.0
    if max(abs(first), abs(second)) < UNKNOWN:
        counted = max(1.0 - min(abs(first), abs(second)) / h, SMALLEST)  # as in ``contact_area``
        share = share_of_node(axes, around.cell, normal, first, second, h) / counted
        middle = max(1.0 - 0.5 * abs(first + second) / h, 0.0)
    return area * (share * h / max(h - opening * middle, 0.5 * h))


@kernel
def open_areas(axes, sides, count, fields, nodes, around, geometry, rows):
    """``open_area`` of every contact that is an interface."""
    area = geometry.area
    for k in prange(count):
        if sides.law[fields.law[k]]:
            h = perpendicular_size(axes, around.cell, geometry.normal[k])
            node = nodes.node[fields.slot[k]]
            area[k] = open_area(
                axes, node, around, area[k], geometry.distances[k], rows.jump[k], geometry.normal[k], h
            )
