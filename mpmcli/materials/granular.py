"""Dry granular flow by the μ(I) rheology, which separates freely."""

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.core.model import Density, Quantity
from mpmcli.core.rows import log, sqrt
from mpmcli.materials.base import MATERIALS, bulk_speed_squared, kirchhoff_stress, wave_speed_squared
from mpmcli.materials.elastic_constants import ElasticModel
from mpmcli.materials.hencky import (
    HISTORY,
    LAST,
    double_contraction,
    elastic_volume,
    hencky_plastic,
    hencky_stiffness,
    keep_plastic,
    keep_tensor,
    split_strain,
    tensor_of_strain,
    trial_tensor,
)

OPENING = len(HISTORY)
"""Row of the logarithmic strain of volume by which grains are apart."""


@MATERIALS.register
class Granular(ElasticModel):
    """Grains with friction μ(I) = μ_s + (μ_2 − μ_s)/(1 + I₀/I) at the inertial number I = γ̇ d √(ρ_s/p).

    Shear at constant volume, Hencky elasticity below the friction, and an implicit step in closed form (Dunatunga and
    Kamrin 2015). Grains less dense than ``critical_density`` are apart and free of stress until they meet again.
    """

    analyses: ClassVar[frozenset[str]] = frozenset({"uniaxial_strain", "plane_strain", "axisymmetric", "3d"})
    history: ClassVar[tuple[str, ...]] = (*HISTORY, "opening")
    properties: ClassVar[frozenset[str]] = frozenset({"isotropic", "stress_free_at_rest", "cohesionless"})

    kind: Literal["granular"]
    mu_s: Annotated[float, Quantity("1", ge=0)]
    """Static friction μ_s: shear stress over pressure at which flow starts."""
    mu_2: Annotated[float, Quantity("1", ge=0)]
    """Friction μ_2 of very fast flow, at least μ_s; equal to it for friction that does not depend on the rate."""
    I0: Annotated[float, Quantity("1", gt=0)] = 0.3
    """Inertial number at which the friction is halfway between both."""
    grain_diameter: Annotated[float, Quantity("length", gt=0)]
    """Diameter d of the grains."""
    grain_density: Density
    """Density ρ_s of the grains themselves."""
    critical_density: Density | None = None
    """Density of the packing below which grains are apart, at least ``density``, its default."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.mu_2 < self.mu_s:
            raise ValueError(f"mu_2 must be at least mu_s, given: {self.mu_2:g} and {self.mu_s:g}")
        if self.critical_density is not None and self.critical_density < self.density:
            raise ValueError(
                f"critical_density must be at least the density, given: {self.critical_density:g} and {self.density:g}"
            )
        return self

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Moduli and friction."""
        return GRAINS[analysis != "3d"](
            **self.elastic_numbers(analysis),
            mu_s=self.mu_s,
            mu_2=self.mu_2,
            fluidity=self.I0 / (self.grain_diameter * sqrt(self.grain_density)),
        )

    def initial_history(self) -> dict[str, float]:
        """Grains start apart if the density is below the critical one."""
        return {"opening": log((self.critical_density or self.density) / self.density)}


class GrainNumbers(NamedTuple):
    """Numbers of a granular material."""

    bulk: float
    shear: float
    density: float
    lateral: float
    mu_s: float
    mu_2: float
    fluidity: float
    """I₀/(d √ρ_s) [1/(time·√pressure)]."""


GRAINS = hencky_plastic("Grains", GrainNumbers._fields, __name__)
"""The parameter tuples in space (False) and in the plane (True)."""


for _Grains in GRAINS.values():

    @kirchhoff_stress.register(_Grains)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        b = trial_tensor(m, dF, H, p)
        trace, e = split_strain(b)
        volume = trace + H[OPENING, p]
        if volume >= 0.0:
            if commit:
                keep_tensor(m, H, p, (1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
                keep_plastic(H, p, 0.0, 0.0)
                H[OPENING, p] = volume
            return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        K, G = m.bulk, m.shear
        pressure = -K * volume
        trial = G * math.sqrt(2.0 * double_contraction(e))
        scale, shear = 1.0, trial
        if trial > m.mu_s * pressure:
            # (trial - shear)(μ_2 p - shear) = a (shear - μ_s p), a = G Δt I₀/d √(p/ρ_s); the smaller root
            low, high = m.mu_s * pressure, m.mu_2 * pressure
            a = G * max(0.0, dt) * m.fluidity * math.sqrt(pressure)
            # the discriminant without cancellation: for a = 0 the root is exactly |μ_2 p - trial|
            root = math.sqrt((high - trial) ** 2 + a * (2.0 * (high + trial) - 4.0 * low + a))
            shear = min(trial, 2.0 * (high * trial + low * a) / (high + trial + a + root))
            scale = shear / trial
        if commit:
            if scale < 1.0 or H[OPENING, p] > 0.0:
                third = volume / 3.0
                b = tensor_of_strain(scale, e, third)
            keep_tensor(m, H, p, b)
            keep_plastic(H, p, (trial - shear) / (math.sqrt(3.0) * G), shear * (trial - shear) / G)
            H[OPENING, p] = 0.0
        g = 2.0 * G * scale
        return g * e[0] - pressure, g * e[1] - pressure, g * e[2] - pressure, g * e[3], g * e[4], g * e[5]

    @wave_speed_squared.register(_Grains)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        # friction grows with the pressure: where grains flow, K + √2 μ K x + 2G(2/3 - x²) with x = n·s·n/|s|
        x = min(math.sqrt(2.0 / 3.0), m.mu_2 * m.bulk / (math.sqrt(8.0) * m.shear))
        stiffer = x * (math.sqrt(2.0) * m.mu_2 * m.bulk - 2.0 * m.shear * x) if H[LAST, p] > 0.0 else 0.0
        return (hencky_stiffness(m, H, p) + stiffer) / m.density

    @bulk_speed_squared.register(_Grains)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return m.bulk * (1.0 - elastic_volume(m, H, p)) / m.density if H[OPENING, p] <= 0.0 else 0.0
