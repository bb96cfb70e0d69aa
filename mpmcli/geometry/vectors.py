"""Lists of a given length in a scene: positions, directions, corners."""

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import AfterValidator, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from mpmcli.core.model import Length, Number, Quantity


@dataclass(frozen=True)
class Count:
    """Annotation of a list: how many items it must have (a wrong item is not counted as missing, too)."""

    least: int
    most: int | None = None
    noun: str = "numbers"

    def check(self, items: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return the items if there are as many as needed."""
        if self.least <= len(items) and (self.most is None or len(items) <= self.most):
            return items
        needed = f"{self.least}" if self.least == self.most else f"at least {self.least}"
        if self.least != self.most and len(items) > self.least:
            needed = f"at most {self.most}"
        raise ValueError(f"{needed} {self.noun} are needed, not {len(items)}")

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self.check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        described = handler(schema)
        described["minItems"] = self.least
        if self.most is not None:
            described["maxItems"] = self.most
        return described


def has_length(direction: tuple[float, ...]) -> tuple[float, ...]:
    """Check that a direction is not the zero vector."""
    if not any(direction):
        raise ValueError("a direction must not have length zero")
    return direction


Factor = Annotated[float, Quantity("1", gt=0)]
"""A factor above zero."""
NonNegative = Annotated[float, Quantity("1", ge=0)]
NonNegativeLength = Annotated[float, Quantity("length", ge=0)]
ColourPart = Annotated[float, Quantity("1", ge=0, le=255)]
Vector = Annotated[tuple[Length, ...], Count(1, 3)]
"""One length per axis of the grid."""
Point2 = Annotated[tuple[Length, ...], Count(2, 2)]
Point3 = Annotated[tuple[Length, ...], Count(3, 3)]
Direction = Annotated[tuple[Number, ...], Count(1, 3), AfterValidator(has_length)]
"""One number per axis of the grid, not all of them zero."""


def in_words(x: Any, digits: int = 6) -> str:
    """A point as messages show it: ``[1, 2.5]``."""
    return "[" + ", ".join(f"{value:.{digits}g}" for value in x) + "]"
