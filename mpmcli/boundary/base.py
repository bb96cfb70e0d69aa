"""What a boundary condition is: a model in words, and a holder that knows the nodes it holds and their
values; and what a load is: a model with the methods by which it acts.

A new condition or load is one new file here, registered in ``CONDITIONS`` or ``LOADS``, and a row in the table of
that registry.
"""

import math
from collections.abc import Callable, Hashable, Sequence
from typing import Any, ClassVar, Protocol

import numpy as np

from mpmcli.boundary.window import Windowed
from mpmcli.core.registry import Registry

Array = np.ndarray


def _lack_of_condition(model: type[Any]) -> str:
    """What a kind of condition lacks."""
    holds = model.holder is not ConditionModel.holder or model.held_face is not ConditionModel.held_face
    return "" if holds else "it does not define 'holder'"


def _lack_of_load(model: type[Any]) -> str:
    """What a kind of load lacks."""
    if not model.effects():
        return f"it defines none of {', '.join(EFFECTS[model.acts_on])}"
    for effect in model.effects() & FACE_EFFECTS:
        if model.loaded_face is LoadModel.loaded_face:
            return f"it defines '{effect}' without 'loaded_face'"
    return ""


CONDITIONS = Registry(
    "boundary condition",
    "mpmcli.boundary",
    {"symmetry": "symmetry", "temperature": "temperature", "velocity": "velocity", "wall": "wall"},
    _lack_of_condition,
)
LOADS = Registry(
    "load",
    "mpmcli.boundary",
    {
        "absorbing": "absorbing",
        "body_force": "body_force",
        "buoyancy": "buoyancy",
        "film": "film",
        "gravity": "gravity",
        "heat_flux": "heat_flux",
        "heat_source": "heat_source",
        "nodal_force": "nodal_force",
        "particle_force": "particle_force",
        "radiation": "radiation",
        "traction": "traction",
    },
    _lack_of_load,
)

TOLERANCE = 1e-9
"""How far from a plane, in cells, a node still counts as on it."""

Values = Sequence[Any]
"""One number or array (n,) per axis."""

SurfaceNodes = Callable[[str, Any], Array]
"""Gives the nodes that a body's surface particles see now: (body name, ``place.Face``) -> sorted node indices."""


def is_finite(values: Any) -> bool:
    """Whether a number, or each of an array, is finite."""
    return math.isfinite(values) if isinstance(values, float) else bool(np.isfinite(values).all())


class Nodes(Protocol):
    """What this room needs to know of a grid (``core.grid.Grid`` has it)."""

    lower: Array
    upper: Array
    cell: Array
    cells: Array
    pad: int
    shape: tuple[int, ...]
    periodic: tuple[int, ...]

    def without_periods(self, dofs: Array) -> Array:
        """Nodes (n,) within one period of the periodic axes that nodes (n,) are one with."""

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


class ConditionModel(Windowed):
    """Base of all boundary conditions."""

    acts_on: ClassVar[str] = "velocity"
    """The quantity that it holds: ``velocity`` or ``temperature``."""

    def held_side(self, grid: Nodes) -> tuple[int, int] | None:
        """The side of the grid (axis; 0 lower, 1 upper) beyond which it holds all velocities across, or None."""
        return None

    def may_wait(self, grid: Nodes) -> bool:
        """Whether it is plausible that no body is at it at the start."""
        return False

    def held_face(self) -> tuple[str, Any] | None:
        """The body and the face (``place.Face``) of it whose temperature it holds, or None: it holds nodes."""
        return None

    def face_temperature_at(self, points: Array, time: float) -> Any:
        """Return the temperature of ``held_face``, at its points (d, n) at the start."""
        raise TypeError(f"{type(self).__name__} holds no face")

    def holder(self, grid: Nodes, surface_nodes: SurfaceNodes | None) -> Holder:
        """The condition on a grid."""
        raise TypeError(f"{type(self).__name__} holds nothing")


EFFECTS = {
    "velocity": (
        "uniform_acceleration",
        "acceleration_at",
        "force_at",
        "impedance_of",
        "nodal_force_at",
        "traction_at",
        "water_at",
    ),
    "temperature": ("heat_flux_at", "heat_power_at"),
}
"""Methods by which a load acts on a quantity; each kind of load defines at least one of those of its quantity."""
FACE_EFFECTS = frozenset({"impedance_of", "traction_at", "heat_flux_at"})
"""Those that act on a face of a body."""


class LoadModel(Windowed):
    """Base of all loads: what acts on which particles, or on which face of a body.

    Values have one member per axis. They are numbers, or (n,) arrays with a member per point.
    """

    acts_on: ClassVar[str] = "velocity"
    """The quantity that it changes: ``velocity`` or ``temperature``."""

    @classmethod
    def effects(cls) -> frozenset[str]:
        """Return which of the ``EFFECTS`` on its quantity this kind of load has."""
        possible = EFFECTS[cls.acts_on]
        return frozenset(name for name in possible if getattr(cls, name) is not getattr(LoadModel, name))

    @property
    def varies(self) -> bool:
        """Whether its value at a particle may change during the run."""
        return True

    @property
    def changes(self) -> bool:
        """Whether what it does to a particle may change during the run: its value, or whether it acts."""
        return self.varies or not self.acts_always

    @property
    def uses_initial_positions(self) -> bool:
        """Whether ``acceleration_at`` and ``force_at`` take the particles' positions at the start."""
        return False

    @property
    def follows_positions(self) -> bool:
        """Whether ``traction_at`` takes the present positions of the face, not those at the start."""
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

    def water_at(self, points: Array, time: float) -> tuple[Any, float]:
        """Return level along gravity and density of the water that lifts the chosen particles, at points (d, n)."""
        raise TypeError(f"{type(self).__name__} has no water")

    def impedance_of(self, material: Any, analysis: str, dimensions: int) -> Sequence[Any]:
        """Return the traction per velocity against it, along each of d axes [pressure/velocity].

        It acts on ``loaded_plane``, or else on ``loaded_face``.

        ``material`` is the model of the body's material, ``analysis`` the name of the kind of analysis. Numbers of the
        material may be ``core.rows.Rows``, if its particles have numbers of their own.
        """
        raise TypeError(f"{type(self).__name__} has no impedance")

    def nodal_force_at(self, time: float) -> tuple[Any, Values]:
        """Return a point of the grid (d,), and the force there [force]."""
        raise TypeError(f"{type(self).__name__} has no force on nodes")

    def heat_flux_at(self, points: Array, time: float, temperature: Array) -> tuple[Any, Any]:
        """Return the power per area into ``loaded_face``, and its derivative by the temperature of the surface.

        ``points`` (d, n) are those of the face at the start, ``temperature`` (n,) is that of the surface, half a
        particle beyond the centres of the particles; both values may be numbers or (n,).
        """
        raise TypeError(f"{type(self).__name__} has no heat flux")

    def heat_power_at(self, points: Array, time: float) -> Any:
        """Return the power in the chosen particles, at their positions (d, n), per what ``power_per`` says."""
        raise TypeError(f"{type(self).__name__} heats no particles")

    @property
    def power_per(self) -> str:
        """What ``heat_power_at`` is per: current ``volume``, ``mass``, or ``total``, shared in proportion to mass.

        In axisymmetric analyses the total is that of the full ring.
        """
        return "volume"

    def chosen(self, points: Array, is_of: Callable[[str], Array]) -> Array | None:
        """Return which particles it acts on, (N,) bool; None: on all.

        ``points`` (d, N) are their positions at the start, ``is_of(name)`` those of a body, (N,) bool.
        """
        return None

    def loaded_face(self) -> tuple[str, Any] | None:
        """Return the name of the body, and the face (``place.Face``) of it, that it acts on, or None."""
        return None

    def loaded_plane(self) -> Any:
        """Return the plane (``place.Plane``) that it acts on, or None."""
        return None


def check_length(key: str, vector: Any, dimensions: int) -> list[tuple[str, str]]:
    """The problem, if any, that a vector has not one component per axis."""
    if len(vector) == dimensions:
        return []
    s = "s" * (dimensions != 1)
    return [(key, f"this analysis needs {dimensions} component{s}, one per axis, not {len(vector)}")]
