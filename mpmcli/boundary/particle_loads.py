"""Loads on particles: gravity, and the force per mass of each particle."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.boundary.base import Array, LoadModel, is_finite
from mpmcli.core.analysis import Analysis, full_ring
from mpmcli.core.errors import SimulationError
from mpmcli.core.identity import by_identity
from mpmcli.core.particles import Particles


class ParticleLoads:
    """The loads of a scene that act on particles.

    Parameters
    ----------
    loads
        Models of the scene's ``loads`` list.
    analysis
        The kind of analysis; in axisymmetric ones forces of the user are those on the full ring.
    bodies
        Names of the bodies, in the order of ``Particles.body``.
    particles
        All particles, at the start of the simulation.

    Attributes
    ----------
    initial_positions : (d, N) positions at the start by identity, or None where no load needs them [length]
    """

    def __init__(
        self, loads: Sequence[LoadModel], analysis: Analysis, bodies: Sequence[str], particles: Particles
    ):
        self._dimensions = analysis.dimensions
        self._ring = full_ring(analysis)
        self._uniform = [load for load in loads if "uniform_acceleration" in load.effects()]
        self._accelerating = [load for load in loads if "acceleration_at" in load.effects()]
        self._pushing = [load for load in loads if "force_at" in load.effects()]
        self._lifting = [load for load in loads if "water_at" in load.effects()]
        on_particles = [*self._accelerating, *self._pushing, *self._lifting]
        indices = {name: index for index, name in enumerate(bodies)}

        def is_of(body: str) -> Array:
            return np.asarray(particles.body == indices[body])

        self._chosen: dict[int, Array] = {}
        """By the load's id: (N,) bool by identity, whether it acts on a particle; loads on all are left out."""
        for load in on_particles:
            mask = load.chosen(particles.X, is_of)
            if mask is not None and not mask.all():
                chosen = np.zeros(int(particles.id.max(initial=-1)) + 1, dtype=bool)
                chosen[particles.id] = mask
                self._chosen[id(load)] = chosen
        self.initial_positions: Array | None = None
        if any(load.uses_initial_positions for load in on_particles):
            self.initial_positions = by_identity(particles.id, particles.X)
        self._is_steady = not any(load.changes for load in (*self._uniform, *on_particles))
        self._gravity: Array | None = None
        self._gravity_changes = any(load.changes for load in self._uniform)
        self._B: Array | None = None
        self._version: Any = None

    def gravity(self, time: float) -> Array | None:
        """Return the acceleration (d,) of all particles alike at ``time``, or None without any."""
        if self._gravity is None or self._gravity_changes:
            self._gravity = np.zeros(self._dimensions)
            for load in acting(self._uniform, time):
                self._gravity += finite(load.uniform_acceleration(time), load, time)
        return self._gravity if self._uniform else None

    def accelerations(
        self, time: float, particles: Particles, version: Any = None, with_gravity: bool = False
    ) -> Array | None:
        """Return the force per mass of each particle at ``time``.

        Parameters
        ----------
        time
            Time at the start of the step.
        particles
            Current state; positions are read where a load depends on them.
        version
            Changes whenever particles are sorted or deleted; with it, loads that never change are kept. None:
            not.
        with_gravity
            Whether gravity is included (needed beside symmetry planes, where nodal masses are folded).

        Returns
        -------
        (d, N) array or None
            None if there are no such loads. Overwritten by the next call.
        """
        gravity = self.gravity(time) if with_gravity else None
        if gravity is None and not self._accelerating and not self._pushing and not self._lifting:
            return None
        if self._is_steady and version is not None and version == self._version and self._B is not None:
            return self._B
        if self._B is None or self._B.shape[1] != particles.count:
            self._B = np.empty((self._dimensions, particles.count))
        B = self._B
        B[:] = 0.0 if gravity is None else gravity[:, None]
        for load in acting(self._accelerating, time):
            rows = self._rows(load, particles)
            for a, value in enumerate(load.acceleration_at(self._points(load, particles, rows), time)):
                B[a, rows] += finite(value, load, time)
        for load in acting(self._pushing, time):
            rows = self._rows(load, particles)
            mass = particles.mass[rows]
            if mass.shape[0] == 0:
                continue
            shared = mass.sum() if load.shares_force else mass
            for a, value in enumerate(load.force_at(self._points(load, particles, rows), time)):
                B[a, rows] += finite(value, load, time) / self._ring / shared
        if self._lifting:
            self._lift(B, time, particles)
        self._version = version
        return B

    def _lift(self, B: Array, time: float, particles: Particles) -> None:
        """Add the force per mass by which water lifts particles."""
        from mpmcli.boundary.buoyancy import lift

        gravity = self.gravity(time)
        if gravity is None:
            return
        for load in acting(self._lifting, time):
            rows = self._rows(load, particles)
            level, density = load.water_at(self._points(load, particles, rows), time)
            axis, value = lift(finite(level, load, time), density, gravity, particles, rows)
            B[axis, rows] += value

    def _rows(self, load: LoadModel, particles: Particles) -> Any:
        """Places in memory of the particles that a load acts on."""
        chosen = self._chosen.get(id(load))
        return slice(None) if chosen is None else np.flatnonzero(chosen[particles.id])

    def _points(self, load: LoadModel, particles: Particles, rows: Any) -> Array:
        """Points (d, n) that a load is evaluated at."""
        if load.uses_initial_positions and self.initial_positions is not None:
            return self.initial_positions[:, particles.id[rows]]
        return particles.X[:, rows]


def acting(loads: Sequence[LoadModel], time: float) -> list[LoadModel]:
    """Return those of some loads that act in a step that starts at ``time``."""
    return [load for load in loads if load.acts_at(time)]


def finite(values: Any, load: LoadModel, time: float) -> Any:
    """Return the values of a load; raises SimulationError where they are not finite."""
    if not is_finite(values):
        raise SimulationError(f"load '{load.name}': its value is not finite at time {time:g}")
    return values
