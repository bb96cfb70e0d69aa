"""Normal of each side by itself, from its own volume gradient."""

from __future__ import annotations

from typing import ClassVar, Literal, NamedTuple

from mpmcli.contact.normals.base import NORMALS, NormalModel, find_normal
from mpmcli.contact.normals.gradients import take_direction, volume_gradients


@NORMALS.register
class OwnGradientModel(NormalModel):
    """Each field's own volume gradient, n = g_α/|g_α| [nairn2023notes, Eq. 3.5], as
    in [bardenhagen2000].

    The two sides of a contact get normals that are not opposite, so that contact does not conserve momentum:
    for comparison with early codes only.
    """

    shares_normal: ClassVar[bool] = False

    kind: Literal["own_gradient"]
    """Normal method."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> OwnGradient:
        """None are needed."""
        return OwnGradient()


class OwnGradient(NamedTuple):
    """The own gradient method has no numbers of its own."""


@find_normal.register(OwnGradient)
def _(normal, axes, neighbours, count, rigid, order, guess, out):
    ga, _, _, _, size = volume_gradients(axes, neighbours, count)
    return take_direction(axes, neighbours, count, order, ga, size, out)
