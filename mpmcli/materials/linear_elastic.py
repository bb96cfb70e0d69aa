"""Linear elasticity for large rotation: Hencky's law between Kirchhoff stress and logarithmic strain."""

from __future__ import annotations

from typing import Any, ClassVar, Literal, NamedTuple

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential_1d, log_symmetric, logarithm
from mpmcli.core.tensors import (
    determinant,
    inverse_transpose,
    largest_eigenvalue_bound,
    left_cauchy_green,
)
from mpmcli.materials.base import (
    MATERIALS,
    bulk_slope,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults
from mpmcli.materials.elastic_constants import ElasticModel
from mpmcli.materials.lateral import lateral_stretch, thickness_stretch
from mpmcli.materials.own_numbers import with_own_numbers

BELOW = 0.95
"""Wave speed that is taken under compression, over the current one."""


@MATERIALS.register
class LinearElastic(ElasticModel):
    """Linear elastic (Hencky): τ = λ tr(ε) I + 2G ε with ε = ½ ln(F Fᵀ).

    Its energy is W = ½λ tr(ε)² + G ε:ε per initial volume.
    """

    properties: ClassVar[frozenset[str]] = frozenset({"hyperelastic", "isotropic", "stress_free_at_rest"})

    kind: Literal["linear_elastic"]

    def parameters(self, analysis: str, adiabatic: bool) -> Hencky:
        """Lamé's moduli and the squares of the wave speeds."""
        return Hencky(
            lame=self.lame_modulus,
            shear=self.shear_modulus,
            wave2=self.initial_wave_speed(analysis) ** 2,
            bulk2=self.bulk_modulus / self.density,
            density=self.density,
        )


@with_own_numbers
@with_defaults
class Hencky(NamedTuple):
    """Numbers of a linear elastic material: λ, G [pressure], squares of wave and bulk speed at rest [velocity²]."""

    lame: float
    shear: float
    wave2: float
    bulk2: float
    density: float


@kirchhoff_stress.register(Hencky)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    e = log_symmetric(left_cauchy_green(F))
    G = m.shear
    volumetric = 0.5 * m.lame * (e[0] + e[1] + e[2])
    return volumetric + G * e[0], volumetric + G * e[1], volumetric + G * e[2], G * e[3], G * e[4], G * e[5]


@strain_energy.register(Hencky)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    e = log_symmetric(left_cauchy_green(F))
    trace = 0.5 * (e[0] + e[1] + e[2])
    squares = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 2.0 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5])
    return 0.5 * m.lame * trace * trace + 0.25 * m.shear * squares


@inline
def hencky_speed_squared(m: Any, F: Any) -> float:
    """Square of the wave speed: that at rest, or 0.95 of the current one under compression, if larger [velocity²].

    So small strains leave the time step alone; `courant: auto` is as much below its limit. The stiffness is ρ₀c² =
    ∂τᵢ/∂(ln λᵢ) − τᵢ of a principal axis i, of which −ln x ≤ 1/x − 1 spares the logarithms.
    """
    J = determinant(F)
    volumetric = max(m.lame * (1.0 / J - 1.0), m.lame * (1.0 - J))
    inverse = largest_eigenvalue_bound(left_cauchy_green(inverse_transpose(F)))
    stiffer = volumetric + m.shear * (inverse - 1.0)
    return max(m.wave2, BELOW * BELOW * (m.wave2 + stiffer / m.density))


@wave_speed_squared.register(Hencky)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return hencky_speed_squared(m, F)


@bulk_speed_squared.register(Hencky)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return m.bulk2


@bulk_slope.register(Hencky)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return m.bulk2 * (1.0 - logarithm(determinant(F)))


@thickness_stretch.register(Hencky)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    # ε_zz = -ν/(1 - ν) (ε_xx + ε_yy)
    return exponential_1d(-m.lame / (m.lame + 2.0 * m.shear) * logarithm(F[0] * F[4] - F[1] * F[3]))


@lateral_stretch.register(Hencky)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    # ε_yy = ε_zz = -ν ε_xx
    return exponential_1d(-0.5 * m.lame / (m.lame + m.shear) * logarithm(F[0]))
