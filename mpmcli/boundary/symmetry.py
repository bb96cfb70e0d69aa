"""A symmetry plane: no velocity through it, and a mirror for everything that reaches beyond it."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Literal

import numpy as np

from mpmcli.boundary.base import CONDITIONS, Array, ConditionModel, Nodes, SurfaceNodes
from mpmcli.boundary.place import Plane, axis_index, check_axis, grid_line, is_side


@CONDITIONS.register
class Symmetry(ConditionModel):
    """A plane in which the material is mirrored: as if the other half were there too."""

    kind: Literal["symmetry"] = "symmetry"
    """Kind of condition."""
    plane: Plane
    """The plane; it must lie on a grid line. The material is on the other side than ``side``."""

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        found = check_axis("plane", self.plane, dimensions)
        if not self.acts_always:
            key = "until" if self.begin == 0.0 else "from"
            found.append(
                (key, "symmetry planes act always; hold the velocity across a plane with kind: velocity")
            )
        return found

    def held_side(self, grid: Nodes) -> tuple[int, int]:
        """The side of the plane."""
        return self.plane.index, int(self.plane.side_on(grid) == "upper")

    def may_wait(self, grid: Nodes) -> bool:
        """On a side of the grid it is a wall, which bodies may reach later."""
        return is_side(grid, self.held_side(grid), self.plane)

    def holder(self, grid: Nodes, surface_nodes: SurfaceNodes | None) -> SymmetryHolder:
        """The plane on a grid."""
        return SymmetryHolder(self, grid)


class SymmetryHolder:
    """Holds the nodes on the plane still along its normal; those beyond are the mirror's (``mirror``)."""

    varies = False

    def __init__(self, condition: Symmetry, grid: Nodes):
        self.axis = condition.plane.index
        self.lower = condition.plane.side_on(grid) == "lower"
        self.line = symmetry_line(condition.plane, grid)
        self.direction = np.eye(len(grid.shape))[self.axis]
        self._grid = grid

    def renew(self, active: Array) -> None:
        """Take over the active nodes."""
        self._active = active

    def key(self, time: float) -> Hashable:
        """Constant: the plane does not move."""
        return 0

    def nodes(self, time: float) -> Array:
        """The active nodes on the plane."""
        return self._active[axis_index(self._grid, self._active, self.axis) == self.line]

    def values(self, time: float, coordinates: Array) -> float:
        """Zero."""
        return 0.0


def symmetry_line(plane: Plane, grid: Nodes) -> int:
    """Index of the plane's nodes along its axis, ghost layers counted; ValueError if between grid lines."""
    line = grid_line(grid, plane.index, plane.at)
    if abs(line - round(line)) > 1e-6 or not 0 <= round(line) < grid.shape[plane.index]:
        raise ValueError(
            f"a symmetry plane must lie on a grid line; {plane.axis} = {plane.at:g} does not "
            f"(lines at {grid.lower[plane.index]:g} + n·{grid.cell[plane.index]:g}, inside the grid)"
        )
    return round(line)
