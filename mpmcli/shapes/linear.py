"""Linear shape functions of point particles (Sulsky, Chen and Schreyer 1994)."""

from typing import NamedTuple

from mpmcli.core.compiled.registers import floor
from mpmcli.core.transfer.separable import product_of_axes
from mpmcli.shapes.base import add_shape


class Linear(NamedTuple):
    """Particles are points; grid functions are hats."""

    order: int = 1


add_shape(
    "linear",
    Linear(),
    width=2,
    grid_functions="linear",
    domain="point",
    description="point particles on linear grid functions; cheap, noisy when particles cross cells",
    reference="Sulsky, Chen and Schreyer, Comput. Methods Appl. Mech. Eng. 118 (1994) 179",
)


@product_of_axes(Linear)
def _(shape, x, l):
    left = floor(x)
    one = 0.0 * x + 1.0
    return left, (1.0 - (x - left), x - left), (0.0 - one, one)
