"""Particles by identity: sorting moves them in memory, their identities stay."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def by_identity(identity: Array, values: Array) -> Array:
    """Return rows of ``values`` (…, N) in the order of identities (N,); NaN where a particle is gone."""
    ordered = np.full((*values.shape[:-1], int(identity.max(initial=-1)) + 1), np.nan)
    ordered[..., identity] = values
    return ordered


def place_of_identity(identity: Array, least: int = 0) -> Array:
    """Return the place in memory of each identity, −1 if it is gone; ``identity`` (N,), at least ``least`` long."""
    place = np.full(max(int(identity.max(initial=-1)) + 1, least), -1, dtype=np.int64)
    place[identity] = np.arange(len(identity))
    return place
