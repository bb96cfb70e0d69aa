"""Growth at a given speed."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from mpmcli.core.expressions import Expression
from mpmcli.core.model import Time, Varying
from mpmcli.cracks.criteria.base import CRITERIA, Criterion, Toughness, share, value_of
from mpmcli.cracks.tip_state import TipState


@CRITERIA.register
class SteadySpeed(Criterion):
    """Growth at a speed, from a time on, or from the first time on at which J₁ ≥ J_c thereafter."""

    kind: Literal["steady_speed"]
    speed: Annotated[Expression, Varying("velocity", ("t", "length"))]
    """Speed of the tip: a number, or an expression of t and length."""
    start: Annotated[Time, Field(alias="from")] = 0.0
    """Time from which on the tip may run."""
    J_c: Toughness | None = None
    """Energy release rate at which it sets in; at once if left out."""

    needs: ClassVar[frozenset[str]] = frozenset()

    def sets_in(self, tip: TipState) -> bool:
        """Whether a tip that has not run so far runs from now on."""
        return tip.time >= self.start and (self.J_c is None or tip.J >= value_of(self.J_c, tip))

    def demand(self, tip: TipState) -> float:
        """Path that the tip should have made since it grew last, over the next increment."""
        if math.isnan(tip.started):
            return 0.0
        return share((tip.time - self._since(tip)) * self._speed(tip), tip.increment)

    def goes_on(self, tip: TipState) -> bool:
        """Whether its speed is above 0."""
        return self._speed(tip) > 0.0

    def moment(self, tip: TipState) -> float:
        """Return the time at which an exact tip would have made the increment, so that no delay adds up."""
        return self._since(tip) + tip.increment / self._speed(tip)

    def _speed(self, tip: TipState) -> float:
        return max(0.0, value_of(self.speed, tip))

    def _since(self, tip: TipState) -> float:
        return tip.started if math.isnan(tip.last) else tip.last
