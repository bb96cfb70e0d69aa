"""Rigid bodies: their particles move as the scene says, whatever the grid does."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

Array = np.ndarray


class NoRigidBodies:
    """A scene without rigid bodies."""

    held = np.zeros(0, dtype=np.int64)
    """Degrees of freedom whose velocity ``hold`` gave."""

    def remember(self) -> None:
        """Nothing to remember."""

    def hold(self, mp: Array, time: float) -> None:
        """Nothing to hold."""

    def move(self, X: Array, time: float, dt: float) -> None:
        """Nothing to move."""


class RigidBodies(NoRigidBodies):
    """The rigid bodies of a scene, whose velocity is a function of place and time."""

    def __init__(self, s: Simulation, bodies: Any):
        self._s = s
        self._velocities = [(i, bodies[i].velocity) for i in s.state.rigid if bodies[i].velocity]
        self._version = -1
        self._members: list[Array] = []
        self._of_fields = _velocities_of_fields(s, bodies)
        self._grid_version = -1
        self._nodes: list[tuple[Array, Array, Any]] = []

    def remember(self) -> None:
        """Keep the positions at the start of the step."""
        p = self._s.particles
        if self._s.order.version != self._version:
            self._version = self._s.order.version
            self._still = np.flatnonzero(np.isin(p.body, self._s.state.rigid))
            self._members = [np.flatnonzero(p.body == i) for i, _ in self._velocities]
        self._start = p.X[:, self._still]

    def hold(self, mp: Array, time: float) -> None:
        """Give the momenta ``mp`` (dofs, 1 + d) of a moving body's nodes its velocity at their places.

        Particles near a surface lie to one side of its nodes, so that what they extrapolate is the velocity of a
        place inside. Where bodies that move differently share a velocity field that has to do, and on symmetry planes.
        """
        if self._s.grid.active_version != self._grid_version:
            self._grid_version = self._s.grid.active_version
            self._find_nodes()
        for dof, X, velocity in self._nodes:
            mp[dof, 1:] = mp[dof, :1] * velocity_at(velocity, X, time).T

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
            self._nodes.append((mine, grid.coordinates(mine), velocity))
        self.held = np.concatenate([self.held[:0], *(dof for dof, _, _ in self._nodes)])

    def move(self, X: Array, time: float, dt: float) -> None:
        """Put positions ``X`` (d, N) and velocities of rigid particles to the end of the step (midpoint rule)."""
        s, V = self._s, self._s.particles.V
        moved = X[:, self._still]
        X[:, self._still] = self._start
        V[:, self._still] = 0.0
        for members, (_, velocity) in zip(self._members, self._velocities, strict=True):
            start = X[:, members]
            middle = start + velocity_at(velocity, start, time) * (0.5 * dt)
            X[:, members] = start + velocity_at(velocity, middle, time + 0.5 * dt) * dt
            V[:, members] = velocity_at(velocity, X[:, members], time + dt)
        apart = np.abs(X[:, self._still] - moved).max(axis=1) / s.grid.cell
        s.order.drift += float(apart.max())


def velocity_at(velocity: Any, X: Array, time: float) -> Array:
    """Components of a velocity given by expressions, at points (d, n) and a time: (d, n)."""
    x, y, z = (*X, 0.0, 0.0)[:3]
    return np.stack([np.broadcast_to(component(x, y, z, time), X.shape[1:]) for component in velocity])


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
