"""Compressible Mooney–Rivlin rubber: energies of both isochoric invariants, and one of the volume."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential_1d, logarithm
from mpmcli.core.model import Quantity
from mpmcli.core.rows import sqrt
from mpmcli.core.tensors import (
    Symmetric,
    determinant,
    largest_eigenvalue_bound,
    left_cauchy_green,
    smallest_eigenvalue_bound,
)
from mpmcli.materials.base import (
    MATERIALS,
    MaterialModel,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults
from mpmcli.materials.elastic_constants import lateral_factor, wave_modulus
from mpmcli.materials.isochoric import FREE_WIDTHS, growth_of_thin, isochoric_lateral_stress
from mpmcli.materials.lateral import lateral_stress, shared_by_trials
from mpmcli.materials.own_numbers import with_own_numbers
from mpmcli.materials.volumetric import FORMS, volumetric_energy, volumetric_stiffness, volumetric_stress


@MATERIALS.register
class MooneyRivlin(MaterialModel):
    """Mooney–Rivlin hyperelasticity [mooney1940, rivlin1951].

    With b̄ = J^(−2/3) F Fᵀ the energy per initial volume and the Kirchhoff stress are

    W = U(J) + ½G1(tr b̄ − 3) + ½G2(tr b̄⁻¹ − 3), τ = J U' I + G1 dev b̄ − G2 dev b̄⁻¹.

    The shear modulus at rest is G1 + G2. U has the modulus K and one of the forms of ``neo_hookean``.
    """

    analyses: ClassVar[frozenset[str]] = frozenset(ANALYSES)
    properties: ClassVar[frozenset[str]] = frozenset({"hyperelastic", "isotropic", "stress_free_at_rest"})

    kind: Literal["mooney_rivlin"]
    G1: Annotated[float, Quantity("pressure", gt=0)]
    """Modulus of the first invariant, twice the constant C10."""
    G2: Annotated[float, Quantity("pressure", ge=0)] = 0.0
    """Modulus of the second invariant, twice the constant C01."""
    K: Annotated[float, Quantity("pressure", gt=0)]
    """Bulk modulus."""
    volumetric: Literal["j_minus_inverse", "log"] = "j_minus_inverse"
    """Energy of a change of volume."""

    @property
    def shear_modulus(self) -> float:
        """G at rest [pressure]."""
        return self.G1 + self.G2

    @property
    def bulk_modulus(self) -> float:
        """K [pressure]."""
        return self.K

    def parameters(self, analysis: str, adiabatic: bool) -> RubberNumbers:
        """Moduli, density, and the square of the wave speed at rest."""
        return RubberNumbers(
            form=FORMS[self.volumetric],
            bulk=self.K,
            G1=self.G1,
            G2=self.G2,
            density=self.density,
            rest2=self.initial_wave_speed(analysis) ** 2,
            lateral=lateral_factor(self._lame, self.shear_modulus, analysis),
            free=FREE_WIDTHS.get(analysis, 0.0),
        )

    def initial_wave_speed(self, analysis: str) -> float:
        """That of isotropic elasticity with K and G = G1 + G2 [velocity]."""
        return sqrt(wave_modulus(self._lame, self.shear_modulus, analysis) / self.density)

    @property
    def _lame(self) -> float:
        return self.K - 2 * self.shear_modulus / 3


@with_own_numbers
@with_defaults
class RubberNumbers(NamedTuple):
    """Numbers of a Mooney–Rivlin material."""

    form: int
    """Volumetric form (``volumetric.FORMS``)."""
    bulk: float
    G1: float
    G2: float
    density: float
    rest2: float
    """Square of the wave speed at rest [velocity²]."""
    lateral: float
    """Wave stiffness of the analysis over that of uniaxial strain."""
    free: float
    """Number of free widths: 1 of sheets, 2 of bars."""


@inline
def isochoric_tensors(F: Any, J: float) -> tuple[Symmetric, Symmetric]:
    """b̄ = J^(−2/3) F Fᵀ and its inverse, whose determinants are 1."""
    b = left_cauchy_green(F)
    s = exponential_1d(-2.0 / 3.0 * logarithm(J))
    xx, yy, zz, xy, yz, xz = s * b[0], s * b[1], s * b[2], s * b[3], s * b[4], s * b[5]
    inverse = (
        yy * zz - yz * yz,
        xx * zz - xz * xz,
        xx * yy - xy * xy,
        xz * yz - xy * zz,
        xy * xz - xx * yz,
        xy * yz - xz * yy,
    )
    return (xx, yy, zz, xy, yz, xz), inverse


@kirchhoff_stress.register(RubberNumbers)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    J = determinant(F)
    b, c = isochoric_tensors(F, J)
    G1, G2 = m.G1, m.G2
    mean = volumetric_stress(m.form, m.bulk, J)
    mean -= (G1 * (b[0] + b[1] + b[2]) - G2 * (c[0] + c[1] + c[2])) / 3.0
    return (
        mean + G1 * b[0] - G2 * c[0],
        mean + G1 * b[1] - G2 * c[1],
        mean + G1 * b[2] - G2 * c[2],
        G1 * b[3] - G2 * c[3],
        G1 * b[4] - G2 * c[4],
        G1 * b[5] - G2 * c[5],
    )


@shared_by_trials.register(RubberNumbers)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    J = determinant(F)
    b, c = isochoric_tensors(F, J)
    return J, (m.G1 * b[0], m.G1 * b[1], m.G1 * b[2]), (m.G2 * c[0], m.G2 * c[1], m.G2 * c[2])


@lateral_stress.register(RubberNumbers)
def _(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
    J, b, c = shared
    return isochoric_lateral_stress(m.form, m.bulk, J, b, c, 0.0, 0.0, x, both)


@strain_energy.register(RubberNumbers)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    J = determinant(F)
    b, c = isochoric_tensors(F, J)
    shape = m.G1 * (b[0] + b[1] + b[2] - 3.0) + m.G2 * (c[0] + c[1] + c[2] - 3.0)
    return volumetric_energy(m.form, m.bulk, J) + 0.5 * shape


@wave_speed_squared.register(RubberNumbers)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    # principal axis i: ∂τᵢ/∂(ln λᵢ) - τᵢ; the smallest λ has the largest of both parts
    J = determinant(F)
    b, c = isochoric_tensors(F, J)
    first = 5.0 / 9.0 * (b[0] + b[1] + b[2]) - max(0.0, smallest_eigenvalue_bound(b)) / 3.0
    second = 5.0 / 3.0 * largest_eigenvalue_bound(c) - (c[0] + c[1] + c[2]) / 9.0
    stiffness = volumetric_stiffness(m.form, m.bulk, J) + m.G1 * first + m.G2 * second
    # W = ½G₂ tr b⁻¹ has ρ₀c² = G₂(3 λᵢ⁻² + λ_z⁻²) along axis i of a sheet and 3 G₂ λ_x⁻² in a bar
    grown = m.G1 * growth_of_thin(m.free, b, 1.0, 4.0 - m.free)
    grown += m.G2 * growth_of_thin(m.free, c, 3.0, 2.0 - m.free)
    return max(m.rest2, m.lateral * stiffness / m.density, m.rest2 + grown / m.density)


@bulk_speed_squared.register(RubberNumbers)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return max(0.0, volumetric_stiffness(m.form, m.bulk, determinant(F)) / m.density)
