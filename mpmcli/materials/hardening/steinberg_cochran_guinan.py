"""Steinberg, Cochran and Guinan: flow stress and shear modulus grow with pressure and fall with temperature."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.core.exponentials import exponential_1d
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.materials.hardening.base import HardeningModel, changes_stiffness, flow, stiffness_ratio


class SteinbergCochranGuinanHardening(HardeningModel):
    """Steinberg–Cochran–Guinan: Y = min(yield_stress (1 + beta (α + alpha0))ⁿ, Y_max)·G/G0 [steinberg1980].

    The shear modulus is G/G0 = 1 + A p J^(1/3) − B (T − T0), at least 0, and 0 above Tm; p is the pressure −K ln J/J of
    the elastic law. α is the equivalent plastic strain. The law does not depend on the rate.
    """

    kind: Literal["steinberg_cochran_guinan"]
    yield_stress: PositivePressure
    """Initial yield stress at T0 without pressure."""
    Y_max: PositivePressure
    """Largest yield stress at T0 without pressure."""
    beta: Annotated[float, Quantity("1", ge=0)] = 0.0
    """Hardening coefficient."""
    n: Annotated[float, Quantity("1", ge=0)] = 1.0
    """Hardening exponent."""
    alpha0: Annotated[float, Quantity("1", ge=0)] = 0.0
    """Equivalent plastic strain at the start."""
    A: Annotated[float, Quantity("1/pressure", ge=0)] = 0.0
    """Relative increase of the shear modulus by pressure, G′_P/G0."""
    B: Annotated[float, Quantity("1/temperature", ge=0)] = 0.0
    """Relative decrease of the shear modulus by temperature, −G′_T/G0."""
    T0: Annotated[float, Quantity("temperature", ge=0)] = 300.0
    """Temperature at which the moduli are those of the material."""
    Tm: Annotated[float, Quantity("temperature", gt=0)] = 1e30
    """Melting temperature, from which on there is no shear stress."""

    @model_validator(mode="after")
    def _hardens(self) -> Self:
        if self.Y_max < self.yield_stress:
            raise ValueError("Y_max must be at least yield_stress")
        return self

    def parameters(self) -> SteinbergCochranGuinan:
        """The numbers of the law."""
        return SteinbergCochranGuinan(
            self.yield_stress, self.Y_max, self.beta, self.n, self.alpha0, self.A, self.B, self.T0, self.Tm
        )


class SteinbergCochranGuinan(NamedTuple):
    """Numbers of the law, as in the model."""

    yield_stress: float
    Y_max: float
    beta: float
    n: float
    alpha0: float
    A: float
    B: float
    T0: float
    Tm: float


@flow.register(SteinbergCochranGuinan)
def _(h: Any, alpha: Any, rate: Any, T: Any, dt: Any) -> Any:
    hardened = 1.0 + h.beta * (alpha + h.alpha0)
    Y = h.yield_stress * hardened**h.n
    if Y >= h.Y_max:
        return h.Y_max, 0.0
    return Y, Y * h.n * h.beta / hardened


@changes_stiffness.register(SteinbergCochranGuinan)
def _(h: Any) -> Any:
    return True


@stiffness_ratio.register(SteinbergCochranGuinan)
def _(h: Any, bulk: Any, log_J: Any, T: Any) -> Any:
    shrunk = h.A * bulk * exponential_1d(-2.0 / 3.0 * log_J)
    ratio = 1.0 - shrunk * log_J - h.B * (T - h.T0)
    if ratio <= 0.0 or h.Tm <= T:
        return 0.0, 0.0
    return ratio, shrunk * (2.0 / 3.0 * log_J - 1.0)
