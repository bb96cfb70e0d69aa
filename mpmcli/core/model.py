"""The pydantic base of everything a scene can say, and the types of its values.

A value may be a number, a string with a unit (``"1 GPa"``, converted to the scene's units) or an
expression of the scene's constants. The loader hands what knows units and constants to pydantic as validation
context (a ``Resolver``); without a context (Python use) only numbers and plain arithmetic are understood.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Protocol

from annotated_types import GroupedMetadata
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)

from mpmcli.core.expressions import Expression, number_in


class Resolver(Protocol):
    """What turns text of a scene into numbers: the scene's units and constants."""

    constants: dict[str, float]

    def number(self, text: str, dimension: str) -> float:
        """The value of ``text`` in the scene's units; raises ValueError with words for the user."""


_UNIT_FOLLOWS = re.compile(
    r"\s*[-+]?(?>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*((?<=\s)1\s*/\s*)?([^\W\d_]|[%°Å])"
)


def has_unit(text: str) -> bool:
    """Whether text is a number with something after it that is no arithmetic, as in ``"1.5 GPa"``."""
    return _UNIT_FOLLOWS.match(text) is not None


class Model(BaseModel):
    """Base of all scene models: unknown keys are errors, values do not change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> Any:
        """The JSON Schema, with the docstrings below the fields as their descriptions."""
        from mpmcli.core.descriptions import field_descriptions

        schema = handler(core_schema)
        properties = handler.resolve_ref_schema(schema).get("properties", {})
        words = field_descriptions(cls)
        for name, field in cls.model_fields.items():
            key = field.alias or name
            if key in properties and name in words:
                properties[key]["description"] = words[name]
        return schema

    @model_validator(mode="before")
    @classmethod
    def _keep_kinds_apart(cls, values: Any, info: ValidationInfo) -> Any:
        """Keep yes/no, whole numbers and text apart, which pydantic would convert into each other."""
        if not isinstance(values, dict):
            return values
        changed = {}
        for name, field in cls.model_fields.items():
            key = field.alias or name
            if key in values and field.annotation in (bool, bool | None):
                changed[key] = values[key] if isinstance(values[key], bool | None) else Refused(values[key])
            elif key in values and field.annotation in (int, int | None):
                changed[key] = _whole_number(values[key], info)
        return values | changed if changed else values


class Refused:
    """A value that pydantic would convert, but must not."""

    def __init__(self, value: Any):
        self.value = value


def _whole_number(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, bool):
        return Refused(value)
    if not isinstance(value, str):
        return value
    try:
        return _resolve_number("1")(value, info)
    except ValueError:
        return Refused(value)


def _resolve_number(dimension: str) -> Any:
    def resolve(value: Any, info: ValidationInfo) -> Any:
        if not isinstance(value, str):
            if isinstance(value, bool):
                raise ValueError("a number is needed, not true or false")
            return value
        if info.context is not None:
            return info.context.number(value, dimension)
        return number_in(value)

    return resolve


@dataclass(frozen=True)
class Quantity(GroupedMetadata):
    """Marks a number with a physical dimension: ``Annotated[float, Quantity("length", gt=0)]``.

    Attributes
    ----------
    dimension : ``"length"``, ``"pressure"``, ``"1"``…
    gt, ge, lt, le : bounds
    """

    dimension: str
    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None

    def __iter__(self) -> Iterator[Any]:
        words = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}
        bounds = {name: getattr(self, name) for name in words if getattr(self, name) is not None}
        number = {"type": "number"} | {words[name]: value for name, value in bounds.items()}
        yield Field(**bounds)
        yield BeforeValidator(_resolve_number(self.dimension))
        yield WithJsonSchema({"anyOf": [number, {"type": "string"}], "x-dimension": self.dimension})


def _resolve_field(dimension: str, variables: tuple[str, ...]) -> Any:
    def resolve(value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, Expression):
            return value
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise ValueError("a number or an expression is needed")
        if isinstance(value, int | float):
            if not abs(value) < float("inf"):
                raise ValueError("must be finite")
            return Expression.constant(float(value))
        resolver = info.context
        if resolver is None:
            return Expression(value, {}, variables)
        if has_unit(value):
            return Expression.constant(resolver.number(value, dimension))
        return Expression(value, resolver.constants, variables, getattr(resolver, "table", None))

    return resolve


@dataclass(frozen=True)
class Varying(GroupedMetadata):
    """Marks a value that may vary in space and time: ``Annotated[Expression, Varying("velocity")]``.

    A scene gives a number, a string with a unit, or an expression of the variables.
    """

    dimension: str
    variables: tuple[str, ...] = ("x", "y", "z", "t")

    def __iter__(self) -> Iterator[Any]:
        yield BeforeValidator(_resolve_field(self.dimension, self.variables))
        schema = {"anyOf": [{"type": "number"}, {"type": "string"}], "x-dimension": self.dimension}
        yield WithJsonSchema(schema)


Number = Annotated[float, Quantity("1")]
Length = Annotated[float, Quantity("length")]
PositiveLength = Annotated[float, Quantity("length", gt=0)]
Pressure = Annotated[float, Quantity("pressure")]
PositivePressure = Annotated[float, Quantity("pressure", gt=0)]
Density = Annotated[float, Quantity("density", gt=0)]
Velocity = Annotated[float, Quantity("velocity")]
Time = Annotated[float, Quantity("time")]
PositiveTime = Annotated[float, Quantity("time", gt=0)]
