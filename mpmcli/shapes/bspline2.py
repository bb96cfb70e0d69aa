"""Quadratic B-splines of point particles (Steffen, Kirby and Berzins 2008)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcli.core.stencil import fill, place, tensor_product
from mpmcli.shapes.base import add_shape


class QuadraticSpline(NamedTuple):
    """Particles are points; grid functions are quadratic splines centred on the nodes."""

    order: int = 2


add_shape(
    "bspline2",
    QuadraticSpline(),
    width=3,
    follows_deformation=False,
    description="point particles on quadratic B-splines",
    reference="Steffen, Kirby and Berzins, Int. J. Numer. Meth. Eng. 76 (2008) 922",
)


@fill.register(QuadraticSpline)
def _(shape, grid, X, F, size, field, first, n, base, S, G, W, status):
    d = len(grid.inverse_cell)
    w = grid.width
    lowest = np.uint64(2 * d) * w
    one, two = np.uint64(1), np.uint64(2)
    for a in range(d):
        origin, inverse, row = grid.origin[a], grid.inverse_cell[a], np.uint64(a) * w
        slope = np.uint64(d + a) * w
        for k in range(n):
            x = (X[a, first + k] - origin) * inverse
            nearest = np.floor(x + 0.5)
            t = x - nearest
            W[lowest + np.uint64(a), k] = nearest - 1.0
            W[row, k] = 0.5 * (0.5 - t) * (0.5 - t)
            W[row + one, k] = 0.75 - t * t
            W[row + two, k] = 0.5 * (0.5 + t) * (0.5 + t)
            W[slope, k] = (t - 0.5) * inverse
            W[slope + one, k] = -2.0 * t * inverse
            W[slope + two, k] = (t + 0.5) * inverse
    place(grid, first, n, lowest, field, base, W, status)
    tensor_product(grid, n, W, S, G)
