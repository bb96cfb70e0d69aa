"""Growth across the opening of the faces."""

import math
from typing import ClassVar, Literal

from mpmcli.cracks.directions.base import DIRECTIONS, Direction
from mpmcli.cracks.tip_state import TipState


@DIRECTIONS.register
class NormalToOpening(Direction):
    """At a right angle to the jump of the faces behind the tip; straight ahead where they are closed."""

    needs: ClassVar[frozenset[str]] = frozenset({"opening"})

    kind: Literal["normal_to_opening"]

    def angle(self, tip: TipState) -> float:
        """−atan(slip/opening)."""
        if tip.opening <= 0.0 and tip.slip == 0.0:
            return 0.0
        return -math.atan2(tip.slip, max(tip.opening, 0.0))
