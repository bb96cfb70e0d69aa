"""Comparing times, which are sums of time steps."""

TOLERANCE = 1e-9
"""Relative slack, so that a time that is 0.07 but for round-off counts as 0.07."""


def is_reached(time: float, due: float) -> bool:
    """Whether ``time`` is at or past ``due``, but for round-off."""
    return time >= due - TOLERANCE * abs(due)
