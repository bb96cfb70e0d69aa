"""Where a growing tip meets another crack, or its own."""

from typing import NamedTuple

import numpy as np

from mpmcli.cracks.chain import END, Chain

Array = np.ndarray

BACK = 1e-9
"""Sine of the angle to its last segment below which a step goes straight back [-]."""


class Meeting(NamedTuple):
    """Where a tip joins a crack.

    point : (2,) on the plane of that crack [length]
    way : share of the step to the place nearest to it
    """

    point: Array
    way: float


def first_meeting(place: Array, goal: Array, planes: list[Array], reach: float) -> Meeting | None:
    """Return where the step from ``place`` to ``goal`` (2,) first crosses, or ends within ``reach`` of, another crack.

    ``planes`` are the points (2, P) of the other chains. A tip that lies within reach already, and moves away, meets
    nothing.
    """
    found: list[Meeting] = []
    for X in planes:
        a, b = X[:, :-1], X[:, 1:]
        crossing = _crossing(place, goal, a, b)
        if crossing is not None:
            found.append(crossing)
            continue
        nearest, distance = _nearest(goal, a, b)
        if distance <= reach and distance < _nearest(place, a, b)[1]:
            found.append(Meeting(nearest, 1.0))
    return min(found, key=lambda meeting: meeting.way, default=None)


def self_meeting(chain: Chain, end: int, goal: Array, reach: float) -> Meeting | None:
    """Return where the step of a tip to ``goal`` (2,) first meets the chain that it belongs to.

    The last segment, at whose end the tip lies, is met only by a step straight back along it: at once.
    """
    last, inner = (chain.X[:, end], chain.X[:, -2 if end else 1])
    step, way = goal - last, inner - last
    if abs(_cross(step, way)) <= BACK * float(step @ way):
        return Meeting(last.copy(), 0.0)
    older = chain.X[:, :-1] if end == END else chain.X[:, 1:]
    return first_meeting(last, goal, [older], reach) if older.shape[1] > 1 else None


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[0] * b[1] - a[1] * b[0])


def _crossing(place: Array, goal: Array, a: Array, b: Array) -> Meeting | None:
    """The first place at which the step crosses one of the segments from ``a`` to ``b`` (2, n)."""
    step, side = (goal - place)[:, None], b - a
    area = _cross(step, side)
    with np.errstate(divide="ignore", invalid="ignore"):
        way = _cross(a - place[:, None], side) / area
        along = _cross(a - place[:, None], step) / area
    hits = np.flatnonzero((area != 0.0) & (way >= 0.0) & (way <= 1.0) & (along >= 0.0) & (along <= 1.0))
    if not hits.size:
        return None
    first = hits[np.argmin(way[hits])]
    return Meeting(place + way[first] * step[:, 0], float(way[first]))


def _nearest(x: Array, a: Array, b: Array) -> tuple[Array, float]:
    """The point of the segments that is nearest to ``x`` (2,), and its distance."""
    side = b - a
    along = np.clip(((x[:, None] - a) * side).sum(axis=0) / (side**2).sum(axis=0), 0.0, 1.0)
    points = a + along * side
    distance = np.hypot(*(points - x[:, None]))
    first = int(np.argmin(distance))
    return points[:, first], float(distance[first])
