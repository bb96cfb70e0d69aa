"""Voce's law: hardening that saturates."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.core.exponentials import exponential_1d
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.materials.hardening.base import HardeningModel, flow, of_constant_stiffness


class VoceHardening(HardeningModel):
    """Voce: Y = yield_stress + (saturation − yield_stress)(1 − exp(−α/eps0)) + modulus·α [voce1948].

    α is the equivalent plastic strain.
    """

    kind: Literal["voce"]
    yield_stress: PositivePressure
    """Initial yield stress."""
    saturation: PositivePressure
    """Flow stress at large plastic strain, without ``modulus``."""
    eps0: Annotated[float, Quantity("1", gt=0)]
    """Plastic strain in which the distance from saturation falls by the factor e."""
    modulus: Annotated[float, Quantity("pressure", ge=0)] = 0.0
    """Slope of the flow stress at large plastic strain."""

    @model_validator(mode="after")
    def _hardens(self) -> Self:
        if self.saturation < self.yield_stress:
            raise ValueError("saturation must be at least yield_stress")
        return self

    def parameters(self) -> Voce:
        """The numbers of the law."""
        return Voce(self.yield_stress, self.saturation - self.yield_stress, self.eps0, self.modulus)


@of_constant_stiffness
class Voce(NamedTuple):
    """Numbers of Voce's law; ``gain`` is the saturation stress minus the yield stress."""

    yield_stress: float
    gain: float
    eps0: float
    modulus: float


@flow.register(Voce)
def _(h: Any, alpha: Any, rate: Any, T: Any, dt: Any) -> Any:
    left = exponential_1d(-alpha / h.eps0)
    Y = h.yield_stress + h.gain * (1.0 - left) + h.modulus * alpha
    return Y, h.gain / h.eps0 * left + h.modulus
