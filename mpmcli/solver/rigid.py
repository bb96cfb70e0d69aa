"""Rigid bodies: their particles move as the scene says, whatever the grid does."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.core.errors import SimulationError

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

Array = np.ndarray


class NoRigidBodies:
    """A scene without rigid bodies."""

    held = np.zeros(0, dtype=np.int64)
    """Degrees of freedom whose velocity ``hold`` gave."""

    def prepare(self, time: float, dt: float) -> None:
        """Nothing to prepare."""

    def hold(self, mp: Array, time: float) -> None:
        """Nothing to hold."""

    def move(self, X: Array) -> None:
        """Nothing to move."""


class RigidBodies(NoRigidBodies):
    """The rigid bodies of a scene, whose velocity is a function of place and time."""

    def __init__(self, s: Simulation, bodies: Any):
        self._s = s
        self._velocities = [(i, bodies[i].velocity) for i in s.state.rigid if bodies[i].velocity]
        self._version = -1
        self._places: list[Array] = []
        self._of_fields = _velocities_of_fields(s, bodies)
        self._grid_version = -1
        self._nodes: list[tuple[str, Array, Array, Any]] = []

    def prepare(self, time: float, dt: float) -> None:
        """Find positions and velocities at the end of the step (midpoint rule), before anything has changed.

        Raises
        ------
        SimulationError
            If a velocity is not finite.
        """
        p = self._s.particles
        if self._s.order.version != self._version:
            self._version = self._s.order.version
            self._still = np.flatnonzero(np.isin(p.body, self._s.state.rigid))
            bodies = p.body[self._still]
            self._places = [np.flatnonzero(bodies == i) for i, _ in self._velocities]
        self._X = p.X[:, self._still]
        self._V = np.zeros_like(self._X)
        for places, (i, velocity) in zip(self._places, self._velocities, strict=True):
            name = self._s.state.bodies[i]
            start = self._X[:, places]
            middle = start + velocity_at(velocity, start, time, name) * (0.5 * dt)
            end = start + velocity_at(velocity, middle, time + 0.5 * dt, name) * dt
            self._X[:, places] = end
            self._V[:, places] = velocity_at(velocity, end, time + dt, name)

    def hold(self, mp: Array, time: float) -> None:
        """Give the momenta ``mp`` (dofs, 1 + d) of a moving body's nodes its velocity at their places.

        Particles near a surface lie to one side of its nodes, so that what they extrapolate is the velocity of a
        place inside. Where bodies that move differently share a velocity field that has to do, and on symmetry planes.
        """
        if self._s.grid.active_version != self._grid_version:
            self._grid_version = self._s.grid.active_version
            self._find_nodes()
        for name, dof, X, velocity in self._nodes:
            mp[dof, 1:] = mp[dof, :1] * velocity_at(velocity, X, time, name).T

    def _find_nodes(self) -> None:
        s, grid = self._s, self._s.grid
        dofs = s.rigid_dofs
        if s.has_mirror:
            conditions: Any = s.conditions
            mirror = conditions.conditions.mirror
            nodes = dofs % grid.node_count
            dofs = dofs[~(mirror.beyond(nodes) | np.isin(nodes, mirror.pairs.own))]
        self._nodes = []
        for field, velocity in self._of_fields:
            mine = dofs[dofs // grid.node_count == field]
            self._nodes.append((s.plan.fields[field], mine, grid.coordinates(mine), velocity))
        self.held = np.concatenate([self.held[:0], *(dof for _, dof, _, _ in self._nodes)])

    def move(self, X: Array) -> None:
        """Put positions ``X`` (d, N) and velocities of rigid particles to the end of the step."""
        s = self._s
        moved = X[:, self._still]
        X[:, self._still] = self._X
        s.particles.V[:, self._still] = self._V
        s.order.drift += float((np.abs(self._X - moved).max(axis=1) / s.grid.cell).max())


def velocity_at(velocity: Any, X: Array, time: float, name: str) -> Array:
    """Return the velocity (d, n) of body ``name``, given by expressions, at points X (d, n) and a time.

    Raises
    ------
    SimulationError
        If it is not finite.
    """
    x, y, z = (*X, 0.0, 0.0)[:3]
    found = np.stack([np.broadcast_to(component(x, y, z, time), X.shape[1:]) for component in velocity])
    if not np.isfinite(found).all():
        raise SimulationError(f"rigid body '{name}': its velocity is not finite at time {time:g}")
    return found


def _velocities_of_fields(s: Simulation, bodies: Any) -> list[tuple[int, Any]]:
    """Velocity of each velocity field whose rigid bodies move, all in the same way."""
    found: dict[int, list[Any]] = {}
    for i in s.state.rigid:
        found.setdefault(s.plan.field_of_body[i], []).append(bodies[i].velocity)
    of_fields = []
    for field, velocities in found.items():
        ways = {tuple(component.source for component in velocity) for velocity in velocities}
        if len(ways) == 1 and velocities[0]:
            of_fields.append((field, velocities[0]))
    return of_fields
