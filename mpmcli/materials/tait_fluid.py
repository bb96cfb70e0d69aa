"""Tait fluid: a nearly incompressible liquid, with viscosity if asked."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential, logarithm_1p
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.core.rows import sqrt
from mpmcli.core.tensors import determinant, multiply
from mpmcli.materials.base import (
    MATERIALS,
    MaterialModel,
    bulk_speed_squared,
    dissipated_heat,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults, yes
from mpmcli.materials.own_numbers import with_own_numbers


class TaitModel(MaterialModel):
    """Base of liquids with Tait's pressure p = (K/n)(J^(−n) − 1) and a viscosity."""

    analyses: ClassVar[frozenset[str]] = frozenset({"uniaxial_strain", "plane_strain", "axisymmetric", "3d"})

    K: PositivePressure
    """Bulk modulus at rest."""
    exponent: Annotated[float, Quantity("1", gt=1)] = 7.0
    """n, slope of the bulk modulus against pressure; 7 for water."""
    viscosity: Annotated[float, Quantity("viscosity", ge=0)] = 0.0
    """Dynamic viscosity μ."""
    tension_limit: Annotated[float, Quantity("pressure", ge=0)] | None = None
    """Largest tension, so that the pressure is never less than its negative; 0 for liquids with a free surface."""

    def tait(self) -> Tait:
        """Modulus, exponent, viscosity, density; the largest tension and the J at which it is reached."""
        utmost = self.K / self.exponent  # which p = (K/n)(J^(-n) - 1) never passes
        limit = utmost if self.tension_limit is None else min(self.tension_limit, utmost)
        largest_J = (1.0 - limit / utmost) ** (-1.0 / self.exponent) if limit < utmost else math.inf
        numbers = (self.K, self.exponent, self.viscosity, self.density, limit, min(largest_J, 1e300))
        return Tait(*numbers)


@MATERIALS.register
class TaitFluid(TaitModel):
    """Tait (Murnaghan) fluid: p = (K/n)(J^(−n) − 1), σ = −p I + 2μ dev D, D the rate of deformation.

    Stored energy per initial volume: (K/n)(J^(1−n)/(n − 1) + J − n/(n − 1)). With ``tension_limit`` T, p is
    at least −T: beyond the J_T where p = −T the pressure stays there, and the energy grows by T(J − J_T).
    """

    properties: ClassVar[frozenset[str]] = frozenset(
        {"hyperelastic", "isotropic", "stress_free_at_rest", "fluid"}
    )

    kind: Literal["tait_fluid"]

    def parameters(self, analysis: str, adiabatic: bool) -> Tait:
        """The numbers of the pressure and the viscosity."""
        return self.tait()

    def initial_wave_speed(self, analysis: str) -> float:
        """√(K/ρ) [velocity]."""
        return sqrt(self.K / self.density)

    def explicit_viscosity(self) -> float:
        """μ [viscosity]."""
        return self.viscosity


@with_defaults
class Tait(NamedTuple):
    """Numbers of a Tait fluid."""

    bulk: float
    exponent: float
    viscosity: float
    density: float
    tension: float
    """Largest tension [pressure]."""
    tension_J: float
    """J at which it is reached."""


needs_increment.register(Tait)(yes)
with_own_numbers(Tait)


@inline
def tait_power(m: Any, J: float) -> float:
    """J^(1−n)."""
    return J * exponential(-m.exponent * logarithm_1p(J - 1.0))


@inline
def tait_mean(m: Any, J: float) -> float:
    """Mean Kirchhoff stress −Jp [pressure]."""
    mean = -m.bulk / m.exponent * (tait_power(m, J) - J)
    return min(mean, m.tension * J)


@inline
def tait_energy(m: Any, J: float) -> float:
    """Stored energy per initial volume [pressure]."""
    n, bounded = m.exponent, min(J, m.tension_J)
    elastic = tait_power(m, bounded) / (n - 1.0) + bounded - n / (n - 1.0)
    return m.bulk / n * elastic + m.tension * (J - bounded)


@inline
def deviator_of_rate(dF: Any) -> Any:
    """dev D Δt, with engineering shear strains: xx, yy, zz, 2xy, 2yz, 2xz."""
    # D Δt is the symmetric part of ln dF = E - E²/2 + …, E = dF - I
    E = (dF[0] - 1.0, dF[1], dF[2], dF[3], dF[4] - 1.0, dF[5], dF[6], dF[7], dF[8] - 1.0)
    S = multiply(E, E)
    xx, yy, zz = E[0] - 0.5 * S[0], E[4] - 0.5 * S[4], E[8] - 0.5 * S[8]
    third = (xx + yy + zz) / 3.0
    xy = E[1] + E[3] - 0.5 * (S[1] + S[3])
    yz = E[5] + E[7] - 0.5 * (S[5] + S[7])
    xz = E[2] + E[6] - 0.5 * (S[2] + S[6])
    return xx - third, yy - third, zz - third, xy, yz, xz


@kirchhoff_stress.register(Tait)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    J = determinant(F)
    mean = tait_mean(m, J)
    if m.viscosity == 0.0 or dt == 0.0:
        return mean, mean, mean, 0.0, 0.0, 0.0
    xx, yy, zz, xy, yz, xz = deviator_of_rate(dF)
    g = 2.0 * m.viscosity * J / dt
    return mean + g * xx, mean + g * yy, mean + g * zz, 0.5 * g * xy, 0.5 * g * yz, 0.5 * g * xz


@strain_energy.register(Tait)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return tait_energy(m, determinant(F))


@dissipated_heat.register(Tait)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    if m.viscosity == 0.0 or dt == 0.0:
        return 0.0
    xx, yy, zz, xy, yz, xz = deviator_of_rate(dF)
    squares = xx * xx + yy * yy + zz * zz + 0.5 * (xy * xy + yz * yz + xz * xz)
    return 2.0 * m.viscosity * determinant(F) * squares / abs(dt)


@bulk_speed_squared.register(Tait)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return m.bulk * tait_power(m, determinant(F)) / m.density


@wave_speed_squared.register(Tait)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return max(1.0, tait_power(m, determinant(F))) * m.bulk / m.density
