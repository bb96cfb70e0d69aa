"""Growth where the density of strain energy around a tip is critical (Sih 1974)."""

import math
from typing import ClassVar, Literal

import numpy as np

from mpmcli.cracks.criteria.base import CRITERIA, Criterion, Factor, share, value_of
from mpmcli.cracks.tip_state import TipState


@CRITERIA.register
class StrainEnergyDensity(Criterion):
    """Growth from √(S/(2(κ − 1))) ≥ K_Ic on, at the angle of the least S on the side opposite to K_II.

    S = a₁₁ K_I² + 2 a₁₂ K_I K_II + a₂₂ K_II², with a₁₁ = (1 + c)(κ − c), a₁₂ = s(2c − κ + 1) and
    a₂₂ = (κ + 1)(1 − c) + (1 + c)(3c − 1), where c and s are the cosine and the sine of the angle.
    """

    needs: ClassVar[frozenset[str]] = frozenset({"K"})
    direction: ClassVar[str] = "hoop"

    kind: Literal["strain_energy_density"]
    K_Ic: Factor
    """Critical stress intensity factor in mode I: a number, or an expression of t, length and speed."""

    def demand(self, tip: TipState) -> float:
        """√(S/(2(κ − 1)))/K_Ic; 0 where the material has no stress intensity factors."""
        if tip.elasticity is None:
            return 0.0
        kappa = tip.elasticity.kappa
        S = density(least_angle(tip.pulled, tip.K_II, kappa), tip.pulled, tip.K_II, kappa)
        return share(math.sqrt(max(S, 0.0) / (2.0 * (kappa - 1.0))), value_of(self.K_Ic, tip))


def density(angle: float, K_I: float, K_II: float, kappa: float) -> float:
    """S at an angle from e₁ [pressure²·length]."""
    c, s = math.cos(angle), math.sin(angle)
    a22 = (kappa + 1.0) * (1.0 - c) + (1.0 + c) * (3.0 * c - 1.0)
    return (1.0 + c) * (kappa - c) * K_I**2 + 2.0 * s * (2.0 * c - kappa + 1.0) * K_I * K_II + a22 * K_II**2


def least_angle(K_I: float, K_II: float, kappa: float) -> float:
    """Return the angle of the first minimum of S from straight ahead to the side opposite to K_II [rad]."""

    def slope(angle: float) -> float:
        c, s = math.cos(angle), math.sin(angle)
        own = s * (2.0 * c - kappa + 1.0) * K_I**2 + s * (kappa - 1.0 - 6.0 * c) * K_II**2
        return own + 2.0 * (2.0 * math.cos(2.0 * angle) - (kappa - 1.0) * c) * K_I * K_II

    side = -math.copysign(1.0, K_II) if K_II else 1.0
    if K_II == 0.0:
        return 0.0
    before = 0.0
    for after in side * np.radians(np.arange(0.5, 100.0, 0.5)):
        if slope(float(after)) * side >= 0.0:
            low, high = before, float(after)
            for _ in range(50):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if slope(middle) * side < 0.0 else (low, middle)
            return 0.5 * (low + high)
        before = float(after)
    return before
