"""Quadratic B-splines of point particles (Steffen, Kirby and Berzins 2008)."""

from typing import NamedTuple

from mpmcli.core.compiled.registers import floor
from mpmcli.core.transfer.separable import product_of_axes
from mpmcli.shapes.base import add_shape


class QuadraticSpline(NamedTuple):
    """Particles are points; grid functions are quadratic splines centred on the nodes."""

    order: int = 2


add_shape(
    "bspline2",
    QuadraticSpline(),
    width=3,
    grid_functions="quadratic",
    domain="point",
    description="point particles on quadratic B-splines",
    reference="Steffen, Kirby and Berzins, Int. J. Numer. Meth. Eng. 76 (2008) 922",
)


@product_of_axes(QuadraticSpline)
def _(shape, x, l):
    nearest = floor(x + 0.5)
    t = x - nearest
    values = (0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t))
    return nearest - 1.0, values, (t - 0.5, -2.0 * t, t + 0.5)
