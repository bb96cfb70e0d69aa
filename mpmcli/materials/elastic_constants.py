"""Isotropic elastic constants, given as one pair, and the wave speeds that follow from them."""

from typing import Annotated, Any, ClassVar, Self

from pydantic import model_validator

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.model import Quantity
from mpmcli.core.rows import sqrt
from mpmcli.materials.base import MaterialModel


class ElasticModel(MaterialModel):
    """Base of materials that start isotropic and elastic, by one pair of constants: E and nu, or K and G."""

    analyses: ClassVar[frozenset[str]] = frozenset(ANALYSES)

    E: Annotated[float, Quantity("pressure", gt=0)] | None = None
    """Young's modulus; needs nu."""
    nu: Annotated[float, Quantity("1", gt=-1, lt=0.5)] | None = None
    """Poisson's ratio; needs E."""
    K: Annotated[float, Quantity("pressure", gt=0)] | None = None
    """Bulk modulus; needs G."""
    G: Annotated[float, Quantity("pressure", gt=0)] | None = None
    """Shear modulus; needs K."""

    @model_validator(mode="after")
    def _one_pair(self) -> Self:
        given = {name for name in ("E", "nu", "K", "G") if getattr(self, name) is not None}
        if given not in ({"E", "nu"}, {"K", "G"}):
            found = " and ".join(sorted(given)) or "none of them"
            raise ValueError(f"give one pair of elastic constants, E and nu or K and G; given: {found}")
        return self

    @property
    def shear_modulus(self) -> float:
        """G [pressure]."""
        if self.G is not None:
            return self.G
        E, nu = self._young_and_poisson()
        return E / (2 * (1 + nu))

    @property
    def bulk_modulus(self) -> float:
        """K [pressure]."""
        if self.K is not None:
            return self.K
        E, nu = self._young_and_poisson()
        return E / (3 * (1 - 2 * nu))

    @property
    def lame_modulus(self) -> float:
        """λ = K − 2G/3 [pressure]; exactly zero for ν = 0."""
        if self.K is not None:
            return self.K - 2 * self.shear_modulus / 3
        E, nu = self._young_and_poisson()
        return E * nu / ((1 + nu) * (1 - 2 * nu))

    def _young_and_poisson(self) -> tuple[float, float]:
        if self.E is None or self.nu is None:
            raise TypeError("E and nu are not the pair that was given")
        return self.E, self.nu

    def elastic_numbers(self, analysis: str) -> dict[str, Any]:
        """K, G, the density, and the wave stiffness of the analysis over that of uniaxial strain, by name."""
        lateral = lateral_factor(self.lame_modulus, self.shear_modulus, analysis)
        moduli = {"bulk": self.bulk_modulus, "shear": self.shear_modulus}
        return moduli | {"density": self.density, "lateral": lateral}

    def initial_wave_speed(self, analysis: str) -> float:
        """√((K+4G/3)/ρ); √(E/(ρ(1−ν²))) in plane stress; √(E/ρ) in uniaxial stress [velocity]."""
        return sqrt(wave_modulus(self.lame_modulus, self.shear_modulus, analysis) / self.density)


def wave_modulus(lame: float, shear: float, analysis: str) -> float:
    """Stiffness of the fastest wave at rest [pressure], by the lateral condition of the analysis."""
    longitudinal = lame + 2 * shear
    if analysis == "plane_stress":
        return longitudinal - lame**2 / longitudinal
    if analysis == "uniaxial_stress":
        return shear * (3 * lame + 2 * shear) / (lame + shear)
    return longitudinal


def lateral_factor(lame: float, shear: float, analysis: str) -> float:
    """Wave stiffness of the analysis over that of uniaxial strain."""
    return wave_modulus(lame, shear, analysis) / (lame + 2 * shear)
