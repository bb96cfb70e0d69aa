"""Polygons in the plane."""

from typing import Annotated, Literal

import numpy as np
from pydantic import field_validator

from mpmcli.geometry.base import REGIONS, TOLERANCE, Array, Region
from mpmcli.geometry.vectors import Count, Point2


@REGIONS.register
class Polygon(Region):
    """A polygon (2D) given by its corners in order, either way round; its edges must not cross."""

    dimensions = frozenset({2})

    kind: Literal["polygon"]
    points: Annotated[tuple[Point2, ...], Count(3, 5000, "corners")]
    """Corners [x, y] in order; the last one is joined to the first."""

    @field_validator("points")
    @classmethod
    def _simple(cls, points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        corners = _without_repeats(np.array(points))
        crossing = first_crossing(corners, np.roll(corners, -1, axis=0))
        if crossing is not None:
            (ax, ay), (bx, by) = (corners[k] for k in crossing)
            raise ValueError(
                f"the edge from [{ax:g}, {ay:g}] crosses or touches the edge from [{bx:g}, {by:g}]"
            )
        if len(corners) < 3 or abs(_area(corners)) <= 1e-12 * np.prod(np.ptp(corners, axis=0)):
            raise ValueError("the corners enclose no area")
        return points

    @property
    def corners(self) -> Array:
        """Corners (n, 2) without repetitions."""
        return _without_repeats(np.array(self.points))

    def _inside(self, points: Array) -> Array:
        # even-odd rule along x; every edge looks only at the points whose y it spans
        corners = self.corners
        reach = float(np.ptp(corners, axis=0).max())
        margin = TOLERANCE * reach
        order = np.argsort(points[1], kind="stable")
        x, y = points[0, order], points[1, order]
        odd = np.zeros(len(x), dtype=bool)
        near = np.zeros(len(x), dtype=bool)
        for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            if ay > by:
                ax, ay, bx, by = bx, by, ax, ay
            spanned = slice(*np.searchsorted(y, [ay, by]))
            if spanned.start < spanned.stop:
                odd[spanned] ^= x[spanned] < ax + (y[spanned] - ay) * ((bx - ax) / (by - ay))
            wide = slice(*np.searchsorted(y, [ay - margin, by + margin], side="right"))
            if wide.start == wide.stop:
                continue
            length = np.hypot(bx - ax, by - ay)
            tx, ty = (bx - ax) / length, (by - ay) / length
            along = (x[wide] - ax) * tx + (y[wide] - ay) * ty
            across = (x[wide] - ax) * ty - (y[wide] - ay) * tx
            near[wide] |= (np.abs(across) <= margin) & (along >= -margin) & (along <= length + margin)
        inside = np.empty(len(x), dtype=bool)
        inside[order] = odd | near
        return inside

    def _turned_bounds(self, turn: Array) -> tuple[Array, Array]:
        corners = self.corners @ turn.T
        return corners.min(axis=0), corners.max(axis=0)

    def _measure(self, d: int) -> float:
        return abs(_area(self.corners))

    def _centroid(self, d: int) -> Array:
        origin = self.corners[0]
        a = self.corners - origin
        b = np.roll(a, -1, axis=0)
        cross = a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]
        return origin + ((a + b) * cross[:, None]).sum(axis=0) / (3 * cross.sum())


def _without_repeats(corners: Array) -> Array:
    """Corners (n, 2) that differ from the one before."""
    return corners[(corners != np.roll(corners, 1, axis=0)).any(axis=1)]


def _area(corners: Array) -> float:
    """Signed area, positive if the corners go from x towards y."""
    a = corners - corners[0]
    b = np.roll(a, -1, axis=0)
    return 0.5 * float((a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]).sum())


def first_crossing(start: Array, end: Array, is_closed: bool = True) -> tuple[int, int] | None:
    """Two of the edges from ``start`` to ``end`` (n, 2) that cross or touch without being neighbours, or None.

    ``is_closed``: the last edge is a neighbour of the first.
    """
    n = len(start)
    low, high = np.minimum(start, end), np.maximum(start, end)

    def side(a: Array, b: Array, p: Array) -> Array:
        """-1, 0, 1: on which side of the line from a to b the points p lie."""
        return np.sign((b[0] - a[0]) * (p[:, 1] - a[1]) - (b[1] - a[1]) * (p[:, 0] - a[0]))

    (left, bottom), (right, top) = (np.ascontiguousarray(side.T) for side in (low, high))
    for i in range(n - 2):
        rest = slice(i + 2, n - (is_closed and i == 0))
        boxes_meet = (left[rest] <= right[i]) & (right[rest] >= left[i])
        boxes_meet &= (bottom[rest] <= top[i]) & (top[rest] >= bottom[i])
        others = i + 2 + np.flatnonzero(boxes_meet)
        if not len(others):
            continue
        first = side(start[i], end[i], start[others]) * side(start[i], end[i], end[others])
        for j in others[first <= 0]:
            both = side(start[j], end[j], np.array([start[i], end[i]]))
            if both[0] * both[1] <= 0:
                return i, int(j)
    return None
