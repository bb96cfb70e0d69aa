"""Temperature given at nodes, or on a face of a body."""

from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from mpmcli.boundary.base import CONDITIONS, Array, ConditionModel, Nodes, SurfaceNodes
from mpmcli.boundary.place import Face, Place
from mpmcli.boundary.velocity import PlaceHolder, check_variables, evaluate
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Varying


@CONDITIONS.register
class Temperature(ConditionModel):
    """Holds the temperature of grid nodes, or of a face of a body."""

    acts_on: ClassVar[str] = "temperature"

    kind: Literal["temperature"]
    """Kind of condition."""
    on: Place
    """Where: nodes on a plane and beyond it, in a box or region, or a face of a body, wherever that is."""
    value: Annotated[Expression, Varying("temperature")]
    """Temperature, a number or an expression of x, y, z (of the node or face) and t."""

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        found = self.on.problems(dimensions) + check_variables("value", self.value, dimensions)
        if self.on.covered_by is not None:
            found.append(("on.covered_by", "a body that covers nodes prescribes velocities only"))
        return found

    def held_face(self) -> tuple[str, Face] | None:
        """The body and face, if it is one."""
        return None if self.on.body is None or self.on.face is None else (self.on.body, self.on.face)

    def face_temperature_at(self, points: Array, time: float) -> Any:
        """Return the temperature at points (d, n) of the face."""
        return evaluate(self.value, points, time)

    def holder(self, grid: Nodes, surface_nodes: SurfaceNodes | None) -> PlaceHolder:
        """The condition on a grid."""
        return PlaceHolder(self.on, self.value, np.ones(1), grid, surface_nodes)
