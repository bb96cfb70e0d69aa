"""Growth where the largest hoop stress around a tip is critical (Erdogan and Sih 1963)."""

import math
from typing import ClassVar, Literal

from mpmcli.cracks.criteria.base import CRITERIA, Criterion, Factor, share, value_of
from mpmcli.cracks.tip_state import TipState, hoop_angle


@CRITERIA.register
class MaximumHoopStress(Criterion):
    """Growth from K_I cos³(θ/2) − 1.5 K_II cos(θ/2) sin θ ≥ K_Ic on, at the angle θ of the largest hoop stress."""

    needs: ClassVar[frozenset[str]] = frozenset({"K"})
    direction: ClassVar[str] = "hoop"

    kind: Literal["maximum_hoop_stress"]
    K_Ic: Factor
    """Critical stress intensity factor: a number, or an expression of t, length and speed."""

    def demand(self, tip: TipState) -> float:
        """Intensity of the hoop stress over K_Ic."""
        angle = hoop_angle(tip.pulled, tip.K_II)
        c = math.cos(0.5 * angle)
        return share(c * (tip.pulled * c * c - 1.5 * tip.K_II * math.sin(angle)), value_of(self.K_Ic, tip))
