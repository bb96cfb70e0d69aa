"""Clocks of conditions, loads and rigid bodies, which events stop and turn back."""

from collections.abc import Hashable, Mapping
from typing import Any

import numpy as np

from mpmcli.boundary.base import EFFECTS, Array, Holder, LoadModel, Values

RATES = {"hold": 0.0, "reverse": -1.0, "continue": 1.0}
"""Rate of a clock after each kind of event."""


class Clock:
    """The time of a condition or load: it runs, rests, or runs backwards until it is 0 again."""

    def __init__(self) -> None:
        self._shown, self._since, self._rate = 0.0, 0.0, 1.0

    def time(self, time: float) -> float:
        """Return what it shows at a time of the simulation."""
        return max(self._shown + self._rate * (time - self._since), 0.0)

    def rate(self, time: float) -> float:
        """Return how fast it runs from then on."""
        return self._rate if self._rate >= 0.0 or self.time(time) > 0.0 else 0.0

    def turn(self, rate: float, time: float) -> None:
        """Let it run at another rate from a time on."""
        self._shown, self._since, self._rate = self.time(time), time, rate

    def numbers(self) -> Array:
        """Return what it remembers."""
        return np.array([self._shown, self._since, self._rate])

    def recall(self, numbers: Array) -> None:
        """Take it back."""
        self._shown, self._since, self._rate = (float(number) for number in numbers)


class Clocks(dict[str, Clock]):
    """Clocks by the name of what goes by them."""

    def memory(self) -> dict[str, Array]:
        """Return what a checkpoint keeps of them."""
        return {name: clock.numbers() for name, clock in self.items()}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Take it back."""
        for name, clock in self.items():
            clock.recall(memory[name])


class ClockedHolder:
    """A condition on a grid that goes by a clock."""

    varies = True

    def __init__(self, holder: Holder, clock: Clock):
        self._holder, self._clock = holder, clock
        self.direction = holder.direction

    def renew(self, active: Array) -> None:
        """Take over the active nodes."""
        self._holder.renew(active)

    def key(self, time: float) -> Hashable:
        """Key of the condition then."""
        return self._holder.key(self._clock.time(time))

    def nodes(self, time: float) -> Array:
        """The held nodes."""
        return self._holder.nodes(self._clock.time(time))

    def values(self, time: float, coordinates: Array) -> Array | float:
        """Velocities, multiplied by the clock's rate."""
        return self._clock.rate(time) * self._holder.values(self._clock.time(time), coordinates)


class ClockedLoad:
    """A load that goes by a clock; all else is that of its model."""

    def __init__(self, model: LoadModel, clock: Clock):
        self._model, self._clock = model, clock

    def __getattr__(self, name: str) -> Any:
        return getattr(self._model, name)

    def acts_at(self, time: float) -> bool:
        """Whether it acts."""
        return self._model.acts_at(self._clock.time(time))

    def nodal_force_at(self, time: float) -> Any:
        """Return a point of the grid, and the force there."""
        return self._model.nodal_force_at(self._clock.time(time))

    def uniform_acceleration(self, time: float) -> Values:
        """Return the acceleration of all particles alike."""
        return self._model.uniform_acceleration(self._clock.time(time))


def _at_clock(name: str) -> Any:
    def value(self: ClockedLoad, points: Array, time: float) -> Values:
        found: Values = getattr(self._model, name)(points, self._clock.time(time))
        return found

    return value


for _name in EFFECTS["velocity"]:
    if _name not in ("impedance_of", "nodal_force_at", "uniform_acceleration"):
        setattr(ClockedLoad, _name, _at_clock(_name))


class ClockedVelocity:
    """A component of the velocity of a rigid body that goes by a clock."""

    def __init__(self, component: Any, clock: Clock):
        self._component, self._clock = component, clock
        self.source, self.variables = component.source, component.variables

    def __call__(self, x: Any, y: Any, z: Any, time: float) -> Any:
        """Return the velocity at points, multiplied by the clock's rate."""
        return self._clock.rate(time) * self._component(x, y, z, self._clock.time(time))
