"""Growth by an empirical law of both modes."""

from typing import Annotated, ClassVar, Literal

from mpmcli.core.model import Quantity
from mpmcli.cracks.criteria.base import CRITERIA, Criterion, Factor, share, value_of
from mpmcli.cracks.tip_state import TipState


@CRITERIA.register
class Empirical(Criterion):
    """Growth from (K_I/K_Ic)^p + (|K_II|/K_IIc)^q ≥ 1 on."""

    needs: ClassVar[frozenset[str]] = frozenset({"K"})
    direction: ClassVar[str] = "hoop"

    kind: Literal["empirical"]
    K_Ic: Factor
    """Critical stress intensity factor in mode I: a number, or an expression of t, length and speed."""
    K_IIc: Factor
    """The same in mode II."""
    p: Annotated[float, Quantity("1", gt=0)] = 2.0
    """Exponent of mode I."""
    q: Annotated[float, Quantity("1", gt=0)] = 2.0
    """Exponent of mode II."""

    def demand(self, tip: TipState) -> float:
        """The sum."""
        first = share(tip.pulled, value_of(self.K_Ic, tip))
        second = share(abs(tip.K_II), value_of(self.K_IIc, tip))
        return float(first**self.p + second**self.q)
