"""Linear shape functions of point particles (Sulsky, Chen and Schreyer 1994)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcli.core.stencil import fill, place, tensor_product
from mpmcli.shapes.base import add_shape


class Linear(NamedTuple):
    """Particles are points; grid functions are hats."""

    order: int = 1


add_shape(
    "linear",
    Linear(),
    width=2,
    follows_deformation=False,
    description="point particles on linear grid functions; cheap, noisy when particles cross cells",
    reference="Sulsky, Chen and Schreyer, Comput. Methods Appl. Mech. Eng. 118 (1994) 179",
)


@fill.register(Linear)
def _(shape, grid, X, F, size, field, first, n, base, S, G, W, status):
    d = len(grid.inverse_cell)
    w = grid.width
    lowest = np.uint64(2 * d) * w
    for a in range(d):
        origin, inverse, row = grid.origin[a], grid.inverse_cell[a], np.uint64(a) * w
        slope = np.uint64(d + a) * w
        for k in range(n):
            x = (X[a, first + k] - origin) * inverse
            left = np.floor(x)
            W[lowest + np.uint64(a), k] = left
            W[row, k] = 1.0 - (x - left)
            W[row + np.uint64(1), k] = x - left
            W[slope, k] = -inverse
            W[slope + np.uint64(1), k] = inverse
    place(grid, first, n, lowest, field, base, W, status)
    tensor_product(grid, n, W, S, G)
