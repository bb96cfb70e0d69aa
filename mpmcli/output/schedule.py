"""When output is due: at the first step at or past a due time, which never changes the time step."""

import math

from mpmcli.core.times import is_reached


class Schedule:
    """Due times 0, every, 2 every, … [time]; ``every`` is infinite if there is to be no output after time 0."""

    def __init__(self, every: float):
        if not every > 0.0:
            raise ValueError("the time between outputs must be above 0")
        self.every = every
        self.count = 0

    @property
    def due(self) -> float:
        """The next due time [time]."""
        return self.count * self.every if self.count else 0.0

    def is_due(self, time: float) -> bool:
        """Whether output is due in a state of this time."""
        return is_reached(time, self.due)

    def advance(self, time: float) -> None:
        """Output was made at ``time``: the next is due at the first due time after it."""
        if math.isinf(self.every):
            self.count = 1
            return
        self.count = max(self.count, math.floor(time / self.every))
        while self.is_due(time):
            self.count += 1

    def recall(self, every: float, count: int, time: float) -> None:
        """Go on from a checkpoint of this ``time``: as before, or with another time between outputs."""
        if every == self.every:
            self.count = count
        else:
            self.advance(time)
