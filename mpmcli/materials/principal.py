"""Principal logarithmic strains in descending order, and tensors from principal values."""

import math
from typing import Any

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import logarithm_1p
from mpmcli.core.tensors import eigen_symmetric, from_eigenvalues


@generic
def principal_strains(m: Any, b: Any) -> Any:
    """Principal values (ε₁ ≥ ε₂ ≥ ε₃) of ½ ln b, those of b, and what ``from_principal`` needs to know of the axes.

    The axes come from b − I, whose digits small strains do not lose. Equal values have any axes that are at right
    angles, which is all that ``from_principal`` needs.
    """


@generic
def from_principal(m: Any, v: Any, axes: Any) -> Any:
    """The symmetric tensor, 6-tuple, with values ``v`` along the axes."""


def strains_in_space(m: Any, b: Any) -> Any:
    """``principal_strains``; the axes are the columns of a 9-tuple."""
    v, Q = eigen_symmetric((b[0] - 1.0, b[1] - 1.0, b[2] - 1.0, b[3], b[4], b[5]))
    x, y, z = v
    ax, bx, cx, ay, by, cy, az, bz, cz = Q
    if x < y:
        x, y, ax, bx, ay, by, az, bz = y, x, bx, ax, by, ay, bz, az
    if y < z:
        y, z, bx, cx, by, cy, bz, cz = z, y, cx, bx, cy, by, cz, bz
    if x < y:
        x, y, ax, bx, ay, by, az, bz = y, x, bx, ax, by, ay, bz, az
    e = (0.5 * logarithm_1p(x), 0.5 * logarithm_1p(y), 0.5 * logarithm_1p(z))
    return e, (1.0 + x, 1.0 + y, 1.0 + z), (ax, bx, cx, ay, by, cy, az, bz, cz)


def tensor_of_space(m: Any, v: Any, axes: Any) -> Any:
    """``from_principal`` by the columns of a 9-tuple."""
    return from_eigenvalues(v, axes)


@inline
def principal_in_plane(a: Any) -> Any:
    """Principal values of a tensor without shear across the plane, in descending order, and its axes.

    Of the axes, cosine and sine of twice the angle from x, and whether z is first or last.
    """
    xx, yy, zz, xy, _, _ = a
    mean, d = 0.5 * (xx + yy), 0.5 * (xx - yy)
    r = math.sqrt(d * d + xy * xy)
    s = 1.0 / max(r, 1e-300)
    high, low = mean + r, mean - r
    values = (max(high, zz), max(low, min(high, zz)), min(low, zz))
    return values, (s * d, s * xy, zz > high, zz < low)


def strains_in_plane(m: Any, b: Any) -> Any:
    """``principal_strains``; the axes are those of ``principal_in_plane``."""
    v, axes = principal_in_plane((b[0] - 1.0, b[1] - 1.0, b[2] - 1.0, b[3], 0.0, 0.0))
    e = (0.5 * logarithm_1p(v[0]), 0.5 * logarithm_1p(v[1]), 0.5 * logarithm_1p(v[2]))
    return e, (1.0 + v[0], 1.0 + v[1], 1.0 + v[2]), axes


def tensor_of_plane(m: Any, v: Any, axes: Any) -> Any:
    """``from_principal`` by what ``strains_in_plane`` finds."""
    x, y, z = v
    c, s, first, last = axes
    high, low = y if first else x, y if last else z
    zz = x if first else z if last else y
    mean, half = 0.5 * (high + low), 0.5 * (high - low)
    return mean + half * c, mean - half * c, zz, half * s, 0.0, 0.0
