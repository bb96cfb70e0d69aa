"""The centrifugal force of a frame that turns."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

from mpmcli.boundary.base import LOADS, Array, LoadModel, Values, check_length
from mpmcli.core.model import Quantity
from mpmcli.geometry.vectors import Vector


@LOADS.register
class Centrifugal(LoadModel):
    """Accelerates the particles of a body away from an axis across the plane, by ω² r."""

    kind: Literal["centrifugal"]
    body: str
    """Name of the body."""
    center: Vector
    """A point of the axis."""
    rate: Annotated[float, Quantity("1/time")]
    """Angular velocity ω."""

    def chosen(self, points: Array, is_of: Callable[[str], Array]) -> Array:
        return is_of(self.body)

    def acceleration_at(self, points: Array, time: float) -> Values:
        return [self.rate**2 * (x - middle) for x, middle in zip(points, self.center, strict=True)]

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        return check_length("center", self.center, dimensions)

    def bodies(self) -> list[tuple[str, str]]:
        return [("body", self.body)]
