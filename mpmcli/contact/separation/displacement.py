"""Separation by extrapolated displacements, for sides that touch at the start and move little."""

from typing import ClassVar, Literal, NamedTuple

from mpmcli.contact.separation.base import APART, SEPARATIONS, UNKNOWN, SeparationModel, find_separation
from mpmcli.contact.separation.extrapolated import extrapolate_along


@SEPARATIONS.register
class Displacement(SeparationModel):
    """δ_n = (u_β − u_α)·n̂ from displacements since the start, extrapolated to the node [nairn2023notes, Eqs. 3.45
    and 3.46].

    Right only where the sides touch at the start and displacements stay small against a cell.
    """

    needs_displacement: ClassVar[bool] = True

    kind: Literal["displacement"]

    def parameters(self, dimensions: int, cell: tuple[float, ...], particles_per_axis: int) -> NamedTuple:
        """None are needed."""
        return Displacements()


class Displacements(NamedTuple):
    """Separation by displacements has no numbers of its own."""


@find_separation.register(Displacements)
def _(separation, axes, neighbours, count, n, h, distances):
    distances[0], distances[1] = UNKNOWN, UNKNOWN
    alpha, beta, both = extrapolate_along(axes, neighbours, neighbours.displacement, count, n)
    return beta - alpha if both else APART
