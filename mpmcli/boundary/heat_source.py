"""Power inside a body, such as that of an electric current."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, TypeAdapter, ValidationInfo, WithJsonSchema

from mpmcli.boundary.base import LOADS, Array
from mpmcli.boundary.body_force import LoadOnBodies, OnBody
from mpmcli.boundary.place import read
from mpmcli.boundary.velocity import check_variables, evaluate
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Varying

_DIMENSIONS = {"volume": "power/volume", "mass": "power/mass", "total": "power"}
_POWERS: dict[str, TypeAdapter[Any]] = {
    per: TypeAdapter(Annotated[Expression, Varying(dimension)]) for per, dimension in _DIMENSIONS.items()
}


def _read_power(value: Any, info: ValidationInfo) -> Any:
    return read(_POWERS[info.data.get("per", "volume")], value, info)


@LOADS.register
class HeatSource(LoadOnBodies):
    """Heats the particles of a body from inside."""

    acts_on: ClassVar[str] = "temperature"

    kind: Literal["heat_source"] = "heat_source"
    """Kind of load."""
    on: OnBody
    """The body."""
    per: Literal["volume", "mass", "total"] = "volume"
    """Whether the power is per current volume, per mass, or that of the body, shared in proportion to mass."""
    power: Annotated[
        Any,
        BeforeValidator(_read_power),
        WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}], "x-dimension": "power/volume"}),
    ]
    """Power (per volume or mass), a number or an expression of x, y, z (of the particle) and t.

    In axisymmetric analyses the total is that of the full ring.
    """

    @property
    def varies(self) -> bool:
        """Whether it depends on time or place, or on the volume of the particle."""
        return self.per == "volume" or not self.power.is_constant

    @property
    def power_per(self) -> str:
        """What the power is per."""
        return self.per

    def heat_power_at(self, points: Array, time: float) -> Any:
        """Return the power at points (d, n)."""
        return evaluate(self.power, points, time)

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        return check_variables("power", self.power, dimensions)
