"""When heat is conducted and over how much time: the Fourier limit of the current state, and the heat steps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mpmcli.core.particles import Particles
from mpmcli.stability.interval import CELLS, MOST_STEPS, ROUNDING

Array = np.ndarray


class HeatLimit:
    """Largest time over which heat may act at once: Fo Δx_min²/D_max.

    D = κ_max/(ρ c_v) has the current density ρ = ρ₀/J of each particle. The J of particles are evaluated only where
    the largest J of ``domain.volume_ratio`` would shorten the time that is asked for.

    Parameters
    ----------
    fourier : Fourier number Fo
    smallest_cell : Δx_min [length]
    diffusivities : (materials,) D at the initial density, 0 where nothing is conducted [length²/time]
    largest_ratio : J beyond which the run has failed
    particles : of the simulation
    """

    def __init__(
        self,
        fourier: float,
        smallest_cell: float,
        diffusivities: Array,
        largest_ratio: float,
        particles: Particles,
    ):
        self._numerator = fourier * smallest_cell**2
        self._diffusivities, self._largest_ratio = np.asarray(diffusivities, dtype=float), largest_ratio
        self._particles = particles

    def shorten(self, time: float) -> float:
        """Return the largest time over which heat may act, ``time`` at most."""
        fastest = float(self._diffusivities.max(initial=0.0)) * self._largest_ratio
        if fastest == 0.0 or time * fastest <= self._numerator:
            return time
        p = self._particles
        diffusivity = float(np.max(self._diffusivities[p.material] * p.determinant(), initial=0.0))
        return min(time, self._numerator / diffusivity) if diffusivity > 0.0 else time


class HeatInterval:
    """Which steps conduct heat, and over how much time.

    Parameters
    ----------
    interval : heat acts on every so many steps; None: as seldom as the limit and the motion allow (``auto``)
    limit : of the time over which heat may act at once
    smallest_cell : Δx_min [length]
    """

    def __init__(self, interval: int | None, limit: HeatLimit, smallest_cell: float):
        self.interval = interval
        self._limit, self._smallest_cell = limit, smallest_cell
        self._steps, self._time, self._path = 0, 0.0, 0.0

    def advance(self, dt: float, speed: float, has_friction: bool = False) -> float:
        """Return the time over which heat acts in the step that begins, 0 if it waits.

        The time is that of all steps since the last heat step.

        Parameters
        ----------
        dt : time step
        speed : of the fastest particle [velocity]
        has_friction : friction heats bodies now, so that ``auto`` does not wait
        """
        self._steps += 1
        self._time += dt
        self._path += speed * dt
        if not self._is_due(dt, speed, has_friction):
            return 0.0
        time = self._time
        self._steps, self._time, self._path = 0, 0.0, 0.0
        return time

    def _is_due(self, dt: float, speed: float, has_friction: bool) -> bool:
        if self.interval is not None:
            return self._steps >= self.interval
        if has_friction or self._steps >= MOST_STEPS:
            return True
        if self._path + speed * dt > CELLS * self._smallest_cell * (1.0 + ROUNDING):
            return True
        next_time = self._time + dt
        return next_time > self._limit.shorten(next_time) * (1.0 + ROUNDING)

    def memory(self) -> dict[str, float]:
        """Return what it remembers from step to step."""
        return {"steps": self._steps, "time": self._time, "path": self._path}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._steps = int(memory["steps"])
        self._time, self._path = float(memory["time"]), float(memory["path"])
