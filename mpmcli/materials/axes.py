"""Material axes of a particle: the rotation R from the grid's axes at the start, as rows of the history.

Column i of R is material axis i. Elastic materials keep R as a unit quaternion.
"""

from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.particles import Particles

Array = np.ndarray

QUATERNION = ("axes_w", "axes_x", "axes_y", "axes_z")
"""Names of the rows: cos(φ/2) and sin(φ/2) times the axis of the rotation by φ; in the plane only w and z count."""
GRADIENT = tuple(f"axes_{row}{column}" for row in "xyz" for column in "xyz")
"""Names of the rows of materials that keep Fᵉ·R, row by row."""


def quaternion_of(axis: Array, degrees: Array) -> Array:
    """Unit quaternions (4, n) of rotations by angles (n,) about an axis (3,) of any length."""
    half = 0.5 * np.radians(degrees)
    return np.stack([np.cos(half), *np.multiply.outer(axis / np.linalg.norm(axis), np.sin(half))])


def multiply_quaternions(a: Array, b: Array) -> Array:
    """Rotation ``b``, then ``a``, (4, n) each."""
    return np.stack(
        [
            a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
        ]
    )


@inline
def turn_in_space(F: Any, w: float, x: float, y: float, z: float) -> Any:
    """F·R with the unit quaternion (w, x, y, z) of R."""
    xx, xy, xz = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    yx, yy, yz = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    zx, zy, zz = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
    return (
        F[0] * xx + F[1] * yx + F[2] * zx,
        F[0] * xy + F[1] * yy + F[2] * zy,
        F[0] * xz + F[1] * yz + F[2] * zz,
        F[3] * xx + F[4] * yx + F[5] * zx,
        F[3] * xy + F[4] * yy + F[5] * zy,
        F[3] * xz + F[4] * yz + F[5] * zz,
        F[6] * xx + F[7] * yx + F[8] * zx,
        F[6] * xy + F[7] * yy + F[8] * zy,
        F[6] * xz + F[7] * yz + F[8] * zz,
    )


@inline
def turn_in_plane(F: Any, w: float, z: float) -> Any:
    """The same about z, of what deforms in the plane."""
    c, s = 1.0 - 2.0 * z * z, 2.0 * w * z
    return (
        F[0] * c + F[1] * s, F[1] * c - F[0] * s, 0.0,
        F[3] * c + F[4] * s, F[4] * c - F[3] * s, 0.0,
        0.0, 0.0, F[8],
    )  # fmt: skip


def rotation_matrix(q: Array) -> Array:
    """R (9, n), row by row, of unit quaternions (4, n)."""
    one, none = np.ones_like(q[0]), np.zeros_like(q[0])
    identity = (one, none, none, none, one, none, none, none, one)
    return np.stack(turn_in_space.py_func(identity, *q))


def current_axis(particles: Particles, models: list[Any]) -> Array:
    """Unit vectors (3, N) along material axis 1, carried with the particles; 0 in isotropic materials."""
    found = np.zeros((3, particles.count))
    for index, model in enumerate(models):
        if model.has_axes:
            mine = np.flatnonzero(particles.material == index)
            axis = model.carried_axis(particles.H[:, mine], full_gradient(particles.F[:, mine]))
            found[:, mine] = axis / np.linalg.norm(axis, axis=0)
    return found


def full_gradient(F: Array) -> Array:
    """Nine components (9, n) of the stored ones."""
    if F.shape[0] == 9:
        return F
    full = np.zeros((9, F.shape[1]))
    full[[0, 4, 8] if F.shape[0] == 3 else [0, 1, 3, 4, 8]] = F
    return full
