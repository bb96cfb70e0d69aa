"""Normal from the volume gradients of both sides, weighted by their volumes at the node."""

from __future__ import annotations

from typing import Literal, NamedTuple

from mpmcli.contact.normals.base import NORMALS, NormalModel, find_normal
from mpmcli.contact.normals.gradients import take_direction, volume_gradients


@NORMALS.register
class VolumeWeightedGradientModel(NormalModel):
    """Volume gradients of both sides weighted by nodal volume, n ∝ Ω_α g_α − Ω_β g_β: what CB-Geo MPM
    makes of the average volume gradient of [nairn2013]."""

    kind: Literal["volume_weighted_gradient"]
    """Normal method."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> VolumeWeightedGradient:
        """None are needed."""
        return VolumeWeightedGradient()


class VolumeWeightedGradient(NamedTuple):
    """The volume-weighted gradient has no numbers of its own."""


@find_normal.register(VolumeWeightedGradient)
def _(normal, axes, neighbours, count, rigid, order, guess, out):
    ga, gb, volume_a, volume_b, size = volume_gradients(axes, neighbours, count)
    volume = volume_a + volume_b
    a = volume_a / volume if volume > 0.0 else 0.5
    b = 1.0 - a
    v = (a * ga[0] - b * gb[0], a * ga[1] - b * gb[1], a * ga[2] - b * gb[2])
    return take_direction(axes, neighbours, count, order, v, size, out)
