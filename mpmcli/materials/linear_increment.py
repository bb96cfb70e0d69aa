"""Linear increments of the deformation gradient: rates of which I + L Δt is the exponential."""

from typing import Any

from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.tensors import inverse, multiply


@inline
def logarithm_of_one_plus(x: float) -> float:
    """ln(1 + x) by its Padé approximant [2/2], with an error of x⁵/180; finite for every x."""
    return x * (6.0 + 3.0 * x) / (6.0 + 6.0 * x + x * x)


@inline
def in_plane(xx: float, xy: float, yx: float, yy: float) -> Any:
    """The same of I + A in the plane, where all functions of A are sums of A and I (Cayley and Hamilton)."""
    trace, determinant = xx + yy, xx * yy - xy * yx
    # (a A + b I) / (c I + e A)
    a, b, c, e = 6.0 + 3.0 * trace, -3.0 * determinant, 6.0 - determinant, 6.0 + trace
    below = 1.0 / (c * c + c * e * trace + e * e * determinant)
    p, q = (a * c - b * e) * below, (b * (c + e * trace) + a * e * determinant) * below
    return p * xx + q, p * xy, p * yx, p * yy + q


@inline
def in_space(A: Any) -> Any:
    """The same of I + A in space."""
    B = multiply(A, A)
    above = (
        6.0 * A[0] + 3.0 * B[0], 6.0 * A[1] + 3.0 * B[1], 6.0 * A[2] + 3.0 * B[2],
        6.0 * A[3] + 3.0 * B[3], 6.0 * A[4] + 3.0 * B[4], 6.0 * A[5] + 3.0 * B[5],
        6.0 * A[6] + 3.0 * B[6], 6.0 * A[7] + 3.0 * B[7], 6.0 * A[8] + 3.0 * B[8],
    )  # fmt: skip
    below = (
        6.0 + 6.0 * A[0] + B[0], 6.0 * A[1] + B[1], 6.0 * A[2] + B[2],
        6.0 * A[3] + B[3], 6.0 + 6.0 * A[4] + B[4], 6.0 * A[5] + B[5],
        6.0 * A[6] + B[6], 6.0 * A[7] + B[7], 6.0 + 6.0 * A[8] + B[8],
    )  # fmt: skip
    return multiply(above, inverse(below))


@inline
def increment_of(L: Any, p: Any, dt: Any) -> Any:
    """A = L dt of a particle in space."""
    return (L[0, p] * dt, L[1, p] * dt, L[2, p] * dt, L[3, p] * dt, L[4, p] * dt, L[5, p] * dt, L[6, p] * dt,
            L[7, p] * dt, L[8, p] * dt)  # fmt: skip


@inline
def store(A: Any, dt: Any, L: Any, p: Any) -> None:
    """Write A/dt in space."""
    L[0, p], L[1, p], L[2, p] = A[0] / dt, A[1] / dt, A[2] / dt
    L[3, p], L[4, p], L[5, p] = A[3] / dt, A[4] / dt, A[5] / dt
    L[6, p], L[7, p], L[8, p] = A[6] / dt, A[7] / dt, A[8] / dt


@kernel
def find_linear_rates(L, dt, rates):
    """``rates`` = ln(I + ``L`` dt)/dt of every particle, both (rows, N) [1/time], with that of the hoop."""
    rows = L.shape[0]
    for p in prange(L.shape[1]):
        if rows == 1:
            rates[0, p] = logarithm_of_one_plus(L[0, p] * dt) / dt
        elif rows < 9:
            A = in_plane(L[0, p] * dt, L[1, p] * dt, L[2, p] * dt, L[3, p] * dt)
            rates[0, p], rates[1, p], rates[2, p], rates[3, p] = A[0] / dt, A[1] / dt, A[2] / dt, A[3] / dt
            if rows == 5:
                rates[4, p] = logarithm_of_one_plus(L[4, p] * dt) / dt
        else:
            store(in_space(increment_of(L, p, dt)), dt, rates, p)


@kernel
def follow_motion(L, dt):
    """L ← L (I + L dt)⁻¹, (rows, N) [1/time]: the gradient of the same velocities at the end of a step."""
    rows = L.shape[0]
    for p in prange(L.shape[1]):
        if rows == 1:
            L[0, p] /= 1.0 + L[0, p] * dt
        elif rows < 9:
            trace, determinant = (L[0, p] + L[3, p]) * dt, (L[0, p] * L[3, p] - L[1, p] * L[2, p]) * dt
            below = 1.0 / (1.0 + trace + determinant * dt)
            L[0, p], L[3, p] = (L[0, p] + determinant) * below, (L[3, p] + determinant) * below
            L[1, p], L[2, p] = L[1, p] * below, L[2, p] * below
            if rows == 5:
                L[4, p] /= 1.0 + L[4, p] * dt
        else:
            A = increment_of(L, p, dt)
            linear = (1.0 + A[0], A[1], A[2], A[3], 1.0 + A[4], A[5], A[6], A[7], 1.0 + A[8])
            store(multiply(A, inverse(linear)), dt, L, p)
