"""Orthotropic elasticity for large rotation, and what all elastic materials with axes share."""

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
from pydantic import model_validator

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.materials.anisotropic import (
    Stiffness,
    bulk_slope_of,
    energy_of,
    extension_of,
    in_plane,
    in_space,
    stiffness_of,
    strain_of,
    stress_of,
    wave_modulus,
)
from mpmcli.materials.axes import QUATERNION, rotation_matrix, turn_in_plane, turn_in_space
from mpmcli.materials.base import (
    MATERIALS,
    MaterialModel,
    bulk_slope,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults
from mpmcli.materials.lateral import thickness_stretch
from mpmcli.materials.own_numbers import with_own_numbers

Array = np.ndarray
STIFFER = len(QUATERNION)
"""Row of the history with what ρ₀c² of the fastest wave exceeds that at rest by [pressure]: found with the stress."""

PoissonRatio = Annotated[float, Quantity("1", gt=-10, lt=10)]


class AnisotropicModel(MaterialModel):
    """Base of materials with axes; its ``stiffness`` is that in material axes."""

    analyses: ClassVar[frozenset[str]] = frozenset(ANALYSES) - {"uniaxial_stress"}
    has_axes: ClassVar[bool] = True

    @property
    def stiffness(self) -> Stiffness:
        """ℂ in material axes [pressure]."""
        raise TypeError(f"{type(self).__name__} gives no stiffness")

    def initial_wave_speed(self, analysis: str) -> float:
        """√(max n·ℂ·n/ρ) of all directions of propagation, in plane stress of the reduced stiffness [velocity]."""
        return math.sqrt(wave_modulus(self.stiffness, analysis) / self.density)


class ElasticWithAxes(AnisotropicModel):
    """Base of elastic materials with axes."""

    history: ClassVar[tuple[str, ...]] = (*QUATERNION, "stiffening")
    properties: ClassVar[frozenset[str]] = frozenset({"hyperelastic", "stress_free_at_rest"})

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Stiffness, density, and ρc² at rest of the fastest wave."""
        kind = OrthotropicSolid if analysis == "3d" else OrthotropicPlanar
        return kind(*self.stiffness, self.density, wave_modulus(self.stiffness, analysis))

    def initial_history(self) -> dict[str, float]:
        """Axes along those of the grid."""
        return {QUATERNION[0]: 1.0}

    def turned_history(self, q: Array) -> dict[str, Array]:
        """Start values for axes with the unit quaternions (4, n)."""
        return dict(zip(QUATERNION, q, strict=True))

    def carried_axis(self, H: Array, F: Array) -> Array:
        """Material axis 1 (3, n), stretched and turned with the deformation gradient (9, n)."""
        R = rotation_matrix(H[: len(QUATERNION)])
        return np.einsum("ijn,jn->in", F.reshape(3, 3, -1), R.reshape(3, 3, -1)[:, 0])


class OrthotropicConstants(AnisotropicModel):
    """Base of materials with nine elastic constants."""

    E1: PositivePressure
    """Young's modulus along material axis 1."""
    E2: PositivePressure
    """Young's modulus along material axis 2."""
    E3: PositivePressure
    """Young's modulus along material axis 3."""
    G12: PositivePressure
    """Shear modulus in the plane of axes 1 and 2."""
    G13: PositivePressure
    """Shear modulus in the plane of axes 1 and 3."""
    G23: PositivePressure
    """Shear modulus in the plane of axes 2 and 3."""
    nu12: PoissonRatio
    """Poisson's ratio ν₁₂: contraction along 2 over extension along 1, of tension along 1 (ν₁₂/E₁ = ν₂₁/E₂)."""
    nu13: PoissonRatio
    """Poisson's ratio ν₁₃: contraction along 3 over extension along 1, of tension along 1."""
    nu23: PoissonRatio
    """Poisson's ratio ν₂₃: contraction along 3 over extension along 2, of tension along 2."""

    @model_validator(mode="after")
    def _is_stable(self) -> Self:
        for name, E, other, of, to in (
            ("nu12", self.E1, self.E2, "E1", "E2"),
            ("nu13", self.E1, self.E3, "E1", "E3"),
            ("nu23", self.E2, self.E3, "E2", "E3"),
        ):
            nu, limit = getattr(self, name), math.sqrt(E / other)
            if abs(nu) >= limit:
                raise ValueError(
                    f"a negative energy would be stored: {name} = {nu:g} must lie between ±√({of}/{to}) = ±{limit:.4g}"
                )
        nu21, nu31 = self.nu12 * self.E2 / self.E1, self.nu13 * self.E3 / self.E1
        nu32 = self.nu23 * self.E3 / self.E2
        pairs = self.nu12 * nu21 + self.nu23 * nu32 + self.nu13 * nu31
        rest = 1.0 - pairs - 2.0 * nu21 * nu32 * self.nu13
        if rest <= 0.0:
            raise ValueError(
                "a negative energy would be stored: 1 - nu12*nu21 - nu23*nu32 - nu13*nu31 - 2*nu21*nu32*nu13 "
                f"= {rest:.4g} must be positive, with nu21 = {nu21:.4g}, nu31 = {nu31:.4g} and nu32 = {nu32:.4g}; "
                "decrease the Poisson's ratios"
            )
        return self

    @property
    def stiffness(self) -> Stiffness:
        """ℂ in material axes [pressure]."""
        c12, c13, c23 = -self.nu12 / self.E1, -self.nu13 / self.E1, -self.nu23 / self.E2
        compliance = [[1 / self.E1, c12, c13], [c12, 1 / self.E2, c23], [c13, c23, 1 / self.E3]]
        return stiffness_of(np.array(compliance), (self.G12, self.G23, self.G13))


@MATERIALS.register
class Orthotropic(OrthotropicConstants, ElasticWithAxes):
    """Orthotropic elastic: three planes of symmetry, for large rotation and small to moderate strain.

    W = ½E:ℂ:E with E = ¼(C − C⁻¹), C = FᵀF in material axes: the logarithmic strain to second order (Bažant 1998).
    `axes` of the body turn the material axes; without them axes 1, 2 and 3 are x, y and z.
    """

    kind: Literal["orthotropic"]


@with_own_numbers
@in_space
@with_defaults
class OrthotropicSolid(NamedTuple):
    """Numbers of an elastic material with axes in space."""

    C11: float
    C22: float
    C33: float
    C12: float
    C13: float
    C23: float
    G12: float
    G23: float
    G13: float
    density: float
    wave: float
    """ρc² of the fastest wave at rest [pressure]."""


@with_own_numbers
@in_plane
@with_defaults
class OrthotropicPlanar(NamedTuple):
    """The same of particles that deform in the plane, where the axes turn about z."""

    C11: float
    C22: float
    C33: float
    C12: float
    C13: float
    C23: float
    G12: float
    G23: float
    G13: float
    density: float
    wave: float


@generic
def to_axes(m: Any, F: Any, H: Any, p: Any) -> Any:
    """F·R: what carries the material axes."""


@to_axes.register(OrthotropicSolid)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return turn_in_space(F, H[0, p], H[1, p], H[2, p], H[3, p])


@to_axes.register(OrthotropicPlanar)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return turn_in_plane(F, H[0, p], H[3, p])


@thickness_stretch.register(OrthotropicPlanar)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    # T_33 = 0; the strains in the plane do not depend on the thickness
    E = strain_of(m, to_axes(m, F, H, p))
    return extension_of(-(m.C13 * E[0] + m.C23 * E[1]) / m.C33)


for _numbers in (OrthotropicSolid, OrthotropicPlanar):

    @kirchhoff_stress.register(_numbers)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        tau, stiffer = stress_of(m, to_axes(m, F, H, p))
        if commit:
            H[STIFFER, p] = stiffer
        return tau

    @strain_energy.register(_numbers)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return energy_of(m, to_axes(m, F, H, p))

    @wave_speed_squared.register(_numbers)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return (m.wave + H[STIFFER, p]) / m.density

    @bulk_slope.register(_numbers)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return bulk_slope_of(m, to_axes(m, F, H, p)) / m.density

    @bulk_speed_squared.register(_numbers)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return max(0.0, bulk_slope_of(m, to_axes(m, F, H, p)) / m.density)
