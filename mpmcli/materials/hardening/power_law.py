"""Ludwik's power law with an optional power of the rate."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple

from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.materials.hardening.base import SMALLEST_STRAIN, RateModel, flow, of_constant_stiffness, with_rate


class PowerLawHardening(RateModel):
    """Power law: Y = (yield_stress + B αⁿ)(α̇/eps0_dot)^m, α the equivalent plastic strain.

    Rates below eps0_dot count as eps0_dot.
    """

    kind: Literal["power_law"]
    yield_stress: PositivePressure
    """Initial yield stress."""
    B: Annotated[float, Quantity("pressure", ge=0)]
    """Hardening coefficient."""
    n: Annotated[float, Quantity("1", gt=0)]
    """Hardening exponent."""

    def parameters(self) -> PowerLaw:
        """The numbers of the law."""
        return PowerLaw(self.yield_stress, self.B, self.n, self.m, self.eps0_dot)


@of_constant_stiffness
class PowerLaw(NamedTuple):
    """Numbers of the power law, as in the model."""

    yield_stress: float
    B: float
    n: float
    m: float
    rate: float


@flow.register(PowerLaw)
def _(h: Any, alpha: Any, rate: Any, T: Any, dt: Any) -> Any:
    hardened = h.B * alpha**h.n
    slope = h.n * hardened / max(alpha, SMALLEST_STRAIN)
    return with_rate(h, h.yield_stress + hardened, slope, rate, dt)
