"""Uniform GIMP: hats averaged over the particle's undeformed box (Bardenhagen and Kober 2004)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcli.core.stencil import fill, place, tensor_product
from mpmcli.shapes.base import add_shape


class UniformGimp(NamedTuple):
    """Particle domains are boxes of their initial size."""

    order: int = 1


add_shape(
    "ugimp",
    UniformGimp(),
    width=3,
    follows_deformation=False,
    description="linear grid functions averaged over undeformed particle boxes",
    reference="Bardenhagen and Kober, CMES 5 (2004) 477",
)


@fill.register(UniformGimp)
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
            l = size[a, first + k] * inverse
            quarter = 0.25 / l
            # mean of the outer hats over [t − l, t + l], by differences of their antiderivative
            l1, l2 = max(l - t, 0.0), max(-l - t, 0.0)
            r1, r2 = max(l + t, 0.0), max(t - l, 0.0)
            left, right = (l1 * l1 - l2 * l2) * quarter, (r1 * r1 - r2 * r2) * quarter
            slope_left, slope_right = (l2 - l1) * (2.0 * quarter * inverse), (r1 - r2) * (2.0 * quarter * inverse)
            W[lowest + np.uint64(a), k] = nearest - 1.0
            W[row, k] = left
            W[row + one, k] = 1.0 - left - right
            W[row + two, k] = right
            W[slope, k] = slope_left
            W[slope + one, k] = -slope_left - slope_right
            W[slope + two, k] = slope_right
    place(grid, first, n, lowest, field, base, W, status)
    tensor_product(grid, n, W, S, G)
