"""Ideal gas."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.core.exponentials import exponential_1d, logarithm
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.core.tensors import determinant
from mpmcli.materials.base import (
    MATERIALS,
    MaterialModel,
    absorb_work,
    bulk_speed_squared,
    isentropic_growth,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults, yes

# rows of the history array
TEMPERATURE, HEAT = 0, 1


@MATERIALS.register
class IdealGas(MaterialModel):
    """Ideal gas: p = (p0/J)(T/T0), τ = −Jp I.

    Isothermal: T = T0. Adiabatic: T ∝ J^(1−γ) plus the heat of artificial viscosity, with ρ₀c_v = p0/((γ −
    1)T0). The gas is under its pressure from the start. Its stored energy is relative to the start: p0
    (J^(1−γ) − 1)/(γ − 1) per initial volume if adiabatic, −p0 ln J if isothermal.
    """

    analyses: ClassVar[frozenset[str]] = frozenset({"uniaxial_strain", "plane_strain", "axisymmetric", "3d"})
    history: ClassVar[tuple[str, ...]] = ("temperature", "heat_energy")
    properties: ClassVar[frozenset[str]] = frozenset(
        {"hyperelastic", "isotropic", "fluid", "equation_of_state"}
    )
    thermal_pressure: ClassVar[str] = "the pressure is proportional to the temperature T"

    kind: Literal["ideal_gas"]
    pressure: PositivePressure
    """Initial pressure p0 at the initial density."""
    gamma: Annotated[float, Quantity("1", gt=1)] = 1.4
    """Ratio of the heat capacities at constant pressure and constant volume."""

    @model_validator(mode="after")
    def _one_capacity(self) -> Self:
        known, given = self.specific_heat, self.heat_capacity
        if given is not None and not math.isclose(known, given, rel_tol=1e-3):
            raise ValueError(
                "heat_capacity follows from pressure, gamma, T0 and density: pressure/((gamma - 1)*T0*density) = "
                f"{known:.7g}, not {given:g}; leave it out"
            )
        return self

    @property
    def specific_heat(self) -> float:
        """Heat capacity per mass at constant volume, p0/((γ − 1)ρ₀T0) [specific_heat]."""
        return self.pressure / ((self.gamma - 1) * self.T0 * self.density)

    def parameters(self, analysis: str, adiabatic: bool) -> Gas:
        """Pressure, temperature and density at the start; the exponent of the adiabat, or 1 if isothermal."""
        return Gas(
            pressure=self.pressure,
            exponent=self.gamma if adiabatic else 1.0,
            density=self.density,
            T0=self.T0,
            capacity=self.pressure / ((self.gamma - 1) * self.T0),
        )

    def initial_wave_speed(self, analysis: str) -> float:
        """√(γ p0/ρ₀), the adiabatic speed [velocity]."""
        return math.sqrt(self.gamma * self.pressure / self.density)


@with_defaults
class Gas(NamedTuple):
    """Numbers of an ideal gas."""

    pressure: float
    exponent: float
    """γ if adiabatic, 1 if isothermal."""
    density: float
    T0: float
    capacity: float
    """ρ₀c_v [pressure/temperature]."""


needs_increment.register(Gas)(yes)


@kirchhoff_stress.register(Gas)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    T = H[TEMPERATURE, p] * exponential_1d((1.0 - m.exponent) * logarithm(determinant(dF)))
    if commit:
        H[TEMPERATURE, p] = T
    tau = -m.pressure * T / m.T0
    return tau, tau, tau, 0.0, 0.0, 0.0


@absorb_work.register(Gas)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
    H[HEAT, p] += viscous
    if m.exponent > 1.0:
        H[TEMPERATURE, p] += viscous / m.capacity


@isentropic_growth.register(Gas)
def _(m: Any, F: Any, dF: Any) -> Any:
    return -m.pressure / (m.capacity * m.T0) * logarithm(determinant(dF))


@strain_energy.register(Gas)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    log = logarithm(determinant(F))
    if m.exponent > 1.0:
        return m.pressure * (exponential_1d((1.0 - m.exponent) * log) - 1.0) / (m.exponent - 1.0)
    return -m.pressure * log


@bulk_speed_squared.register(Gas)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return m.exponent * m.pressure * H[TEMPERATURE, p] / (m.T0 * m.density)


@wave_speed_squared.register(Gas)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return m.exponent * m.pressure * max(1.0, H[TEMPERATURE, p] / m.T0) / m.density
