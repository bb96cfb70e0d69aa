"""Particles that left the domain: the policies ``error``, ``delete`` and ``stop_at_wall``.

Where a condition holds the velocity across a side of the grid, the ghost cell beyond belongs to the domain. Shape
functions of particles at that side see free nodes in front of it, which may move the particles past it by a fraction of
a cell.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.state import State

Array = np.ndarray

MOST_OVERRUN = 1.0 - 1e-6
"""Cells that particles may be beyond a held side: the order of particles and nodes in use allow for one."""
STOPPED = 1e-9
"""Cells from a side at which particles stop: on a grid line ``linear`` has gradients at nodes without mass."""


def held_sides(conditions: Iterable[Any], grid: Grid) -> dict[tuple[int, int], str]:
    """Sides of the grid (axis; 0 lower, 1 upper) across which a condition holds the velocity, and its name."""
    found: dict[tuple[int, int], str] = {}
    for condition in conditions:
        side = condition.held_side(grid)
        if side is not None:
            found.setdefault(side, condition.name)
    return found


def overrun_of(held: dict[tuple[int, int], str], grid: Grid, policy: str) -> Array:
    """Return how far beyond the sides of the grid particles may be, (d, 2) [cells]; ``held`` from ``held_sides``."""
    overrun = np.zeros((grid.dimensions, 2))
    if policy != "stop_at_wall":
        for side in held:
            overrun[side] = MOST_OVERRUN
    return overrun


class Exits:
    """The sides of the domain, and what becomes of particles that pass them.

    Parameters
    ----------
    policy : ``domain.on_exit`` of the scene
    held : sides that conditions hold, from ``held_sides``
    grid, particles, state : where particles are, and the account of what is lost
    describe : names a particle (by its place in memory) in messages
    remove : keeps only the particles of a mask
    jumped : is told the axes along which particles have entered again at the other side

    Attributes
    ----------
    bounds : (d, 2) the domain [length]
    """

    def __init__(
        self,
        policy: str,
        held: dict[tuple[int, int], str],
        grid: Grid,
        particles: Particles,
        state: State,
        describe: Callable[[int], str],
        remove: Callable[[Array], None],
        jumped: Callable[[list[int]], None] = lambda axes: None,
    ):
        self.policy, self.held = policy, held
        self._grid, self._particles, self._state = grid, particles, state
        self._describe, self._remove, self._jumped = describe, remove, jumped
        below, above = np.maximum(overrun_of(held, grid, policy), 1e-9).T * grid.cell
        self.bounds = np.stack([grid.lower - below, grid.upper + above], axis=1)
        if policy != "error":
            state.work.setdefault("boundary_work", 0.0)
        if policy == "delete":
            state.extra.update(deleted_particles=0.0, deleted_mass=0.0)

    def apply(self) -> None:
        """Task 6: apply the policy to every particle outside the domain.

        Energy that the walls or the deletion take away counts as (negative) ``boundary_work``.

        Raises
        ------
        SimulationError
            If no particle may leave, or none is left.
        """
        p = self._particles
        if self._grid.periodic:
            from mpmcli.boundary.periodic import enter_again

            self._jumped(enter_again(self._grid, p, self._state.X0))
        below, above = self.bounds[:, :1] > p.X, self.bounds[:, 1:] < p.X
        inside = ~np.any(below | above, axis=0)
        gone = np.flatnonzero(~inside)
        if len(gone) == 0:
            return
        if self.policy == "stop_at_wall":
            self._stop(gone, below[:, gone], above[:, gone])
        elif self.policy == "delete":
            self._delete(gone, inside)
        else:
            others = f" and {len(gone) - 1} others" if len(gone) > 1 else ""
            axis = int(np.argmax((below | above)[:, gone[0]]))
            side = axis, int(above[axis, gone[0]])
            raise SimulationError(
                f"{self._describe(int(gone[0]))} left the grid{others}. {self._advice(side)}"
            )

    def _stop(self, gone: Array, low: Array, high: Array) -> None:
        p, grid = self._particles, self._grid
        inside = (STOPPED * grid.cell)[:, None]
        p.X[:, gone] = np.clip(p.X[:, gone], grid.lower[:, None] + inside, grid.upper[:, None] - inside)
        matter = self._without_rigid(gone)
        before = self._kinetic_energy(matter)
        outward = (low & (p.V[:, gone] < 0.0)) | (high & (p.V[:, gone] > 0.0))
        p.V[:, gone] = np.where(outward, 0.0, p.V[:, gone])
        self._state.work["boundary_work"] -= before - self._kinetic_energy(matter)

    def _delete(self, gone: Array, inside: Array) -> None:
        p, state = self._particles, self._state
        state.extra["deleted_particles"] += len(gone)
        matter = self._without_rigid(gone)
        state.extra["deleted_mass"] += float(p.mass[matter].sum()) * state.full_ring
        state.work["boundary_work"] -= self._kinetic_energy(matter) + float(p.stress_work[matter].sum())
        if "deleted_heat" in state.extra:
            state.extra["deleted_heat"] += self._heat_of(matter) * state.full_ring
        if len(gone) == p.count:
            raise SimulationError(f"the last particle left the grid at time {state.time:.6g}")
        self._remove(inside)

    def _heat_of(self, chosen: Array) -> float:
        """Heat that goes with these particles, by the temperatures that they carry, so that sums balance."""
        p = self._particles
        c = np.array([m.specific_heat or 0.0 for m in self._state.material_models])
        C = p.mass[chosen] * c[p.material[chosen]]
        carried = np.asarray(p.T if p.T_carried is None else p.T_carried)[chosen]
        if p.heat_inflow is None:
            return float((C * (carried - np.asarray(p.T_start)[chosen])).sum())
        return float((p.heat_inflow[chosen] + C * (carried - np.asarray(p.T)[chosen])).sum())

    def _advice(self, side: tuple[int, int]) -> str:
        """What may be done about particles that left at a side of the grid, and is not done yet."""
        name = self.held.get(side)
        if name is not None:
            return (
                f"The boundary condition '{name}' holds the velocity there, but the particle is a cell beyond it. Try "
                "a shorter step, a condition of kind symmetry, or domain.on_exit: stop_at_wall"
            )
        where = f"the {('lower', 'upper')[side[1]]} side of {'xyz'[side[0]]}"
        return (
            f"No boundary condition holds {where}. Enlarge the grid, add a condition there (kind: symmetry is a smooth "
            "wall), or use domain.on_exit: delete or stop_at_wall"
        )

    def _without_rigid(self, chosen: Array) -> Array:
        """Those of the particles at these places in memory that belong to no rigid body."""
        return chosen[~np.isin(self._particles.body[chosen], self._state.rigid)]

    def _kinetic_energy(self, chosen: Array) -> float:
        """Kinetic energy of the particles at these places in memory."""
        p = self._particles
        return 0.5 * float((p.mass[chosen] * np.square(p.V[:, chosen]).sum(axis=0)).sum())
