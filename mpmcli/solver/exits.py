"""Particles that left the domain: the policies ``error``, ``delete`` and ``stop_at_wall``.

Where a condition holds the velocity across a side of the grid, the ghost cell beyond belongs to the domain. Shape
functions of particles at that side see free nodes in front of it, which may move the particles past it by a fraction of
a cell.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

MOST_OVERRUN = 1.0 - 1e-6
"""Cells that particles may be beyond a held side: the order of particles and nodes in use allow for one."""


def held_sides(scene: Any, grid: Grid) -> dict[tuple[int, int], str]:
    """Sides of the grid (axis; 0 lower, 1 upper) across which a condition holds the velocity, and its name."""
    found: dict[tuple[int, int], str] = {}
    for condition in scene.boundary:
        side = condition.held_side(grid)
        if side is not None:
            found.setdefault(side, condition.name)
    return found


def overrun_of(held: dict[tuple[int, int], str], grid: Grid, on_exit: str) -> np.ndarray:
    """How far beyond the sides of the grid particles may be, (d, 2) [cells]; ``held`` from ``held_sides``."""
    overrun = np.zeros((grid.dimensions, 2))
    if on_exit != "stop_at_wall":
        for side in held:
            overrun[side] = MOST_OVERRUN
    return overrun


def settle_exits(s: Simulation) -> None:
    """Apply the scene's policy to every particle outside the domain.

    Energy that the walls or the deletion take away counts as (negative) ``boundary_work``.
    """
    p = s.particles
    lower, upper = s.transfer.bounds[:, :1], s.transfer.bounds[:, 1:]
    below, above = lower > p.X, upper < p.X
    inside = ~np.any(below | above, axis=0)
    gone = np.flatnonzero(~inside)
    if len(gone) == 0:
        return
    if s.on_exit == "stop_at_wall":
        low, high = below[:, gone], above[:, gone]
        p.X[:, gone] = np.clip(p.X[:, gone], s.grid.lower[:, None], s.grid.upper[:, None])
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
        axis = int(np.argmax((below | above)[:, gone[0]]))
        side = axis, int(above[axis, gone[0]])
        raise SimulationError(f"{s.describe(int(gone[0]))} left the grid{others}. {_advice(s, side)}")


def _advice(s: Simulation, side: tuple[int, int]) -> str:
    """What may be done about particles that left at a side of the grid, and is not done yet."""
    name = s.held_sides.get(side)
    if name is not None:
        return (
            f"The boundary condition '{name}' holds the velocity there, and the particle is a cell beyond it: try a "
            "shorter step, a plane of kind symmetry, or domain.on_exit: stop_at_wall"
        )
    where = f"the {('lower', 'upper')[side[1]]} side of {'xyz'[side[0]]}"
    return (
        f"Nothing holds particles at {where}: enlarge the grid, put a boundary condition there (kind: symmetry is a "
        "smooth wall), or choose domain.on_exit: delete or stop_at_wall"
    )


def without_rigid(s: Simulation, chosen: np.ndarray) -> np.ndarray:
    """Those of the particles at these places in memory that belong to no rigid body."""
    return chosen[~np.isin(s.particles.body[chosen], s.state.rigid)]


def kinetic_energy(s: Simulation, chosen: np.ndarray) -> float:
    """Kinetic energy of the particles at these places in memory."""
    p = s.particles
    return 0.5 * float((p.mass[chosen] * np.square(p.V[:, chosen]).sum(axis=0)).sum())
