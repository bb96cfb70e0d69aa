"""A concentrated force at a point of the grid."""

from typing import Annotated, Literal

from mpmcli.boundary.base import LOADS, Array, LoadModel, Values, check_length
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Length, Varying

ForceField = Annotated[Expression, Varying("force", ("t",))]


@LOADS.register
class NodalForce(LoadModel):
    """Acts on the grid node at a point, or on the nodes around it by their linear functions.

    Nodes without mass pass their part on to the others; where none has mass, nothing is loaded.
    """

    kind: Literal["nodal_force"] = "nodal_force"
    """Kind of load."""
    at: tuple[Length, ...]
    """The point, which does not move and lies in the grid."""
    force: tuple[ForceField, ...]
    """Force, one number or expression of t per axis (axisymmetric: on the full ring)."""

    @property
    def varies(self) -> bool:
        """Whether it depends on time."""
        return any("t" in component.variables for component in self.force)

    def nodal_force_at(self, time: float) -> tuple[Array | tuple[float, ...], Values]:
        """Return the point, and the force there."""
        return self.at, [component(t=time) for component in self.force]

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        return check_length("at", self.at, dimensions) + check_length("force", self.force, dimensions)
