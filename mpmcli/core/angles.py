"""Angles of scenes: numbers in degrees, or text with a unit."""

import math
import re
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from mpmcli.core.expressions import number_in
from mpmcli.core.model import has_unit

IN_DEGREES = {
    "deg": 1.0,
    "degree": 1.0,
    "degrees": 1.0,
    "°": 1.0,
    "rad": 180 / math.pi,
    "radian": 180 / math.pi,
}
IN_DEGREES["radians"] = IN_DEGREES["rad"]
ANGLE = re.compile(r"(.*[\d\s.)])\s*(" + "|".join(sorted(IN_DEGREES, key=len, reverse=True)) + r")\s*")


def _in_degrees(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, bool):
        raise ValueError("a number is needed, not true or false")
    if not isinstance(value, str):
        return value
    match = ANGLE.fullmatch(value)
    text, factor = (match[1], IN_DEGREES[match[2]]) if match else (value, 1.0)
    if has_unit(text):
        raise ValueError(
            f"'{value}' is not an angle; give degrees, or text with a unit such as '15 deg' or '0.3 rad'"
        )
    if info.context is not None:
        return factor * info.context.number(text.strip(), "1")
    return factor * number_in(text.strip())


Angle = Annotated[
    float,
    BeforeValidator(_in_degrees),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}], "x-dimension": "angle"}),
]
"""An angle in degrees; text may carry its unit (``"0.3 rad"``, ``"15 deg"``)."""
