"""Uniform GIMP: hats averaged over the particle's undeformed box (Bardenhagen and Kober 2004)."""

from typing import NamedTuple

from mpmcli.core.compiled.registers import floor, positive_part
from mpmcli.core.transfer.separable import product_of_axes
from mpmcli.shapes.base import add_shape


class UniformGimp(NamedTuple):
    """Particle domains are boxes of their initial size."""

    order: int = 1


add_shape(
    "ugimp",
    UniformGimp(),
    width=3,
    grid_functions="linear",
    domain="box",
    description="linear grid functions averaged over undeformed particle boxes",
    reference="Bardenhagen and Kober, CMES 5 (2004) 477",
)


@product_of_axes(UniformGimp)
def _(shape, x, l):
    nearest = floor(x + 0.5)
    t = x - nearest
    quarter = 0.25 / l
    # mean of the outer hats over [t − l, t + l], by differences of their antiderivative
    l1, l2 = positive_part(l - t), positive_part(0.0 - l - t)
    r1, r2 = positive_part(l + t), positive_part(t - l)
    left, right = (l1 * l1 - l2 * l2) * quarter, (r1 * r1 - r2 * r2) * quarter
    falls, rises = (l2 - l1) * (2.0 * quarter), (r1 - r2) * (2.0 * quarter)
    return nearest - 1.0, (left, 1.0 - left - right, right), (falls, 0.0 - falls - rises, rises)
