"""Particles at rest where tests place them."""

from typing import Any

import numpy as np

from mpmcli.core.particles import Particles


def particles_at(
    analysis: Any, X: np.ndarray, half: Any, vol0: Any = 1.0, mass: Any = 1.0, owner: Any = 0, **more: Any
) -> Particles:
    """Particles at ``X`` (d, N), with half sizes ``half`` that are one number or one per axis.

    ``owner`` is the number of body, material and velocity field; one number stands for all particles.
    """
    d, n = X.shape
    size = np.array(np.broadcast_to(np.reshape(half, (-1, 1)), (d, n)), dtype=float)
    vol0, mass = (np.array(np.broadcast_to(each, n), dtype=float) for each in (vol0, mass))
    owners = {name: np.array(np.broadcast_to(owner, n)) for name in ("body", "material", "velocity_field")}
    return Particles.at_rest(analysis, X, size, vol0, mass, **owners, **more)
