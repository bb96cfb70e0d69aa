"""Quadratic B-splines averaged over the particle's undeformed box."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcli.core.kernel import inline
from mpmcli.core.stencil import axis_weights, fill, fill_tensor_product
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
def _(shape, grid, across, X, F, size, p, S, G, W, status):
    return fill_tensor_product(grid, shape, across, X, size, p, S, G, status)


@axis_weights.register(SplineGimp)
def _(shape, x, l):
    lowest = np.floor(x) - 1.0
    r = x - lowest
    half = 0.5 / l
    values = (
        (spline_integral(r + l) - spline_integral(r - l)) * half,
        (spline_integral(r - 1.0 + l) - spline_integral(r - 1.0 - l)) * half,
        (spline_integral(r - 2.0 + l) - spline_integral(r - 2.0 - l)) * half,
        (spline_integral(r - 3.0 + l) - spline_integral(r - 3.0 - l)) * half,
    )
    slopes = (
        (spline(r + l) - spline(r - l)) * half,
        (spline(r - 1.0 + l) - spline(r - 1.0 - l)) * half,
        (spline(r - 2.0 + l) - spline(r - 2.0 - l)) * half,
        (spline(r - 3.0 + l) - spline(r - 3.0 - l)) * half,
    )
    return lowest, values, slopes
