"""Damping on the grid and of particles, and the energy that it takes."""

from __future__ import annotations

import numpy as np

from mpmcli.boundary.images import Images
from mpmcli.boundary.rigid import RigidBodies
from mpmcli.core.chunks import CHUNKS
from mpmcli.core.particles import Particles
from mpmcli.core.state import State

Array = np.ndarray


class Damping:
    """Damping of a scene; what a scene does not damp has no array.

    Parameters
    ----------
    grid, particle : rates [1/time]
    state : receives the energy taken
    images : mirror images of particles, or None

    Attributes
    ----------
    grid : (1,) rate of grid damping, or None
    particle : rate of particle damping
    of_nodes, of_particles : (chunks,) energy that each has taken in the step, or None
    rigid : the rigid bodies, which nothing damps, or None
    """

    rigid: RigidBodies | None = None

    def __init__(self, grid: float, particle: float, state: State, images: Images | None):
        self.grid: Array | None = np.array([grid]) if grid else None
        self.particle = particle
        self.of_nodes: Array | None = np.zeros(CHUNKS) if grid else None
        self.of_particles: Array | None = np.zeros(CHUNKS) if particle else None
        self._state, self._images = state, images
        if grid or particle:
            state.work["damping_work"] = 0.0

    def leave_out_images(self, mp: Array, f: Array, dt: float) -> None:
        """Take what mirror images of particles lost out of what nodes lost."""
        images = self._images
        if images is not None and self.grid is not None and self.of_nodes is not None:
            self.of_nodes[0] -= images.damping_of(mp, f, self.grid[0], dt)

    def leave_out_rigid(self, mp: Array, f: Array, dt: float) -> None:
        """Take what the nodes of rigid bodies lost, which get their velocity back, out of what nodes lost."""
        if self.rigid is not None and self.grid is not None and self.of_nodes is not None:
            dofs = self.rigid.dofs
            m, force = mp[dofs, 0], f[dofs]
            p = mp[dofs, 1:] - force * dt
            taken = self.grid[0] * dt * (p * (p + 0.5 * force * dt)).sum(axis=1)
            self.of_nodes[0] -= float(np.divide(taken, m, out=np.zeros_like(m), where=m > 0.0).sum())

    def damped_masses(self, particles: Particles) -> Array:
        """Return the masses (N,) by which what particles lose is counted: 0 in rigid bodies."""
        if self.rigid is None or self.of_particles is None:
            return particles.mass
        return np.where(np.isin(particles.body, self._state.rigid), 0.0, particles.mass)

    def account(self) -> None:
        """Task 6: add the energy taken."""
        if self.of_nodes is not None:
            self._state.work["damping_work"] += float(self.of_nodes.sum())
        if self.of_particles is not None:
            self._state.work["damping_work"] += float(self.of_particles.sum())
