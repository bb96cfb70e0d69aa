"""Areas that nodes have of surfaces: the divergence of the shape functions over the matter around them."""

import numpy as np

from mpmcli.boundary.images import Images
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.solver.transfer import Transfer

Array = np.ndarray


class NodalAreas:
    """−Σ_p V_p ∇S_pi: the sum over the nodes at and beyond a plane is its area, as a vector into the material.

    Parameters
    ----------
    transfer, particles, grid : parts of the step
    images : mirror images of particles, or None
    """

    def __init__(self, transfer: Transfer, particles: Particles, grid: Grid, images: Images | None):
        self._transfer, self._particles, self._images = transfer, particles, images
        self._areas = np.zeros(grid.f.shape)
        self._unit = np.zeros((len(particles.tau), 0))

    def __call__(self, weights: Array | None = None) -> Array:
        """Return them at the positions of the start of the step (dofs, d) [area]; overwritten by the next call.

        ``weights`` (N,) by identity multiply the volumes of particles.
        """
        p = self._particles
        if self._unit.shape != p.tau.shape:  # kept: kernels stay bound to every array that they were given
            self._unit = np.zeros(p.tau.shape)
        self._unit[:3] = p.determinant() if weights is None else p.determinant() * weights[p.id]
        self._transfer.internal_forces(self._unit, self._areas)
        if self._images is not None:
            self._images.complete(self._areas, 0.0)
        return self._areas
