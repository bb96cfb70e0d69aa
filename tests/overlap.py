"""How far bodies have gone into each other: particle centres that lie in the domains of other bodies' particles."""

from itertools import product

import numpy as np

Array = np.ndarray


def find_overlapping(X: Array, F: Array, size: Array, body: Array) -> Array:
    """Which particles have their centre inside the deformed domain of a particle of another body.

    A centre that is inside has gone half a particle too far. The domain of particle q is the parallelogram (2D), the
    interval or the parallelepiped of all points X_q + F_q ξ with |ξ_a| < R_a.

    Parameters
    ----------
    X
        (d, N) positions [length].
    F
        (d, d, N) deformation gradients in the axes of the analysis [-].
    size
        (d, N) half sizes R of the undeformed particles [length].
    body
        (N,) index of the body of each particle.

    Returns
    -------
    (N,) booleans.
    """
    d, count = X.shape
    found = np.zeros(count, dtype=bool)
    if count == 0:
        return found
    inverse = np.linalg.inv(np.moveaxis(F, 2, 0))
    reach = np.einsum("ijn,jn->in", np.abs(F), size)
    bin_size = reach.max(axis=1)
    cell = np.floor((X - X.min(axis=1)[:, None]) / bin_size[:, None]).astype(np.int64) + 1
    shape = cell.max(axis=1) + 2
    stride = np.concatenate([[1], np.cumprod(shape[:-1])])
    key = stride @ cell
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    for shift in product((-1, 0, 1), repeat=d):
        wanted = key + stride @ np.array(shift)
        first = np.searchsorted(ordered, wanted, side="left")
        number = np.searchsorted(ordered, wanted, side="right") - first
        p = np.repeat(np.arange(count), number)
        start = np.repeat(first - np.concatenate([[0], np.cumsum(number)[:-1]]), number)
        q = order[start + np.arange(len(p))]
        other = body[p] != body[q]
        p, q = p[other], q[other]
        local = np.einsum("nij,jn->in", inverse[q], X[:, p] - X[:, q]) / size[:, q]
        found[p[(np.abs(local) < 1.0).all(axis=0)]] = True
    return found
