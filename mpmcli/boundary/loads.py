"""All loads of a scene: gravity, and the force per mass of each particle. Tractions are in ``faces``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.boundary.base import Array, LoadModel
from mpmcli.boundary.body_force import BodyForce
from mpmcli.boundary.gravity import Gravity
from mpmcli.boundary.particle_force import ParticleForce
from mpmcli.boundary.place import inside
from mpmcli.boundary.traction import Traction
from mpmcli.boundary.velocity import evaluate
from mpmcli.core.analysis import Analysis, Axisymmetric
from mpmcli.core.errors import SimulationError
from mpmcli.core.particles import Particles


class Loads:
    """The loads of a scene.

    Parameters
    ----------
    loads
        Models of the scene's ``loads`` list.
    analysis
        The kind of analysis; in axisymmetric ones forces of the user are those on the full ring.
    bodies
        Names of the bodies, in the order of ``Particles.body``.

    Attributes
    ----------
    tractions : the models of tractions, for ``TractionFaces``
    initial_positions : (d, N) positions at the start by identity, or None where no load needs them [length]
    """

    def __init__(self, loads: Sequence[LoadModel], analysis: Analysis, bodies: Sequence[str]):
        self._bodies = {name: index for index, name in enumerate(bodies)}
        self._dimensions = analysis.dimensions
        self._ring = 2 * math.pi if isinstance(analysis, Axisymmetric) else 1.0
        self._gravities = [load for load in loads if isinstance(load, Gravity)]
        self._body_forces = [load for load in loads if isinstance(load, BodyForce)]
        self._forces = [load for load in loads if isinstance(load, ParticleForce)]
        self.tractions = [load for load in loads if isinstance(load, Traction)]
        self.initial_positions: Array | None = None
        self._targets: list[Array] = []
        self._B: Array | None = None
        self._version: Any = None
        self._steady = self._is_steady()

    @property
    def needs_initial_positions(self) -> bool:
        """Whether the positions at the start must be known (and kept in a checkpoint)."""
        return any(load.coordinates == "initial" for load in self._body_forces) or any(
            load.on.box is not None or load.on.region is not None for load in self._forces
        )

    def start(self, particles: Particles, initial_positions: Array | None = None) -> None:
        """Note what the loads must know of the particles at the start.

        Parameters
        ----------
        particles
            All particles, at the start of the simulation.
        initial_positions
            (d, N) by identity, from a checkpoint; by default the particles are at their initial positions.
        """
        if self.needs_initial_positions:
            self.initial_positions = (
                by_identity(particles) if initial_positions is None else initial_positions
            )
        self._targets = []
        for load in self._forces:
            chosen = np.ones(int(particles.id.max(initial=-1)) + 1, dtype=bool)
            if self.initial_positions is not None:
                chosen = np.ones(self.initial_positions.shape[1], dtype=bool)
                if load.on.box is not None:
                    chosen &= inside(load.on.box, None, self.initial_positions)
                if load.on.region is not None:
                    chosen &= inside(None, load.on.region, self.initial_positions)
            self._targets.append(chosen)
        self._version = None

    def gravity(self, time: float) -> Array | None:
        """Acceleration (d,) of gravity at ``time``, or None without gravity."""
        if not self._gravities:
            return None
        total = np.zeros(self._dimensions)
        for load in self._gravities:
            total += [component(t=time) for component in load.acceleration]
        return self._finite(total, "gravity", time)

    def particle_accelerations(
        self, time: float, particles: Particles, version: Any = None, with_gravity: bool = False
    ) -> Array | None:
        """Force per mass of each particle at ``time`` from body forces and particle forces.

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
        if gravity is None and not self._body_forces and not self._forces:
            return None
        if self._steady and version is not None and version == self._version and self._B is not None:
            return self._B
        if self._B is None or self._B.shape[1] != particles.count:
            self._B = np.empty((self._dimensions, particles.count))
        B = self._B
        B[:] = 0.0 if gravity is None else gravity[:, None]
        for body_force in self._body_forces:
            self._add_body_force(body_force, time, particles, B)
        for force, chosen in zip(self._forces, self._targets, strict=True):
            self._add_force(force, chosen, time, particles, B)
        self._version = version
        return B

    def _add_body_force(self, load: BodyForce, time: float, particles: Particles, B: Array) -> None:
        points = particles.X
        rows: Any = slice(None)
        if load.coordinates == "initial" and self.initial_positions is not None:
            points = self.initial_positions[:, particles.id]
        if load.on is not None:
            rows = np.flatnonzero(particles.body == self._bodies[load.on.body])
            points = points[:, rows]
        for a, component in enumerate(load.acceleration):
            B[a, rows] += self._finite(evaluate(component, points, time), f"load '{load.name}'", time)

    def _add_force(
        self, load: ParticleForce, chosen: Array, time: float, particles: Particles, B: Array
    ) -> None:
        loaded = chosen[particles.id]
        if load.on.body is not None:
            loaded &= particles.body == self._bodies[load.on.body]
        rows = np.flatnonzero(loaded)
        if rows.shape[0] == 0:
            return
        mass = particles.mass[rows]
        shared = mass.sum() if load.per == "total" else mass
        for a, component in enumerate(load.force):
            force = self._finite(component(t=time), f"load '{load.name}'", time) / self._ring
            B[a, rows] += force / shared

    def _is_steady(self) -> bool:
        """Whether no load on particles ever changes, for given particles in a given order."""
        fields = [c for load in self._gravities for c in load.acceleration]
        fields += [c for load in self._forces for c in load.force]
        fields += [c for load in self._body_forces for c in load.acceleration]
        current = [
            c for load in self._body_forces if load.coordinates == "current" for c in load.acceleration
        ]
        return not any("t" in c.variables for c in fields) and all(c.is_constant for c in current)

    @staticmethod
    def _finite(values: Any, what: str, time: float) -> Any:
        if not np.all(np.isfinite(values)):
            raise SimulationError(f"{what}: its value is not finite at time {time:g}")
        return values


def by_identity(particles: Particles) -> Array:
    """Positions (d, N) ordered by identity; identities without particle are not a number."""
    ordered = np.full((particles.X.shape[0], int(particles.id.max(initial=-1)) + 1), np.nan)
    ordered[:, particles.id] = particles.X
    return ordered
