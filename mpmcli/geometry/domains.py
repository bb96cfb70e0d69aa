"""Finding the particle in whose domain (a box around it) a point lies."""

from itertools import product

import numpy as np

Array = np.ndarray


def in_a_domain(points: Array, X: Array, size: Array, margin: float = 1e-9) -> Array:
    """Tell which points lie in the domain of any particle.

    Parameters
    ----------
    points : (d, m) coordinates [length]
    X, size : (d, n) centres and half-sizes of the particles' domains [length]
    margin : by how much the domains are widened, in sizes

    Returns
    -------
    (m,) booleans
    """
    d, m = points.shape
    inside = np.zeros(m, dtype=bool)
    if X.shape[1] == 0 or m == 0:
        return inside
    # bins as wide as the largest domain: the particle that covers a point is in the point's bin or next to it
    width = 2 * size.max(axis=1) * (1 + 2 * margin)
    low = X.min(axis=1)
    bins = np.floor((X - low[:, None]) / width[:, None]).astype(np.int64)
    count = bins.max(axis=1) + 1
    stride = np.concatenate([[1], np.cumprod(count[:-1] + 2)])
    key = stride @ (bins + 1)
    order = np.argsort(key, kind="stable")
    key = key[order]
    position = np.floor((points - low[:, None]) / width[:, None])
    near = np.flatnonzero(((position >= -1) & (position <= count[:, None])).all(axis=0))
    of_point = position[:, near].astype(np.int64)
    for offset in product((0, -1, 1), repeat=d):
        neighbour = of_point + np.array(offset)[:, None]
        valid = ((neighbour >= 0) & (neighbour < count[:, None])).all(axis=0) & ~inside[near]
        candidates = near[valid]
        wanted = stride @ (neighbour[:, valid] + 1)
        first = np.searchsorted(key, wanted, side="left")
        last = np.searchsorted(key, wanted, side="right")
        for depth in range(int((last - first).max(initial=0))):
            at = np.flatnonzero(first + depth < last)
            particle, query = order[first[at] + depth], candidates[at]
            reach = (1 + margin) * size[:, particle]
            inside[query] |= (np.abs(points[:, query] - X[:, particle]) <= reach).all(axis=0)
    return inside
