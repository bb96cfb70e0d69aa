"""A limit between numbers that hold and numbers that do not, found by bisection."""

from __future__ import annotations

from collections.abc import Callable

FIRST_STRIDE = 0.03
"""First stride of a search, as a share of where it begins."""


def bisect_limit(
    is_stable: Callable[[int], bool], start: int, lowest: int, highest: int
) -> tuple[int | None, int | None]:
    """Neighbours (stable, unstable = stable + 1) between ``lowest`` and ``highest``, searched from ``start``.

    The first is None if even ``lowest`` is unstable (the second is then ``lowest``), the second if even ``highest`` is
    stable.
    """
    low, high = None, None
    place = min(max(start, lowest), highest)
    stride = max(1, round(FIRST_STRIDE * place))
    while low is None or high is None:
        if is_stable(place):
            low = place
            if place == highest:
                return highest, None
            place = min(place + stride, highest)
        else:
            high = place
            if place == lowest:
                return None, lowest
            # not far below at once: runs with small steps are long
            place = max(place - stride, place // 2, lowest)
        stride *= 2
    while high - low > 1:
        middle = (low + high) // 2
        if is_stable(middle):
            low = middle
        else:
            high = middle
    return low, high
