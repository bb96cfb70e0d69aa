"""Growth in a given direction."""

import math
from typing import Annotated, Literal

from pydantic import AfterValidator

from mpmcli.core.model import Number
from mpmcli.cracks.directions.base import DIRECTIONS, Direction
from mpmcli.cracks.tip_state import TipState
from mpmcli.geometry.vectors import Count, has_length


@DIRECTIONS.register
class Given(Direction):
    """Along a vector in space."""

    kind: Literal["given"]
    along: Annotated[tuple[Number, ...], Count(2, 2), AfterValidator(has_length)]
    """The vector [x, y], of any length."""

    def angle(self, tip: TipState) -> float:
        """To the vector."""
        return math.atan2(self.along[1], self.along[0]) - tip.angle
