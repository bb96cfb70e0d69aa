"""Particles by identity: sorting moves them in memory, their identities stay."""

import numpy as np

Array = np.ndarray


def by_identity(identity: Array, values: Array) -> Array:
    """Return rows of ``values`` (…, N) in the order of identities (N,); NaN where a particle is gone."""
    ordered = np.full((*values.shape[:-1], int(identity.max(initial=-1)) + 1), np.nan)
    ordered[..., identity] = values
    return ordered


def place_of_identity(identity: Array, asked: Array) -> Array:
    """Return the place in memory of each identity, −1 if it is gone; as long as the highest identity asks for.

    Parameters
    ----------
    identity
        (N,) of the particles that exist.
    asked
        Identities that the result is asked for; those of the highest number may all be gone.
    """
    highest = max(int(identity.max(initial=-1)), int(asked.max(initial=-1)))
    place = np.full(highest + 1, -1, dtype=np.int64)
    place[identity] = np.arange(len(identity))
    return place
