"""Feedback damping: a rate that grows while the kinetic energy exceeds its target, as in NairnMPM."""

from typing import Any

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.core.state import State

RATE = "feedback_rate"
"""Column of the rate, which the state also keeps for a run that is resumed."""


class Feedback:
    """The rate α of feedback damping: dα/dt = 2 g (K − K_target)/M, between 0 and its limit.

    K and M are kinetic energy and mass of all bodies that are not rigid.

    Parameters
    ----------
    model : gain g [1/length²], ``target`` (an expression of t) and ``limit`` or None
    state : keeps the rate
    """

    def __init__(self, model: Any, state: State):
        self._model, self._state = model, state
        state.extra[RATE] = 0.0

    def next_rate(self, time: float, dt: float) -> float:
        """Return the rate of a step of size ``dt`` from ``time`` [1/time]."""
        particles, state, model = self._state.particles, self._state, self._model
        mass = particles.mass
        if state.rigid:
            mass = np.where(np.isin(particles.body, state.rigid), 0.0, mass)
        target = model.target(t=time) / state.full_ring
        if not np.isfinite(target):
            raise SimulationError(f"method.damping.feedback.target is {target:g} at time {time:g}")
        kinetic = 0.5 * float((mass * np.square(particles.V).sum(axis=0)).sum())
        rate = state.extra[RATE] + 2.0 * model.gain * (kinetic - target) / float(mass.sum()) * dt
        rate = max(rate, 0.0) if model.limit is None else min(max(rate, 0.0), model.limit)
        state.extra[RATE] = rate
        return float(rate)
