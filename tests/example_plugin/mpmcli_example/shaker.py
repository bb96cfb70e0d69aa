"""A table that shakes."""

from __future__ import annotations

import math
from collections.abc import Hashable
from typing import Annotated, Literal

import numpy as np

from mpmcli.boundary.base import CONDITIONS, Array, ConditionModel, Nodes, SurfaceNodes
from mpmcli.boundary.place import Plane, beyond, check_axis
from mpmcli.core.model import Quantity, Velocity


@CONDITIONS.register
class Shaker(ConditionModel):
    """Moves all that is beyond a plane along its normal, at v cos(2π f t)."""

    kind: Literal["shaker"]
    plane: Plane
    """The plane."""
    speed: Velocity
    """Largest velocity v."""
    frequency: Annotated[float, Quantity("1/time", gt=0)]
    """Frequency f."""

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        return check_axis("plane", self.plane, dimensions)

    def holder(self, grid: Nodes, surface_nodes: SurfaceNodes | None) -> ShakerHolder:
        return ShakerHolder(self, grid)


class ShakerHolder:
    """The nodes that it holds, and their velocity."""

    varies = True

    def __init__(self, condition: Shaker, grid: Nodes):
        self._condition, self._grid = condition, grid
        self.direction = np.eye(len(grid.shape))[condition.plane.index]

    def renew(self, active: Array) -> None:
        self._active = active

    def key(self, time: float) -> Hashable:
        return 0  # the nodes stay the same as long as the active ones do

    def nodes(self, time: float) -> Array:
        return self._active[beyond(self._grid, self._active, self._condition.plane)]

    def values(self, time: float, coordinates: Array) -> float:
        return self._condition.speed * math.cos(2 * math.pi * self._condition.frequency * time)
