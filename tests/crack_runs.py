"""What tests and figures of cracks share: where matter is, and exact figures."""

from typing import Any

import numpy as np

from mpmcli.cracks.tips import REACH

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


def tip(run: Any, crack: int = 0, end: int = -1, ring: tuple[float, float] | None = None) -> Any:
    """J, K_I and K_II of a tip, over a ring of other radii if given [cells]."""
    tips = run.simulation.cracks.tips
    if ring is not None:
        cell = run.simulation.grid.cell[0]
        tips.inner, tips.outer = ring[0] * cell, ring[1] * cell
        tips._far, tips._reach = tips.outer, tips.outer + REACH * cell
        tips._found.clear()
    return tips.values(crack, end)


MODULUS = 1000.0 / (1.0 - 0.33**2)
"""E' of all scenes with static cracks [MPa]."""
CENTRE = 1.1862 * np.sqrt(5.0 * np.pi)
"""K_I of ``centre_crack.yaml`` (Tada, Paris and Irwin) [MPa √mm]."""
EDGE = 2.8266 * np.sqrt(5.0 * np.pi)
"""K_I of ``edge_crack.yaml``."""
INCLINED = 0.5 * np.sqrt(3.0 * np.pi)
"""K_I and K_II of ``inclined_crack.yaml`` in an infinite plate."""
CROSS = 0.8636 * np.sqrt(3.0 * np.pi)
"""K_I of ``crossing_cracks.yaml`` under biaxial tension in an infinite plate."""
PENNY = 2.0 * np.sqrt(4.0 / np.pi)
"""K_I of ``penny_crack.yaml`` in an infinite body."""


WEDGE_STIFFNESS, WEDGE_REACH = 2300.0 / (1.0 - 0.33**2) * 8.0**3 / 12.0, 0.669 * 8.0
"""E'I of an arm [N mm²] and χh [mm] of ``wedge_splitting.yaml``."""
WEDGE_MOMENT = np.sqrt(0.2 * WEDGE_STIFFNESS)
"""Moment at the tip of its crack at which M²/(E'I) is the toughness [N]."""
WEDGE_RATIO, WEDGE_FRICTION = (0.3 + 0.2) / (1.0 - 0.3 * 0.2), 0.2 * (1.0 + 0.3**2) / (0.3 + 0.2)
"""Half the force on the wedge over the force across an arm; share of its work that friction takes."""


def wedge_force(a: Array) -> Array:
    """Force on the wedge while its crack grows, by its length [N]; its half acts at half the height of an arm, too."""
    return np.asarray(2.0 * WEDGE_RATIO * WEDGE_MOMENT / (a + WEDGE_REACH - 4.0 * WEDGE_RATIO))


def wedge_opening(a: Array) -> Array:
    """Opening of each arm at the edge of the slot while the crack grows, by its length [mm]."""
    reach, across = a + WEDGE_REACH, wedge_force(a) / (2.0 * WEDGE_RATIO)
    return np.asarray(across * reach**2 * (reach / 3.0 - 2.0 * WEDGE_RATIO) / WEDGE_STIFFNESS)


def wedge_run(run: Any) -> Array:
    """Place of the wedge times its slope, length of the crack, force, work of the wedge and its parts, (9,).

    The parts: stored, kinetic, taken by friction, by damping, and released by growth.
    """
    state, p = run.simulation.state, run.particles
    block, view = p.body == 0, state.contact
    kinetic = 0.5 * float((p.mass * (p.V**2).sum(axis=0))[block].sum())
    parts = (run.strain_energy, kinetic, state.work["contact_work"], state.work["damping_work"])
    place, length = 0.3 * 1.25 * min(run.time, 2.0), 50.0 - chain(run).X[0, 0]
    force, released = abs(float(view.force[0, 0])), float(state.cracks.released[0])
    return np.array([place, length, force, view.rigid_work["wedge"], *parts, released])
