"""Modified Cam clay: soils whose strength and stiffness follow the pressure and its history."""

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential_1d, logarithm
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.core.rows import sqrt
from mpmcli.materials.base import (
    MATERIALS,
    MaterialModel,
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
    elastic_volume,
    keep_plastic,
    keep_tensor,
    split_strain,
    tensor_of_strain,
    trial_tensor,
)
from mpmcli.materials.planar import in_space_and_plane

CONSOLIDATION = len(HISTORY)
"""Row of the preconsolidation pressure."""

Positive = Annotated[float, Quantity("1", gt=0)]


@MATERIALS.register
class ModifiedCamClay(MaterialModel):
    """Modified Cam clay: q²/M² + p(p − p_c) ≤ 0, associated flow, p = −τₘ, q = √(3 J₂).

    The specific volume falls by κ per unit of ln p in elastic compression and by λ in plastic compression; with
    logarithmic strain the slopes are κ/(1 + e0) and λ/(1 + e0). The shear modulus follows from the current bulk modulus
    and Poisson's ratio. The step is implicit.
    """

    analyses: ClassVar[frozenset[str]] = frozenset({"uniaxial_strain", "plane_strain", "axisymmetric", "3d"})
    history: ClassVar[tuple[str, ...]] = (*HISTORY, "preconsolidation_pressure")
    properties: ClassVar[frozenset[str]] = frozenset({"isotropic"})

    kind: Literal["modified_cam_clay"]
    M: Positive
    """Slope of the critical state line, q over p."""
    lambda_: Annotated[Positive, Field(alias="lambda")]
    """Slope λ of the normal compression line, specific volume against ln p."""
    kappa: Positive
    """Slope κ of unloading and reloading, less than λ."""
    nu: Annotated[float, Quantity("1", ge=0, lt=0.5)]
    """Poisson's ratio."""
    e0: Annotated[float, Quantity("1", ge=0)]
    """Void ratio at the start."""
    p0: PositivePressure
    """Preconsolidation pressure p_c at the start."""
    pressure: PositivePressure | None = None
    """Pressure at the start, in all directions, at most p0, its default. The stress of a body takes its place."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.kappa >= self.lambda_:
            raise ValueError(
                f"kappa must be less than lambda, given: {self.kappa:g} and {self.lambda_:g}"
            )  # fmt: skip
        if self.start_pressure > self.p0:
            raise ValueError(f"pressure may be at most p0, given: {self.pressure:g} and {self.p0:g}")
        return self

    @property
    def start_pressure(self) -> float:
        """Pressure at the start [pressure]."""
        return self.p0 if self.pressure is None else self.pressure

    def parameters(self, analysis: str, adiabatic: bool) -> Any:
        """Slopes by logarithmic strain, and the pressure without elastic strain."""
        volume = 1.0 + self.e0
        return CLAY[analysis != "3d"](
            M=self.M,
            swelling=self.kappa / volume,
            hardening=self.lambda_ / (self.lambda_ - self.kappa),
            shear=1.5 * (1 - 2 * self.nu) / (1 + self.nu),
            pressure=self.start_pressure,
            density=self.density,
        )

    def initial_history(self) -> dict[str, float]:
        """The preconsolidation pressure starts at p0."""
        return {"preconsolidation_pressure": self.p0}

    def initial_wave_speed(self, analysis: str) -> float:
        """√((K + 4G/3 + p)/ρ) [velocity], K = p(1 + e0)/κ."""
        m = self.parameters(analysis, False)
        return sqrt(m.pressure * ((1 + 4 / 3 * m.shear) / m.swelling + 1) / m.density)


class ClayNumbers(NamedTuple):
    """Numbers of modified Cam clay."""

    M: float
    swelling: float
    """κ/(1 + e0)."""
    hardening: float
    """λ/(λ − κ)."""
    shear: float
    """Shear modulus over bulk modulus."""
    pressure: float
    """Pressure without elastic strain."""
    density: float


CLAY = in_space_and_plane("Clay", ClayNumbers._fields, __name__)
"""The parameter tuples in space (False) and in the plane (True)."""


@inline
def plastic_drop(w0: float, eta2: float, a: float, c: float) -> float:
    """u = ln(p_trial/p) with 1 + η² h² = w, where w = p_c/p = w0 exp(a u) and h = (2 − w)/(2 − w + c u).

    ``w0`` is p_c/p of the trial state, ``eta2`` η² its (q/p)²/M². The root lies between 0 and the critical state, w =
    2; Newton's method is kept between them.
    """
    inside, critical = 0.0, logarithm(2.0 / w0) / a
    u = 0.0
    for _ in range(60):
        if abs(critical - inside) < 1e-13:
            break
        w = w0 * exponential_1d(a * u)
        d = 2.0 - w
        s = d + c * u
        h = d / s if s != 0.0 else 0.0
        g = 1.0 + eta2 * h * h - w
        if abs(g) <= 1e-14 * w:
            break
        if g > 0.0:
            inside = u
        else:
            critical = u
        slope = -a * w
        if s != 0.0:
            slope -= 2.0 * eta2 * h * c * (a * w * u + d) / (s * s)
        step = g / slope
        u -= step
        if (u - inside) * (u - critical) >= 0.0:
            u = 0.5 * (inside + critical)
        elif abs(step) < 1e-9:  # the next one would be its square
            break
    return u


for _Clay in CLAY.values():

    @kirchhoff_stress.register(_Clay)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        b = trial_tensor(m, dF, H, p)
        trace, e = split_strain(b)
        pressure = m.pressure * exponential_1d(-trace / m.swelling)
        # q = G n and G = shear p/κ*, so that q/p does not depend on p
        n = math.sqrt(6.0 * double_contraction(e))
        eta = m.shear * n / m.swelling
        eta2 = eta * eta / (m.M * m.M)
        yielding = H[CONSOLIDATION, p]
        scale, u = 1.0, 0.0
        if pressure * (1.0 + eta2) > yielding:
            w0 = yielding / pressure
            c = 6.0 * m.shear / (m.M * m.M)
            u = plastic_drop(w0, eta2, m.hardening, c)
            w = w0 * exponential_1d(m.hardening * u)
            # of two equal formulas the one that is accurate: at the critical state h is 0/0, far from it η is small
            scale = (2.0 - w) / (2.0 - w + c * u) if w < 1.5 else math.sqrt((w - 1.0) / max(eta2, 1e-300))
            scale = min(1.0, scale)
            pressure *= exponential_1d(-u)
            yielding = w * pressure
        if commit:
            work = 0.0
            if u != 0.0 or scale < 1.0:
                third = (trace + m.swelling * u) / 3.0
                b = tensor_of_strain(scale, e, third)
                work = pressure * (m.swelling * u + scale * eta * (1.0 - scale) * n / 3.0)
            keep_tensor(m, H, p, b)
            keep_plastic(H, p, (1.0 - scale) * n / 3.0, work)
            H[CONSOLIDATION, p] = yielding
        g = 2.0 * m.shear * pressure / m.swelling * scale
        return g * e[0] - pressure, g * e[1] - pressure, g * e[2] - pressure, g * e[3], g * e[4], g * e[5]

    @strain_energy.register(_Clay)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        trace, e = split_strain(elastic_tensor(m, H, p))
        pressure = m.pressure * exponential_1d(-trace / m.swelling)
        return m.swelling * (pressure - m.pressure) + m.shear * pressure / m.swelling * double_contraction(e)

    @dissipated_heat.register(_Clay)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        return H[LAST, p]

    @bulk_speed_squared.register(_Clay)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        pressure = m.pressure * exponential_1d(-elastic_volume(m, H, p) / m.swelling)
        return pressure * (1.0 / m.swelling + 1.0) / m.density

    @wave_speed_squared.register(_Clay)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        b = elastic_tensor(m, H, p)
        pressure = m.pressure * exponential_1d(-elastic_volume(m, H, p) / m.swelling)
        # ρ₀c² = ∂τ/∂ε - τ: the shear modulus grows with p, of τ the deviator is at most 2q/3; dev ε is about dev b/2
        mean = (b[0] + b[1] + b[2]) / 3.0
        squares = double_contraction((b[0] - mean, b[1] - mean, b[2] - mean, b[3], b[4], b[5]))
        deviator = m.shear * math.sqrt(2.0 / 3.0 * squares) / (m.swelling * mean)
        stiffness = (1.0 + 4.0 / 3.0 * m.shear + deviator) / m.swelling + 1.0 + deviator
        at_rest = m.pressure * ((1.0 + 4.0 / 3.0 * m.shear) / m.swelling + 1.0)
        return max(at_rest, pressure * stiffness) / m.density
