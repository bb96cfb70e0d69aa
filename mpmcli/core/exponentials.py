"""Exponentials and logarithms of numbers and of 3 x 3 tensors (``core.tensors``), for use inside kernels."""

import math

import numpy as np

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.tensors import (
    Symmetric,
    Tensor,
    determinant,
    eigen_symmetric,
    from_eigenvalues,
    multiply,
    multiply_commuting,
)

LN2 = math.log(2.0)
NEXT_WHOLE = 1.5 * 2.0**52
"""Added to a number and taken away again, it leaves the next whole number."""
SQRT_HALF_BITS = 0x3FE6A09E667F3BCD

SMALL_INCREMENT = 0.05
"""Exponentials of matrices none of whose members is larger have a series without cases."""

TERMS_OF_SMALL = tuple(np.uint64(n) for n in range(10))
"""As many terms behind the identity make the series of a 3 x 3 matrix exact to round-off up to ``SMALL_INCREMENT``."""

TINY_INCREMENT = 0.002
TERMS_OF_TINY = TERMS_OF_SMALL[:5]
"""The same for members up to ``TINY_INCREMENT``: (3 · 0.002)⁶/6! = 6e-17."""


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
    return k * LN2 + 2.0 * z * _artanh_ratio(z * z)


@inline
def _artanh_ratio(w: float) -> float:
    """artanh √w / √w by its series, exact to round-off for w ≤ 0.03, in pairs as in ``_small_exponential``."""
    w2 = w * w
    w4 = w2 * w2
    a = 1.0 / 3.0 + w * (1.0 / 5.0) + w2 * (1.0 / 7.0 + w * (1.0 / 9.0))
    b = 1.0 / 11.0 + w * (1.0 / 13.0) + w2 * (1.0 / 15.0 + w * (1.0 / 17.0))
    c = 1.0 / 19.0 + w * (1.0 / 21.0)
    return 1.0 + w * (a + w4 * (b + w4 * c))


@inline
def _small_artanh_ratio(w: float) -> float:
    """``_artanh_ratio`` for w ≤ 0.006."""
    w2 = w * w
    return 1.0 + w * (
        1.0 / 3.0
        + w * (1.0 / 5.0)
        + w2 * (1.0 / 7.0 + w * (1.0 / 9.0) + w2 * (1.0 / 11.0 + w * (1.0 / 13.0)))
    )


@inline
def logarithm_1p(y: float) -> float:
    """ln(1 + y) without loss of digits, sooner where |y| is small, as in elastic strains."""
    if abs(y) > 2.0 * SMALL_INCREMENT:
        return logarithm(1.0 + y)
    z = y / (2.0 + y)
    return 2.0 * z * _small_artanh_ratio(z * z)


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
def exponential_of_increment(x: float) -> float:
    """exp x by its series, exact to round-off for |x| ≤ ``SMALL_INCREMENT``, in pairs as in ``_small_exponential``."""
    x2 = x * x
    a = 1.0 / 24.0 + x * (1.0 / 120.0) + x2 * (1.0 / 720.0 + x * (1.0 / 5040.0) + x2 * (1.0 / 40320.0))
    return 1.0 + (x + x2 * (0.5 + x * (1.0 / 6.0) + x2 * a))


@inline
def exponential(x: float) -> float:
    """exp x, sooner where |x| is small, as in elastic strains."""
    return exponential_1d(x) if abs(x) > SMALL_INCREMENT else exponential_of_increment(x)


@inline
def exponential_2d(xx: float, xy: float, yx: float, yy: float) -> tuple[float, float, float, float]:
    """The exponential (xx, xy, yx, yy) of a 2 x 2 matrix A.

    exp A = eʰ [cosh √q I + (sinh √q / √q)(A - hI)] with h = tr A / 2 and q = ((xx - yy)/2)² + xy·yx. Both
    functions of q are entire: one series serves rotation (q < 0), shear (q = 0) and stretch (q > 0).
    """
    h = 0.5 * (xx + yy)
    d = 0.5 * (xx - yy)
    q = d * d + xy * yx
    if abs(h) <= SMALL_INCREMENT and abs(q) <= 2.0 * SMALL_INCREMENT**2:
        e = exponential_of_increment(h)
        q2 = q * q
        c = e + e * (q * 0.5 + q2 * (1.0 / 24.0 + q * (1.0 / 720.0) + q2 * (1.0 / 40320.0)))
        s = e + e * (q * (1.0 / 6.0) + q2 * (1.0 / 120.0 + q * (1.0 / 5040.0) + q2 * (1.0 / 362880.0)))
    elif abs(q) < 0.02:
        e = exponential_1d(h)
        q2 = q * q
        c = 1.0 / 24.0 + q * (1.0 / 720.0) + q2 * (1.0 / 40320.0 + q * (1.0 / 3628800.0))
        c = e + e * (q * 0.5 + q2 * c)
        s = 1.0 / 120.0 + q * (1.0 / 5040.0) + q2 * (1.0 / 362880.0 + q * (1.0 / 39916800.0))
        s = e + e * (q * (1.0 / 6.0) + q2 * s)
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
        return xx, yy, exponential(a[2]), xy, 0.0, 0.0
    E = exponential_3d((a[0], a[3], a[5], a[3], a[1], a[4], a[5], a[4], a[2]))
    return E[0], E[4], E[8], E[1], E[5], E[2]


@inline
def _log_block(xx: float, yy: float, xy: float) -> tuple[float, float, float]:
    """(xx, yy, xy) of the logarithm of a positive 2 x 2 tensor.

    ln b = ½ ln(det b) I + (artanh(r/m)/r)(b - mI), with m the mean and r half the difference of the
    eigenvalues.
    """
    m = 0.5 * (xx + yy)
    d = 0.5 * (xx - yy)
    x, y = xx - 1.0, yy - 1.0
    r2 = d * d + xy * xy
    w = r2 / (m * m)
    if abs(x) + abs(y) <= 2.0 * SMALL_INCREMENT and w <= 0.006:
        half_log = 0.5 * logarithm_1p(x + y + (x * y - xy * xy))
        f = _small_artanh_ratio(w) / m
    else:
        half_log = 0.5 * logarithm(xx * yy - xy * xy)
        if w > 0.01:
            r = math.sqrt(r2)
            f = (logarithm(m + r) - half_log) / r
        else:
            f = _artanh_ratio(w) / m
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
    return from_eigenvalues((logarithm(v[0]), logarithm(v[1]), logarithm(v[2])), Q)


@inline
def log_symmetric(b: Symmetric) -> Symmetric:
    """The logarithm of a positive symmetric tensor.

    A 2 x 2 block with zz has a closed form, a tensor near the identity a short series; else by eigenvalues.
    """
    if b[4] == 0.0 and b[5] == 0.0:
        xx, yy, xy = _log_block(b[0], b[1], b[3])
        return xx, yy, logarithm_1p(b[2] - 1.0), xy, 0.0, 0.0
    dx, dy, dz = b[0] - 1.0, b[1] - 1.0, b[2] - 1.0
    if dx * dx + dy * dy + dz * dz + 2.0 * (b[3] * b[3] + b[4] * b[4] + b[5] * b[5]) < 0.03:
        return _log_near_identity(b)
    return _log_by_eigenvalues(b)
