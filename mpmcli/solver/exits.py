"""Particles that left the domain: the policies ``error``, ``delete`` and ``stop_at_wall``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmcli.core.errors import SimulationError

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation


def settle_exits(s: Simulation) -> None:
    """Apply the scene's policy to every particle outside the grid.

    Energy that the walls or the deletion take away counts as (negative) ``boundary_work``.
    """
    p, grid = s.particles, s.grid
    lower, upper = grid.lower[:, None], grid.upper[:, None]
    below, above = lower > p.X, upper < p.X
    inside = ~np.any(below | above, axis=0)
    gone = np.flatnonzero(~inside)
    if len(gone) == 0:
        return
    if s.on_exit == "stop_at_wall":
        low, high = below[:, gone], above[:, gone]
        p.X[:, gone] = np.clip(p.X[:, gone], lower, upper)
        matter = without_rigid(s, gone)
        before = kinetic_energy(s, matter)
        outward = (low & (p.V[:, gone] < 0.0)) | (high & (p.V[:, gone] > 0.0))
        p.V[:, gone] = np.where(outward, 0.0, p.V[:, gone])
        s.state.work["boundary_work"] -= before - kinetic_energy(s, matter)
    elif s.on_exit == "delete":
        s.state.extra["deleted_particles"] += len(gone)
        matter = without_rigid(s, gone)
        s.state.extra["deleted_mass"] += float(p.mass[matter].sum()) * s.state.full_ring
        s.state.work["boundary_work"] -= kinetic_energy(s, matter) + float(p.stress_work[matter].sum())
        if len(gone) == p.count:
            raise SimulationError(f"the last particle left the grid at time {s.state.time:.6g}")
        s.remove_particles(inside)
    else:
        others = f" and {len(gone) - 1} others" if len(gone) > 1 else ""
        raise SimulationError(
            f"{s.describe(int(gone[0]))} left the grid{others}; enlarge the grid, hold the body, or choose "
            "domain.on_exit: delete or stop_at_wall"
        )


def without_rigid(s: Simulation, chosen: np.ndarray) -> np.ndarray:
    """Those of the particles at these places in memory that belong to no rigid body."""
    return chosen[~np.isin(s.particles.body[chosen], s.state.rigid)]


def kinetic_energy(s: Simulation, chosen: np.ndarray) -> float:
    """Kinetic energy of the particles at these places in memory."""
    p = s.particles
    return 0.5 * float((p.mass[chosen] * np.square(p.V[:, chosen]).sum(axis=0)).sum())
