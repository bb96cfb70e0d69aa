"""Normal from the side with the larger volume at the node."""

from __future__ import annotations

from typing import Literal, NamedTuple

from mpmcli.contact.normals.base import NORMALS, NormalModel, find_normal
from mpmcli.contact.normals.gradients import EQUAL, difference, negative, take_direction, volume_gradients


@NORMALS.register
class MaximumVolumeModel(NormalModel):
    """Volume gradient of the side with more volume at the node [nairn2023notes, Eq. 3.4]; with equal
    volumes the average of both."""

    kind: Literal["maximum_volume"]
    """Normal method."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> MaximumVolume:
        """None are needed."""
        return MaximumVolume()


class MaximumVolume(NamedTuple):
    """The maximum volume method has no numbers of its own."""


@find_normal.register(MaximumVolume)
def _(normal, axes, neighbours, count, rigid, order, guess, out):
    ga, gb, a, b, size = volume_gradients(axes, neighbours, count)
    if abs(a - b) <= EQUAL * (a + b):
        v = difference(ga, gb)
    elif a > b:
        v = ga
    else:
        v = negative(gb)
    return take_direction(axes, neighbours, count, order, v, size, out)
