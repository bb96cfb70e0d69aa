"""Force per area on the surface of a body, through the faces of its particles."""

from __future__ import annotations

from typing import Annotated, Any, Literal, cast

from pydantic import model_validator

from mpmcli.boundary.base import LOADS, Array, LoadModel, Values, check_length
from mpmcli.boundary.place import Face, Surface, check_axis
from mpmcli.boundary.velocity import check_variables, evaluate
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Varying

TractionField = Annotated[Expression, Varying("pressure")]


@LOADS.register
class Traction(LoadModel):
    """Loads a face of a body, dead (by initial area and axes) or following its deformed particle faces."""

    kind: Literal["traction"] = "traction"
    """Kind of load."""
    on: Surface
    """Body and face."""
    traction: tuple[TractionField, ...] | None = None
    """Force per area, one number or expression of x, y, z (of the face) and t per axis."""
    pressure: TractionField | None = None
    """Instead of ``traction``: pressure on the face, positive inwards."""
    follower: bool | None = None
    """Whether area and direction follow the deformed face; by default pressures do and tractions do not."""

    coordinates: Literal["initial", "current"] | None = None
    """Positions that expressions take: those of the face at the start, which is the default, or those of now."""

    @model_validator(mode="after")
    def _traction_or_pressure(self) -> Traction:
        if (self.traction is None) == (self.pressure is None):
            raise ValueError("give either traction or pressure")
        return self

    @property
    def follows(self) -> bool:
        """Whether area and direction follow the deformed face."""
        return self.pressure is not None if self.follower is None else self.follower

    @property
    def follows_positions(self) -> bool:
        """Whether expressions take present positions."""
        return self.coordinates == "current"

    @property
    def varies(self) -> bool:
        """Whether it changes during the run."""
        if self.follows_positions:
            return True
        components = (self.pressure,) if self.traction is None else self.traction
        return any(component is not None and "t" in component.variables for component in components)

    def loaded_face(self) -> tuple[str, Face]:
        """Return body and face."""
        return self.on.body, self.on.face

    def traction_at(self, points: Array, time: float) -> Values:
        """Return the traction at points (d, n) of the face; a pressure acts against the outward normal."""
        if self.traction is not None:
            return [evaluate(component, points, time) for component in self.traction]
        face = self.on.face
        along: list[Any] = [0.0] * points.shape[0]
        along[face.index] = -face.sign * evaluate(cast(Expression, self.pressure), points, time)
        return along

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        found = check_axis("on.face", self.on.face, dimensions)
        if self.pressure is not None:
            return found + check_variables("pressure", self.pressure, dimensions)
        found += check_length("traction", self.traction, dimensions)
        for a, component in enumerate(self.traction or ()):
            found += check_variables(f"traction.{a}", component, dimensions)
        return found
