"""A force per mass that varies in space and time."""

from __future__ import annotations

from typing import Any, Literal

from mpmcli.boundary.base import LOADS, LoadModel, check_length
from mpmcli.boundary.velocity import check_variables
from mpmcli.core.model import Model, field_of

_Acceleration: Any = field_of("acceleration")


class OnBody(Model):
    """Which body a load acts on."""

    body: str
    """Name of the body."""


@LOADS.register
class BodyForce(LoadModel):
    """Gives particles a force per mass, evaluated at each of them at the start of the step."""

    kind: Literal["body_force"] = "body_force"
    """Kind of load."""
    on: OnBody | None = None
    """The body; by default all of them."""
    acceleration: tuple[_Acceleration, ...]
    """Force per mass, one number or expression of x, y, z and t per axis."""
    coordinates: Literal["current", "initial"] = "current"
    """Whether x, y, z are the particle's position now or that at the start of the simulation."""

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        found = check_length("acceleration", self.acceleration, dimensions)
        for a, component in enumerate(self.acceleration):
            found += check_variables(f"acceleration.{a}", component, dimensions)
        return found

    def bodies(self) -> list[tuple[str, str]]:
        """The body that it acts on, if it is one."""
        return [] if self.on is None else [("on.body", self.on.body)]
