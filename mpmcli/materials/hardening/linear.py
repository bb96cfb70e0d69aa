"""Linear hardening."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple

from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.materials.hardening.base import HardeningModel, flow, of_constant_stiffness


class LinearHardening(HardeningModel):
    """Linear isotropic hardening: Y = yield_stress + modulus·α, α the equivalent plastic strain."""

    kind: Literal["linear"]
    yield_stress: PositivePressure
    """Initial yield stress."""
    modulus: Annotated[float, Quantity("pressure", ge=0)] = 0.0
    """Slope of the flow stress against equivalent plastic strain; 0 is perfectly plastic."""

    def parameters(self) -> Linear:
        """The numbers of the law."""
        return Linear(self.yield_stress, self.modulus)


@of_constant_stiffness
class Linear(NamedTuple):
    """Numbers of linear hardening."""

    yield_stress: float
    modulus: float


@flow.register(Linear)
def _(h: Any, alpha: Any, rate: Any, T: Any, dt: Any) -> Any:
    return h.yield_stress + h.modulus * alpha, h.modulus
