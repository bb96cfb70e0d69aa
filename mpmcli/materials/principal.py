"""Principal logarithmic strains in descending order, and tensors from principal values."""

from __future__ import annotations

from typing import Any

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import logarithm
from mpmcli.core.tensors import eigen_symmetric


@inline
def principal_strains(b: Any) -> Any:
    """Principal values (ε₁ ≥ ε₂ ≥ ε₃) of ½ ln b, and the principal axes as the columns of a 9-tuple.

    The axes come from b − I, whose digits small strains do not lose. Equal values have any axes that are at right
    angles, which is all that ``from_principal`` needs.
    """
    v, Q = eigen_symmetric((b[0] - 1.0, b[1] - 1.0, b[2] - 1.0, b[3], b[4], b[5]))
    x, y, z = v
    ax, bx, cx, ay, by, cy, az, bz, cz = Q
    if x < y:
        x, y, ax, bx, ay, by, az, bz = y, x, bx, ax, by, ay, bz, az
    if y < z:
        y, z, bx, cx, by, cy, bz, cz = z, y, cx, bx, cy, by, cz, bz
    if x < y:
        x, y, ax, bx, ay, by, az, bz = y, x, bx, ax, by, ay, bz, az
    e = (0.5 * logarithm(1.0 + x), 0.5 * logarithm(1.0 + y), 0.5 * logarithm(1.0 + z))
    return e, (ax, bx, cx, ay, by, cy, az, bz, cz)


@inline
def from_principal(v: Any, Q: Any) -> Any:
    """The symmetric tensor, 6-tuple, with values ``v`` along the columns of ``Q``."""
    x, y, z = v
    return (
        x * Q[0] * Q[0] + y * Q[1] * Q[1] + z * Q[2] * Q[2],
        x * Q[3] * Q[3] + y * Q[4] * Q[4] + z * Q[5] * Q[5],
        x * Q[6] * Q[6] + y * Q[7] * Q[7] + z * Q[8] * Q[8],
        x * Q[0] * Q[3] + y * Q[1] * Q[4] + z * Q[2] * Q[5],
        x * Q[3] * Q[6] + y * Q[4] * Q[7] + z * Q[5] * Q[8],
        x * Q[0] * Q[6] + y * Q[1] * Q[7] + z * Q[2] * Q[8],
    )
