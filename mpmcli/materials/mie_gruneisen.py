"""Mie–Grüneisen solid under shock: a Hugoniot reference pressure, internal energy, and a shear term."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential_1d
from mpmcli.core.model import Quantity
from mpmcli.core.tensors import determinant
from mpmcli.materials.base import (
    MATERIALS,
    HeatCapacity,
    MaterialModel,
    absorb_heat,
    absorb_work,
    bulk_speed_squared,
    isentropic_growth,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults, yes
from mpmcli.materials.isochoric import isochoric_stiffness, isochoric_stress

# rows of the history array
ENERGY, TEMPERATURE, HEAT = 0, 1, 2


@MATERIALS.register
class MieGruneisen(MaterialModel):
    """Mie–Grüneisen equation of state with the shear term of a neo-Hookean solid.

    With η = 1 − J and E = ρ₀U the internal energy per initial volume, the pressure (Cauchy) is

    p = K η (1 − ½γ₀η) / (1 − S₁η − S₂η² − S₃η³)² + γ₀E for η > 0 (compression), p = K η + γ₀E otherwise

    (Eq. 51 of Nairn, Hammerquist & Smith 2020, whose branches are printed the other way round), and
    τ = −Jp I + G J^(−2/3) dev(F Fᵀ). Adiabatic: E grows by all work of the stress, dT = γ₀T dη plus viscous
    heating. Isothermal: heat flows so that T stays at T0, dE = dw − ρ₀c_v γ₀T0 dη.
    """

    analyses: ClassVar[frozenset[str]] = frozenset({"uniaxial_strain", "plane_strain", "axisymmetric", "3d"})
    history: ClassVar[tuple[str, ...]] = ("internal_energy", "temperature", "heat_energy")
    properties: ClassVar[frozenset[str]] = frozenset(
        {"isotropic", "stress_free_at_rest", "equation_of_state"}
    )
    thermal_pressure: ClassVar[str] = (
        "gamma0 gives the pressure of heat (gamma0 = 3*expansion*K/(density*heat_capacity))"
    )

    kind: Literal["mie_gruneisen"]
    K: Annotated[float, Quantity("pressure", gt=0)] | None = None
    """Bulk modulus at rest; or give C0."""
    C0: Annotated[float, Quantity("velocity", gt=0)] | None = None
    """Bulk wave speed at rest, K = ρ₀C0²; or give K."""
    G: Annotated[float, Quantity("pressure", ge=0)] = 0.0
    """Shear modulus."""
    S1: Annotated[float, Quantity("1")] = 0.0
    """Slope of shock speed against particle speed."""
    S2: Annotated[float, Quantity("1")] = 0.0
    """Second coefficient of the Hugoniot curve."""
    S3: Annotated[float, Quantity("1")] = 0.0
    """Third coefficient of the Hugoniot curve."""
    gamma0: Annotated[float, Quantity("1", ge=0)] = 0.0
    """Grüneisen parameter at rest; γρ stays constant."""
    heat_capacity: HeatCapacity
    """Heat capacity per mass at constant volume, c_v."""

    @model_validator(mode="after")
    def _one_modulus(self) -> Self:
        if (self.K is None) == (self.C0 is None):
            raise ValueError("give exactly one of K (bulk modulus) and C0 (bulk wave speed)")
        return self

    @property
    def bulk_modulus(self) -> float:
        """K at rest [pressure]."""
        if self.C0 is not None:
            return self.density * self.C0**2
        return self.K  # type: ignore[return-value]

    def parameters(self, analysis: str, adiabatic: bool) -> EquationOfState:
        """The numbers of the equation of state."""
        return EquationOfState(
            bulk=self.bulk_modulus,
            shear=self.G,
            s1=self.S1,
            s2=self.S2,
            s3=self.S3,
            gamma0=self.gamma0,
            density=self.density,
            capacity=self.density * self.heat_capacity,
            T0=self.T0,
            adiabatic=float(adiabatic),
        )

    def initial_wave_speed(self, analysis: str) -> float:
        """√((K + 4G/3)/ρ) [velocity]."""
        return math.sqrt((self.bulk_modulus + 4 * self.G / 3) / self.density)


@with_defaults
class EquationOfState(NamedTuple):
    """Numbers of a Mie–Grüneisen solid: moduli [pressure], ``capacity`` ρ₀c_v [pressure/temperature]."""

    bulk: float
    shear: float
    s1: float
    s2: float
    s3: float
    gamma0: float
    density: float
    capacity: float
    T0: float
    adiabatic: float
    """1 if heat stays where it arises, 0 if the temperature is held."""


@inline
def cold_pressure(m: Any, eta: float) -> float:
    """Pressure at E = 0; the denominator is kept above 0.05, far beyond every real Hugoniot curve."""
    if eta <= 0.0:
        return m.bulk * eta
    d = max(0.05, 1.0 - eta * (m.s1 + eta * (m.s2 + eta * m.s3)))
    return m.bulk * eta * (1.0 - 0.5 * m.gamma0 * eta) / (d * d)


@inline
def cold_slope(m: Any, eta: float) -> float:
    """Derivative of ``cold_pressure``."""
    if eta <= 0.0:
        return m.bulk
    d = max(0.05, 1.0 - eta * (m.s1 + eta * (m.s2 + eta * m.s3)))
    slope = m.s1 + eta * (2.0 * m.s2 + 3.0 * eta * m.s3)
    return m.bulk * (1.0 - m.gamma0 * eta + 2.0 * slope * eta * (1.0 - 0.5 * m.gamma0 * eta) / d) / (d * d)


needs_increment.register(EquationOfState)(yes)


@kirchhoff_stress.register(EquationOfState)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    J = determinant(F)
    eta = 1.0 - J
    start = J / determinant(dF)
    step = start - J
    # the work of the mean pressure of this step belongs to E already: linear in E, so solved in closed form
    E = H[ENERGY, p]
    cold = cold_pressure(m, eta)
    old = cold_pressure(m, 1.0 - start) + m.gamma0 * E
    heat = (m.adiabatic - 1.0) * m.capacity * m.gamma0 * H[TEMPERATURE, p] * step
    E = (E + 0.5 * (old + cold) * step + heat) / (1.0 - 0.5 * m.gamma0 * step)
    mean = -J * (cold + m.gamma0 * E)
    s = isochoric_stress(m.shear, F, J)
    return mean + s[0], mean + s[1], mean + s[2], s[3], s[4], s[5]


@absorb_work.register(EquationOfState)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
    J = determinant(F)
    step = J / determinant(dF) - J
    if m.adiabatic > 0.0:
        E = H[ENERGY, p] + work
        T = H[TEMPERATURE, p] * exponential_1d(m.gamma0 * step) + viscous / m.capacity
    else:
        T = H[TEMPERATURE, p]
        E = H[ENERGY, p] + work - viscous - m.capacity * m.gamma0 * T * step
    H[ENERGY, p] = E
    H[TEMPERATURE, p] = T
    H[HEAT, p] = m.capacity * (T - m.T0 * exponential_1d(m.gamma0 * (1.0 - J)))


@absorb_heat.register(EquationOfState)
def _(m: Any, H: Any, p: Any, dT: Any) -> Any:
    H[ENERGY, p] += m.capacity * dT


@isentropic_growth.register(EquationOfState)
def _(m: Any, F: Any, dF: Any) -> Any:
    J = determinant(F)
    return m.gamma0 * (J / determinant(dF) - J)


@strain_energy.register(EquationOfState)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    # what is left of E without the heat that raised T above the isentrope through the initial state
    return H[ENERGY, p] - m.capacity * (
        H[TEMPERATURE, p] - m.T0 * exponential_1d(m.gamma0 * (1.0 - determinant(F)))
    )


@bulk_speed_squared.register(EquationOfState)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    # ρ₀c² = J² dp/dη at constant entropy
    J = determinant(F)
    slope = cold_slope(m, 1.0 - J) + m.gamma0 * (cold_pressure(m, 1.0 - J) + m.gamma0 * H[ENERGY, p])
    return max(0.0, J * J * slope / m.density)


@wave_speed_squared.register(EquationOfState)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    J = determinant(F)
    slope = cold_slope(m, 1.0 - J) + m.gamma0 * (cold_pressure(m, 1.0 - J) + m.gamma0 * H[ENERGY, p])
    stiffness = J * J * slope + isochoric_stiffness(m.shear, F, J)
    return max(m.bulk + 4.0 / 3.0 * m.shear, stiffness) / m.density
