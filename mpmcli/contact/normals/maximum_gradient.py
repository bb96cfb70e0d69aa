"""Normal from the side with the larger volume gradient."""

from __future__ import annotations

from typing import Literal, NamedTuple

from mpmcli.contact.normals.base import NORMALS, BiasedNormalModel, find_normal
from mpmcli.contact.normals.gradients import (
    EQUAL,
    difference,
    length,
    negative,
    prefer_rigid,
    take_direction,
    volume_gradients,
)


@NORMALS.register
class MaximumGradientModel(BiasedNormalModel):
    """The larger of the two sides' volume gradients [nairn2023notes, Eq. 3.3]; their average if equal."""

    kind: Literal["maximum_gradient"]
    """Normal method."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> MaximumGradient:
        """The rigid bias."""
        return MaximumGradient(bias=float(self.rigid_bias))


class MaximumGradient(NamedTuple):
    """Numbers of the maximum gradient: rigid bias [-]."""

    bias: float


@find_normal.register(MaximumGradient)
def _(normal, axes, neighbours, count, rigid, order, guess, out):
    ga, gb, _, _, size = volume_gradients(axes, neighbours, count)
    a, b = length(ga), length(gb)
    if abs(a - b) <= EQUAL * (a + b):
        v = difference(ga, gb)
        largest = (0.5 * v[0], 0.5 * v[1], 0.5 * v[2])
    elif a > b:
        largest = ga
    else:
        largest = negative(gb)
    v = prefer_rigid(normal.bias, rigid, largest, ga, gb)
    return take_direction(axes, neighbours, count, order, v, size, out)
