"""Neo-Hookean rubber: four energies, by the volumetric part and by how it is split from the shear part."""

import math
from typing import Any, ClassVar, Literal, NamedTuple

from mpmcli.core.exponentials import exponential_1d, logarithm
from mpmcli.core.tensors import determinant, largest_eigenvalue_bound, left_cauchy_green
from mpmcli.materials.base import (
    MATERIALS,
    bulk_slope,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults
from mpmcli.materials.elastic_constants import ElasticModel, lateral_factor
from mpmcli.materials.isochoric import (
    FREE_WIDTHS,
    growth_of_thin,
    isochoric_energy,
    isochoric_lateral_stress,
    isochoric_stiffness,
    isochoric_stress,
)
from mpmcli.materials.lateral import (
    lateral_stress,
    lateral_stretch,
    search_lateral,
    search_thickness,
    shared_by_trials,
    thickness_stretch,
)
from mpmcli.materials.own_numbers import with_own_numbers
from mpmcli.materials.volumetric import FORMS, volumetric_energy, volumetric_stiffness, volumetric_stress

J_MINUS_INVERSE = FORMS["j_minus_inverse"]


@MATERIALS.register
class NeoHookean(ElasticModel):
    """Neo-Hookean hyperelasticity.

    With b = F Fᵀ and I₁ = tr b, the Kirchhoff stress and the energy per initial volume are

    - ``split: none``: τ = M u' I + G(b − I), W = U + ½G(I₁ − 3 − 2 ln J), where the modulus M of U is λ;
    - ``split: isochoric``: τ = M u' I + G J^(−2/3) dev b, W = U + ½G(I₁ J^(−2/3) − 3), where M is the bulk
      modulus K;

    and the volumetric part is

    - ``volumetric: j_minus_inverse``: U = ½M(½(J² − 1) − ln J), M u' = ½M(J² − 1);
    - ``volumetric: log``: U = ½M ln²J, M u' = M ln J.

    The default is Eq. 14 of Nairn (2026), σ = ½λ(J − 1/J) I + (G/J)(b − I). ``split: isochoric`` gives Eq.
    18 of Nairn, Hammerquist & Smith (2020), ``volumetric: log`` the law P = G(F − F⁻ᵀ) + λ ln J F⁻ᵀ.
    """

    properties: ClassVar[frozenset[str]] = frozenset({"hyperelastic", "isotropic", "stress_free_at_rest"})

    kind: Literal["neo_hookean"]
    volumetric: Literal["j_minus_inverse", "log"] = "j_minus_inverse"
    """Energy of a change of volume."""
    split: Literal["none", "isochoric"] = "none"
    """Whether the shear part depends on the change of volume too (none) or on the shape only (isochoric)."""

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Moduli, density, and the square of the wave speed at rest."""
        isochoric = self.split == "isochoric"
        modulus = self.bulk_modulus if isochoric else self.lame_modulus
        numbers = (
            FORMS[self.volumetric],
            modulus,
            self.shear_modulus,
            self.density,
            self.initial_wave_speed(analysis) ** 2,
            lateral_factor(self.lame_modulus, self.shear_modulus, analysis),
            FREE_WIDTHS.get(analysis, 0.0),
        )
        return IsochoricNeoHookean(*numbers) if isochoric else CoupledNeoHookean(*numbers)


@with_own_numbers
@with_defaults
class CoupledNeoHookean(NamedTuple):
    """Numbers of a neo-Hookean material, ``split: none``."""

    form: int
    """Volumetric form (``volumetric.FORMS``)."""
    modulus: float
    """λ [pressure]."""
    shear: float
    """G [pressure]."""
    density: float
    rest2: float
    """Square of the wave speed at rest [velocity²]."""
    lateral: float
    """Wave stiffness of the analysis over that of uniaxial strain."""
    free: float
    """Number of free widths: 1 of sheets, 2 of bars."""


@with_own_numbers
@with_defaults
class IsochoricNeoHookean(NamedTuple):
    """Numbers of a neo-Hookean material, ``split: isochoric``; as above, the volumetric modulus is K."""

    form: int
    modulus: float
    shear: float
    density: float
    rest2: float
    lateral: float
    free: float


@kirchhoff_stress.register(CoupledNeoHookean)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    b = left_cauchy_green(F)
    G = m.shear
    c = volumetric_stress(m.form, m.modulus, determinant(F)) - G
    return c + G * b[0], c + G * b[1], c + G * b[2], G * b[3], G * b[4], G * b[5]


@thickness_stretch.register(CoupledNeoHookean)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    if m.form != J_MINUS_INVERSE:
        return search_thickness(m, F, dF, H, p, dt)
    # ½λ(a²z² - 1) + G(z² - 1) = 0 with the stretch a of the area
    area = F[0] * F[4] - F[1] * F[3]
    half = 0.5 * m.modulus
    return math.sqrt((half + m.shear) / (half * area * area + m.shear))


@lateral_stretch.register(CoupledNeoHookean)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    if m.form != J_MINUS_INVERSE:
        return search_lateral(m, F, dF, H, p, dt)
    # ½λ(F_xx²w² - 1) + G(w - 1) = 0 with w = z²; this form of the root holds for λ = 0 too
    a, c = 0.5 * m.modulus * F[0] * F[0], 0.5 * m.modulus + m.shear
    return math.sqrt(2.0 * c / (m.shear + math.sqrt(m.shear * m.shear + 4.0 * a * c)))


@strain_energy.register(CoupledNeoHookean)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    b = left_cauchy_green(F)
    J = determinant(F)
    return volumetric_energy(m.form, m.modulus, J) + 0.5 * m.shear * (
        b[0] + b[1] + b[2] - 3.0 - 2.0 * logarithm(J)
    )


@wave_speed_squared.register(CoupledNeoHookean)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    # principal axis i: ρ₀ c² = ∂τᵢ/∂(ln λᵢ) - τᵢ = volumetric + G(λᵢ² + 1)
    b = left_cauchy_green(F)
    shear = m.shear * (largest_eigenvalue_bound(b) + 1.0)
    stiffness = volumetric_stiffness(m.form, m.modulus, determinant(F)) + shear
    grown = m.shear * growth_of_thin(m.free, b, 1.0, 4.0 - m.free)
    return max(m.rest2, m.lateral * stiffness / m.density, m.rest2 + grown / m.density)


@bulk_speed_squared.register(CoupledNeoHookean)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    b = left_cauchy_green(F)
    shear = m.shear * (1.0 - (b[0] + b[1] + b[2]) / 9.0)
    return max(0.0, (volumetric_stiffness(m.form, m.modulus, determinant(F)) + shear) / m.density)


@bulk_slope.register(CoupledNeoHookean)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    # without a tensor of its own, so that the loop over particles vectorises
    trace = F[0] * F[0] + F[1] * F[1] + F[2] * F[2] + F[3] * F[3] + F[4] * F[4] + F[5] * F[5]
    trace += F[6] * F[6] + F[7] * F[7] + F[8] * F[8]
    shear = m.shear * (1.0 - trace / 9.0)
    return (volumetric_stiffness(m.form, m.modulus, determinant(F)) + shear) / m.density


@kirchhoff_stress.register(IsochoricNeoHookean)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    J = determinant(F)
    s = isochoric_stress(m.shear, F, J)
    mean = volumetric_stress(m.form, m.modulus, J)
    return mean + s[0], mean + s[1], mean + s[2], s[3], s[4], s[5]


@shared_by_trials.register(IsochoricNeoHookean)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    b, J = left_cauchy_green(F), determinant(F)
    g = m.shear * exponential_1d(-2.0 / 3.0 * logarithm(J))
    return J, (g * b[0], g * b[1], g * b[2])


@lateral_stress.register(IsochoricNeoHookean)
def _(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
    J, b = shared
    return isochoric_lateral_stress(m.form, m.modulus, J, b, (0.0, 0.0, 0.0), 0.0, 0.0, x, both)


@strain_energy.register(IsochoricNeoHookean)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    J = determinant(F)
    return volumetric_energy(m.form, m.modulus, J) + isochoric_energy(m.shear, F, J)


@wave_speed_squared.register(IsochoricNeoHookean)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    J = determinant(F)
    stiffness = volumetric_stiffness(m.form, m.modulus, J) + isochoric_stiffness(m.shear, F, J)
    b, s = left_cauchy_green(F), exponential_1d(-2.0 / 3.0 * logarithm(J))
    grown = m.shear * growth_of_thin(m.free, (s * b[0], s * b[1], s * b[2], s * b[3]), 1.0, 4.0 - m.free)
    return max(m.rest2, m.lateral * stiffness / m.density, m.rest2 + grown / m.density)


@bulk_speed_squared.register(IsochoricNeoHookean)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return max(0.0, volumetric_stiffness(m.form, m.modulus, determinant(F)) / m.density)
