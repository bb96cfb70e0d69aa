"""Normal from linear regression."""

from __future__ import annotations

from typing import Literal, NamedTuple

from mpmcli.contact.normals.base import FOUND, NORMALS, find_normal
from mpmcli.contact.normals.gradients import fall_back, set_normal
from mpmcli.contact.normals.plane import RegressionModel, linear_plane, plane_numbers, take_rigid


@NORMALS.register
class LinearRegressionModel(RegressionModel):
    """Plane between the particles of both sides by linear regression [nairn2023notes, Eqs. 3.17–3.18].

    The same as stopping ``logistic_regression`` after its first pass, up to a factor in the penalties.
    """

    kind: Literal["linear_regression"]
    """Normal method."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> LinearPlane:
        """Penalties and cell size."""
        return LinearPlane(**plane_numbers(self, cell))


class LinearPlane(NamedTuple):
    """Numbers of the linear regression: 1/h [1/length], penalties of normal (over h²) and offset, rigid
    bias."""

    inverse_cell: float
    penalty: float
    offset_penalty: float
    bias: float


@find_normal.register(LinearPlane)
def _(normal, axes, neighbours, count, rigid, order, guess, out):
    if take_rigid(normal, axes, neighbours, count, rigid, out):
        return FOUND
    beta, has_direction = linear_plane(normal, axes, neighbours, count, 1.0)
    if not has_direction:
        return fall_back(axes, neighbours, count, order, out)
    set_normal(axes, beta, out)
    return FOUND
