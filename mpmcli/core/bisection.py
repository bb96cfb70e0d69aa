"""A limit between numbers that hold and numbers that do not, found by bisection."""

from collections.abc import Callable
from itertools import pairwise

FIRST_STRIDE = 0.03
"""First stride of a search, as a share of where it begins."""


def bisect_limit(
    is_stable: Callable[[int], bool], start: int, lowest: int, highest: int, checks: int = 0
) -> tuple[int | None, int | None]:
    """Neighbours (stable, unstable = stable + 1) between ``lowest`` and ``highest``, searched from ``start``.

    The first is None if even ``lowest`` is unstable (the second is then ``lowest``), the second if even ``highest`` is
    stable. Once they are found, up to ``checks`` numbers amid those found stable are checked too, the widest gap
    first, and from an unstable one the search goes on downward: there may be stable numbers above unstable ones. No
    number is asked for twice.
    """
    low, high = None, None
    stable: list[int] = []
    place = min(max(start, lowest), highest)
    stride = max(1, round(FIRST_STRIDE * place))
    while low is None or high is None:
        if is_stable(place):
            stable.append(place)
            low = place
            if place == highest:
                break
            place = min(place + stride, highest)
        else:
            high = place
            if place == lowest:
                return None, lowest
            # not far below at once: runs with small steps are long
            place = max(place - stride, place // 2, lowest)
        stride *= 2
    while True:
        while high is not None and high - low > 1:
            middle = (low + high) // 2
            if is_stable(middle):
                stable.append(middle)
                low = middle
            else:
                high = middle
        while checks > 0 and (gap := _widest_gap(stable)) is not None:
            checks -= 1
            middle = sum(gap) // 2
            if not is_stable(middle):
                low, high = gap[0], middle
                stable = [each for each in stable if each <= low]
                break
            stable.append(middle)
        else:
            return low, high


def _widest_gap(stable: list[int]) -> tuple[int, int] | None:
    """Neighbours among these numbers with most others between them, the highest of equals; None if there are none."""
    gaps = [(upper - lower, lower) for lower, upper in pairwise(sorted(stable)) if upper - lower > 1]
    if not gaps:
        return None
    width, lower = max(gaps)
    return lower, lower + width
