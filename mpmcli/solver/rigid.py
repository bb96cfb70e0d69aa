"""Rigid bodies: their particles move as the scene says, whatever the grid does."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

Array = np.ndarray


class NoRigidBodies:
    """A scene without rigid bodies."""

    def remember(self) -> None:
        """Nothing to remember."""

    def move(self, X: Array, time: float, dt: float) -> None:
        """Nothing to move."""


class RigidBodies(NoRigidBodies):
    """The rigid bodies of a scene, whose velocity is a function of place and time."""

    def __init__(self, s: Simulation, bodies: Any):
        self._s = s
        self._velocities = [(i, bodies[i].velocity) for i in s.state.rigid if bodies[i].velocity]
        self._version = -1
        self._members: list[Array] = []

    def remember(self) -> None:
        """Keep the positions at the start of the step."""
        p = self._s.particles
        if self._s.order.version != self._version:
            self._version = self._s.order.version
            self._still = np.flatnonzero(np.isin(p.body, self._s.state.rigid))
            self._members = [np.flatnonzero(p.body == i) for i, _ in self._velocities]
        self._start = p.X[:, self._still]

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
