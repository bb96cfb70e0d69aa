"""A force per mass that varies in space and time."""

from collections.abc import Callable
from typing import Annotated, Literal

from mpmcli.boundary.base import LOADS, Array, LoadModel, Values, check_length
from mpmcli.boundary.velocity import check_variables, evaluate
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Model, Varying

AccelerationField = Annotated[Expression, Varying("acceleration")]


class OnBody(Model):
    """Which body a load acts on."""

    body: str
    """Name of the body."""


class LoadOnBodies(LoadModel):
    """Base of loads on the particles of one body, or of all of them."""

    on: OnBody | None = None
    """The body; by default all of them."""

    def chosen(self, points: Array, is_of: Callable[[str], Array]) -> Array | None:
        """Return which particles are of the body."""
        return None if self.on is None else is_of(self.on.body)


@LOADS.register
class BodyForce(LoadOnBodies):
    """Gives particles a force per mass, evaluated at each of them at the start of the step."""

    kind: Literal["body_force"] = "body_force"
    """Kind of load."""
    acceleration: tuple[AccelerationField, ...]
    """Force per mass, one number or expression of x, y, z and t per axis."""
    coordinates: Literal["current", "initial"] = "current"
    """Whether x, y, z are the particle's position now or that at the start of the simulation."""

    @property
    def varies(self) -> bool:
        """Whether it depends on time, or on the current position."""
        if self.uses_initial_positions:
            return any("t" in component.variables for component in self.acceleration)
        return not all(component.is_constant for component in self.acceleration)

    @property
    def uses_initial_positions(self) -> bool:
        """Whether it is evaluated at the positions at the start."""
        return self.coordinates == "initial"

    def acceleration_at(self, points: Array, time: float) -> Values:
        """Return the force per mass at points (d, n)."""
        return [evaluate(component, points, time) for component in self.acceleration]

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        found = check_length("acceleration", self.acceleration, dimensions)
        for a, component in enumerate(self.acceleration):
            found += check_variables(f"acceleration.{a}", component, dimensions)
        return found
