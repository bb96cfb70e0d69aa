"""Cylinders and tubes between two points."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from mpmcli.core.model import PositiveLength
from mpmcli.geometry.base import REGIONS, TOLERANCE, Array, Region
from mpmcli.geometry.sphere import inner_below_outer
from mpmcli.geometry.vectors import NonNegativeLength, Point3


@REGIONS.register
class Cylinder(Region):
    """A straight circular cylinder (3D) with flat ends, a tube if `inner_radius` is given."""

    dimensions = frozenset({3})

    kind: Literal["cylinder"]
    start: Point3 = Field(alias="from")
    """Middle of one end."""
    end: Point3 = Field(alias="to")
    """Middle of the other end."""
    radius: PositiveLength
    """Outer radius."""
    inner_radius: NonNegativeLength = 0.0
    """Radius of the hole along the axis; 0 for none."""

    _inner = field_validator("inner_radius")(inner_below_outer)

    @model_validator(mode="after")
    def _has_length(self) -> Cylinder:
        if self.start == self.end:
            raise ValueError("'from' and 'to' are the same point")
        return self

    def _axis(self) -> tuple[float, Array]:
        """Length and direction (3,) of the axis."""
        axis = np.subtract(self.end, self.start)
        length = float(np.linalg.norm(axis))
        return length, axis / length

    def _inside(self, points: Array) -> Array:
        length, axis = self._axis()
        from_start = points - np.array(self.start)[:, None]
        along = sum(a * x for a, x in zip(axis, from_start, strict=True))
        squared = ((from_start - axis[:, None] * along) ** 2).sum(axis=0)
        inside = squared <= (self.radius * (1 + TOLERANCE)) ** 2
        if self.inner_radius:
            inside &= squared >= (self.inner_radius * (1 - TOLERANCE)) ** 2
        return inside & (along >= -TOLERANCE * length) & (along <= (1 + TOLERANCE) * length)

    def _turned_bounds(self, turn: Array) -> tuple[Array, Array]:
        ends = np.array([self.start, self.end]) @ turn.T
        half = self.radius * np.sqrt(np.maximum(1 - (turn @ self._axis()[1]) ** 2, 0))
        return ends.min(axis=0) - half, ends.max(axis=0) + half

    def _measure(self, d: int) -> float:
        return math.pi * (self.radius**2 - self.inner_radius**2) * self._axis()[0]

    def _centroid(self, d: int) -> Array:
        return 0.5 * np.add(self.start, self.end)
