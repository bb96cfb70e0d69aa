"""How many steps lie between two heat steps that ``heat.interval: auto`` selects."""

from __future__ import annotations

import math

MOST_STEPS = 100
"""Largest interval that ``auto`` selects."""
CELLS = 0.5
"""No particle moves by more than so many cells between two heat steps that ``auto`` selects."""
ROUNDING = 1e-9
"""Relative slack of comparisons of times."""


def largest_interval(
    dt: float, limit: float, speed: float, smallest_cell: float, has_friction: bool = False
) -> int:
    """Return the number of steps between heat steps that ``interval: auto`` selects.

    Parameters
    ----------
    dt : time step
    limit : largest time over which heat may act at once
    speed : of the fastest particle [velocity]
    smallest_cell : Δx_min [length]
    has_friction : friction heats bodies, which needs heat in every step
    """
    if has_friction:
        return 1
    within = min(limit, CELLS * smallest_cell / speed if speed > 0.0 else math.inf) * (1.0 + ROUNDING)
    return max(1, MOST_STEPS if within >= MOST_STEPS * dt else math.floor(within / dt))
