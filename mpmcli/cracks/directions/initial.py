"""Growth along the first direction of a tip."""

from typing import Literal

from mpmcli.cracks.directions.base import DIRECTIONS, Direction
from mpmcli.cracks.tip_state import TipState


@DIRECTIONS.register
class Initial(Direction):
    """Along the direction in space that the tip had at the start of the run."""

    kind: Literal["initial"]

    def angle(self, tip: TipState) -> float:
        """Back to that direction."""
        return tip.angle0 - tip.angle
