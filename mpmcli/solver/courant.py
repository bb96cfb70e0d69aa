"""The size of the next time step (Nairn 2026, section 3.3), with the Fourier limit of heat conduction."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from mpmcli.core.errors import SimulationError
from mpmcli.stability.scene_limit import step_of_courant

if TYPE_CHECKING:
    from mpmcli.solver.heat_interval import HeatInterval

COLLAPSED = 1e-6
"""A step smaller than this share of the first one ends the simulation."""


class TimeStep:
    """Δt = C Δx_min / max(c, |V|) with the current wave and particle speeds, or a fixed step.

    With conduction on every n-th step, n Δt is Fo Δx_min²/D_max at most, unless the step is fixed.

    Parameters
    ----------
    step : fixed time step, or None
    courant : Courant number, or None with a fixed step
    smallest_cell : Δx_min [length]
    heat : the interval of heat steps, whose limit bounds steps of a Courant number; None without conduction

    Attributes
    ----------
    dt, courant_of_step : size and Courant number of the last step that was chosen
    heat : the interval of heat steps, or None
    """

    def __init__(
        self,
        step: float | None,
        courant: float | None,
        smallest_cell: float,
        heat: HeatInterval | None = None,
    ):
        self.fixed = float(step or 0.0)
        self.heat = heat
        self.courant = courant
        self.smallest_cell = smallest_cell
        self.dt = self.courant_of_step = 0.0
        self._first: float | None = None

    def choose(
        self, wave_speed: float, particle_speed: float, describe: Callable[[str], str] = lambda which: ""
    ) -> float:
        """Choose the size of the next step for these largest speeds [velocity].

        ``describe`` tells, for messages, of the ``fastest`` or the most ``compressed`` particle.

        Raises
        ------
        SimulationError
            If a particle would move by more than a cell, or the step is next to nothing.
        """
        self.dt = self._size(wave_speed, particle_speed, describe)
        self.courant_of_step = self.dt * max(wave_speed, particle_speed) / self.smallest_cell
        return self.dt

    def _size(self, wave_speed: float, particle_speed: float, describe: Callable[[str], str]) -> float:
        if self.courant is None:
            cells = self.fixed * particle_speed / self.smallest_cell
            if cells > 1.0:
                raise SimulationError(
                    f"a particle would move by {cells:.3g} cells in one step of {self.fixed:.3g}; "
                    f"{describe('fastest')}. The step is too long for this speed, or the run is unstable; try "
                    f"time.step below {self.smallest_cell / max(particle_speed, wave_speed):.2g}, or time.courant"
                )
            return self.fixed
        dt = step_of_courant(self.courant, self.smallest_cell, wave_speed, particle_speed)
        if self.heat is not None:
            dt = self.heat.shorten(dt)
        if not (0.0 < dt < math.inf):
            raise SimulationError(
                f"the time step is not finite for wave speed {wave_speed:.3g}, particle speed {particle_speed:.3g} "
                f"and cell {self.smallest_cell:.3g}; check the values and units of materials, velocities and grid"
            )
        if self._first is None:
            self._first = dt
        if not dt > COLLAPSED * self._first:
            which = "fastest" if particle_speed > wave_speed else "compressed"
            raise SimulationError(
                f"the time step decreased from {self._first:.3g} to {dt:.3g}: the wave speed is {wave_speed:.3g}, the "
                f"particle speed {particle_speed:.3g}; {describe(which)}. The run is probably unstable; check "
                f"energy_error in globals.csv, and try time.courant: {0.5 * self.courant:.2g}"
            )
        return dt

    def memory(self) -> dict[str, float]:
        """What it remembers from step to step: the first step, 0 before it."""
        return {"first": self._first or 0.0}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._first = float(memory["first"]) or None
