"""Algebra of 3 x 3 tensors as tuples of numbers, for use inside kernels.

A general tensor is the 9-tuple of its rows (xx, xy, xz, yx, yy, yz, zx, zy, zz); a symmetric one the 6-tuple
(xx, yy, zz, xy, yz, xz). Components that are known to be zero when a kernel is compiled (2D and 1D analyses)
cost nothing: the compiler removes them.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from mpmcli.core.kernel import inline

Tensor: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]
Symmetric: TypeAlias = tuple[float, float, float, float, float, float]
Vector: TypeAlias = tuple[float, float, float]

LN2 = math.log(2.0)
NEXT_WHOLE = 1.5 * 2.0**52
"""Added to a number and taken away again, it leaves the next whole number."""
SQRT_HALF_BITS = 0x3FE6A09E667F3BCD

SMALL_INCREMENT = 0.05
"""Exponentials of matrices none of whose members is larger have a series without cases."""

IDENTITY: Tensor = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@inline
def multiply(A: Tensor, B: Tensor) -> Tensor:
    """The product A·B."""
    return (
        A[0] * B[0] + A[1] * B[3] + A[2] * B[6],
        A[0] * B[1] + A[1] * B[4] + A[2] * B[7],
        A[0] * B[2] + A[1] * B[5] + A[2] * B[8],
        A[3] * B[0] + A[4] * B[3] + A[5] * B[6],
        A[3] * B[1] + A[4] * B[4] + A[5] * B[7],
        A[3] * B[2] + A[4] * B[5] + A[5] * B[8],
        A[6] * B[0] + A[7] * B[3] + A[8] * B[6],
        A[6] * B[1] + A[7] * B[4] + A[8] * B[7],
        A[6] * B[2] + A[7] * B[5] + A[8] * B[8],
    )


@inline
def determinant(A: Tensor) -> float:
    """det A."""
    return (
        A[0] * (A[4] * A[8] - A[5] * A[7])
        - A[1] * (A[3] * A[8] - A[5] * A[6])
        + A[2] * (A[3] * A[7] - A[4] * A[6])
    )


@inline
def inverse_transpose(A: Tensor) -> Tensor:
    """A⁻ᵀ, the matrix of cofactors over the determinant."""
    xx = A[4] * A[8] - A[5] * A[7]
    xy = A[5] * A[6] - A[3] * A[8]
    xz = A[3] * A[7] - A[4] * A[6]
    r = 1.0 / (A[0] * xx + A[1] * xy + A[2] * xz)
    return (
        r * xx,
        r * xy,
        r * xz,
        r * (A[2] * A[7] - A[1] * A[8]),
        r * (A[0] * A[8] - A[2] * A[6]),
        r * (A[1] * A[6] - A[0] * A[7]),
        r * (A[1] * A[5] - A[2] * A[4]),
        r * (A[2] * A[3] - A[0] * A[5]),
        r * (A[0] * A[4] - A[1] * A[3]),
    )


@inline
def inverse(A: Tensor) -> Tensor:
    """A⁻¹."""
    B = inverse_transpose(A)
    return (B[0], B[3], B[6], B[1], B[4], B[7], B[2], B[5], B[8])


@inline
def left_cauchy_green(F: Tensor) -> Symmetric:
    """b = F·Fᵀ."""
    return (
        F[0] * F[0] + F[1] * F[1] + F[2] * F[2],
        F[3] * F[3] + F[4] * F[4] + F[5] * F[5],
        F[6] * F[6] + F[7] * F[7] + F[8] * F[8],
        F[0] * F[3] + F[1] * F[4] + F[2] * F[5],
        F[3] * F[6] + F[4] * F[7] + F[5] * F[8],
        F[0] * F[6] + F[1] * F[7] + F[2] * F[8],
    )


@inline
def push_forward(A: Tensor, b: Symmetric) -> Symmetric:
    """A·b·Aᵀ for a symmetric b."""
    C = multiply(A, (b[0], b[3], b[5], b[3], b[1], b[4], b[5], b[4], b[2]))
    return (
        C[0] * A[0] + C[1] * A[1] + C[2] * A[2],
        C[3] * A[3] + C[4] * A[4] + C[5] * A[5],
        C[6] * A[6] + C[7] * A[7] + C[8] * A[8],
        C[0] * A[3] + C[1] * A[4] + C[2] * A[5],
        C[3] * A[6] + C[4] * A[7] + C[5] * A[8],
        C[0] * A[6] + C[1] * A[7] + C[2] * A[8],
    )


@inline
def multiply_commuting(a: Symmetric, b: Symmetric) -> Symmetric:
    """The product of two symmetric tensors with common axes, which is symmetric."""
    return (
        a[0] * b[0] + a[3] * b[3] + a[5] * b[5],
        a[3] * b[3] + a[1] * b[1] + a[4] * b[4],
        a[5] * b[5] + a[4] * b[4] + a[2] * b[2],
        a[0] * b[3] + a[3] * b[1] + a[5] * b[4],
        a[3] * b[5] + a[1] * b[4] + a[4] * b[2],
        a[0] * b[5] + a[3] * b[4] + a[5] * b[2],
    )


@inline
def logarithm(x: float) -> float:
    """ln x for positive x, without branches or a library call, so that loops over it vectorise.

    x = 2ᵏ m with m in [√½, √2), and ln m = 2 artanh z by its series, z = (m - 1)/(m + 1). The result is
    meaningless for x that is not finite or not positive.
    """
    bits = np.float64(x).view(np.int64)
    k = (bits - SQRT_HALF_BITS) >> 52
    m = np.int64(bits - (k << 52)).view(np.float64)
    z = (m - 1.0) / (m + 1.0)
    w = z * z
    s = 1.0 / 15.0 + w * (1.0 / 17.0 + w * (1.0 / 19.0 + w * (1.0 / 21.0)))
    s = 1.0 / 7.0 + w * (1.0 / 9.0 + w * (1.0 / 11.0 + w * (1.0 / 13.0 + w * s)))
    return k * LN2 + 2.0 * z * (1.0 + w * (1.0 / 3.0 + w * (1.0 / 5.0 + w * s)))


@inline
def exponential_1d(x: float) -> float:
    """exp x, without branches or a library call, so that loops over it vectorise.

    exp x = 2ᵏ exp r with k the whole number next to x/ln 2, and exp r by its series. Beyond the range of
    numbers the result is inf or 2⁻¹⁰²²; for NaN it is meaningless.
    """
    x = min(max(x, -708.0), 710.0)
    # k is in the last bits of what is so large that its spacing is 1
    shifted = np.float64(x * (1.0 / LN2) + NEXT_WHOLE)
    scale = np.int64((shifted.view(np.int64) + 1023) << 52).view(np.float64)
    return scale * _small_exponential(x - (shifted - NEXT_WHOLE) * LN2)


@inline
def _small_exponential(x: float) -> float:
    """exp x by its series, exact to round-off for |x| < 0.35.

    Pairs of terms, pairs of pairs and so on do not wait for each other, as those of Horner's scheme do.
    """
    x2 = x * x
    x4 = x2 * x2
    a = 1.0 / 24.0 + x * (1.0 / 120.0) + x2 * (1.0 / 720.0 + x * (1.0 / 5040.0))
    b = 1.0 / 40320.0 + x * (1.0 / 362880.0) + x2 * (1.0 / 3628800.0 + x * (1.0 / 39916800.0))
    c = 1.0 / 479001600.0 + x * (1.0 / 6227020800.0)
    return 1.0 + (x + (x2 * (0.5 + x * (1.0 / 6.0)) + x4 * (a + x4 * (b + x4 * c))))


@inline
def exponential_2d(xx: float, xy: float, yx: float, yy: float) -> tuple[float, float, float, float]:
    """The exponential (xx, xy, yx, yy) of a 2 x 2 matrix A.

    exp A = eʰ [cosh √q I + (sinh √q / √q)(A - hI)] with h = tr A / 2 and q = ((xx - yy)/2)² + xy·yx. Both
    functions of q are entire: one series serves rotation (q < 0), shear (q = 0) and stretch (q > 0).
    """
    h = 0.5 * (xx + yy)
    d = 0.5 * (xx - yy)
    q = d * d + xy * yx
    if abs(q) < 0.02:
        e = exponential_1d(h)
        c = 1.0 / 720.0 + q * (1.0 / 40320.0 + q * (1.0 / 3628800.0))
        c = e * (1.0 + q * (0.5 + q * (1.0 / 24.0 + q * c)))
        s = 1.0 / 5040.0 + q * (1.0 / 362880.0 + q * (1.0 / 39916800.0))
        s = e * (1.0 + q * (1.0 / 6.0 + q * (1.0 / 120.0 + q * s)))
    elif q > 0.0:
        root = math.sqrt(q)
        up = 0.5 * exponential_1d(h + root)
        down = 0.5 * exponential_1d(h - root)
        c, s = up + down, (up - down) / root
    else:
        root = math.sqrt(-q)
        e = exponential_1d(h)
        c, s = e * math.cos(root), e * math.sin(root) / root
    return c + s * d, s * xy, s * yx, c - s * d


@inline
def small_exponential_3d(A: Tensor) -> Tensor:
    """``exponential_3d`` without branches, for members up to ``SMALL_INCREMENT``.

    The trace is split off; the rest B is summed as a series in which the theorem of Cayley and Hamilton,
    B³ = I₃ I - I₂ B, keeps every power in the span of I, B and B².
    """
    h = (A[0] + A[4] + A[8]) / 3.0
    B = (A[0] - h, A[1], A[2], A[3], A[4] - h, A[5], A[6], A[7], A[8] - h)
    B2 = multiply(B, B)
    I2 = -0.5 * (B2[0] + B2[4] + B2[8])
    I3 = determinant(B)
    # Horner's rule on the coefficients of B², B and I: times B, plus 1/n!
    a, b, c = 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0
    a, b, c = b, c - a * I2, a * I3 + 1.0 / 5040.0
    a, b, c = b, c - a * I2, a * I3 + 1.0 / 720.0
    a, b, c = b, c - a * I2, a * I3 + 1.0 / 120.0
    a, b, c = b, c - a * I2, a * I3 + 1.0 / 24.0
    a, b, c = b, c - a * I2, a * I3 + 1.0 / 6.0
    a, b, c = b, c - a * I2, a * I3 + 0.5
    a, b, c = b, c - a * I2, a * I3 + 1.0
    a, b, c = b, c - a * I2, a * I3 + 1.0
    e = _small_exponential(h)
    a, b, c = e * a, e * b, e * c
    return (
        a * B2[0] + b * B[0] + c,
        a * B2[1] + b * B[1],
        a * B2[2] + b * B[2],
        a * B2[3] + b * B[3],
        a * B2[4] + b * B[4] + c,
        a * B2[5] + b * B[5],
        a * B2[6] + b * B[6],
        a * B2[7] + b * B[7],
        a * B2[8] + b * B[8] + c,
    )


@inline
def exponential_3d(A: Tensor) -> Tensor:
    """The exponential of a 3 x 3 matrix: halved until it is small, and squared back."""
    largest = max(
        abs(A[0]), abs(A[1]), abs(A[2]), abs(A[3]), abs(A[4]), abs(A[5]), abs(A[6]), abs(A[7]), abs(A[8])
    )
    r = 1.0
    halvings = 0
    while largest * r > SMALL_INCREMENT and halvings < 60:
        r *= 0.5
        halvings += 1
    E = small_exponential_3d(
        (r * A[0], r * A[1], r * A[2], r * A[3], r * A[4], r * A[5], r * A[6], r * A[7], r * A[8])
    )
    for _ in range(halvings):
        E = multiply(E, E)
    return E


@inline
def exponential_symmetric(a: Symmetric) -> Symmetric:
    """The exponential of a symmetric tensor."""
    if a[4] == 0.0 and a[5] == 0.0:
        xx, xy, _, yy = exponential_2d(a[0], a[3], a[3], a[1])
        return xx, yy, exponential_1d(a[2]), xy, 0.0, 0.0
    E = exponential_3d((a[0], a[3], a[5], a[3], a[1], a[4], a[5], a[4], a[2]))
    return E[0], E[4], E[8], E[1], E[5], E[2]


@inline
def _rotate(p: float, q: float, pq: float) -> tuple[float, float, float]:
    """Cosine, sine and tangent of the Jacobi rotation that removes the off-diagonal member ``pq``."""
    if pq == 0.0:
        return 1.0, 0.0, 0.0
    d = q - p
    root = math.sqrt(d * d + 4.0 * pq * pq)
    t = 2.0 * pq / (d + root) if d >= 0.0 else 2.0 * pq / (d - root)
    c = 1.0 / math.sqrt(1.0 + t * t)
    return c, t * c, t


@inline
def eigen_symmetric(b: Symmetric) -> tuple[Vector, Tensor]:
    """Eigenvalues, and eigenvectors as the columns of an orthogonal matrix, by cyclic Jacobi rotations.

    The values are not sorted. Equal and nearly equal values need no special case; a tensor that is a 2 x 2
    block and zz is solved by one rotation.
    """
    xx, yy, zz, xy, yz, xz = b
    ax, bx, cx, ay, by, cy, az, bz, cz = IDENTITY
    scale = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + xz * xz)
    for _ in range(20):
        if xy * xy + yz * yz + xz * xz <= 1e-34 * scale:
            break
        c, s, t = _rotate(xx, yy, xy)
        xx, yy, xy = xx - t * xy, yy + t * xy, 0.0
        xz, yz = c * xz - s * yz, s * xz + c * yz
        ax, bx, ay, by = c * ax - s * bx, s * ax + c * bx, c * ay - s * by, s * ay + c * by
        az, bz = c * az - s * bz, s * az + c * bz
        c, s, t = _rotate(xx, zz, xz)
        xx, zz, xz = xx - t * xz, zz + t * xz, 0.0
        xy, yz = c * xy - s * yz, s * xy + c * yz
        ax, cx, ay, cy = c * ax - s * cx, s * ax + c * cx, c * ay - s * cy, s * ay + c * cy
        az, cz = c * az - s * cz, s * az + c * cz
        c, s, t = _rotate(yy, zz, yz)
        yy, zz, yz = yy - t * yz, zz + t * yz, 0.0
        xy, xz = c * xy - s * xz, s * xy + c * xz
        bx, cx, by, cy = c * bx - s * cx, s * bx + c * cx, c * by - s * cy, s * by + c * cy
        bz, cz = c * bz - s * cz, s * bz + c * cz
    return (xx, yy, zz), (ax, bx, cx, ay, by, cy, az, bz, cz)


@inline
def largest_eigenvalue_bound(b: Symmetric) -> float:
    """An upper bound of the largest eigenvalue (Gershgorin), exact for diagonal tensors."""
    xy, yz, xz = abs(b[3]), abs(b[4]), abs(b[5])
    return max(b[0] + xy + xz, b[1] + xy + yz, b[2] + xz + yz)


@inline
def smallest_eigenvalue_bound(b: Symmetric) -> float:
    """A lower bound of the smallest eigenvalue (Gershgorin), exact for diagonal tensors."""
    xy, yz, xz = abs(b[3]), abs(b[4]), abs(b[5])
    return min(b[0] - xy - xz, b[1] - xy - yz, b[2] - xz - yz)


@inline
def _log_block(xx: float, yy: float, xy: float) -> tuple[float, float, float]:
    """(xx, yy, xy) of the logarithm of a positive 2 x 2 tensor.

    ln b = ½ ln(det b) I + (artanh(r/m)/r)(b - mI), with m the mean and r half the difference of the
    eigenvalues.
    """
    m = 0.5 * (xx + yy)
    d = 0.5 * (xx - yy)
    half_log = 0.5 * logarithm(xx * yy - xy * xy)
    r2 = d * d + xy * xy
    w = r2 / (m * m)
    if w > 0.01:
        r = math.sqrt(r2)
        f = (logarithm(m + r) - half_log) / r
    else:
        f = 1.0 / 9.0 + w * (1.0 / 11.0 + w * (1.0 / 13.0 + w * (1.0 / 15.0 + w * (1.0 / 17.0))))
        f = (1.0 + w * (1.0 / 3.0 + w * (1.0 / 5.0 + w * (1.0 / 7.0 + w * f)))) / m
    return half_log + f * d, half_log - f * d, f * xy


@inline
def _log_near_identity(b: Symmetric) -> Symmetric:
    """ln b = 2 artanh Z with Z = (b - I)(b + I)⁻¹, as the series 2Z (I + W/3 + W²/5 + …), W = Z²."""
    xx, yy, zz, xy, yz, xz = b[0] + 1.0, b[1] + 1.0, b[2] + 1.0, b[3], b[4], b[5]
    cxx, cxy, cxz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    r = 1.0 / (xx * cxx + xy * cxy + xz * cxz)
    # (b - I)(b + I)⁻¹ = I - 2 (b + I)⁻¹ would cancel: multiply instead
    C = (r * cxx, r * (xx * zz - xz * xz), r * (xx * yy - xy * xy), r * cxy, r * (xy * xz - xx * yz), r * cxz)
    Z = multiply_commuting((b[0] - 1.0, b[1] - 1.0, b[2] - 1.0, xy, yz, xz), C)
    W = multiply_commuting(Z, Z)
    W2 = multiply_commuting(W, W)
    I1 = W[0] + W[1] + W[2]
    I2 = 0.5 * (I1 * I1 - (W2[0] + W2[1] + W2[2]))
    I3 = (
        W[0] * (W[1] * W[2] - W[4] * W[4])
        - W[3] * (W[3] * W[2] - W[4] * W[5])
        + W[5] * (W[3] * W[4] - W[1] * W[5])
    )
    # Horner's rule on the coefficients of W², W and I
    p, q, s = 1.0 / 17.0, 1.0 / 15.0, 1.0 / 13.0
    p, q, s = p * I1 + q, s - p * I2, p * I3 + 1.0 / 11.0
    p, q, s = p * I1 + q, s - p * I2, p * I3 + 1.0 / 9.0
    p, q, s = p * I1 + q, s - p * I2, p * I3 + 1.0 / 7.0
    p, q, s = p * I1 + q, s - p * I2, p * I3 + 1.0 / 5.0
    p, q, s = p * I1 + q, s - p * I2, p * I3 + 1.0 / 3.0
    p, q, s = p * I1 + q, s - p * I2, p * I3 + 1.0
    p, q, s = 2.0 * p, 2.0 * q, 2.0 * s
    P = (
        p * W2[0] + q * W[0] + s,
        p * W2[1] + q * W[1] + s,
        p * W2[2] + q * W[2] + s,
        p * W2[3] + q * W[3],
        p * W2[4] + q * W[4],
        p * W2[5] + q * W[5],
    )
    return multiply_commuting(Z, P)


@inline
def _log_by_eigenvalues(b: Symmetric) -> Symmetric:
    """ln b from eigenvalues and eigenvectors."""
    v, Q = eigen_symmetric(b)
    x, y, z = logarithm(v[0]), logarithm(v[1]), logarithm(v[2])
    return (
        x * Q[0] * Q[0] + y * Q[1] * Q[1] + z * Q[2] * Q[2],
        x * Q[3] * Q[3] + y * Q[4] * Q[4] + z * Q[5] * Q[5],
        x * Q[6] * Q[6] + y * Q[7] * Q[7] + z * Q[8] * Q[8],
        x * Q[0] * Q[3] + y * Q[1] * Q[4] + z * Q[2] * Q[5],
        x * Q[3] * Q[6] + y * Q[4] * Q[7] + z * Q[5] * Q[8],
        x * Q[0] * Q[6] + y * Q[1] * Q[7] + z * Q[2] * Q[8],
    )


@inline
def log_symmetric(b: Symmetric) -> Symmetric:
    """The logarithm of a positive symmetric tensor.

    A 2 x 2 block with zz has a closed form, a tensor near the identity a short series; else by eigenvalues.
    """
    if b[4] == 0.0 and b[5] == 0.0:
        xx, yy, xy = _log_block(b[0], b[1], b[3])
        return xx, yy, logarithm(b[2]), xy, 0.0, 0.0
    dx, dy, dz = b[0] - 1.0, b[1] - 1.0, b[2] - 1.0
    if dx * dx + dy * dy + dz * dz + 2.0 * (b[3] * b[3] + b[4] * b[4] + b[5] * b[5]) < 0.03:
        return _log_near_identity(b)
    return _log_by_eigenvalues(b)
