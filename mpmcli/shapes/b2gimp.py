"""Quadratic B-splines averaged over the particle's undeformed box."""

from typing import NamedTuple

from mpmcli.core.compiled.registers import floor
from mpmcli.core.functions import quadratic_spline, quadratic_spline_integral
from mpmcli.core.transfer.separable import product_of_axes
from mpmcli.shapes.base import add_shape


class SplineGimp(NamedTuple):
    """Particle domains are boxes of their initial size; grid functions are quadratic splines."""

    order: int = 2


add_shape(
    "b2gimp",
    SplineGimp(),
    width=4,
    grid_functions="quadratic",
    domain="box",
    description="quadratic B-splines averaged over undeformed particle boxes",
    reference="Nairn and Hammerquist, Comput. Methods Appl. Mech. Eng. 377 (2021) 113667",
)


@product_of_axes(SplineGimp)
def _(shape, x, l):
    lowest = floor(x) - 1.0
    r = x - lowest
    half = 0.5 / l
    values = (
        (quadratic_spline_integral(r + l) - quadratic_spline_integral(r - l)) * half,
        (quadratic_spline_integral(r - 1.0 + l) - quadratic_spline_integral(r - 1.0 - l)) * half,
        (quadratic_spline_integral(r - 2.0 + l) - quadratic_spline_integral(r - 2.0 - l)) * half,
        (quadratic_spline_integral(r - 3.0 + l) - quadratic_spline_integral(r - 3.0 - l)) * half,
    )
    slopes = (
        (quadratic_spline(r + l) - quadratic_spline(r - l)) * half,
        (quadratic_spline(r - 1.0 + l) - quadratic_spline(r - 1.0 - l)) * half,
        (quadratic_spline(r - 2.0 + l) - quadratic_spline(r - 2.0 - l)) * half,
        (quadratic_spline(r - 3.0 + l) - quadratic_spline(r - 3.0 - l)) * half,
    )
    return lowest, values, slopes
