"""Damping on the grid and of particles, and the energy that it takes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.boundary.grid_conditions import GridConditions
from mpmcli.boundary.images import Images
from mpmcli.boundary.rigid import RigidBodies
from mpmcli.core.chunks import CHUNKS
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.state import State
from mpmcli.core.step import Step

if TYPE_CHECKING:  # imported by scenes with periodic axes
    from mpmcli.boundary.periodic import PeriodicSides

Array = np.ndarray


class Damping:
    """Damping of a scene; what a scene does not damp has no array.

    Parameters
    ----------
    model : the scene's words (``scene.method.Damping``)
    state : receives the energy taken
    images : mirror images of particles, or periodic sides, or None

    Attributes
    ----------
    grid : (1,) rate of grid damping in this step, or None
    particle : rate of particle damping in this step
    of_nodes, of_particles, of_forces : (chunks,) energy that rates of nodes and particles, and local damping, have
        taken in the step, or None
    rigid : the rigid bodies, which nothing damps, or None
    """

    rigid: RigidBodies | None = None

    def __init__(self, model: Any, state: State, images: Images | PeriodicSides | None):
        damped = model.feedback.damps if model.feedback is not None else ""
        at_nodes, of_particles = bool(model.damps_grid), bool(model.damps_particles)
        self.grid: Array | None = np.array([model.grid(t=0.0)]) if at_nodes else None
        self.particle = float(model.particle(t=0.0))
        self.of_nodes: Array | None = np.zeros(CHUNKS) if at_nodes else None
        self.of_particles: Array | None = np.zeros(CHUNKS) if of_particles else None
        self._local: Any = None
        if model.local is not None:
            from mpmcli.solver.local_damping import LocalDamping

            self._local = LocalDamping(state.particles.negligible_mass())
        self.of_forces: Array | None = None if self._local is None else self._local.taken
        self._model, self._state, self._images = model, state, images
        self._varies = not (model.grid.is_constant and model.particle.is_constant)
        self._feedback: Any = None
        self._damped_by_feedback = damped
        if model.feedback is not None:
            from mpmcli.solver.feedback import Feedback

            self._feedback = Feedback(model.feedback, state)
        if model.takes_energy:
            state.work["damping_work"] = 0.0

    def prepare(self, step: Step) -> None:
        """Find the rates of a step."""
        if not self._varies and self._feedback is None:
            return
        rates = {name: self._value(name, step.time) for name in ("grid", "particle")}
        if self._feedback is not None:
            rates[self._damped_by_feedback] += self._feedback.next_rate(step.time, step.dt)
        if self.grid is not None:
            self.grid[0] = rates["grid"]
        self.particle = rates["particle"]

    def _value(self, name: str, time: float) -> float:
        value = float(getattr(self._model, name)(t=time))
        if not (math.isfinite(value) and value >= 0.0):
            raise SimulationError(
                f"method.damping.{name} is {value:g} at time {time:g}; it must be at least 0"
            )
        return value

    def add_local(self, step: Step, grid: Grid, conditions: GridConditions | None, parallel: bool) -> None:
        """Add local damping to the nodal forces."""
        if self._local is not None:
            rate = 0.0 if self.grid is None else float(self.grid[0])
            self._local.add(
                self._value("local", step.time), rate, step.dt, grid, conditions, self.rigid, parallel
            )

    def leave_out_others(self, mp: Array, f: Array, dt: float) -> None:
        """Take out of what nodes lost what is none of the scene's.

        That is what mirror images of particles or copies of nodes lost, and the nodes of rigid bodies, which get their
        velocity back.
        """
        if self.grid is None or self.of_nodes is None:
            return
        others = [] if self._images is None else [self._images.copies()]
        others += [] if self.rigid is None else [(self.rigid.dofs, 1.0)]
        for nodes, share in others:
            m, force = mp[nodes, 0], f[nodes]
            p = mp[nodes, 1:] - force * dt
            taken = self.grid[0] * dt * (p * (p + 0.5 * force * dt)).sum(axis=1)
            taken = np.divide(taken, m, out=np.zeros_like(m), where=m > 0.0)
            self.of_nodes[0] -= float((share * taken).sum())

    def damped_masses(self, particles: Particles) -> Array:
        """Return the masses (N,) by which what particles lose is counted: 0 in rigid bodies."""
        if self.rigid is None or self.of_particles is None:
            return particles.mass
        return np.where(np.isin(particles.body, self._state.rigid), 0.0, particles.mass)

    def account(self) -> None:
        """Task 6: add the energy taken."""
        for taken in (self.of_nodes, self.of_particles, self.of_forces):
            if taken is not None:
                self._state.work["damping_work"] += float(taken.sum())
