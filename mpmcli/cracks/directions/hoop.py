"""Growth across the largest hoop stress (Erdogan and Sih 1963)."""

from typing import ClassVar, Literal

from mpmcli.cracks.directions.base import DIRECTIONS, Direction
from mpmcli.cracks.tip_state import TipState, hoop_angle


@DIRECTIONS.register
class Hoop(Direction):
    """θ = 2 atan(¼(K_I/K_II ∓ √((K_I/K_II)² + 8))): −70.53° in pure mode II with K_II > 0."""

    needs: ClassVar[frozenset[str]] = frozenset({"K"})

    kind: Literal["hoop"]

    def angle(self, tip: TipState) -> float:
        """The angle."""
        return hoop_angle(tip.pulled, tip.K_II)
