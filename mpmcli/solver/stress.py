"""Strain, stress and energies of all particles: every material's kernel, one after the other."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from mpmcli.core.compiled.bound import BoundKernels
from mpmcli.core.compiled.runtime import available_threads
from mpmcli.core.particles import Particles
from mpmcli.materials.base import dissipated_heat
from mpmcli.materials.defaults import dissipate_nothing
from mpmcli.materials.strain import (
    BLOCK,
    ArtificialViscosity,
    block_count,
    stored_energy,
    update_strain_and_stress,
)
from mpmcli.materials.thermal import Thermal, thermal_of
from mpmcli.materials.warmth import ROWS
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
    work : accumulated energies by name; with conduction between isothermal materials ``bath_heat`` is one of them
    lightness : density of each material over that of its lightest particle

    Attributes
    ----------
    wave_speed : largest wave speed after the last update [velocity]
    knows_temperature : temperatures change a stress, or are changed by one
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
        work: dict[str, float],
        lightness: Sequence[float],
    ):
        name = plan.analysis_name
        self._analysis, self._viscosity, self._cell = plan.analysis, plan.viscosity, cell
        self._particles, self._parallel, self._refuse = particles, parallel, refuse
        self._threads = available_threads() if parallel else 1
        self._kernels = BoundKernels(parallel, lambda: particles.version)
        self._materials, self._work, self._lightness = materials, work, lightness
        self._has_bath = plan.heat is not None and not plan.adiabatic
        if self._has_bath:
            work["bath_heat"] = 0.0
        self._parameters = [m.parameters(name, plan.adiabatic or self._heats_bath(m)) for m in materials]
        self._thermals = [self._thermal_of(plan, i) for i in range(len(materials))]
        self._limits = (float(volume_ratio[0]), float(volume_ratio[1]))
        self._used = [i for i in range(len(materials)) if np.any(particles.material == i)]
        self.knows_temperature = any(self._thermals[i] is not None for i in self._used)
        self.starts_with_stress = self.knows_temperature or any(
            "stress_free_at_rest" not in materials[i].properties for i in self._used
        )
        self.wave_speed = max(
            materials[i].initial_wave_speed(name) * math.sqrt(lightness[i]) for i in self._used
        )
        self.fit()

    def fit(self) -> None:
        """Make the arrays of blocks as long as there are blocks of particles."""
        blocks = block_count(self._particles.count)
        self._speed2 = np.zeros(blocks)
        self._bad = np.full(blocks, -1, dtype=np.int64)
        self._extremes = np.array([0.0, -1.0])
        self._bath = np.zeros(blocks) if self._has_bath else None
        if any(numbers is not None for numbers in self._thermals):
            self._scratch = np.zeros((min(blocks, self._threads), ROWS, BLOCK))

    def update(self, L: Array, dt: float) -> None:
        """Advance all particles by ``dt`` with velocity gradients ``L`` (nL, N).

        Raises
        ------
        SimulationError
            If a state is not finite or J is out of its limits.
        """
        fastest = 0.0
        if self._bath is not None:
            self._bath[:] = 0.0
        for i in self._used:
            self._kernels.run(update_strain_and_stress, i, id(L), partial(self._arguments, i, L), dt)
            speed2, bad = self._extremes.tolist()
            if bad >= 0:
                self._refuse(int(bad))
            fastest = max(fastest, speed2 * self._lightness[i])
        self.wave_speed = math.sqrt(fastest)
        if self._bath is not None:
            heat = float(self._bath.sum())
            self._work["bath_heat"] += heat
            self._work["boundary_heat"] += heat

    def _arguments(self, material: int, L: Array) -> tuple[Any, ...]:
        p, several = self._particles, len(self._used) > 1
        return (
            self._analysis, self._parameters[material], material if several else -1, p.F, L, p.tau, p.H, p.mass, p.vol0,
            p.material, p.stress_work, self._viscous(), self._thermal(material), self._limits, self._speed2, self._bad,
            self._extremes,
        )  # fmt: skip

    def energy_density(self) -> Array:
        """Return the stored energy per initial volume of every particle (N,) [pressure]."""
        p = self._particles
        out = np.zeros(p.count)
        for i in self._used:
            stored_energy[self._parallel](
                self._analysis, self._parameters[i], i, p.F, p.H, p.material, self._thermal(i), out
            )
        return out

    def _viscous(self) -> ArtificialViscosity | None:
        if self._viscosity is None:
            return None
        p, (linear, quadratic) = self._particles, self._viscosity
        return ArtificialViscosity(linear, quadratic, self._cell, p.viscous_pressure, p.viscous_work)

    def _heats_bath(self, model: Any) -> bool:
        """Whether the material is to find how work would heat it; equations of state know it without."""
        return self._has_bath and "equation_of_state" not in model.properties

    def _thermal_of(self, plan: Plan, index: int) -> Thermal | None:
        if not plan.has_temperature:
            return None
        parameters = type(self._parameters[index])
        own = dissipated_heat.implementations.get(parameters) is not dissipate_nothing
        return thermal_of(
            self._materials[index], plan.adiabatic, self._has_bath, own or plan.viscosity is not None
        )

    def _thermal(self, index: int) -> Thermal | None:
        """The numbers with the arrays as they are now."""
        numbers, p = self._thermals[index], self._particles
        if numbers is None:
            return None
        history = self._materials[index].history
        rows = {name: p.H[row] for row, name in enumerate(history)}
        expands = numbers.expansion is not None
        return numbers._replace(
            T=p.T,
            T_carried=p.T_carried,
            T_stress=p.T_stress,
            tracked=rows.get("temperature"),
            heat=rows.get("heat_energy") if numbers.own else None,
            plastic_work=rows.get("plastic_work") if expands else None,
            heat_energy=rows.get("heat_energy") if expands else None,
            entropy=p.entropy,
            heat_inflow=p.heat_inflow,
            bath=self._bath,
            scratch=self._scratch,
        )
