"""Velocity given at nodes: on a plane, in a box or region, or at the surface of a body."""

from __future__ import annotations

import math
from collections.abc import Hashable
from typing import Annotated, Any, Literal

import numpy as np

from mpmcli.boundary.base import CONDITIONS, Array, Nodes, SurfaceNodes
from mpmcli.boundary.place import AXES, Direction, Place, check_direction, is_side, unit_vector
from mpmcli.boundary.roughness import Rough, sign_along
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Varying


@CONDITIONS.register
class Velocity(Rough):
    """Holds one component of the velocity of grid nodes at a value."""

    kind: Literal["velocity"] = "velocity"
    """Kind of condition."""
    on: Place
    """Where: nodes on a plane and beyond it, in a box or region, or reached by a body's surface particles."""
    direction: Direction
    """Direction, an axis or vector of any length; with friction in a box, region or on a face, into the body."""
    value: Annotated[Expression, Varying("velocity")]
    """Velocity in that direction, a number or an expression of x, y, z (of the node) and t."""

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        found = self.on.problems(dimensions) + check_direction("direction", self.direction, dimensions)
        plane = self.on.plane
        held = None if found or plane is None else unit_vector(self.direction, dimensions)[plane.index]
        if self.rubs and held == 0.0:
            found.append(("direction", "friction needs the velocity across the plane to be held"))
        return found + check_variables("value", self.value, dimensions)

    def bodies(self) -> list[tuple[str, str]]:
        """The body whose surface is held, or that covers nodes, if any."""
        named = {"on.body": self.on.body, "on.covered_by": self.on.covered_by}
        return [(key, name) for key, name in named.items() if name is not None]

    def held_side(self, grid: Nodes) -> tuple[int, int] | None:
        """The side of a plane whose normal it holds."""
        plane = self.on.plane
        if plane is None or abs(unit_vector(self.direction, len(grid.shape))[plane.index]) != 1.0:
            return None
        return plane.index, int(plane.side_on(grid) == "upper")

    def may_wait(self, grid: Nodes) -> bool:
        """A plane on a side of the grid that holds the velocity across is a floor, which moving bodies may reach."""
        side = self.held_side(grid)
        return side is not None and self.on.plane is not None and is_side(grid, side, self.on.plane)

    def inward(self, grid: Nodes) -> float:
        """Planes lie beyond the material; elsewhere the direction points into it."""
        plane = self.on.plane
        if plane is None:
            return 1.0
        direction = unit_vector(self.direction, len(grid.shape))
        return sign_along(direction, plane.index, plane.side_on(grid) == "upper")

    def holder(self, grid: Nodes, surface_nodes: SurfaceNodes | None) -> PlaceHolder:
        """The condition on a grid."""
        direction = unit_vector(self.direction, len(grid.shape))
        return PlaceHolder(self.on, self.value, direction, grid, surface_nodes)


class PlaceHolder:
    """A condition that holds the nodes of a place at a value, on a grid."""

    def __init__(
        self,
        place: Place,
        value: Expression,
        direction: Array,
        grid: Nodes,
        surface_nodes: SurfaceNodes | None,
    ):
        self._place = place
        self._grid = grid
        self._surface_nodes = surface_nodes
        self._value: Any = value
        self._seen = np.empty(0, dtype=np.int64)
        self._changes = 0
        self.direction = direction
        self.varies = "t" in value.variables

    def renew(self, active: Array) -> None:
        """Take over the active nodes."""
        self._active = active

    def key(self, time: float) -> Hashable:
        """Constant, except on or under bodies, where it counts how often the seen nodes changed."""
        body = self._place.covered_by or self._place.body
        if body is not None:
            if self._surface_nodes is None:
                raise ValueError("bodies need to know the nodes that particles see")
            seen = self._surface_nodes(body, self._place.face)
            if not np.array_equal(seen, self._seen):
                self._seen = seen
                self._changes += 1
        return self._changes

    def nodes(self, time: float) -> Array:
        """The held ones of the active nodes."""
        if self._place.face is not None:
            return np.intersect1d(self._active, self._seen)
        if self._place.covered_by is not None:
            count = math.prod(self._grid.shape)
            return self._active[np.isin(self._active % count, self._seen % count)]
        return self._active[self._place.holds(self._grid, self._active)]

    def values(self, time: float, coordinates: Array) -> Array | float:
        """Values at the nodes."""
        return evaluate(self._value, coordinates, time)


def evaluate(expression: Expression, points: Array, time: float) -> Any:
    """An expression at points (d, n): a number if it does not vary in space, else (n,)."""
    if expression.variables <= {"t"}:
        return expression(t=time)
    x, y, z = (*points, 0.0, 0.0)[:3]
    return expression(x, y, z, time)


def check_variables(key: str, expression: Expression, dimensions: int) -> list[tuple[str, str]]:
    """The problem, if any, that an expression uses a coordinate that the analysis does not have."""
    absent = sorted(expression.variables & set(AXES[dimensions:]))
    if not absent:
        return []
    return [(key, f"'{absent[0]}' does not exist in this analysis, which has {', '.join(AXES[:dimensions])}")]
