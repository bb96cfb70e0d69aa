"""A moving wall: holds the nodes with mass behind it, and those in front of it to a depth."""

from __future__ import annotations

import math
from collections.abc import Hashable
from typing import Annotated, Any, Literal, cast

import numpy as np
from pydantic import BeforeValidator, TypeAdapter, ValidationInfo, WithJsonSchema

from mpmcli.boundary.base import CONDITIONS, TOLERANCE, Array, Nodes, SurfaceNodes, check_length
from mpmcli.boundary.place import (
    Direction,
    along_axis,
    axis_index,
    check_direction,
    grid_line,
    last_index,
    read,
    unit_vector,
)
from mpmcli.boundary.roughness import Rough
from mpmcli.core.errors import SimulationError
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Quantity, Varying

_coordinate: TypeAdapter[Any] = TypeAdapter(Annotated[Expression, Varying("length", ("t",))])


def _read_position(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, list | tuple):
        return tuple(read(_coordinate, v, info) for v in value)
    return read(_coordinate, value, info)


_VALUE: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}], "x-dimension": "length"}
Position = Annotated[
    Any,
    BeforeValidator(_read_position),
    WithJsonSchema(_VALUE | {"anyOf": [*_VALUE["anyOf"], {"type": "array", "items": _VALUE}]}),
]
"""An expression of t, or a tuple of such."""


@CONDITIONS.register
class Wall(Rough):
    """A plane that moves through the grid and pushes or pulls the material at it.

    It sets v_i = v + ∇v (x_i − x_wall) along its normal on all nodes with mass behind it, and on those in the
    material to ``depth`` cells; nodes are chosen anew every step [nairn2026, section 3.1].
    """

    kind: Literal["wall"] = "wall"
    """Kind of condition."""
    normal: Direction
    """Normal of the wall, pointing into the material: an axis or a vector of any length, as [-1, 0]."""
    position: Position
    """Coordinate along the axis of the normal, an expression of t; for an oblique normal a point."""
    velocity: Annotated[Expression, Varying("velocity", ("t",))]
    """Velocity along the positive axis of the normal (oblique: along the normal), an expression of t."""
    gradient: Annotated[Expression, Varying("1/time", ("t",))] = cast(Any, 0.0)
    """Gradient of the velocity along that axis, an expression of t."""
    depth: Annotated[float, Quantity("1", ge=0)] = 1.0
    """How far into the material nodes are held, in cells."""

    model_config = {"validate_default": True}

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        found = check_direction("normal", self.normal, dimensions)
        if isinstance(self.position, tuple):
            found += check_length("position", self.position, dimensions)
        elif not found and along_axis(unit_vector(self.normal, dimensions)) is None:
            found.append(
                ("position", "a wall with an oblique normal needs a point as position, such as [0, 0]")
            )
        return found

    def held_side(self, grid: Nodes) -> tuple[int, int] | None:
        """The side behind a wall across an axis, if the wall is within the grid at the start."""
        normal = unit_vector(self.normal, len(grid.shape))
        axis = along_axis(normal)
        if axis is None:
            return None
        position = self.position[axis] if isinstance(self.position, tuple) else self.position
        line = grid_line(grid, axis, position(t=0.0)) - grid.pad
        is_within = -TOLERANCE <= line <= grid.cells[axis] + TOLERANCE
        return (axis, int(normal[axis] < 0.0)) if is_within else None

    def is_behind(self, X: Array) -> Array:
        """Whether points (d, N) lie behind the wall at the start, (N,)."""
        normal = unit_vector(self.normal, len(X))
        if isinstance(self.position, tuple):
            return normal @ X < sum(n * p(t=0.0) for n, p in zip(normal, self.position, strict=True))
        return normal @ X < normal.sum() * self.position(t=0.0)

    def inward(self, grid: Nodes) -> float:
        """The normal points into the material; walls across an axis hold the component along its positive side."""
        normal = unit_vector(self.normal, len(grid.shape))
        axis = along_axis(normal)
        return 1.0 if axis is None else float(normal[axis])

    def holder(self, grid: Nodes, surface_nodes: SurfaceNodes | None) -> AxisWall | ObliqueWall:
        """The wall on a grid."""
        axis = along_axis(unit_vector(self.normal, len(grid.shape)))
        return ObliqueWall(self, grid) if axis is None else AxisWall(self, grid, axis)


def finite_position(position: float, name: str, time: float) -> float:
    """The position of a wall; SimulationError if it is no number."""
    if not math.isfinite(position):
        raise SimulationError(f"wall '{name}': its position is not finite at time {time:g}")
    return position


class AxisWall:
    """A wall across an axis; which nodes it holds changes only when its reach passes a grid line."""

    def __init__(self, wall: Wall, grid: Nodes, axis: int):
        position: Any = wall.position
        self._position = position[axis] if isinstance(position, tuple) else position
        self._name = wall.name
        self._velocity: Any = wall.velocity
        self._gradient: Any = wall.gradient
        self._axis = axis
        self._sign = unit_vector(wall.normal, len(grid.shape))[axis]
        self._reach = float(wall.depth) * grid.cell[axis] * self._sign
        self._grid = grid
        self.direction = np.eye(len(grid.shape))[axis]
        steady = self._velocity.is_constant and self._gradient.is_constant
        self.varies = not (steady and (self._gradient() == 0.0 or self._position.is_constant))

    def renew(self, active: Array) -> None:
        """Take over the active nodes and their grid lines."""
        self._active = active
        self._index = axis_index(self._grid, active, self._axis)

    def key(self, time: float) -> int:
        """Index of the innermost held grid line."""
        reach = finite_position(self._position(t=time), self._name, time) + self._reach
        return last_index(self._grid, self._axis, reach, lower=self._sign > 0)

    def nodes(self, time: float) -> Array:
        """The active nodes behind the wall and to its depth."""
        k = self.key(time)
        return self._active[self._index <= k if self._sign > 0 else self._index >= k]

    def values(self, time: float, coordinates: Array) -> Array | float:
        """v + ∇v (x_i − x_wall) along the positive axis."""
        speed = self._velocity(t=time)
        gradient = self._gradient(t=time)
        if gradient == 0.0:
            return speed
        return speed + gradient * (coordinates[self._axis] - self._position(t=time))


class ObliqueWall:
    """A wall whose normal is along no axis; its nodes are looked for at every time."""

    def __init__(self, wall: Wall, grid: Nodes):
        if not isinstance(wall.position, tuple):
            raise ValueError(f"wall '{wall.name}' has an oblique normal, so its position must be a point")
        self._point: Any = wall.position
        self._name = wall.name
        self._velocity: Any = wall.velocity
        self._gradient: Any = wall.gradient
        self._grid = grid
        self.direction = unit_vector(wall.normal, len(grid.shape))
        height = math.sqrt(float(np.sum((self.direction * grid.cell) ** 2)))
        self._reach = (float(wall.depth) + TOLERANCE) * height
        self._still = all(c.is_constant for c in self._point)
        self.varies = not (self._still and self._velocity.is_constant and self._gradient.is_constant)

    def renew(self, active: Array) -> None:
        """Take over the active nodes and their coordinates along the normal."""
        self._active = active
        self._along = self.direction @ self._grid.coordinates(active)

    def key(self, time: float) -> Hashable:
        """The wall's point along the normal."""
        return 0.0 if self._still else self._offset(time)

    def nodes(self, time: float) -> Array:
        """The active nodes behind the wall and to its depth."""
        return self._active[self._along <= self._offset(time) + self._reach]

    def values(self, time: float, coordinates: Array) -> Array | float:
        """v + ∇v (x_i − x_wall)·n along the normal."""
        return self._velocity(t=time) + self._gradient(t=time) * (
            self.direction @ coordinates - self._offset(time)
        )

    def _offset(self, time: float) -> float:
        offset = sum(n * c(t=time) for n, c in zip(self.direction, self._point, strict=True))
        return finite_position(float(offset), self._name, time)
