"""Normal from the average of both sides' volume gradients."""

from __future__ import annotations

from typing import Literal, NamedTuple

from mpmcli.contact.normals.base import NORMALS, BiasedNormalModel, find_normal
from mpmcli.contact.normals.gradients import prefer_rigid, take_direction, volume_gradients


@NORMALS.register
class AverageGradientModel(BiasedNormalModel):
    """Average of the volume gradients of both sides, n ∝ g_α − g_β [nairn2020, Eq. 13]."""

    kind: Literal["average_gradient"]
    """Normal method."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> AverageGradient:
        """The rigid bias."""
        return AverageGradient(bias=float(self.rigid_bias))


class AverageGradient(NamedTuple):
    """Numbers of the average gradient: rigid bias [-]."""

    bias: float


@find_normal.register(AverageGradient)
def _(normal, axes, neighbours, count, rigid, order, guess, out):
    ga, gb, _, _, size = volume_gradients(axes, neighbours, count)
    mean = (0.5 * (ga[0] - gb[0]), 0.5 * (ga[1] - gb[1]), 0.5 * (ga[2] - gb[2]))
    v = prefer_rigid(normal.bias, rigid, mean, ga, gb)
    return take_direction(axes, neighbours, count, order, v, size, out)
