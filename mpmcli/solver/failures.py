"""What a message says of a run that cannot go on: which particle, where, and what to try."""

import math

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.state import State
from mpmcli.solver.courant import TimeStep

Array = np.ndarray

LIMITED = 0.99
"""Share of the Fourier number of a scene from which on it has set the step."""


class Failures:
    """Raises the errors of a running simulation, in words for people.

    Parameters
    ----------
    particles, state, grid, time_step : of the simulation
    volume_ratio : smallest and largest J that a particle may have
    """

    def __init__(
        self,
        particles: Particles,
        state: State,
        grid: Grid,
        time_step: TimeStep,
        volume_ratio: tuple[float, float],
    ):
        self._particles, self._state, self._grid = particles, state, grid
        self._time_step, self._limits = time_step, volume_ratio

    def describe(self, particle: int) -> str:
        """Particle, body, position, cell and time in words; ``particle`` is its place in memory."""
        p, state, grid = self._particles, self._state, self._grid
        X = p.X[:, particle]
        at = ", ".join(f"{x:.6g}" for x in X)
        place = np.floor((X - grid.lower) / grid.cell)
        cell = f", cell ({', '.join(f'{i:.10g}' for i in place)})," if np.isfinite(place).all() else ""
        return (
            f"particle {p.id[particle]} of body '{state.bodies[p.body[particle]]}' at ({at}){cell} "
            f"in step {state.step + 1}, time {state.time:.6g}"
        )

    def describe_extreme(self, which: str) -> str:
        """The ``fastest`` or the most ``compressed`` particle in words."""
        p = self._particles
        if which == "fastest":
            speed = np.sqrt(np.square(p.V).sum(axis=0))
            particle = int(np.argmax(speed))
            return f"the fastest is {self.describe(particle)}, with speed {speed[particle]:.3g}"
        J = p.determinant()
        particle = int(np.argmin(J))
        return f"the most compressed is {self.describe(particle)}, with J = {J[particle]:.3g}"

    @np.errstate(all="ignore")
    def refuse_state(self, particle: int) -> None:
        """Raise SimulationError for a particle whose stress or J is impossible."""
        J = float(self._particles.determinant()[particle])
        low, high = self._limits
        if np.isfinite(J) and J <= 0.0:
            what = f"J = det F = {J:.3g}: the particle is inverted"
        elif np.isfinite(J) and not low <= J <= high:
            what = f"J = {J:.6g} is outside domain.volume_ratio, {low:g} to {high:g}"
        else:
            what = "the stress is not finite"
        raise SimulationError(f"{what}; {self.describe(particle)}. {self._advice()}")

    def refuse_temperature(self, particle: int) -> None:
        """Raise SimulationError for a particle whose temperature is negative, not finite, or rose by too much."""
        T = float(np.asarray(self._particles.T)[particle])
        what = f"the temperature became {T:.4g}" if np.isfinite(T) else "the temperature is not finite"
        if T > 0.0 and np.isfinite(T):
            what += ", more than twice the highest one before the step"
        raise SimulationError(f"{what}; {self.describe(particle)}. {self._advice_on_heat()}")

    def refuse_leap(self, cells: float) -> None:
        """Raise SimulationError if a particle has just moved by more than a cell along an axis."""
        if 1.0 < cells < np.inf:
            raise SimulationError(
                f"a particle moved by {cells:.3g} cells in one step; {self.describe_extreme('fastest')}. "
                f"{self._advice()}"
            )

    def refuse_speed(self, speed: float) -> None:
        """Raise SimulationError if the largest speed of particles is not finite."""
        if not math.isfinite(speed):
            bad = ~np.isfinite(self._particles.V).all(axis=0)
            raise SimulationError(
                f"the velocity is not finite; {self.describe(int(np.argmax(bad)))}. {self._advice()}"
            )

    def _advice(self) -> str:
        step = self._time_step
        if step.dt == 0.0:  # a body that is not in its stress-free state
            return "The run has not begun; check 'expansion', 'T0' and the initial temperature"
        key, half = ("step", 0.5 * step.dt) if step.courant is None else ("courant", 0.5 * step.courant)
        return (
            f"The last time step, {step.dt:.3g} (Courant number {step.courant_of_step:.2g}), is probably too long; "
            f"try time.{key}: {half:.2g}"
        )

    def _advice_on_heat(self) -> str:
        """What to try where heat is conducted over too long a time, or too much of it enters in a step."""
        step, heat = self._time_step, self._time_step.heat
        assert heat is not None
        fourier = heat.last_fourier
        if heat.interval is not None and heat.interval > 1:
            cure = f"heat.interval: {heat.interval // 2}"
        elif step.courant is None:
            cure = f"time.step: {0.5 * step.dt:.2g}"
        elif fourier > LIMITED * heat.limit.fourier:
            cure = f"heat.fourier: {0.5 * fourier:.2g}"
        else:
            cure = f"time.courant: {0.5 * step.courant_of_step:.2g}"
        return (
            f"The last heat step, {heat.last:.3g} (Fourier number {fourier:.2g}), is probably too long for conduction, "
            f"or for the power of a load; try {cure}, or check the values and units of heat_capacity, conductivity "
            "and loads"
        )
