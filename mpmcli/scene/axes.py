"""Material axes of bodies: how a scene turns them, and what they are at the particles."""

from collections.abc import Iterator
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field, GetJsonSchemaHandler, ValidationInfo

from mpmcli.boundary.velocity import check_variables
from mpmcli.core.angles import ANGLE, IN_DEGREES
from mpmcli.core.errors import Problem
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Model, Varying
from mpmcli.geometry.rotation import Direction3
from mpmcli.scene.values import not_finite

Array = np.ndarray
MOST_TURNS = 6


def _with_unit(value: Any, info: ValidationInfo) -> Any:
    """Text with a unit of angles behind it, in degrees."""
    match = ANGLE.fullmatch(value) if isinstance(value, str) else None
    return value if match is None else f"({match[1]})*{IN_DEGREES[match[2]]!r}"


AngleField = Annotated[Expression, Varying("angle", ("x", "y", "z")), BeforeValidator(_with_unit)]


class Turn(Model):
    """A rotation of the material axes, right-handed."""

    angle: AngleField
    """Angle in degrees, or text with its unit ("atan2(y, x) rad"): a number or an expression of x, y, z."""
    axis: Direction3 = (0.0, 0.0, 1.0)
    """Direction about which to turn, fixed in space: x, y, z or three numbers of any length; in 2D always z."""


def _as_turns(value: Any) -> Any:
    """A plain angle turns about z; one turn stands for a list of one."""
    if isinstance(value, dict | Turn):
        return [value]
    return value if isinstance(value, list | tuple) else [{"angle": value}]


class _AngleOrTurns:
    """Adds what may stand for a list of turns to its JSON Schema."""

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        turns = handler(schema)
        return {"anyOf": [{"type": "number"}, {"type": "string"}, turns["items"], turns]}


Axes = Annotated[
    tuple[Turn, ...], BeforeValidator(_as_turns), Field(min_length=1, max_length=MOST_TURNS), _AngleOrTurns()
]
"""Turns, one after the other."""


def check_axes(body: Any, material: Any, dimensions: int) -> Iterator[tuple[str, str]]:
    """What keeps the ``axes`` of a body from use: place in the body, and words."""
    if body.axes is None:
        return
    if not getattr(material, "has_axes", True):
        yield "axes", f"the material '{body.material}' ({material.kind}) has no axes to turn"
    if dimensions == 1:
        yield "axes", "a 1D analysis has no rotations"
    if body.stress is not None and not all(turn.angle.is_constant for turn in body.axes):
        yield "stress", "a body that starts with stress needs axes that are the same everywhere"
    for index, turn in enumerate(body.axes):
        if dimensions == 2 and any(turn.axis[:2]):
            words = (
                "material axes of a plane or axisymmetric analysis turn about z only, because other turns would couple "
                "stress and shear across the plane; to have another material axis along z, exchange the constants"
            )
            yield f"axes.{index}.axis", words
        yield from check_variables(f"axes.{index}.angle", turn.angle, dimensions)


def turn_history(body: Any, model: Any, X: Array, H: Array) -> list[Problem]:
    """Write the material axes of a body at points X (d, n) into its history H (rows, n); return what is wrong."""
    if body.axes is None:
        return []
    turns, found = start_axes(body, X)
    for name, values in model.turned_history(turns).items():
        H[model.history.index(name)] = values
    return found


def start_axes(body: Any, X: Array) -> tuple[Array, list[Problem]]:
    """Return the turns of a body's material axes at points X (d, n), unit quaternions (4, n), and what is wrong."""
    from mpmcli.materials.axes import multiply_quaternions, quaternion_of

    q = np.zeros((4, X.shape[1]))
    q[0] = 1.0
    problems = []
    for index, turn in enumerate(body.axes):
        degrees = np.broadcast_to(turn.angle(**dict(zip("xyz", X, strict=False))), X.shape[1:])
        words = f"the angle '{turn.angle.source}' is not finite at some particles"
        problems += not_finite(degrees, f"bodies.{body.name}.axes.{index}.angle", words)
        q = multiply_quaternions(quaternion_of(np.array(turn.axis), degrees), q)
    return q, problems
