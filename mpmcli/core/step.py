"""What one time step is: its size, when it begins, and the choices of the scene that are in force in it."""

from typing import Any, NamedTuple


class Step(NamedTuple):
    """One time step, as every part of a simulation is told of it."""

    plan: Any
    """The choices of the scene in this step; periodic transfers change them from step to step."""
    dt: float
    """Δt [time]."""
    time: float
    """Time at which the step begins."""
