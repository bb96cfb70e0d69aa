"""Elastic law with three planes of symmetry for large rotation, shared by the anisotropic materials.

With A = F·R, where R turns the grid's axes to the material axes, the strain in material axes is (Bažant 1998)

    E = ¼(AᵀA − (AᵀA)⁻¹),    W = ½ E:ℂ:E per initial volume,    τ = ½(A T Aᵀ + A⁻ᵀ T A⁻¹),    T = ℂ:E .

In principal axes E = ½ sinh(2 ln λ) = ln λ + ⅔ ln³λ + …: the logarithmic strain to second order, without eigenvectors.
The Green–Lagrange strain (St. Venant–Kirchhoff) agrees to first order only, loses its stiffness in compression (at
λ = 0.58 in uniaxial strain) and gives a thickness of zero in plane stress at large extension. This law stiffens in both
(τ ∝ ¼ sinh(4 ln λ) in uniaxial strain: 7 % above Hencky's law at |ln λ| = 0.16, 20 % at 0.26).
"""

import math
from functools import cache
from typing import Any, NamedTuple, TypeVar

import numpy as np

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential_symmetric, log_symmetric
from mpmcli.core.tensors import (
    inverse_transpose,
    largest_eigenvalue_bound,
    multiply,
    multiply_commuting,
    push_forward,
)

SMALL = 0.004
"""Plastic strain of a step from which on logarithms are needed."""


class Stiffness(NamedTuple):
    """Stiffness ℂ in material axes [pressure], each shear modulus by the plane of its shear."""

    C11: float
    C22: float
    C33: float
    C12: float
    C13: float
    C23: float
    G12: float
    G23: float
    G13: float


def stiffness_of(compliance: np.ndarray, shear: tuple[float, float, float]) -> Stiffness:
    """Stiffness of the compliance (3, 3) of normal stresses [1/pressure] and the shear moduli of planes 12, 23, 13."""
    C = np.linalg.inv(compliance)
    normal = (C[0, 0], C[1, 1], C[2, 2], C[0, 1], C[0, 2], C[1, 2])
    return Stiffness(*map(float, normal), *map(float, shear))


def wave_modulus(C: Stiffness, analysis: str) -> float:
    """Largest ρc² at rest [pressure], of all directions of propagation in the analysis.

    The largest eigenvalue of the acoustic tensor n·ℂ·n; in plane stress of the reduced stiffness.
    """
    if analysis == "uniaxial_strain":
        return C.C11
    if analysis == "plane_stress":
        C = reduced_stiffness(C)
    return _largest_acoustic_eigenvalue(C, 3 if analysis == "3d" else 2)


def reduced_stiffness(C: Stiffness) -> Stiffness:
    """Stiffness in the plane where T_33 = 0, which has C33 = C13 = C23 = 0."""
    C11, C22 = C.C11 - C.C13 * C.C13 / C.C33, C.C22 - C.C23 * C.C23 / C.C33
    return C._replace(C11=C11, C22=C22, C33=0.0, C12=C.C12 - C.C13 * C.C23 / C.C33, C13=0.0, C23=0.0)


@cache
def _largest_acoustic_eigenvalue(C: Stiffness, d: int) -> float:
    """Search by directions in one octant, which symmetry repeats; each round divides the distances by 16."""
    points, rounds = 33, 4
    middle, half = np.full(d - 1, 0.25 * math.pi), 0.25 * math.pi
    for _ in range(rounds):
        angles = np.stack(np.meshgrid(*(np.linspace(m - half, m + half, points) for m in middle)))
        angles = np.clip(angles.reshape(d - 1, -1), 0.0, 0.5 * math.pi)
        values = _acoustic_eigenvalues(C, angles)
        middle, half = angles[:, values.argmax()], 2.0 * half / (points - 1)
    return float(values.max())


def _acoustic_eigenvalues(C: Stiffness, angles: np.ndarray) -> np.ndarray:
    """Largest eigenvalues (n,) of acoustic tensors of directions with the angles (1 or 2, n)."""
    if len(angles) == 1:
        n = np.stack([np.cos(angles[0]), np.sin(angles[0]), np.zeros(angles.shape[1])])
    else:
        n = np.stack(
            [np.cos(angles[0]) * np.cos(angles[1]), np.sin(angles[0]) * np.cos(angles[1]), np.sin(angles[1])]
        )
    x, y, z = n * n
    Q = np.empty((angles.shape[1], 3, 3))
    Q[:, 0, 0] = C.C11 * x + C.G12 * y + C.G13 * z
    Q[:, 1, 1] = C.G12 * x + C.C22 * y + C.G23 * z
    Q[:, 2, 2] = C.G13 * x + C.G23 * y + C.C33 * z
    Q[:, 0, 1] = Q[:, 1, 0] = (C.C12 + C.G12) * n[0] * n[1]
    Q[:, 0, 2] = Q[:, 2, 0] = (C.C13 + C.G13) * n[0] * n[2]
    Q[:, 1, 2] = Q[:, 2, 1] = (C.C23 + C.G23) * n[1] * n[2]
    d = len(angles) + 1  # in the plane, motions across it are none
    return np.linalg.eigvalsh(Q[:, :d, :d])[:, -1]


@generic
def squared(m: Any, A: Any) -> Any:
    """AᵀA."""


@generic
def inverse_transposed(m: Any, A: Any) -> Any:
    """A⁻ᵀ."""


@generic
def carried(m: Any, A: Any, T: Any) -> Any:
    """A·T·Aᵀ."""


Numbers = TypeVar("Numbers", bound=type)


def in_space(numbers: Numbers) -> Numbers:
    """Class decorator of numbers of particles that deform in space."""

    @squared.register(numbers)
    def _(m: Any, A: Any) -> Any:
        return (
            A[0] * A[0] + A[3] * A[3] + A[6] * A[6],
            A[1] * A[1] + A[4] * A[4] + A[7] * A[7],
            A[2] * A[2] + A[5] * A[5] + A[8] * A[8],
            A[0] * A[1] + A[3] * A[4] + A[6] * A[7],
            A[1] * A[2] + A[4] * A[5] + A[7] * A[8],
            A[0] * A[2] + A[3] * A[5] + A[6] * A[8],
        )

    @inverse_transposed.register(numbers)
    def _(m: Any, A: Any) -> Any:
        return inverse_transpose(A)

    @carried.register(numbers)
    def _(m: Any, A: Any, T: Any) -> Any:
        return push_forward(A, T)

    return numbers


def in_plane(numbers: Numbers) -> Numbers:
    """Class decorator of numbers of particles that deform in the plane, which shortens the same functions."""

    @squared.register(numbers)
    def _(m: Any, A: Any) -> Any:
        xy = A[0] * A[1] + A[3] * A[4]
        return A[0] * A[0] + A[3] * A[3], A[1] * A[1] + A[4] * A[4], A[8] * A[8], xy, 0.0, 0.0

    @inverse_transposed.register(numbers)
    def _(m: Any, A: Any) -> Any:
        r = 1.0 / (A[0] * A[4] - A[1] * A[3])
        return r * A[4], -r * A[3], 0.0, -r * A[1], r * A[0], 0.0, 0.0, 0.0, 1.0 / A[8]

    @carried.register(numbers)
    def _(m: Any, A: Any, T: Any) -> Any:
        xx, xy = A[0] * T[0] + A[1] * T[3], A[0] * T[3] + A[1] * T[1]
        yx, yy = A[3] * T[0] + A[4] * T[3], A[3] * T[3] + A[4] * T[1]
        normal = (xx * A[0] + xy * A[1], yx * A[3] + yy * A[4], A[8] * A[8] * T[2])
        return normal[0], normal[1], normal[2], xx * A[3] + xy * A[4], 0.0, 0.0

    return numbers


@inline
def combine(a: float, X: Any, b: float, Y: Any) -> Any:
    """The tensor a X + b Y of six components."""
    return (
        a * X[0] + b * Y[0],
        a * X[1] + b * Y[1],
        a * X[2] + b * Y[2],
        a * X[3] + b * Y[3],
        a * X[4] + b * Y[4],
        a * X[5] + b * Y[5],
    )


@inline
def strain_of(m: Any, A: Any) -> Any:
    """E = ¼(AᵀA − (AᵀA)⁻¹)."""
    return combine(0.25, squared(m, A), -0.25, squared(m, inverse_transposed(m, A)))


@inline
def mean_metric(m: Any, A: Any) -> Any:
    """½(AᵀA + (AᵀA)⁻¹), in principal axes cosh(2 ln λ)."""
    return combine(0.5, squared(m, A), 0.5, squared(m, inverse_transposed(m, A)))


@inline
def extension_of(E: float) -> float:
    """The stretch λ > 0 with ¼(λ² − λ⁻²) = E."""
    root = math.sqrt(2.0 * abs(E) + math.sqrt(4.0 * E * E + 1.0))
    return root if E >= 0.0 else 1.0 / root


@inline
def times_stiffness(m: Any, E: Any) -> Any:
    """ℂ:E."""
    return (
        m.C11 * E[0] + m.C12 * E[1] + m.C13 * E[2],
        m.C12 * E[0] + m.C22 * E[1] + m.C23 * E[2],
        m.C13 * E[0] + m.C23 * E[1] + m.C33 * E[2],
        2.0 * m.G12 * E[3],
        2.0 * m.G23 * E[4],
        2.0 * m.G13 * E[5],
    )


@inline
def double_product(X: Any, Y: Any) -> float:
    """X:Y."""
    return X[0] * Y[0] + X[1] * Y[1] + X[2] * Y[2] + 2.0 * (X[3] * Y[3] + X[4] * Y[4] + X[5] * Y[5])


@inline
def push_stress(m: Any, A: Any, T: Any) -> Any:
    """Kirchhoff stress of T in material axes, and what the bound of ρ₀c² exceeds ``m.wave`` by [pressure].

    With F → (I + s v⊗n)F the second derivative of W is δE:ℂ:δE + nτ₁n − vτ₂v − 2(n·v)(vτ₂n), where τ₁ and τ₂ are the
    two parts of τ, and δE grows at most as the largest cosh(2 ln λ).
    """
    G = inverse_transposed(m, A)
    C, D = squared(m, A), squared(m, G)
    first, second = carried(m, A, T), carried(m, G, T)
    stretched = largest_eigenvalue_bound(combine(0.5, C, 0.5, D))
    pressed = largest_eigenvalue_bound(combine(0.5, first, -1.5, second))
    stiffer = m.wave * (stretched * stretched - 1.0) + max(0.0, pressed)
    return combine(0.5, first, 0.5, second), max(0.0, stiffer)


@inline
def stress_of(m: Any, A: Any) -> Any:
    """Kirchhoff stress at A, and what it adds to ρ₀c² (``push_stress``) [pressure]."""
    return push_stress(m, A, times_stiffness(m, strain_of(m, A)))


@inline
def minus(A: Any, X: Any, s: float) -> Any:
    """s A·(I − X) with a symmetric X."""
    B = multiply(A, (X[0], X[3], X[5], X[3], X[1], X[4], X[5], X[4], X[2]))
    return (
        s * (A[0] - B[0]), s * (A[1] - B[1]), s * (A[2] - B[2]),
        s * (A[3] - B[3]), s * (A[4] - B[4]), s * (A[5] - B[5]),
        s * (A[6] - B[6]), s * (A[7] - B[7]), s * (A[8] - B[8]),
    )  # fmt: skip


@inline
def deviator(X: Any) -> Any:
    """dev X."""
    mean = (X[0] + X[1] + X[2]) / 3.0
    return X[0] - mean, X[1] - mean, X[2] - mean, X[3], X[4], X[5]


@inline
def flowed(m: Any, A: Any, E: Any, X: Any) -> Any:
    """A of elastic strain E after the plastic strain X of the strain E + X, without change of volume.

    A·exp(½ ln AᵀA − E) has it if both have the same axes and E is small; one correction for the rest. Where E + X is
    small, it is taken for ½ ln AᵀA, which the correction covers too. The trace of the strain follows from the volume
    and the shape: what it exceeds that of E by comes second.
    """
    if double_product(X, X) > SMALL * SMALL:
        X = deviator(combine(0.5, log_symmetric(squared(m, A)), -1.0, E))
        e = exponential_symmetric((-X[0], -X[1], -X[2], -X[3], -X[4], -X[5]))
    else:
        X = deviator(X)
        X2 = multiply_commuting(X, X)
        e = combine(-1.0, X, 0.5, combine(1.0, X2, -1.0 / 3.0, multiply_commuting(X, X2)))
        e = (1.0 + e[0], 1.0 + e[1], 1.0 + e[2], e[3], e[4], e[5])
    B = multiply(A, (e[0], e[3], e[5], e[3], e[1], e[4], e[5], e[4], e[2]))
    Y = combine(1.0, strain_of(m, B), -1.0, E)
    dilation = Y[0] + Y[1] + Y[2]
    Y = deviator(Y)
    return minus(B, Y, 1.0 + double_product(Y, Y) / 6.0), dilation


@inline
def energy_of(m: Any, A: Any) -> float:
    """Stored energy per initial volume at A [pressure]."""
    E = strain_of(m, A)
    return 0.5 * double_product(E, times_stiffness(m, E))


@inline
def bulk_slope_of(m: Any, A: Any) -> float:
    """J²∂²W/∂J² at A [pressure], for changes of size without change of shape."""
    E, B = strain_of(m, A), mean_metric(m, A)
    T = times_stiffness(m, E)
    # dE/d ln J = B/3, d²E/d(ln J)² = 4E/9
    second = (double_product(B, times_stiffness(m, B)) + 4.0 * double_product(T, E)) / 9.0
    return second - double_product(T, B) / 3.0
