"""A second run of a scene beside the first, with perturbed velocities: does the perturbation grow?

The total energy does not show an instability where plastic flow, friction or damping dissipates the spurious energy.
The difference of two runs with nearly the same initial velocities shows it within a few steps.
"""

import math
from typing import Any

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.scene.loader import LoadedScene
from mpmcli.solver.simulation import Simulation

AMPLITUDE = 1e-6
"""Standard deviation of each component's disturbance over the largest speed, of waves or particles."""
EVERY = 5
"""Steps between comparisons."""
FIRST = 20
"""Number of first steps that are all compared."""


class DisturbedTwin:
    """The same scene with randomly perturbed initial velocities, run with the time steps of the first run.

    ``growth``: largest difference of velocities between both runs over that at the start, root mean square over mass.
    """

    def __init__(self, loaded: LoadedScene, first: Simulation, threads: int | None):
        span = loaded.scene.time.model_copy(update={"courant": None, "step": 1.0})
        scene = loaded.scene.model_copy(update={"time": span})
        self._first = first
        self._twin = Simulation(LoadedScene(**(vars(loaded) | {"scene": scene})), threads=threads)
        p = self._twin.particles
        amplitude = AMPLITUDE * max(first.wave_speed, first.particle_speed)
        rigid = np.array([m.kind == "rigid" for m in first.state.material_models])[p.material]
        noise = np.random.default_rng(0).normal(scale=amplitude, size=p.V.shape)
        p.V += np.where(rigid, 0.0, noise)
        self._start = self._difference()
        self.growth = 0.0

    def step(self) -> None:
        """Repeat the step that the first run has just made, before events turn its clocks."""
        if self.growth == math.inf:
            return
        self._twin.time_step.fixed = self._first.state.dt
        self._twin.clocks.recall(self._first.clocks.memory())
        try:
            with np.errstate(all="ignore"):
                self._twin.step()
        except SimulationError:
            self.growth = math.inf
            return
        step = self._first.state.step
        if step <= FIRST or step % EVERY == 0:
            self.look()

    def look(self) -> None:
        """Update the growth by the difference of both runs."""
        found = self._difference()
        share = found / self._start if self._start > 0.0 else 0.0
        self.growth = max(self.growth, share if math.isfinite(share) else math.inf)

    def _difference(self) -> float:
        one, other = _in_order(self._first.particles), _in_order(self._twin.particles)
        if one[2].shape != other[2].shape or (one[2] != other[2]).any():
            return math.inf  # particles left the grid in one run, and not in the other
        (V, mass, _), (W, _, _) = one, other
        return math.sqrt(float((mass * np.square(V - W).sum(axis=0)).sum()) / float(mass.sum()))


def _in_order(p: Any) -> tuple[Any, Any, Any]:
    """Velocities (d, N), masses and numbers (N,) by the numbers of the particles."""
    order = np.argsort(p.id, kind="stable")
    return p.V[:, order], p.mass[order], p.id[order]
