"""What a boundary condition is: a model in words, and a holder that knows the nodes it holds and their
values.

A new condition or load is one new file here, registered in ``CONDITIONS`` or ``LOADS``, and a row in the table of
that registry.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Any, ClassVar, Protocol

import numpy as np
from pydantic import Field

from mpmcli.core.model import Model
from mpmcli.core.registry import Registry

Array = np.ndarray


def _lack_of_condition(model: type[Any]) -> str:
    """What a kind of condition lacks."""
    return "" if model.holder is not ConditionModel.holder else "it does not define 'holder'"


def _lack_of_load(model: type[Any]) -> str:
    """What a kind of load lacks."""
    if not model.effects():
        return f"it defines none of {', '.join(EFFECTS)}"
    if "traction_at" in model.effects() and model.loaded_face is LoadModel.loaded_face:
        return "it defines 'traction_at' without 'loaded_face'"
    return ""


CONDITIONS = Registry(
    "boundary condition",
    "mpmcli.boundary",
    {
        "symmetry": "symmetry",
        "temperature": "temperature",
        "velocity": "velocity",
        "wall": "wall",
    },
    _lack_of_condition,
)
LOADS = Registry(
    "load",
    "mpmcli.boundary",
    {
        "body_force": "body_force",
        "gravity": "gravity",
        "particle_force": "particle_force",
        "traction": "traction",
    },
    _lack_of_load,
)

TOLERANCE = 1e-9
"""How far from a plane, in cells, a node still counts as on it."""

Values = Sequence[Any]
"""One number or array (n,) per axis."""

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

    acts_on: ClassVar[str] = "velocity"
    """The quantity that it holds: ``velocity`` or ``temperature``."""

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


EFFECTS = ("uniform_acceleration", "acceleration_at", "force_at", "traction_at")
"""Methods by which a load acts; each kind of load defines at least one of them."""


class LoadModel(Model):
    """Base of all loads: what acts on which particles, or on which face of a body.

    Values have one member per axis. They are numbers, or (n,) arrays with a member per point.
    """

    acts_on: ClassVar[str] = "velocity"
    """The quantity that it changes: ``velocity`` or ``temperature``."""

    name: str = Field(min_length=1)
    """Name of the load, used in messages."""

    @classmethod
    def effects(cls) -> frozenset[str]:
        """Return which of ``EFFECTS`` this kind of load has."""
        return frozenset(name for name in EFFECTS if getattr(cls, name) is not getattr(LoadModel, name))

    @property
    def varies(self) -> bool:
        """Whether its value at a particle may change during the run."""
        return True

    @property
    def uses_initial_positions(self) -> bool:
        """Whether ``acceleration_at`` and ``force_at`` take the particles' positions at the start."""
        return False

    @property
    def shares_force(self) -> bool:
        """Whether ``force_at`` is the force on all particles, shared by mass, and not that on each."""
        return False

    @property
    def follows(self) -> bool:
        """Whether a traction follows the deformed face: its area and its direction."""
        return False

    def uniform_acceleration(self, time: float) -> Values:
        """Return the acceleration of all particles alike [acceleration]."""
        raise TypeError(f"{type(self).__name__} has no uniform acceleration")

    def acceleration_at(self, points: Array, time: float) -> Values:
        """Return the force per mass on the chosen particles, at their positions (d, n) [acceleration]."""
        raise TypeError(f"{type(self).__name__} accelerates no particles")

    def force_at(self, points: Array, time: float) -> Values:
        """Return the force on the chosen particles, at their positions (d, n) [force].

        In axisymmetric analyses the force is that on the full ring.
        """
        raise TypeError(f"{type(self).__name__} has no force on particles")

    def traction_at(self, points: Array, time: float) -> Values:
        """Return the force per area on ``loaded_face``, at its points (d, n) at the start [pressure]."""
        raise TypeError(f"{type(self).__name__} has no traction")

    def chosen(self, points: Array, is_of: Callable[[str], Array]) -> Array | None:
        """Return which particles it acts on, (N,) bool; None: on all.

        ``points`` (d, N) are their positions at the start, ``is_of(name)`` those of a body, (N,) bool.
        """
        return None

    def loaded_face(self) -> tuple[str, Any]:
        """Return the name of the body, and the face (``place.Face``), that ``traction_at`` acts on."""
        raise TypeError(f"{type(self).__name__} loads no face")

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
    return [(key, f"this analysis needs {dimensions} component{s}, one per axis, not {len(vector)}")]
