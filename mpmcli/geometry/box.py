"""Boxes: an interval in 1D, a rectangle in 2D, a block in 3D."""

from typing import Literal

import numpy as np
from pydantic import field_validator
from pydantic_core.core_schema import ValidationInfo

from mpmcli.geometry.base import REGIONS, TOLERANCE, Array, Region
from mpmcli.geometry.vectors import Vector


@REGIONS.register
class Box(Region):
    """An interval (1D), rectangle (2D) or block (3D) along the grid's axes."""

    dimensions = frozenset({1, 2, 3})
    per_axis = ("lower", "upper")

    kind: Literal["box"]
    lower: Vector
    """Corner with the smallest coordinates."""
    upper: Vector
    """Corner with the largest coordinates."""

    @field_validator("upper")
    @classmethod
    def _above_lower(cls, upper: tuple[float, ...], info: ValidationInfo) -> tuple[float, ...]:
        lower = info.data.get("lower")
        if lower is None:
            return upper
        if len(lower) != len(upper):
            raise ValueError(f"lower has {len(lower)} numbers and upper {len(upper)}")
        for axis, low, high in zip("xyz", lower, upper, strict=False):
            if not low < high:
                raise ValueError(f"upper must lie above lower, but {high:g} <= {low:g} along {axis}")
        return upper

    def _inside(self, points: Array) -> Array:
        inside = np.ones(points.shape[1], dtype=bool)
        for x, low, high in zip(points, self.lower, self.upper, strict=True):
            margin = TOLERANCE * (high - low)
            inside &= (x >= low - margin) & (x <= high + margin)
        return inside

    def _bounds(self, d: int) -> tuple[Array, Array]:
        return np.array(self.lower), np.array(self.upper)

    def _measure(self, d: int) -> float:
        return float(np.prod(np.subtract(self.upper, self.lower)))

    def _centroid(self, d: int) -> Array:
        return 0.5 * np.add(self.lower, self.upper)
