"""Types of values that several parts of a scene share."""

from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema

from mpmcli.core.errors import Problem
from mpmcli.core.expressions import Expression, number_in
from mpmcli.core.model import Length, PositiveLength, Varying

Name = Annotated[str, Field(min_length=1, max_length=80)]
"""A name that the user chooses; which characters it may have is checked for all names together."""

Point = Annotated[tuple[Length, ...], Field(min_length=1, max_length=3)]
"""One coordinate per axis."""

VelocityField = Annotated[Expression, Varying("velocity")]
TemperatureField = Annotated[Expression, Varying("temperature", ("x", "y", "z"))]

MAX_PARTICLES_PER_AXIS = 100


def _read_counts(value: Any, info: ValidationInfo) -> int | tuple[int, ...]:
    """A whole number, or one per axis."""
    if isinstance(value, list | tuple):
        if not 1 <= len(value) <= 3:
            raise ValueError("one whole number, or one per axis, is needed")
        return tuple(_read_count(member, info) for member in value)
    return _read_count(value, info)


def _read_count(value: Any, info: ValidationInfo) -> int:
    if isinstance(value, str):
        constants = {} if info.context is None else info.context.constants
        value = number_in(value, constants)
    if isinstance(value, bool) or not isinstance(value, int | float) or value != value // 1:
        raise ValueError(f"{value!r} is not a whole number")
    if not 1 <= value <= MAX_PARTICLES_PER_AXIS:
        raise ValueError(f"{value:g} is out of range: must be 1 to {MAX_PARTICLES_PER_AXIS}")
    return int(value)


_COUNT: dict[str, Any] = {"type": "integer", "minimum": 1, "maximum": MAX_PARTICLES_PER_AXIS}
ParticlesPerAxis = Annotated[
    Any,
    BeforeValidator(_read_counts),
    WithJsonSchema({"anyOf": [_COUNT, {"type": "array", "items": _COUNT, "minItems": 1, "maxItems": 3}]}),
]
"""A whole number, or a tuple with one per axis."""


def _per_axis(value: Any, info: ValidationInfo) -> Any:
    """One number stands for all axes of the grid."""
    if isinstance(value, list | tuple):
        return value
    lower = info.data.get("lower")
    return [value] * (len(lower) if lower else 1)


_SIZE: list[dict[str, Any]] = [{"type": "number", "exclusiveMinimum": 0}, {"type": "string"}]
CellSize = Annotated[
    tuple[PositiveLength, ...],
    BeforeValidator(_per_axis),
    Field(min_length=1, max_length=3),
    WithJsonSchema(
        {"anyOf": [*_SIZE, {"type": "array", "items": {"anyOf": _SIZE}, "minItems": 1, "maxItems": 3}]}
    ),
]
"""One length per axis; in a scene one number may stand for all axes."""


def not_finite(values: Any, path: str, words: str) -> list[Problem]:
    """Return the problem that values at particles are not all finite, if so."""
    return [] if np.all(np.isfinite(values)) else [Problem(path, words, code="not_finite")]
