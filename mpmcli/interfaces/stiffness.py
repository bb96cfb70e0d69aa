"""Words for a stiffness that may be infinite."""

from typing import Annotated, Any

from pydantic import AllowInfNan, BeforeValidator, TypeAdapter, ValidationInfo, WithJsonSchema

from mpmcli.core.model import Quantity
from mpmcli.core.suggest import did_you_mean
from mpmcli.interfaces.springs import Elastic, Rigid

_stiffness: TypeAdapter[Any] = TypeAdapter(
    Annotated[float, Quantity("pressure/length", ge=0), AllowInfNan(False)]
)


def read_stiffness(value: Any, info: ValidationInfo) -> Any:
    """A stiffness [pressure/length], or ``perfect``."""
    if value == "perfect":
        return value
    if isinstance(value, str) and (hint := did_you_mean(value, ["perfect"])):
        raise ValueError(f"'{value}' is not a stiffness{hint}")
    return _stiffness.validate_python(value, context=info.context)


NUMBER_OR_WORD = WithJsonSchema(
    {"anyOf": [{"type": "number", "minimum": 0}, {"type": "string"}], "x-dimension": "pressure/length"}
)
Stiffness = Annotated[Any, BeforeValidator(read_stiffness), NUMBER_OR_WORD]


def spring_of(stiffness: Any) -> Rigid | Elastic:
    """The spring of a stiffness."""
    return Rigid() if stiffness == "perfect" else Elastic(float(stiffness))


def slope_of(stiffness: Any) -> float:
    """The slope of its traction, 0 if perfect [pressure/length]."""
    return 0.0 if stiffness == "perfect" else float(stiffness)
