"""Growth straight ahead."""

from typing import Literal

from mpmcli.cracks.directions.base import DIRECTIONS, Direction
from mpmcli.cracks.tip_state import TipState


@DIRECTIONS.register
class SelfSimilar(Direction):
    """Along the last segment of the crack as it lies now."""

    kind: Literal["self_similar"]

    def angle(self, tip: TipState) -> float:
        """Zero."""
        return 0.0
