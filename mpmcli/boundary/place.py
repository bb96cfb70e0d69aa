"""Where a condition or load acts: a plane, a box, a region, or a face of a body; and in which direction."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    BeforeValidator,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)

from mpmcli.boundary.base import TOLERANCE, Array, Nodes, check_length
from mpmcli.core.model import Length, Model, Number
from mpmcli.core.suggest import did_you_mean

AXES = ("x", "y", "z")
Axis = Literal["x", "y", "z"]
Side = Literal["lower", "upper"]

_number: TypeAdapter[float] = TypeAdapter(Number)


class Plane(Model):
    """A plane across one axis, with all that lies beyond it."""

    axis: Axis
    """Axis that the plane is normal to (in axisymmetric analyses x is r, y is z)."""
    at: Length
    """Coordinate of the plane."""
    side: Side | None = None
    """Towards which side "beyond" is; by default away from the grid's centre."""

    @property
    def index(self) -> int:
        """Number of the axis."""
        return AXES.index(self.axis)

    def side_on(self, grid: Nodes) -> str:
        """The side, or the one away from the grid's centre."""
        if self.side is not None:
            return self.side
        a = self.index
        centre = 0.5 * (grid.lower[a] + grid.upper[a])
        if abs(self.at - centre) <= TOLERANCE * grid.cell[a]:
            raise ValueError(
                f"the plane {self.axis} = {self.at:g} is in the middle of the grid; "
                "give 'side: lower' or 'side: upper'"
            )
        return "lower" if self.at < centre else "upper"


class Box(Model):
    """A box with faces across the axes, its surface included."""

    lower: tuple[Length, ...]
    """Lowest corner."""
    upper: tuple[Length, ...]
    """Highest corner."""


class Face(Model):
    """The faces of a body's particles towards one side of an axis with no neighbour of the body there."""

    axis: Axis
    """Axis that the face is normal to, before deformation."""
    side: Side
    """Which side of the body."""

    @property
    def index(self) -> int:
        """Number of the axis."""
        return AXES.index(self.axis)

    @property
    def sign(self) -> int:
        """-1 for the lower, 1 for the upper side: the outward normal's component."""
        return 1 if self.side == "upper" else -1


class Surface(Model):
    """A face of a body."""

    body: str
    """Name of the body."""
    face: Face
    """Which of its faces."""


class SurfaceOrPlane(Model):
    """Either ``plane``, or ``body`` with ``face``."""

    plane: Plane | None = None
    """A plane on a grid line; what ends on it or beyond it."""
    body: str | None = None
    """Name of the body."""
    face: Face | None = None
    """Which of its faces."""

    @model_validator(mode="after")
    def _one_place(self) -> SurfaceOrPlane:
        if (self.plane is None) == (self.body is None) or (self.body is None) != (self.face is None):
            raise ValueError("give either plane, or body with face")
        return self

    @property
    def surface(self) -> tuple[str, Face]:
        """Body and face."""
        if self.body is None or self.face is None:
            raise TypeError("a plane is no face of a body")
        return self.body, self.face


def _resolve_region(value: Any, info: ValidationInfo) -> Any:
    """Let the scene's context build the region; without one the value stays as it is (a region object)."""
    region = getattr(info.context, "region", None)
    if isinstance(value, dict) and region is not None:
        return region(value)
    return value


Region = Annotated[
    Any, BeforeValidator(_resolve_region), WithJsonSchema({"type": "object", "x-one-of": "region"})
]
"""An object with ``contains(points (d, n)) -> (n,) bool``; the context of a scene makes it."""


class Place(Model):
    """Exactly one of ``plane``, ``box``, ``region``, ``covered_by``, or ``body`` with ``face``."""

    plane: Plane | None = None
    """Nodes on a plane and beyond it."""
    box: Box | None = None
    """Nodes in a box."""
    region: Region = None
    """Nodes in a region."""
    covered_by: str | None = None
    """Nodes that the particles of this rigid body see, wherever it has moved to; only for velocities."""
    body: str | None = None
    """Nodes that the surface particles of this body see, also those up to a cell inside the body."""
    face: Face | None = None
    """Which surface of the body."""

    @model_validator(mode="after")
    def _one_place(self) -> Place:
        given = [n for n in ("plane", "box", "region", "covered_by", "body") if getattr(self, n) is not None]
        if len(given) != 1:
            raise ValueError("give one of: plane, box, region, or body with face, or covered_by")
        if (self.body is None) != (self.face is None):
            raise ValueError("give both body and face, or neither")
        return self

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit so many axes."""
        found = check_axis("on.plane", self.plane, dimensions) + check_axis("on.face", self.face, dimensions)
        return found + check_space("on", self.box, self.region, dimensions)

    def holds(self, grid: Nodes, nodes: Array) -> Array:
        """Which nodes are on the plane or beyond, or in the box or region, (n,) bool."""
        if self.plane is not None:
            return beyond(grid, nodes, self.plane)
        return inside(self.box, self.region, grid.coordinates(nodes), TOLERANCE * float(min(grid.cell)))


def inside(box: Box | None, region: Any, points: Array, margin: float = 0.0) -> Array:
    """Which points (d, n) are in a box (widened by ``margin`` [length]) or else in a region, (n,) bool."""
    if box is None:
        return np.asarray(region.contains(points), dtype=bool)
    low = np.array(box.lower)[:, None] - margin
    high = np.array(box.upper)[:, None] + margin
    return np.asarray(((points >= low) & (points <= high)).all(axis=0))


def axis_index(grid: Nodes, nodes: Array, axis: int) -> Array:
    """Index of nodes along one axis, ghost layers counted."""
    stride = math.prod(grid.shape[:axis])
    return (nodes // stride) % grid.shape[axis]


def grid_line(grid: Nodes, axis: int, coordinate: float) -> float:
    """The coordinate as a (fractional) node index along an axis, ghost layers counted."""
    return float((coordinate - grid.lower[axis]) / grid.cell[axis]) + grid.pad


def last_index(grid: Nodes, axis: int, coordinate: float, lower: bool) -> int:
    """Index of the innermost node at or beyond a coordinate, on the lower or upper side."""
    line = grid_line(grid, axis, coordinate)
    return math.floor(line + TOLERANCE) if lower else math.ceil(line - TOLERANCE)


def beyond(grid: Nodes, nodes: Array, plane: Plane) -> Array:
    """Which nodes are on a plane or beyond it, (n,) bool."""
    lower = plane.side_on(grid) == "lower"
    k = last_index(grid, plane.index, plane.at, lower)
    index = axis_index(grid, nodes, plane.index)
    return np.asarray(index <= k if lower else index >= k)


def is_side(grid: Nodes, side: tuple[int, int], plane: Plane) -> bool:
    """Whether a plane lies on a side of the grid (axis; 0 lower, 1 upper)."""
    a, upper = side
    end = grid.upper[a] if upper else grid.lower[a]
    return bool(abs(plane.at - end) <= TOLERANCE * grid.cell[a])


def check_axis(key: str, part: Plane | Face | None, dimensions: int) -> list[tuple[str, str]]:
    """The problem, if any, that an axis does not exist."""
    if part is None or part.index < dimensions:
        return []
    return [
        (f"{key}.axis", f"there is no axis {part.axis}; this analysis has {', '.join(AXES[:dimensions])}")
    ]


def check_space(key: str, box: Box | None, region: Any, dimensions: int) -> list[tuple[str, str]]:
    """What is wrong with a box or region for so many axes."""
    found = []
    if box is not None:
        found += check_length(f"{key}.box.lower", box.lower, dimensions)
        found += check_length(f"{key}.box.upper", box.upper, dimensions)
        if not found and any(low > high for low, high in zip(box.lower, box.upper, strict=True)):
            found.append((f"{key}.box.upper", "must not lie below lower"))
    if dimensions not in getattr(region, "dimensions", (dimensions,)):
        found.append((f"{key}.region", f"this kind of region is not available in {dimensions}D"))
    if getattr(region, "gives_particles", False):
        found.append((f"{key}.region", "a list of particles is not a region of space"))
    return found


def read(adapter: TypeAdapter[Any], value: Any, info: ValidationInfo) -> Any:
    """A part of a value, read with the context of the whole; its error in one sentence."""
    try:
        return adapter.validate_python(value, context=info.context)
    except ValidationError as error:
        raise ValueError(error.errors()[0]["msg"].removeprefix("Value error, ")) from None


def _read_direction(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, str):
        if value not in AXES:
            is_turned = value[:1] == "-" and value[1:] in AXES
            hint = "" if is_turned else did_you_mean(value, AXES)
            example = "[-1, 0] for -x" if is_turned else "[1, 0]"
            raise ValueError(
                f"'{value}' is not a direction{hint}; give x, y, z or a vector such as {example}"
            )
        return value
    if not isinstance(value, list | tuple) or not 1 <= len(value) <= 3:
        raise ValueError("give x, y, z or a vector with one component per axis")
    if any(v in AXES for v in value):
        raise ValueError("a direction is one axis or a vector of numbers; several axes need a condition each")
    components = [read(_number, v, info) for v in value]
    size = math.hypot(*components)
    if not (math.isfinite(size) and size > 0):
        raise ValueError("a direction must not have length zero")
    return tuple(component / size for component in components)


Direction = Annotated[
    Any,
    BeforeValidator(_read_direction),
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": list(AXES)},
                {
                    "type": "array",
                    "items": {"anyOf": [{"type": "number"}, {"type": "string"}]},
                    "minItems": 1,
                    "maxItems": 3,
                },
            ]
        }
    ),
]
"""An axis name, or a tuple of components of a unit vector."""


def unit_vector(direction: str | tuple[float, ...], dimensions: int) -> Array:
    """A ``Direction`` as an array (d,)."""
    if isinstance(direction, str):
        return np.eye(dimensions)[AXES.index(direction)]
    return np.array(direction, dtype=np.float64)


def along_axis(normal: Array) -> int | None:
    """Number of the axis that a unit vector (d,) is along, or None."""
    axis = int(np.argmax(np.abs(normal)))
    return axis if abs(normal[axis]) == 1.0 else None


def check_direction(key: str, direction: Any, dimensions: int) -> list[tuple[str, str]]:
    """What is wrong with a direction for so many axes."""
    if not isinstance(direction, str):
        return check_length(key, direction, dimensions)
    if AXES.index(direction) < dimensions:
        return []
    return [(key, f"there is no axis {direction}; this analysis has {', '.join(AXES[:dimensions])}")]
