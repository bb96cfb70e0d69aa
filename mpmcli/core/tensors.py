"""Algebra of 3 x 3 tensors as tuples of numbers, for use inside kernels.

A general tensor is the 9-tuple of its rows (xx, xy, xz, yx, yy, yz, zx, zy, zz); a symmetric one the 6-tuple
(xx, yy, zz, xy, yz, xz). Components that are known to be zero when a kernel is compiled (2D and 1D analyses)
cost nothing: the compiler removes them.
"""

import math
from typing import TypeAlias

from mpmcli.core.compiled.kernel import inline

Tensor: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]
Symmetric: TypeAlias = tuple[float, float, float, float, float, float]
Vector: TypeAlias = tuple[float, float, float]

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
def from_eigenvalues(v: Vector, Q: Tensor) -> Symmetric:
    """The symmetric tensor with these eigenvalues, whose eigenvectors are the columns of Q."""
    x, y, z = v
    return (
        x * Q[0] * Q[0] + y * Q[1] * Q[1] + z * Q[2] * Q[2],
        x * Q[3] * Q[3] + y * Q[4] * Q[4] + z * Q[5] * Q[5],
        x * Q[6] * Q[6] + y * Q[7] * Q[7] + z * Q[8] * Q[8],
        x * Q[0] * Q[3] + y * Q[1] * Q[4] + z * Q[2] * Q[5],
        x * Q[3] * Q[6] + y * Q[4] * Q[7] + z * Q[5] * Q[8],
        x * Q[0] * Q[6] + y * Q[1] * Q[7] + z * Q[2] * Q[8],
    )


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
