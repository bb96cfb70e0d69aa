"""Annuli."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from mpmcli.core.model import PositiveLength
from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.vectors import Vector


@REGIONS.register
class Annulus(Region):
    """The points between two circles (2D)."""

    dimensions = frozenset({2})
    per_axis = ("center",)

    kind: Literal["annulus"]
    center: Vector
    """Centre of both circles."""
    inner: PositiveLength
    """Radius of the inner circle."""
    outer: PositiveLength
    """Radius of the outer circle."""

    def _inside(self, points: Array) -> Array:
        r = np.hypot(points[0] - self.center[0], points[1] - self.center[1])
        return (r >= self.inner) & (r <= self.outer)

    def _bounds(self, d: int) -> tuple[Array, Array]:
        center = np.array(self.center)
        return center - self.outer, center + self.outer

    def _measure(self, d: int) -> float:
        return math.pi * (self.outer**2 - self.inner**2)
