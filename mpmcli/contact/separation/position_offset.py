"""Separation of extrapolated positions less a constant: the contact position method."""

from typing import Annotated, Literal, NamedTuple

from mpmcli.contact.separation.base import APART, SEPARATIONS, UNKNOWN, SeparationModel, find_separation
from mpmcli.contact.separation.extrapolated import extrapolate_along
from mpmcli.core.model import Quantity


@SEPARATIONS.register
class PositionOffset(SeparationModel):
    """δ_n = (x_β − x_α)·n̂ − δ_c h⊥ from positions extrapolated to the node [nairn2020, Eq. 16; nairn2023notes,
    Eqs. 3.50 and 3.54].

    It assumes undeformed particles and sides more than two cells thick.
    """

    kind: Literal["position_offset"]
    offset: Annotated[float, Quantity("1")] | None = None
    """Separation of extrapolated positions in contact, δ_c, in cells. Left out: 0.8, or 1.07 for bodies with one
    particle per axis. Straight lines fitted to the exact relation give 0.92 for GIMP and 0.96 for CPDI with two
    particles per axis [nairn2020, Eq. 17]."""

    def parameters(self, dimensions: int, cell: tuple[float, ...], particles_per_axis: int) -> NamedTuple:
        """The offset in cells."""
        usual = 1.07 if particles_per_axis == 1 else 0.8
        return OffsetPositions(usual if self.offset is None else self.offset)


class OffsetPositions(NamedTuple):
    """δ_c [cells]."""

    offset: float


@find_separation.register(OffsetPositions)
def _(separation, axes, neighbours, count, n, h, distances):
    distances[0], distances[1] = UNKNOWN, UNKNOWN
    alpha, beta, both = extrapolate_along(axes, neighbours, neighbours.x, count, n)
    return beta - alpha - separation.offset * h if both else APART
