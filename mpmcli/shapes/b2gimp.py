"""Quadratic B-splines averaged over the particle's undeformed box."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcli.core.kernel import inline
from mpmcli.core.stencil import fill, place, tensor_product
from mpmcli.shapes.base import add_shape


class SplineGimp(NamedTuple):
    """Particle domains are boxes of their initial size; grid functions are quadratic splines."""

    order: int = 2


add_shape(
    "b2gimp",
    SplineGimp(),
    width=4,
    follows_deformation=False,
    description="quadratic B-splines averaged over undeformed particle boxes",
    reference="Nairn and Hammerquist, Comput. Methods Appl. Mech. Eng. 377 (2021) 113667",
)


@inline
def spline(r):
    """Quadratic B-spline of support (−3/2, 3/2)."""
    s = abs(r)
    outer = max(1.5 - s, 0.0)
    inner = max(0.5 - s, 0.0)
    return 0.5 * outer * outer - 1.5 * inner * inner


@inline
def spline_integral(r):
    """Integral of the spline from 0 to r (odd, ±1/2 outside the support)."""
    s = abs(r)
    outer = max(1.5 - s, 0.0)
    inner = max(0.5 - s, 0.0)
    value = 0.5 - outer * outer * outer / 6.0 + 0.5 * inner * inner * inner
    return value if r > 0.0 else -value


@fill.register(SplineGimp)
def _(shape, grid, X, F, size, field, first, n, base, S, G, W, status):
    d = len(grid.inverse_cell)
    w = grid.width
    lowest = np.uint64(2 * d) * w
    for a in range(d):
        origin, inverse, row = grid.origin[a], grid.inverse_cell[a], np.uint64(a) * w
        slope = np.uint64(d + a) * w
        for k in range(n):
            x = (X[a, first + k] - origin) * inverse
            W[lowest + np.uint64(a), k] = np.floor(x) - 1.0
        for i in range(w):
            for k in range(n):
                x = (X[a, first + k] - origin) * inverse
                l = size[a, first + k] * inverse
                r = x - (W[lowest + np.uint64(a), k] + i)
                half = 0.5 / l
                W[row + i, k] = (spline_integral(r + l) - spline_integral(r - l)) * half
                W[slope + i, k] = (spline(r + l) - spline(r - l)) * (half * inverse)
    place(grid, first, n, lowest, field, base, W, status)
    tensor_product(grid, n, W, S, G)
