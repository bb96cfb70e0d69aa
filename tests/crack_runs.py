"""What tests and figures of cracks share: where matter is, and exact figures."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray


def spin(run: Any) -> Array:
    """Kinetic energy in the frame of the centre of mass, angular momentum about it, and total energy there, (3,)."""
    p = run.particles
    at, moving = ((p.mass * a).sum(axis=1)[:, None] / p.mass.sum() for a in (p.X, p.V))
    X, V = p.X - at, p.V - moving
    kinetic = 0.5 * float((p.mass * (V**2).sum(axis=0)).sum())
    return np.array([kinetic, (p.mass * (X[0] * V[1] - X[1] * V[0])).sum(), kinetic + run.strain_energy])


def places(run: Any, X0: Array, reach: float) -> Array:
    """Where points (2, n) of the matter are, by the affine motion of the particles within ``reach`` of each."""
    found = []
    for x in X0.T:
        near = np.hypot(*(run.X0 - x[:, None])) < reach
        terms = np.vstack([run.X0[:, near], np.ones(near.sum())]).T
        found.append(np.append(x, 1.0) @ np.linalg.lstsq(terms, run.X[:, near].T, rcond=None)[0])
    return np.array(found).T


def chain(run: Any, crack: int = 0) -> Any:
    """The chain of a crack."""
    return run.simulation.cracks.chains[crack]


def largest_openings(run: Any, crack: int = 0) -> Array:
    """Largest opening and largest slip of a crack [cells], (2,)."""
    cell = run.simulation.grid.cell[0]
    return np.array([np.abs(opening).max() / cell for opening in chain(run, crack).openings])
