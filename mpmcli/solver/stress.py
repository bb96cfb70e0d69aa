"""Strain, stress and energies of all particles: every material's kernel, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mpmcli.core.particles import Particles
from mpmcli.materials.strain import (
    ArtificialViscosity,
    block_count,
    stored_energy,
    update_strain_and_stress,
)
from mpmcli.solver.plan import Plan

Array = np.ndarray


class StressUpdate:
    """Task 5 (and 1.d): deformation gradients, stresses and energies from velocity gradients.

    Parameters
    ----------
    plan, particles : of the simulation
    materials : models of the scene, in its order
    volume_ratio : smallest and largest J that a particle may have
    cell : smallest cell size, the length of artificial viscosity [length]
    parallel : run the parallel version of every kernel
    refuse : raises SimulationError for a particle (its place in memory) whose state is impossible

    Attributes
    ----------
    wave_speed : largest wave speed after the last update [velocity]
    """

    def __init__(
        self,
        plan: Plan,
        particles: Particles,
        materials: Sequence[Any],
        volume_ratio: tuple[float, float],
        cell: float,
        parallel: bool,
        refuse: Callable[[int], None],
    ):
        name = plan.analysis_name
        self._analysis, self._viscosity, self._cell = plan.analysis, plan.viscosity, cell
        self._particles, self._parallel, self._refuse = particles, parallel, refuse
        self._parameters = [m.parameters(name, plan.adiabatic) for m in materials]
        self._limits = (float(volume_ratio[0]), float(volume_ratio[1]))
        self._used = [i for i in range(len(materials)) if np.any(particles.material == i)]
        self.starts_with_stress = any(
            "stress_free_at_rest" not in materials[i].properties for i in self._used
        )
        self.wave_speed = max(materials[i].initial_wave_speed(name) for i in self._used)
        self.fit()

    def fit(self) -> None:
        """Make the arrays of blocks as long as there are blocks of particles."""
        blocks = block_count(self._particles.count)
        self._speed2 = np.zeros(blocks)
        self._bad = np.full(blocks, -1, dtype=np.int64)

    def update(self, L: Array, dt: float) -> None:
        """Advance all particles by ``dt`` with velocity gradients ``L`` (nL, N).

        Raises
        ------
        SimulationError
            If a state is not finite or J is out of its limits.
        """
        p = self._particles
        several = len(self._used) > 1
        fastest = 0.0
        for i in self._used:
            update_strain_and_stress[self._parallel](
                self._analysis, self._parameters[i], i if several else -1, p.F, L, p.tau, p.H, p.mass, p.vol0,
                p.material, p.stress_work, self._viscous(), dt, self._limits, self._speed2, self._bad,
            )  # fmt: skip
            bad = int(self._bad.max())
            if bad >= 0:
                self._refuse(bad)
            fastest = max(fastest, float(self._speed2.max()))
        self.wave_speed = float(np.sqrt(fastest))

    def energy_density(self) -> Array:
        """Return the stored energy per initial volume of every particle (N,) [pressure]."""
        p = self._particles
        out = np.zeros(p.count)
        for i in self._used:
            stored_energy[self._parallel](self._analysis, self._parameters[i], i, p.F, p.H, p.material, out)
        return out

    def _viscous(self) -> ArtificialViscosity | None:
        if self._viscosity is None:
            return None
        p, (linear, quadratic) = self._particles, self._viscosity
        return ArtificialViscosity(linear, quadratic, self._cell, p.viscous_pressure, p.viscous_work)
