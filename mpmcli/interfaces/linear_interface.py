"""A spring in each direction, or none at all."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, TypeAdapter, ValidationInfo, WithJsonSchema, model_validator

from mpmcli.contact.laws.base import LAWS
from mpmcli.core.model import Quantity
from mpmcli.interfaces.base import InterfaceModel
from mpmcli.interfaces.independent import Independent
from mpmcli.interfaces.springs import Elastic, Rigid

_stiffness: TypeAdapter[Any] = TypeAdapter(Annotated[float, Quantity("pressure/length", ge=0)])


def read_stiffness(value: Any, info: ValidationInfo) -> Any:
    """A stiffness [pressure/length], or ``perfect``."""
    return "perfect" if value == "perfect" else _stiffness.validate_python(value, context=info.context)


Stiffness = Annotated[
    Any,
    BeforeValidator(read_stiffness),
    WithJsonSchema(
        {
            "anyOf": [{"type": "number", "minimum": 0}, {"type": "string"}],
            "x-dimension": "pressure/length",
        }
    ),
]


def spring_of(stiffness: Any) -> Rigid | Elastic:
    """The spring of a stiffness."""
    return Rigid() if stiffness == "perfect" else Elastic(float(stiffness))


@LAWS.register
class LinearInterface(InterfaceModel):
    """A linear imperfect interface: T_n = D_n δ_n and T_t = D_t δ_t, also in compression [nairn2023notes, 5.3]."""

    kind: Literal["linear_interface"]
    normal: Stiffness
    """Pressure per opening D_n; ``perfect``: no jump along the normal."""
    tangential: Stiffness
    """Shear traction per slip D_t; ``perfect``: no slip."""

    @model_validator(mode="after")
    def _not_all_perfect(self) -> Self:
        if self.normal == self.tangential == "perfect":
            raise ValueError("an interface that is perfect in both directions is the contact law 'perfect'")
        return self

    @property
    def slopes(self) -> tuple[float, float]:
        """D_n and D_t, 0 if perfect."""
        normal, tangential = (0.0 if d == "perfect" else d for d in (self.normal, self.tangential))
        return normal, tangential

    def parameters(self) -> Independent:
        """Two springs."""
        return Independent(spring_of(self.normal), spring_of(self.tangential))
