"""The faces of a body: particles that have no neighbour of the same body on one side."""

import numpy as np

from mpmcli.geometry.domains import in_a_domain

Array = np.ndarray


def surface_faces(X: Array, size: Array, axis: int, side: str, members: Array | None = None) -> Array:
    """Find the particles that show a face towards one side of an axis.

    A particle has a neighbour if the point half a half-size beyond its own domain lies in that of another
    particle of the body. Meant for set-up, where the domains are not deformed.

    Parameters
    ----------
    X, size : (d, n) positions and half-sizes of the domains [length]
    axis : 0, 1 or 2
    side : ``lower`` or ``upper``
    members : (n,) mask of the body's particles, or their indices; all particles by default

    Returns
    -------
    (m,) indices of the particles, ascending
    """
    if side not in ("lower", "upper"):
        raise ValueError(f"side must be lower or upper, not '{side}'")
    d, n = X.shape
    if not 0 <= axis < d:
        raise ValueError(f"there is no axis {axis} in {d}D")
    if members is None:
        members = np.arange(n)
    elif members.dtype == bool:
        members = np.flatnonzero(members)
    if len(members) == 0:
        return members
    X, size = X[:, members], size[:, members]
    beside = X.copy()
    beside[axis] += (1.5 if side == "upper" else -1.5) * size[axis]
    return np.sort(members[~in_a_domain(beside, X, size)])
