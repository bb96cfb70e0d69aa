"""Deformation gradients that are those of the motion of the particles."""

import numpy as np

from mpmcli.core.particles import Particles
from mpmcli.materials.linear_increment import find_linear_rates, follow_motion

Array = np.ndarray


class LinearIncrements:
    """``method.deformation_increment: linear``: dF = I + L Δt, the gradient of the displacements of a step by v⁺.

    The exponential of L Δt has terms of second order besides, by which F departs from the motion where bodies turn.
    """

    def __init__(self, particles: Particles, parallel: bool):
        self._particles, self._parallel = particles, parallel
        self._rates = np.zeros_like(particles.L)

    def rates(self, L: Array, dt: float) -> Array:
        """Rates (nL, N) whose exponential over ``dt`` is the linear increment of ``L`` (nL, N) [1/time]."""
        if self._rates.shape != L.shape:  # particles were removed
            self._rates = np.zeros_like(L)
        find_linear_rates[self._parallel](L, dt, self._rates)
        return self._rates

    def follow(self, dt: float) -> None:
        """Let the velocity gradients of the particles, found at the start of a step, be those at its end."""
        follow_motion[self._parallel](self._particles.L, dt)
