"""Anisotropic plasticity of metals for large strain: Hill's yield function of 1948, elasticity with axes."""

import math
from collections import namedtuple
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import logarithm
from mpmcli.core.model import Quantity
from mpmcli.core.tensors import determinant, multiply
from mpmcli.materials.anisotropic import (
    Stiffness,
    combine,
    energy_of,
    extension_of,
    flowed,
    in_plane,
    in_space,
    push_stress,
    reduced_stiffness,
    strain_of,
    times_stiffness,
    wave_modulus,
)
from mpmcli.materials.axes import GRADIENT, rotation_matrix
from mpmcli.materials.base import (
    MATERIALS,
    absorb_work,
    bulk_speed_squared,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults, yes
from mpmcli.materials.hardening import (
    LAWS,
    JohnsonCookHardening,
    LinearHardening,
    PowerLawHardening,
    SteinbergCochranGuinan,
    SwiftHardening,
    VoceHardening,
    flow,
    flow_stress,
)
from mpmcli.materials.hill_anisotropy import Hill, HillAnisotropy, Modes, modes_of
from mpmcli.materials.lateral import free_stress, thickness_stretch, widened
from mpmcli.materials.orthotropic import OrthotropicConstants
from mpmcli.materials.own_numbers import with_own_numbers

Array = np.ndarray

# rows of the history after the nine of Fᵉ·R
STRAIN, WORK, TEMPERATURE, HEAT, STIFFER = 9, 10, 11, 12, 13
LEAST = 1e-9
"""Flow stress over the trial stress, at least."""

ConstantStiffness = Annotated[
    LinearHardening | JohnsonCookHardening | PowerLawHardening | SwiftHardening | VoceHardening,
    Field(discriminator="kind"),
]
"""Hardening laws that leave the elastic moduli as they are."""


@MATERIALS.register
class HillPlastic(OrthotropicConstants):
    """Hill's anisotropic plasticity with a multiplicative split F = FᵉFᵖ and the elasticity of `orthotropic`.

    The history is A = Fᵉ·R, R turning to the material axes, which do not turn with the plastic flow. A step takes A to
    dF·A. With E = ¼(AᵀA − (AᵀA)⁻¹), T = ℂ:E and Hill's equivalent stress σ̄ of T, where σ̄ passes the flow stress Y,
    the elastic strain is E − Δα ∂σ̄/∂T at the end of the step, with σ̄ = Y there, and A becomes one of this strain and
    of the same volume. For small elastic strain. Adiabatic: the part χ of the plastic work heats the material.
    """

    history: ClassVar[tuple[str, ...]] = (
        *GRADIENT,
        "equivalent_plastic_strain",
        "plastic_work",
        "temperature",
        "heat_energy",
        "stiffening",
    )
    properties: ClassVar[frozenset[str]] = frozenset({"stress_free_at_rest"})

    kind: Literal["hill_plastic"]
    anisotropy: HillAnisotropy
    """Hill's yield function, by coefficients, ratios of yield stresses, or R-values."""
    hardening: ConstantStiffness
    """Flow stress Y against equivalent plastic strain, rate and temperature."""
    taylor_quinney: Annotated[float, Quantity("1", ge=0, le=1)] = 0.9
    """Part χ of the plastic work that turns into heat."""

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Stiffness, Hill's coefficients and modes, what heating needs, and the hardening law's numbers."""
        C, hill = self.stiffness, self.anisotropy.coefficients
        thin_1, thin_2 = -self.nu13 / self.E1, -self.nu23 / self.E2
        heating = self.heating(adiabatic)
        bulk = (C.C11 + C.C22 + C.C33 + 2.0 * (C.C12 + C.C13 + C.C23)) / 9.0
        others = Others(
            self.density, wave_modulus(C, analysis), bulk, heating, self.taylor_quinney, thin_1, thin_2
        )
        if analysis == "plane_stress":
            C = reduced_stiffness(C)
        law = self.hardening.parameters()
        kind = HILL_WITH[type(law), analysis != "3d"]
        return kind(*C, *hill, *modes_of(hill, C), *others, *law)

    def initial_history(self) -> dict[str, float]:
        """No elastic strain, axes along those of the grid; the temperature starts at T0."""
        return {"axes_xx": 1.0, "axes_yy": 1.0, "axes_zz": 1.0, "temperature": self.T0}

    def turned_history(self, q: Array) -> dict[str, Array]:
        """Start values for axes with the unit quaternions (4, n)."""
        return dict(zip(GRADIENT, rotation_matrix(q), strict=True))

    def carried_axis(self, H: Array, F: Array) -> Array:
        """Material axis 1 (3, n), carried with the elastic part of the deformation gradient."""
        return H[[0, 3, 6]]


class Others(NamedTuple):
    """Numbers of the material but those of stiffness, yield function and hardening."""

    density: float
    wave: float
    """ρc² of the fastest wave at rest [pressure]."""
    bulk: float
    """Mean stress over dilation at equal strain in all directions [pressure]."""
    heating: float
    """1/(ρ₀c_v), or 0 where the temperature is held [temperature/pressure]."""
    chi: float
    thin_1: float
    """Elastic strain across a sheet over the stress along axis 1 [1/pressure]."""
    thin_2: float


# flat tuples, because numba's parallel loops take no tuple within a tuple
_FIELDS = (*Stiffness._fields, *(f"hill_{name}" for name in Hill._fields), *Modes._fields, *Others._fields)
HILL_WITH: dict[tuple[type, bool], Any] = {
    (law, planar): namedtuple(  # type: ignore[misc]
        f"Hill{'Planar' if planar else ''}{law.__name__}", (*_FIELDS, *law._fields), module=__name__
    )
    for law in LAWS
    if law is not SteinbergCochranGuinan
    for planar in (False, True)
}
"""The parameter tuple for that of each hardening law, in space (False) and in the plane (True)."""
globals().update(
    {made.__name__: made for made in HILL_WITH.values()}
)  # where the compiler's cache finds them


@generic
def gradient_of(m: Any, H: Any, p: Any) -> Any:
    """A of a particle."""


@inline
def squares_of(m: Any, E: Any, T: Any) -> Any:
    """Parts of σ̄² by the five modes: λy² of the normal ones, and those of the shears 12, 23, 13 [pressure²]."""
    y = m.first_1 * E[0] + m.first_2 * E[1] + m.first_3 * E[2]
    z = m.second_1 * E[0] + m.second_2 * E[1] + m.second_3 * E[2]
    xy, yz, xz = 2.0 * m.hill_N * T[3] * T[3], 2.0 * m.hill_L * T[4] * T[4], 2.0 * m.hill_M * T[5] * T[5]
    return m.first * y * y, m.second * z * z, xy, yz, xz


@generic
def reduced(m: Any, parts: Any, k: Any) -> Any:
    """σ̄² when the plastic strain is k ∂(½σ̄²)/∂T, and −½ its derivative by k."""


@inline
def reduced_modes(m: Any, parts: Any, k: float) -> Any:
    """The same of the normal modes and the shear of axes 1 and 2."""
    xy = 2.0 * m.G12 * m.hill_N
    a, b, c = 1.0 / (1.0 + k * m.first), 1.0 / (1.0 + k * m.second), 1.0 / (1.0 + k * xy)
    u, v, w = parts[0] * a * a, parts[1] * b * b, parts[2] * c * c
    return u + v + w, u * a * m.first + v * b * m.second + w * c * xy


def reduced_in_plane(m: Any, parts: Any, k: Any) -> Any:
    """``reduced`` without shear across the plane."""
    return reduced_modes(m, parts, k)


def reduced_in_space(m: Any, parts: Any, k: Any) -> Any:
    """``reduced`` with all shears."""
    yz, xz = 2.0 * m.G23 * m.hill_L, 2.0 * m.G13 * m.hill_M
    d, e = 1.0 / (1.0 + k * yz), 1.0 / (1.0 + k * xz)
    x, y = parts[3] * d * d, parts[4] * e * e
    square, fall = reduced_modes(m, parts, k)
    return square + x + y, fall + x * d * yz + y * e * xz


@inline
def return_factor(m: Any, parts: Any, trial: float, alpha: float, T: float, dt: float) -> Any:
    """k = Δα/σ̄ with σ̄(k) = Y(α + Δα, Δα/dt, T), and σ̄: Newton's method for 1/σ̄ = 1/Y, kept inside its bracket.

    The first step starts from k = 0, where it needs neither roots nor quotients but its own. The last one starts from
    an error below 1e-5 and is quadratic, so that its end needs no evaluation.
    """
    rate = 1.0 / dt if dt > 0.0 else 0.0
    Y, slope = flow(m, alpha, 0.0, T, dt)
    Y = max(Y, LEAST * trial)
    low, high = 0.0, (trial / Y - 1.0) / m.least
    square, fall = reduced(m, parts, 0.0)
    k = min(high, (trial - Y) * Y * square / (slope * square * square + fall * Y * Y))
    stress, change = trial, 0.0
    for _ in range(60):
        square, fall = reduced(m, parts, k)
        stress = math.sqrt(square)
        step = k * stress
        Y, slope = flow(m, alpha + step, step * rate, T, dt)
        Y = max(Y, LEAST * trial)
        excess = stress - Y
        # dσ̄/dk = −fall/σ̄, dΔα/dk = (σ̄² − k fall)/σ̄
        hardening = slope * (square - k * fall)
        change = excess * Y * square / (hardening * square + fall * Y * Y)
        if abs(excess) <= 1e-5 * trial:
            k, stress = max(0.0, k + change), stress - change * fall / stress
            break
        if excess > 0.0:
            low = k
        else:
            high = k
        k += change
        if k <= low or k > high:
            k = 0.5 * (low + high)
    return k, stress


@inline
def slope_of(m: Any, T: Any) -> Any:
    """∂(½σ̄²)/∂T [pressure]."""
    F, G, H = m.hill_F * (T[1] - T[2]), m.hill_G * (T[2] - T[0]), m.hill_H * (T[0] - T[1])
    return H - G, F - H, G - F, m.hill_N * T[3], m.hill_L * T[4], m.hill_M * T[5]


@inline
def relaxed(m: Any, E: Any, T: Any, k: float) -> Any:
    """T after the plastic strain k ∂(½σ̄²)/∂T at the end."""
    y = m.first_1 * E[0] + m.first_2 * E[1] + m.first_3 * E[2]
    z = m.second_1 * E[0] + m.second_2 * E[1] + m.second_3 * E[2]
    y *= k * m.first / (1.0 + k * m.first)
    z *= k * m.second / (1.0 + k * m.second)
    return (
        T[0] - y * m.first_1 - z * m.second_1,
        T[1] - y * m.first_2 - z * m.second_2,
        T[2] - y * m.first_3 - z * m.second_3,
        T[3] / (1.0 + 2.0 * k * m.G12 * m.hill_N),
        T[4] / (1.0 + 2.0 * k * m.G23 * m.hill_L),
        T[5] / (1.0 + 2.0 * k * m.G13 * m.hill_M),
    )


@inline
def returned(m: Any, E: Any, alpha: float, temperature: float, dt: float) -> Any:
    """T, k = Δα/σ̄ and σ̄ at the end of a step with the elastic trial strain E."""
    T = times_stiffness(m, E)
    parts = squares_of(m, E, T)
    stress, k = math.sqrt(parts[0] + parts[1] + parts[2] + parts[3] + parts[4]), 0.0
    if stress > flow_stress(m, alpha, 0.0, temperature):
        k, stress = return_factor(m, parts, stress, alpha, temperature, dt)
        T = relaxed(m, E, T, k)
    return T, k, stress


def gradient_in_plane(m: Any, H: Any, p: Any) -> Any:
    """The gradient of particle ``p`` without shear across the plane."""
    return H[0, p], H[1, p], 0.0, H[3, p], H[4, p], 0.0, 0.0, 0.0, H[8, p]


def gradient_in_space(m: Any, H: Any, p: Any) -> Any:
    """All components of the gradient of particle ``p``."""
    return H[0, p], H[1, p], H[2, p], H[3, p], H[4, p], H[5, p], H[6, p], H[7, p], H[8, p]


@inline
def settled_stress(
    m: Any, A: Any, E: Any, T: Any, k: float, end: float, H: Any, p: Any, dt: float, commit: Any
) -> Any:
    """Kirchhoff stress of A with the trial strain E, of which T and k = Δα/σ̄, σ̄ being ``end``, are ``returned``."""
    if k > 0.0:
        alpha, temperature = H[STRAIN, p], H[TEMPERATURE, p]
        X = slope_of(m, T)
        X = combine(k, X, 0.0, X)
        A, dilation = flowed(m, A, combine(1.0, E, -1.0, X), X)
        if commit:
            step = k * end
            rate = step / dt if dt > 0.0 else 0.0
            # the pressure takes its part of what flow changes the trace of the elastic strain by
            work = 0.5 * (min(end, flow_stress(m, alpha, rate, temperature)) + end) * step
            work -= (T[0] + T[1] + T[2]) / 3.0 * dilation
            H[STRAIN, p] = alpha + step
            H[WORK, p] += work
            H[TEMPERATURE, p] = temperature + m.heating * m.chi * work
            H[HEAT, p] += m.chi * work
    tau, stiffer = push_stress(m, A, T)
    if commit:
        H[STIFFER, p] = stiffer
        H[0, p], H[1, p], H[2, p] = A[0], A[1], A[2]
        H[3, p], H[4, p], H[5, p] = A[3], A[4], A[5]
        H[6, p], H[7, p], H[8, p] = A[6], A[7], A[8]
    return tau


@inline
def free_trial(m: Any, dF: Any, H: Any, p: Any, dt: float) -> Any:
    """A with the thickness of the last step and its strain, the one across the plane, and what is ``returned``.

    In plane stress the numbers are those of the plane: the return needs no thickness.
    """
    A = multiply(dF, gradient_of(m, H, p))
    E = strain_of(m, A)
    T, k, end = returned(m, E, H[STRAIN, p], H[TEMPERATURE, p], dt)
    return A, E, m.thin_1 * T[0] + m.thin_2 * T[1] + k * slope_of(m, T)[2], T, k, end


def plane_thickness(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """``thickness_stretch`` of the law."""
    A, _, across, _, _, _ = free_trial(m, dF, H, p, dt)
    return F[8] * extension_of(across) / A[8]


def plane_stress(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
    """``free_stress`` of the law."""
    A, E, across, T, k, end = free_trial(m, dF, H, p, dt)
    z = extension_of(across)
    F1, dF1 = widened(F, dF, F[8] * z / A[8], both)
    A = (A[0], A[1], 0.0, A[3], A[4], 0.0, 0.0, 0.0, z)
    E = (E[0], E[1], across, E[3], 0.0, 0.0)
    return F1, dF1, settled_stress(m, A, E, T, k, end, H, p, dt, True)


for (_law, _planar), _Hill in HILL_WITH.items():
    with_defaults((in_plane if _planar else in_space)(_Hill))
    needs_increment.register(_Hill)(yes)
    with_own_numbers(_Hill)
    flow.register(_Hill)(flow.implementations[_law])

    gradient_of.register(_Hill)(gradient_in_plane if _planar else gradient_in_space)
    reduced.register(_Hill)(reduced_in_plane if _planar else reduced_in_space)
    if _planar:
        thickness_stretch.register(_Hill)(plane_thickness)
        free_stress.register(_Hill)(plane_stress)

    @kirchhoff_stress.register(_Hill)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        A = multiply(dF, gradient_of(m, H, p))
        E = strain_of(m, A)
        T, k, end = returned(m, E, H[STRAIN, p], H[TEMPERATURE, p], dt)
        return settled_stress(m, A, E, T, k, end, H, p, dt, commit)

    @absorb_work.register(_Hill)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
        H[TEMPERATURE, p] += m.heating * viscous
        H[HEAT, p] += viscous

    @strain_energy.register(_Hill)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return energy_of(m, gradient_of(m, H, p))

    @bulk_speed_squared.register(_Hill)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return max(0.0, m.bulk * (1.0 - logarithm(determinant(F))) / m.density)

    @wave_speed_squared.register(_Hill)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return (m.wave + H[STIFFER, p]) / m.density
