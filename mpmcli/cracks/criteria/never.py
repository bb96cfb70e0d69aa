"""No growth."""

from typing import Literal

from mpmcli.cracks.criteria.base import CRITERIA, Criterion
from mpmcli.cracks.tip_state import TipState


@CRITERIA.register
class Never(Criterion):
    """The tip stays where it is."""

    kind: Literal["never"]

    def demand(self, tip: TipState) -> float:
        """Nothing."""
        return 0.0
