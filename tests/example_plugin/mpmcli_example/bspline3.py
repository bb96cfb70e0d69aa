"""Cubic B-splines of point particles."""

from __future__ import annotations

from typing import NamedTuple

from mpmcli.core.compiled.registers import floor
from mpmcli.core.transfer.separable import product_of_axes
from mpmcli.shapes.base import add_shape


class CubicSpline(NamedTuple):
    """Particles are points; grid functions are cubic splines centred on the nodes."""

    order: int = 3


add_shape(
    "bspline3",
    CubicSpline(),
    width=4,
    grid_functions="other",
    domain="point",
    description="point particles on cubic B-splines",
    reference="Steffen, Kirby and Berzins, Int. J. Numer. Meth. Eng. 76 (2008) 922",
)


@product_of_axes(CubicSpline)
def _(shape, x, l):
    below = floor(x)
    t = x - below
    u = 1.0 - t
    values = (
        u * u * u / 6.0,
        (4.0 - 3.0 * t * t * (1.0 + u)) / 6.0,
        (4.0 - 3.0 * u * u * (1.0 + t)) / 6.0,
        t * t * t / 6.0,
    )
    slopes = (-0.5 * u * u, t * (1.5 * t - 2.0), u * (2.0 - 1.5 * u), 0.5 * t * t)
    return below - 1.0, values, slopes
