"""Swift's power law with an optional power of the rate."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple

from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.materials.hardening.base import RateModel, flow, of_constant_stiffness, with_rate


class SwiftHardening(RateModel):
    """Swift: Y = yield_stress (1 + α/eps0)ⁿ (α̇/eps0_dot)^m, α the equivalent plastic strain [swift1952].

    Rates below eps0_dot count as eps0_dot.
    """

    kind: Literal["swift"]
    yield_stress: PositivePressure
    """Initial yield stress."""
    eps0: Annotated[float, Quantity("1", gt=0)]
    """Reference strain."""
    n: Annotated[float, Quantity("1", ge=0)]
    """Hardening exponent."""

    def parameters(self) -> Swift:
        """The numbers of the law."""
        return Swift(self.yield_stress, self.eps0, self.n, self.m, self.eps0_dot)


@of_constant_stiffness
class Swift(NamedTuple):
    """Numbers of Swift's law, as in the model."""

    yield_stress: float
    eps0: float
    n: float
    m: float
    rate: float


@flow.register(Swift)
def _(h: Any, alpha: Any, rate: Any, T: Any, dt: Any) -> Any:
    static = h.yield_stress * (1.0 + alpha / h.eps0) ** h.n
    return with_rate(h, static, static * h.n / (h.eps0 + alpha), rate, dt)
