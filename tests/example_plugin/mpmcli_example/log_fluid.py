"""Logarithmic fluid: no shear stress, pressure linear in the logarithm of the volume."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal, NamedTuple

from mpmcli.core.exponentials import logarithm
from mpmcli.core.model import PositivePressure
from mpmcli.core.tensors import determinant
from mpmcli.materials.base import (
    MATERIALS,
    MaterialModel,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults


@MATERIALS.register
class LogFluid(MaterialModel):
    """Logarithmic fluid: τ = K ln J I, W = ½K ln²J."""

    analyses: ClassVar[frozenset[str]] = frozenset({"uniaxial_strain", "plane_strain", "axisymmetric", "3d"})
    properties: ClassVar[frozenset[str]] = frozenset(
        {"hyperelastic", "isotropic", "stress_free_at_rest", "fluid"}
    )

    kind: Literal["log_fluid"]
    K: PositivePressure
    """Bulk modulus."""

    def parameters(self, analysis: str, adiabatic: bool) -> Log:
        """Modulus and density."""
        return Log(self.K, self.density)

    def initial_wave_speed(self, analysis: str) -> float:
        """√(K/ρ) [velocity]."""
        return math.sqrt(self.K / self.density)


@with_defaults
class Log(NamedTuple):
    """Numbers of a logarithmic fluid."""

    bulk: float
    density: float


@kirchhoff_stress.register(Log)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    mean = m.bulk * logarithm(determinant(F))
    return mean, mean, mean, 0.0, 0.0, 0.0


@strain_energy.register(Log)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    log = logarithm(determinant(F))
    return 0.5 * m.bulk * log * log


@wave_speed_squared.register(Log)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    # ρ₀c² = dτ/d(ln J) - τ
    return m.bulk * max(1.0, 1.0 - logarithm(determinant(F))) / m.density


@bulk_speed_squared.register(Log)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return m.bulk * max(0.0, 1.0 - logarithm(determinant(F))) / m.density
