"""When heat is conducted and over how much time: the Fourier limit of the current state, and the heat steps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmcli.core.particles import Particles
from mpmcli.stability.heat import MOST_CELLS, MOST_STEPS, ROUNDING, chosen_fourier, diffusivities

Array = np.ndarray

REFRESH = 10
"""Steps after which the largest diffusivity is evaluated again: volumes change little in them."""
UNKNOWN = -1.0
"""A diffusivity that was not evaluated yet."""


def make_interval(scene: Any, particles: Particles, speed: Callable[[], float]) -> HeatInterval:
    """Return which steps of a scene conduct heat; ``speed`` gives that of the fastest particle [velocity]."""
    of_material, cell = diffusivities(scene), float(min(scene.grid.cell))
    at_rest = np.array([of_material.get(name, 0.0) for name in scene.materials])
    limit = HeatLimit(chosen_fourier(scene), cell, at_rest, float(scene.domain.volume_ratio[1]), particles)
    asked = scene.heat.interval
    return HeatInterval(None if asked == "auto" else asked, limit, cell, speed)


class HeatLimit:
    """Largest time over which heat may act at once: Fo Δx_min²/D_max.

    D = κ_max/(ρ c_v) has the current density ρ = ρ₀/J of each particle. The J of particles are evaluated once in
    ``REFRESH`` steps, and only where the largest J of ``domain.volume_ratio`` would shorten the time that is asked for.

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
        self.fourier, self._smallest_cell = fourier, smallest_cell
        self._numerator = fourier * smallest_cell * smallest_cell
        self._diffusivities, self._largest_ratio = np.asarray(diffusivities, dtype=float), largest_ratio
        self._particles = particles
        self._known, self._age = UNKNOWN, 0

    def shorten(self, time: float) -> float:
        """Return the largest time over which heat may act, ``time`` at most."""
        fastest = float(self._diffusivities.max(initial=0.0)) * self._largest_ratio
        if fastest == 0.0 or time * fastest <= self._numerator:
            return time
        if self._known < 0.0 or self._age >= REFRESH:
            self._known, self._age = self._largest_diffusivity(), 0
        diffusivity = self._known
        return min(time, self._numerator / diffusivity) if diffusivity > 0.0 else time

    def pass_step(self) -> None:
        """Note that a step has begun."""
        self._age += 1

    def memory(self) -> dict[str, float]:
        """Return what it remembers from step to step."""
        return {"diffusivity": self._known, "age": self._age}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._known, self._age = float(memory["diffusivity"]), int(memory["age"])

    def fourier_of(self, time: float) -> float:
        """Return the Fourier number of a heat step of this length."""
        return self._largest_diffusivity() * time / self._smallest_cell / self._smallest_cell

    def _largest_diffusivity(self) -> float:
        p = self._particles
        return float(np.max(self._diffusivities[p.material] * p.determinant(), initial=0.0))


class HeatInterval:
    """Which steps conduct heat, and over how much time.

    Parameters
    ----------
    interval : heat acts on every so many steps; None: as seldom as the limit and the motion allow (``auto``)
    limit : of the time over which heat may act at once
    smallest_cell : Δx_min [length]
    speed : gives the speed of the fastest particle now [velocity]

    Attributes
    ----------
    has_friction : tells whether friction heats bodies now, so that ``auto`` does not wait
    last : time over which heat acted last
    """

    def __init__(
        self,
        interval: int | None,
        limit: HeatLimit,
        smallest_cell: float,
        speed: Callable[[], float],
    ):
        self.interval = interval
        self.limit, self._smallest_cell = limit, smallest_cell
        self._speed = speed
        self.has_friction: Callable[[], bool] = lambda: False
        self._steps, self._time, self._path = 0, 0.0, 0.0
        self.last = 0.0

    @property
    def last_fourier(self) -> float:
        """Fourier number of the last heat step."""
        return self.limit.fourier_of(self.last)

    def shorten(self, dt: float) -> float:
        """Return a time step that is ``dt`` at most, so that heat keeps its limit."""
        steps = self.interval or 1
        return self.limit.shorten(steps * dt) / steps

    def advance(self, dt: float) -> float:
        """Return the time over which heat acts in the step ``dt`` that begins, 0 if it waits.

        The time is that of all steps since the last heat step.
        """
        self.limit.pass_step()
        path = self._speed() * dt
        self._steps += 1
        self._time += dt
        self._path += path
        if not self._is_due(dt, path):
            return 0.0
        self.last = self._time
        self._steps, self._time, self._path = 0, 0.0, 0.0
        return self.last

    def _is_due(self, dt: float, path: float) -> bool:
        """Return whether heat acts; one more step like this one might be too long."""
        if self.interval is not None:
            return self._steps >= self.interval
        if self._steps >= MOST_STEPS or self.has_friction():
            return True
        if self._path + path > MOST_CELLS * self._smallest_cell * (1.0 + ROUNDING):
            return True
        next_time = self._time + dt
        return next_time > self.limit.shorten(next_time) * (1.0 + ROUNDING)

    def memory(self) -> dict[str, float]:
        """Return what it remembers from step to step."""
        return {"steps": self._steps, "time": self._time, "path": self._path} | self.limit.memory()

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._steps = int(memory["steps"])
        self._time, self._path = float(memory["time"]), float(memory["path"])
        self.limit.recall(memory)
