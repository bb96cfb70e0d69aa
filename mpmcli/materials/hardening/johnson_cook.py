"""Johnson and Cook's flow stress."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, NamedTuple

from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.materials.hardening.base import HardeningModel, flow, of_constant_stiffness


class JohnsonCookHardening(HardeningModel):
    """Johnson–Cook: Y = (A + B αⁿ)(1 + C ln(α̇/eps0_dot))(1 − T*ᵐ), T* = (T − T0)/(Tm − T0).

    Rates below eps0_dot count as eps0_dot, temperatures below T0 as T0, and above Tm the flow stress is zero.
    """

    kind: Literal["johnson_cook"]
    A: PositivePressure
    """Initial yield stress."""
    B: Annotated[float, Quantity("pressure", ge=0)] = 0.0
    """Hardening coefficient."""
    n: Annotated[float, Quantity("1", gt=0)] = 1.0
    """Hardening exponent."""
    C: Annotated[float, Quantity("1", ge=0)] = 0.0
    """Rate coefficient."""
    eps0_dot: Annotated[float, Quantity("rate", gt=0)] = 1.0
    """Reference rate of plastic strain."""
    Tm: Annotated[float, Quantity("temperature", gt=0)] = 1e30
    """Melting temperature; without it there is no thermal softening."""
    T0: Annotated[float, Quantity("temperature", ge=0)] = 300.0
    """Reference temperature."""
    m: Annotated[float, Quantity("1", gt=0)] = 1.0
    """Exponent of thermal softening."""

    def parameters(self) -> JohnsonCook:
        """The numbers of the law."""
        return JohnsonCook(self.A, self.B, self.n, self.C, self.eps0_dot, self.Tm, self.T0, self.m)


@of_constant_stiffness
class JohnsonCook(NamedTuple):
    """Numbers of the Johnson–Cook law, as in the model."""

    A: float
    B: float
    n: float
    C: float
    rate: float
    Tm: float
    T0: float
    m: float


@flow.register(JohnsonCook)
def _(h: Any, alpha: Any, rate: Any, T: Any, dt: Any) -> Any:
    hardened = h.A + h.B * alpha**h.n
    hastened = 1.0 + h.C * math.log(max(1.0, rate / h.rate))
    heated = min(1.0, max(0.0, (T - h.T0) / (h.Tm - h.T0)))
    slope = h.B * h.n * max(alpha, 1e-12) ** (h.n - 1.0) * hastened
    if rate > h.rate:
        slope += hardened * h.C / (rate * dt)
    cooler = 1.0 - heated**h.m
    return hardened * hastened * cooler, slope * cooler
