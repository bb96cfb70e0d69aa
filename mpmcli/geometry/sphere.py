"""Disks and spheres, hollow ones too."""

import math
from typing import Literal

import numpy as np
from pydantic import field_validator
from pydantic_core.core_schema import ValidationInfo

from mpmcli.core.model import PositiveLength
from mpmcli.geometry.base import REGIONS, TOLERANCE, Array, Region
from mpmcli.geometry.vectors import NonNegativeLength, Vector


def inner_below_outer(inner: float, info: ValidationInfo) -> float:
    """Check that a hole is smaller than what it is in."""
    radius = info.data.get("radius")
    if radius is not None and inner >= radius:
        raise ValueError(f"inner_radius must be below radius, but {inner:g} >= {radius:g}")
    return inner


@REGIONS.register
class Sphere(Region):
    """A disk (2D) or a sphere (3D), with a concentric hole if `inner_radius` is given."""

    dimensions = frozenset({2, 3})
    per_axis = ("center",)

    kind: Literal["disk", "sphere"]
    center: Vector
    """Centre."""
    radius: PositiveLength
    """Outer radius."""
    inner_radius: NonNegativeLength = 0.0
    """Radius of the hole; 0 for none."""

    _inner = field_validator("inner_radius")(inner_below_outer)

    def own_dimensions(self) -> frozenset[int]:
        return frozenset({2 if self.kind == "disk" else 3})

    def _inside(self, points: Array) -> Array:
        squared = np.zeros(points.shape[1])
        for x, c in zip(points, self.center, strict=True):
            squared += (x - c) ** 2
        inside = squared <= (self.radius * (1 + TOLERANCE)) ** 2
        if self.inner_radius:
            inside &= squared >= (self.inner_radius * (1 - TOLERANCE)) ** 2
        return inside

    def _turned_bounds(self, turn: Array) -> tuple[Array, Array]:
        center = turn @ np.array(self.center)
        return center - self.radius, center + self.radius

    def _measure(self, d: int) -> float:
        factor = math.pi if d == 2 else 4 * math.pi / 3
        return factor * (self.radius**d - self.inner_radius**d)

    def _centroid(self, d: int) -> Array:
        return np.array(self.center)
