"""No separation: sides that share a node and approach are in contact."""

from typing import Literal, NamedTuple

from mpmcli.contact.separation.base import SEPARATIONS, TOUCHING, UNKNOWN, SeparationModel, find_separation


@SEPARATIONS.register
class NoSeparation(SeparationModel):
    """Approach alone makes contact, as in early codes [nairn2020, Eq. 14]: found up to two cells too soon."""

    kind: Literal["none"]

    def parameters(self, dimensions: int, cell: tuple[float, ...], particles_per_axis: int) -> NamedTuple:
        """None are needed."""
        return AlwaysTouching()


class AlwaysTouching(NamedTuple):
    """Sides that always touch have no numbers."""


@find_separation.register(AlwaysTouching)
def _(separation, axes, neighbours, count, n, h, distances):
    distances[0], distances[1] = UNKNOWN, UNKNOWN
    return TOUCHING
