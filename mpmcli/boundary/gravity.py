"""Gravity: the same acceleration everywhere."""

from typing import Annotated, Literal

from mpmcli.boundary.base import LOADS, LoadModel, Values, check_length
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Varying

AccelerationField = Annotated[Expression, Varying("acceleration", ("t",))]


@LOADS.register
class Gravity(LoadModel):
    """Accelerates all particles alike."""

    kind: Literal["gravity"] = "gravity"
    """Kind of load."""
    acceleration: tuple[AccelerationField, ...]
    """Acceleration, one number or expression of t per axis."""

    @property
    def varies(self) -> bool:
        """Whether it depends on time."""
        return any("t" in component.variables for component in self.acceleration)

    def uniform_acceleration(self, time: float) -> Values:
        """Return the acceleration of all particles."""
        return [component(t=time) for component in self.acceleration]

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        return check_length("acceleration", self.acceleration, dimensions)
