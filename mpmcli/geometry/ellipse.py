"""Ellipses and ellipsoids."""

import math
from typing import Annotated, Literal

import numpy as np

from mpmcli.core.model import PositiveLength
from mpmcli.geometry.base import REGIONS, TOLERANCE, Array, Region
from mpmcli.geometry.vectors import Count, Vector


@REGIONS.register
class Ellipse(Region):
    """An ellipse (2D) or an ellipsoid (3D); turn it with `rotate`."""

    dimensions = frozenset({2, 3})
    per_axis = ("center", "semi_axes")

    kind: Literal["ellipse", "ellipsoid"]
    center: Vector
    """Centre."""
    semi_axes: Annotated[tuple[PositiveLength, ...], Count(2, 3)]
    """Half of its width along each axis."""

    def own_dimensions(self) -> frozenset[int]:
        return frozenset({2 if self.kind == "ellipse" else 3})

    def _inside(self, points: Array) -> Array:
        squared = np.zeros(points.shape[1])
        for x, c, a in zip(points, self.center, self.semi_axes, strict=True):
            squared += ((x - c) / a) ** 2
        return squared <= (1 + TOLERANCE) ** 2

    def _turned_bounds(self, turn: Array) -> tuple[Array, Array]:
        center = turn @ np.array(self.center)
        half = np.sqrt(((turn * np.array(self.semi_axes)) ** 2).sum(axis=1))
        return center - half, center + half

    def _measure(self, d: int) -> float:
        return (math.pi if d == 2 else 4 * math.pi / 3) * math.prod(self.semi_axes)

    def _centroid(self, d: int) -> Array:
        return np.array(self.center)
