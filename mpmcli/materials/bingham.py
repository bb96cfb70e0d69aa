"""Bingham fluid: a nearly incompressible liquid that flows only above a yield stress."""

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from mpmcli.core.exponentials import exponential_symmetric
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.core.rows import sqrt
from mpmcli.core.tensors import determinant
from mpmcli.materials.base import (
    MATERIALS,
    bulk_speed_squared,
    dissipated_heat,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.hencky import (
    HISTORY,
    LAST,
    double_contraction,
    elastic_tensor,
    keep_plastic,
    keep_tensor,
    split_strain,
    trial_tensor,
)
from mpmcli.materials.planar import in_space_and_plane
from mpmcli.materials.tait_fluid import Tait, TaitModel, tait_energy, tait_mean, tait_power


@MATERIALS.register
class Bingham(TaitModel):
    """Bingham fluid: √J₂ = τ₀ + μγ̇ where it flows, with the pressure of ``tait_fluid``.

    Below the yield stress τ₀ it is elastic in shear, and does not creep. The shear stress at the end of a step is
    implicit in the rate of plastic shear γ̇, in closed form. Elasticity adds a relaxation time μ/G.
    """

    # not elastic_xx: it holds no strain of volume, which the pressure takes from the deformation gradient
    history: ClassVar[tuple[str, ...]] = tuple(name.replace("elastic", "elastic_shear") for name in HISTORY)
    properties: ClassVar[frozenset[str]] = frozenset({"isotropic", "stress_free_at_rest"})

    kind: Literal["bingham"]
    yield_stress: Annotated[float, Quantity("pressure", ge=0)]
    """Shear stress τ₀ above which the fluid flows."""
    G: PositivePressure | None = None
    """Shear modulus below the yield stress, by default K/10; much larger than the yield stress."""

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """The numbers of the pressure, the shear modulus and the yield stress."""
        return SLURRY[analysis != "3d"](*self.tait(), self.shear_modulus, self.yield_stress)

    @property
    def shear_modulus(self) -> float:
        """G [pressure]."""
        return self.K / 10 if self.G is None else self.G

    def initial_wave_speed(self, analysis: str) -> float:
        """√((K + 4G/3)/ρ) [velocity]."""
        return sqrt((self.K + 4.0 / 3.0 * self.shear_modulus) / self.density)


SLURRY = in_space_and_plane("Slurry", (*Tait._fields, "shear", "yield_stress"), __name__)
"""The parameter tuples in space (False) and in the plane (True)."""


for _Slurry in SLURRY.values():

    @kirchhoff_stress.register(_Slurry)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        J, G = determinant(F), m.shear
        mean = tait_mean(m, J)
        _, e = split_strain(trial_tensor(m, dF, H, p))
        trial = G * math.sqrt(2.0 * double_contraction(e))
        scale, shear = 1.0, trial
        if trial > m.yield_stress * J:
            # shear = Jτ₀ + Jμγ̇ with trial - shear = Gγ̇Δt
            viscous, elastic = m.viscosity * J, G * max(0.0, dt)
            shear = m.yield_stress * J
            if viscous + elastic > 0.0:
                shear = (viscous * trial + elastic * shear) / (viscous + elastic)
            scale = shear / trial
        if commit:
            twice = 2.0 * scale
            keep_tensor(
                m,
                H,
                p,
                exponential_symmetric(
                    (twice * e[0], twice * e[1], twice * e[2], twice * e[3], twice * e[4], twice * e[5])
                ),
            )
            keep_plastic(H, p, (trial - shear) / (math.sqrt(3.0) * G), shear * (trial - shear) / G)
        g = 2.0 * G * scale
        return mean + g * e[0], mean + g * e[1], mean + g * e[2], g * e[3], g * e[4], g * e[5]

    @strain_energy.register(_Slurry)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        _, e = split_strain(elastic_tensor(m, H, p))
        return tait_energy(m, determinant(F)) + m.shear * double_contraction(e)

    @dissipated_heat.register(_Slurry)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        return H[LAST, p]

    @bulk_speed_squared.register(_Slurry)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return m.bulk * tait_power(m, determinant(F)) / m.density

    @wave_speed_squared.register(_Slurry)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        stiffer = max(1.0, tait_power(m, determinant(F)))
        return (stiffer * m.bulk + 4.0 / 3.0 * m.shear) / m.density
