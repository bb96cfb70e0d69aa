"""Metal plasticity for large strain: von Mises yielding, isotropic hardening, Hencky elasticity."""

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential, exponential_symmetric, log_symmetric, logarithm
from mpmcli.core.model import Quantity
from mpmcli.core.tensors import determinant
from mpmcli.materials.base import (
    MATERIALS,
    absorb_work,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.elastic_constants import ElasticModel
from mpmcli.materials.hardening import LAWS, Hardening, changes_stiffness, flow, flow_stress, stiffness_ratio
from mpmcli.materials.hencky import double_contraction, elastic_tensor, keep_tensor, trial_tensor
from mpmcli.materials.lateral import (
    add_laterally,
    free_stress,
    lateral_stretch,
    search_lateral,
    search_thickness,
    stress_of_stretch,
    stretch_tensor,
    thickness_stretch,
    widened,
)
from mpmcli.materials.planar import in_space_and_plane

# rows of the history array after the six of the elastic strain
STRAIN, WORK, TEMPERATURE, HEAT = 6, 7, 8, 9

LEAST = 1e-12
"""Flow stress over the trial stress that the search for the thickness takes of a material without any, as molten."""


@MATERIALS.register
class J2Plastic(ElasticModel):
    """Von Mises plasticity with a multiplicative split F = FᵉFᵖ and Hencky elasticity.

    The elastic left Cauchy–Green tensor bᵉ is the history. A step takes it to dF bᵉ dFᵀ; with the elastic
    strain ε = ½ ln bᵉ the stress is τ = K tr(ε) I + 2G dev ε, and where √(3/2)|dev τ| passes the flow stress
    Y, dev ε is scaled back so that it meets Y at the end of the step (radial return, exact in logarithmic
    strain; Simo 1992). A hardening law may multiply G and Y by one factor of J and T. Adiabatic: the part χ of the
    plastic work heats the material.
    """

    history: ClassVar[tuple[str, ...]] = (
        *(f"elastic_{component}" for component in ("xx", "yy", "zz", "xy", "yz", "xz")),
        "equivalent_plastic_strain",
        "plastic_work",
        "temperature",
        "heat_energy",
    )
    properties: ClassVar[frozenset[str]] = frozenset({"isotropic", "stress_free_at_rest"})

    kind: Literal["j2_plastic"]
    hardening: Hardening
    """Flow stress against plastic strain, rate and temperature."""
    taylor_quinney: Annotated[float, Quantity("1", ge=0, le=1)] = 0.9
    """Part χ of the plastic work that turns into heat."""
    temperature: Annotated[float, Quantity("temperature", ge=0)] | None = None
    """Older word for T0."""

    @model_validator(mode="after")
    def _one_temperature(self) -> Self:
        if self.temperature is not None:
            if "T0" in self.model_fields_set:
                raise ValueError("give T0 or temperature, its older word, not both")
            # the value has one name from here on
            self.__dict__ |= {"T0": self.temperature, "temperature": None}
            self.__pydantic_fields_set__.symmetric_difference_update({"T0", "temperature"})
        return self

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Moduli, what heating needs, and the hardening law's numbers."""
        elastic = ElasticPart(
            **self.elastic_numbers(analysis),
            heating=self.heating(adiabatic),
            chi=self.taylor_quinney,
        )
        law = self.hardening.parameters()
        return J2_WITH[type(law), analysis != "3d"](*elastic, *law)


class ElasticPart(NamedTuple):
    """Numbers of a von Mises plastic material but those of its hardening."""

    bulk: float
    shear: float
    density: float
    lateral: float
    """Wave stiffness of the analysis over that of uniaxial strain."""
    heating: float
    """1/(ρ₀c_v), or 0 where the temperature is held [temperature/pressure]."""
    chi: float


# flat tuples, because numba's parallel loops take no tuple within a tuple
J2_WITH: dict[tuple[type, bool], Any] = {
    (law, planar): made
    for law in LAWS
    for planar, made in in_space_and_plane(
        f"J2{law.__name__}", (*ElasticPart._fields, *law._fields), __name__
    ).items()
}
"""The parameter tuple for that of each hardening law, in space (False) and in the plane (True)."""


@inline
def plastic_increment(
    m: Any, trial: float, stiffness: float, start: Any, alpha: float, T: float, dt: float
) -> float:
    """Δα ≥ 0 with trial − stiffness·Δα = Y(α + Δα, Δα/dt, T), by Chebyshev's method kept inside its bracket.

    The first step starts from Δα = 0, where ``start`` is the flow. The curvature of Y is taken as that of a logarithm,
    its slope over −Δα, which it hardly passes: the last step is of an excess below 1e-5 of the trial stress, and leaves
    at most 1e-13.
    """
    low, high = 0.0, trial / stiffness
    rate = 1.0 / dt if dt > 0.0 else 0.0
    step = min(high, (trial - start[0]) / (stiffness + start[1]))
    for _ in range(60):
        Y, slope = flow(m, alpha + step, step * rate, T, dt)
        excess = trial - stiffness * step - Y
        if abs(excess) <= 1e-13 * trial:
            break
        if excess > 0.0:
            low = step
        else:
            high = step
        change = excess / (stiffness + slope)
        is_last = abs(excess) <= 1e-5 * trial and slope * change * change <= 1e-13 * trial * step
        bend = slope / (step * (stiffness + slope))
        step += change + 0.5 * bend * change * min(step, max(-step, change))
        if step >= high if excess > 0.0 else step <= low:
            step = 0.5 * (low + high)
        elif is_last:
            break
    return step


@inline
def free_increment(
    m: Any, a: float, b: float, k: float, h: float, ratio: float, start: Any, step: float, alpha: float, T: float,
    dt: float,
) -> Any:  # fmt: skip
    """Δα > 0 with (a/(Y + kΔα))² + (b/(Y + hΔα))² = 1, and Y, which is ``ratio`` times ``flow``.

    Chebyshev's method from ``step`` on for 1/√ of the left side, which is linear in Δα where a or b is 0 and Y is
    linear. As in ``plastic_increment`` the curvature of Y is taken as that of a logarithm. ``start`` is the flow of
    ``step``; k is at most h.
    """
    low, high = 0.0, (a + b) / k
    rate = 1.0 / dt if dt > 0.0 else 0.0
    least = LEAST * (a + b)
    Y, slope = max(least, ratio * start[0]), ratio * start[1]
    for _ in range(60):
        y, z = 1.0 / (Y + k * step), 1.0 / (Y + h * step)
        u, v, f, g = a * a * y * y, b * b * z * z, (slope + k) * y, (slope + h) * z
        square, fall = u + v, u * f + v * g
        excess = math.sqrt(square) - 1.0
        if abs(excess) <= 1e-13:
            break
        if excess > 0.0:
            low = step
        else:
            high = step
        change = square * excess / fall
        bend = 3.0 * u * v * (f - g) * (f - g) / (square * fall)
        limit, is_last = abs(change), False
        if step > 0.0:
            bend += slope * (u * y + v * z) / (step * fall)
            limit = min(limit, step)
            is_last = abs(excess) <= 1e-5 and slope * change * change * z <= 1e-13 * step
        step += change + 0.5 * bend * change * min(limit, max(-limit, change))
        if step >= high if excess > 0.0 else step <= low:
            step = 0.5 * (low + high)
        elif is_last:
            Y += slope * change
            break
        Y, slope = flow(m, alpha + step, step * rate, T, dt)
        Y, slope = max(least, ratio * Y), ratio * slope
    return step, Y


@inline
def free_strain(m: Any, e: Any, both: Any, alpha: float, T: float, dt: float) -> Any:
    """Logarithmic strain along the axes without stress, z or y and z, the plastic increment, and whether it is found.

    ``e`` is twice the trial strain with the stretches of the last step along these axes. Hooke's law of plane or
    uniaxial stress gives sum and difference of the stresses along the others. Where the moduli change with the volume,
    the strain is found in rounds, each closer by a factor of about the elastic strain.
    """
    free, stiffness = (2.0, 1.0) if both else (1.0, 4.0)
    trace = 0.5 * e[0] if both else 0.5 * (e[0] + e[1])
    shape = 0.0 if both else 0.75 * (e[0] - e[1]) * (e[0] - e[1]) + 3.0 * e[3] * e[3]
    begin = flow(m, alpha, 0.0, T, dt)
    start, step, strain, change = begin, 0.0, 0.5 * e[2], 1e-6
    ratio, shift, K = 1.0, 0.0, 3.0 * m.bulk
    for turn in range(20):
        if changes_stiffness(m):
            ratio, slope = stiffness_ratio(m, m.bulk, trace + free * strain, T)
        G, s = ratio * m.shear, trace + (3.0 - free) / 3.0 * shift
        below = 1.0 / (K + stiffness * G)
        k, elastic = 3.0 * K * G * below, (K - 2.0 * G) / free * below
        a, b = k * abs(s), G * math.sqrt(shape)
        stress, found = math.sqrt(a * a + b * b), -s * elastic
        if stress > ratio * begin[0]:
            step, stress = free_increment(m, a, b, k, 3.0 * G, ratio, start, step, alpha, T, dt)
            found = -s * (elastic * stress + k / free * step) / (stress + k * step)
        else:
            step = 0.0
        if not changes_stiffness(m):
            return found, step, True
        found -= shift / 3.0
        last, change, strain = change, abs(found - strain), found
        if turn > 0 and change * change <= 1e-14 * last:  # the first one knows no shift
            return found, step, True
        # the mean stress that follows from the change of G, as a strain of volume
        shift = 0.5 * slope * stress * stress / (max(ratio * ratio, 1e-300) * m.shear * K)
        start = flow(m, alpha + step, step / dt if dt > 0.0 else 0.0, T, dt)
    return strain, step, False


@inline
def split(m: Any, e: Any) -> Any:
    """A third of tr e, dev e, and √(3/2)|G dev e|: the equivalent trial stress, where e is twice the trial strain."""
    mean = (e[0] + e[1] + e[2]) / 3.0
    d = (e[0] - mean, e[1] - mean, e[2] - mean, e[3], e[4], e[5])
    return mean, d, m.shear * math.sqrt(1.5 * double_contraction(d))


@inline
def stress_of_step(
    m: Any, b: Any, mean: float, d: Any, trial: float, step: float, H: Any, p: Any, dt: float, commit: Any
) -> Any:
    """Kirchhoff stress after the plastic increment ``step`` of a trial state with the tensor b and ``split`` ln b."""
    xx, yy, zz, xy, yz, xz = d
    G, alpha, T = m.shear, H[STRAIN, p], H[TEMPERATURE, p]
    ratio, slope = stiffness_ratio(m, m.bulk, 1.5 * mean, T) if changes_stiffness(m) else (1.0, 0.0)
    if step > 0.0:
        r = 1.0 - 3.0 * G * step / trial
        xx, yy, zz, xy, yz, xz = r * xx, r * yy, r * zz, r * xy, r * yz, r * xz
        if commit:
            b = exponential_symmetric((xx + mean, yy + mean, zz + mean, xy, yz, xz))
            rate = step / dt if dt > 0.0 else 0.0
            end = trial - 3.0 * G * step
            work = 0.5 * (min(end, flow_stress(m, alpha, rate, T)) + end) * step
            if changes_stiffness(m):
                work *= ratio
            H[STRAIN, p] = alpha + step
            H[WORK, p] += work
            H[TEMPERATURE, p] = T + m.heating * m.chi * work
            H[HEAT, p] += m.chi * work
    if commit:
        keep_tensor(m, H, p, b)
    mean *= 1.5 * m.bulk
    if changes_stiffness(m):
        # the modulus depends on J, and so does the energy of the shape
        mean += 0.25 * G * slope * double_contraction((xx, yy, zz, xy, yz, xz))
        G *= ratio
    return mean + G * xx, mean + G * yy, mean + G * zz, G * xy, G * yz, G * xz


@inline
def free_trial(m: Any, dF: Any, H: Any, p: Any, dt: float, both: Any) -> Any:
    """b and ln b after an elastic step, half of what ln b lacks along the axes without stress, and ``free_strain``."""
    b = trial_tensor(m, dF, H, p)
    e = log_symmetric(b)
    strain, step, is_found = free_strain(m, e, both, H[STRAIN, p], H[TEMPERATURE, p], dt)
    return b, e, strain - 0.5 * e[2], step, is_found


for (_law, _), _J2 in J2_WITH.items():
    flow.register(_J2)(flow.implementations[_law])
    changes_stiffness.register(_J2)(changes_stiffness.implementations[_law])
    stiffness_ratio.register(_J2)(stiffness_ratio.implementations[_law])

    @kirchhoff_stress.register(_J2)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        b = trial_tensor(m, dF, H, p)
        # τ = G·(twice the elastic strain)
        mean, d, trial = split(m, log_symmetric(b))
        alpha, T = H[STRAIN, p], H[TEMPERATURE, p]
        start, step = flow(m, alpha, 0.0, T, dt), 0.0
        if trial > start[0]:
            step = plastic_increment(m, trial, 3.0 * m.shear, start, alpha, T, dt)
        return stress_of_step(m, b, mean, d, trial, step, H, p, dt, commit)

    @free_stress.register(_J2)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
        b, e, x, step, is_found = free_trial(m, dF, H, p, dt, both)
        if not is_found:
            return stress_of_stretch(m, F, dF, H, p, dt, both)
        F1, dF1 = widened(F, dF, F[8] * exponential(x), both)
        mean, d, trial = split(m, add_laterally(e, 2.0 * x, both))
        b = stretch_tensor(b, x, both)
        return F1, dF1, stress_of_step(m, b, mean, d, trial, step, H, p, dt, True)

    @thickness_stretch.register(_J2)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        _, _, x, _, is_found = free_trial(m, dF, H, p, dt, False)
        return F[8] * exponential(x) if is_found else search_thickness(m, F, dF, H, p, dt)

    @lateral_stretch.register(_J2)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        _, _, x, _, is_found = free_trial(m, dF, H, p, dt, True)
        return F[8] * exponential(x) if is_found else search_lateral(m, F, dF, H, p, dt)

    @absorb_work.register(_J2)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
        H[TEMPERATURE, p] += m.heating * viscous
        H[HEAT, p] += viscous

    @strain_energy.register(_J2)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        e = log_symmetric(elastic_tensor(m, H, p))
        trace = e[0] + e[1] + e[2]
        squares = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 2.0 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5])
        shear = m.shear
        if changes_stiffness(m):
            shear *= stiffness_ratio(m, m.bulk, 0.5 * trace, H[TEMPERATURE, p])[0]
        return 0.125 * m.bulk * trace * trace + 0.25 * shear * (squares - trace * trace / 3.0)

    @bulk_speed_squared.register(_J2)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return max(0.0, m.bulk * (1.0 - logarithm(determinant(F))) / m.density)

    @wave_speed_squared.register(_J2)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        # ρ₀c² = K + 4G/3 - τ; of τ only the mean, since yielding bounds the rest
        stiffer = -m.bulk * min(0.0, logarithm(determinant(F)))
        shear = m.shear
        if changes_stiffness(m):
            shear *= max(1.0, stiffness_ratio(m, m.bulk, logarithm(determinant(F)), H[TEMPERATURE, p])[0])
        return m.lateral * (m.bulk + 4.0 / 3.0 * shear + stiffer) / m.density
