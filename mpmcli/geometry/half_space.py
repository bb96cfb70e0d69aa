"""Half spaces: everything on one side of a plane."""

from typing import Literal

import numpy as np

from mpmcli.geometry.base import REGIONS, TOLERANCE, Array, Region
from mpmcli.geometry.vectors import Direction, Vector


@REGIONS.register
class HalfSpace(Region):
    """Everything behind a plane (in 2D a line, in 1D a point): the points x with n·(x − p) ≤ 0.

    A body of this region ends where the grid ends. It turns about its point.
    """

    dimensions = frozenset({1, 2, 3})
    per_axis = ("point", "normal")

    kind: Literal["half_space"]
    point: Vector
    """A point p of the plane."""
    normal: Direction
    """Direction n, of any length, that points out of the region."""

    def _inside(self, points: Array) -> Array:
        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        level = sum(n * p for n, p in zip(normal, self.point, strict=True))
        height, rounding = np.full((2, points.shape[1]), [[-level], [abs(level)]])
        for n, x in zip(normal, points, strict=True):
            height += n * x
            rounding += np.abs(n * x)
        return height <= 1e-3 * TOLERANCE * rounding

    def _turned_bounds(self, turn: Array) -> tuple[Array, Array]:
        normal, point = turn @ np.array(self.normal), turn @ np.array(self.point)
        lower, upper = np.full(len(turn), -np.inf), np.full(len(turn), np.inf)
        along = np.flatnonzero(np.abs(normal) > 1e-12 * np.abs(normal).max())
        if len(along) == 1:
            axis = along[0]
            (upper if normal[axis] > 0 else lower)[axis] = point[axis]
        return lower, upper

    def _pivot(self, d: int) -> Array:
        return np.array(self.point)
