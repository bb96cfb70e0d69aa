"""Growth where the energy release rate reaches a critical value (Griffith 1921)."""

from typing import ClassVar, Literal

from mpmcli.cracks.criteria.base import CRITERIA, Criterion, Toughness, share, value_of
from mpmcli.cracks.tip_state import TipState


@CRITERIA.register
class EnergyReleaseRate(Criterion):
    """Growth from J₁ ≥ J_c on."""

    needs: ClassVar[frozenset[str]] = frozenset({"J"})

    kind: Literal["energy_release_rate"]
    J_c: Toughness
    """Critical energy release rate: a number, or an expression of t, length and speed."""

    def demand(self, tip: TipState) -> float:
        """J₁/J_c."""
        return share(tip.J, value_of(self.J_c, tip))
