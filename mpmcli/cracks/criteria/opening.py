"""Growth where the faces behind a tip are far enough apart."""

from typing import Annotated, ClassVar, Literal, Self

from pydantic import model_validator

from mpmcli.core.expressions import Expression
from mpmcli.core.model import Varying
from mpmcli.cracks.criteria.base import CRITERIA, VARIABLES, Criterion, share, value_of
from mpmcli.cracks.tip_state import TipState

Displacement = Annotated[Expression, Varying("length", VARIABLES)]


@CRITERIA.register
class Opening(Criterion):
    """Growth from a critical opening on, or from a critical slip, of the point of the chain behind the tip."""

    needs: ClassVar[frozenset[str]] = frozenset({"opening"})

    kind: Literal["opening"]
    normal: Displacement | None = None
    """Critical opening: a number, or an expression of t, length and speed; any if left out."""
    tangential: Displacement | None = None
    """Critical slip, likewise."""

    @model_validator(mode="after")
    def _one_at_least(self) -> Self:
        if self.normal is None and self.tangential is None:
            raise ValueError("give normal, tangential, or both")
        return self

    def demand(self, tip: TipState) -> float:
        """The larger share."""
        pairs = ((self.normal, tip.opening), (self.tangential, abs(tip.slip)))
        return max(share(now, value_of(critical, tip)) for critical, now in pairs if critical is not None)
