"""Directions of many points at once, and those across them."""

import numpy as np

Array = np.ndarray


def unit_vectors(v: Array) -> Array:
    """Vectors (d, n) of length 1; those that are zero but for round-off stay zero."""
    length = np.sqrt((v**2).sum(axis=0))
    return np.where(length > 1e-9, v / np.maximum(length, 1e-9), 0.0)


def perpendicular(n: Array) -> list[Array]:
    """Unit vectors (d, n) across ``n``: one in the plane, two in space."""
    if len(n) == 2:
        return [np.stack([-n[1], n[0]])]
    axis = np.eye(3)[np.abs(n).argmin(axis=0)].T
    first = unit_vectors(np.cross(n, axis, axis=0))
    return [first, np.cross(n, first, axis=0)]


def normal_across(chords: list[Array]) -> Array:
    """Unit vectors across chords (d, n) along what ``perpendicular`` gives."""
    first = chords[0] / np.maximum(np.abs(chords[0]).max(axis=0), 1e-300)
    if len(first) == 2:
        return unit_vectors(np.stack([first[1], -first[0]]))
    return unit_vectors(
        np.cross(first, chords[1] / np.maximum(np.abs(chords[1]).max(axis=0), 1e-300), axis=0)
    )
