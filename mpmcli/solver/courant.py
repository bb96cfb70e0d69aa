"""The size of the next time step (Nairn 2026, section 3.3)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mpmcli.core.errors import SimulationError

COLLAPSED = 1e-6
"""A step smaller than this share of the first one ends the simulation."""


class TimeStep:
    """Δt = C Δx_min / max(c, |V|) with the current wave and particle speeds, or a fixed step.

    Parameters
    ----------
    span : the scene's ``time``
    smallest_cell : Δx_min [length]
    """

    def __init__(self, span: Any, smallest_cell: float):
        self.fixed = float(span.step or 0.0)
        self.courant = None if span.courant is None else float(span.courant)
        self.smallest_cell = smallest_cell
        self._first: float | None = None

    def choose(self, wave_speed: float, particle_speed: float) -> float:
        """Size of the next step for these largest speeds [velocity]."""
        if self.courant is None:
            return self.fixed
        dt = self.courant * self.smallest_cell / max(wave_speed, particle_speed)
        if self._first is None:
            self._first = dt
        if not dt > COLLAPSED * self._first:
            raise SimulationError(
                f"the time step collapsed to {dt:.3g}, from {self._first:.3g} at the start: the largest wave speed "
                f"is {wave_speed:.3g}, the largest particle speed {particle_speed:.3g}; try a smaller Courant number"
            )
        return dt

    def memory(self) -> dict[str, float]:
        """What it remembers from step to step: the first step, 0 before it."""
        return {"first": self._first or 0.0}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._first = float(memory["first"]) or None

    def courant_of(self, dt: float, wave_speed: float, particle_speed: float) -> float:
        """Courant number that a step of ``dt`` has."""
        return dt * max(wave_speed, particle_speed) / self.smallest_cell
