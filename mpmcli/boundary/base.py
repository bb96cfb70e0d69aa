"""What a boundary condition is: a model in words, and a holder that knows the nodes it holds and their
values.

A new condition or load is one new file here, registered in ``CONDITIONS`` or ``LOADS``.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, Protocol

import numpy as np
from pydantic import Field

from mpmcli.core.model import Model
from mpmcli.core.registry import Registry

Array = np.ndarray

CONDITIONS = Registry("boundary condition", "CONDITIONS")
LOADS = Registry("load", "LOADS")

TOLERANCE = 1e-9
"""How far from a plane, in cells, a node still counts as on it."""

SurfaceNodes = Callable[[str, Any], Array]
"""Gives the nodes that a body's surface particles see now: (body name, ``place.Face``) -> node indices."""


class Nodes(Protocol):
    """What this room needs to know of a grid (``core.grid.Grid`` has it)."""

    lower: Array
    upper: Array
    cell: Array
    cells: Array
    pad: int
    shape: tuple[int, ...]

    def coordinates(self, indices: Array) -> Array:
        """Coordinates (d, n) of nodes (n,)."""


class Holder(Protocol):
    """A condition on a grid: which nodes it holds, in which direction, at which velocity."""

    direction: Array
    """Unit vector (d,)."""

    def renew(self, active: Array) -> None:
        """The nodes that may have mass are now the sorted indices ``active`` (n,)."""

    def key(self, time: float) -> Hashable:
        """Changes whenever the held nodes change, the active nodes being the same."""

    def nodes(self, time: float) -> Array:
        """The held ones of the active nodes, sorted."""

    def values(self, time: float, coordinates: Array) -> Array | float:
        """Velocity along ``direction`` at the start of a step, at nodes with ``coordinates`` (d, n)."""

    @property
    def varies(self) -> bool:
        """Whether the values change with time."""


class ConditionModel(Model):
    """Base of all boundary conditions."""

    name: str = Field(min_length=1)
    """Name of the condition, used in tables and messages."""

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What is wrong in an analysis with so many axes: pairs of key (``direction``) and message."""
        raise TypeError(f"{type(self).__name__} checks nothing")

    def held_side(self, grid: Nodes) -> tuple[int, int] | None:
        """The side of the grid (axis; 0 lower, 1 upper) beyond which it holds all velocities across, or None."""
        return None

    def may_wait(self, grid: Nodes) -> bool:
        """Whether it is plausible that no body is at it at the start."""
        return False

    def bodies(self) -> list[tuple[str, str]]:
        """Names of bodies that it refers to: pairs of key and name."""
        return []

    def holder(self, grid: Nodes, surface_nodes: SurfaceNodes | None) -> Holder:
        """The condition on a grid."""
        raise TypeError(f"{type(self).__name__} holds nothing")


class LoadModel(Model):
    """Base of all loads."""

    name: str = Field(min_length=1)
    """Name of the load, used in messages."""

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What is wrong in an analysis with so many axes: pairs of key and message."""
        raise TypeError(f"{type(self).__name__} checks nothing")

    def bodies(self) -> list[tuple[str, str]]:
        """Names of bodies that it refers to: pairs of key and name."""
        return []


def check_length(key: str, vector: Any, dimensions: int) -> list[tuple[str, str]]:
    """The problem, if any, that a vector has not one component per axis."""
    if len(vector) == dimensions:
        return []
    s = "s" * (dimensions != 1)
    return [(key, f"{dimensions} component{s} needed (one per axis), not {len(vector)}")]
