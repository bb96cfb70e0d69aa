"""Heat through a film between the surface of a body and what is around it (convection)."""

from typing import Annotated, Any, ClassVar, Literal

from mpmcli.boundary.base import LOADS, Array
from mpmcli.boundary.face_heat import FaceHeat
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Varying


@LOADS.register
class Film(FaceHeat):
    """Heats a face of a body in proportion to the difference of temperatures, or cools it."""

    positive: ClassVar[tuple[str, ...]] = ("coefficient", "around")

    kind: Literal["film"] = "film"
    """Kind of load."""
    coefficient: Annotated[Expression, Varying("film_coefficient")]
    """Power per area and temperature difference: a number or expression of x, y, z (of the face at the start) and t."""
    around: Annotated[Expression, Varying("temperature")]
    """Temperature around the body, a number or an expression of the same variables."""

    def heat_flux_at(self, points: Array, time: float, temperature: Array) -> tuple[Any, Any]:
        """Return h (T_a − T_s) and −h."""
        h = self.value("coefficient", points, time)
        return h * (self.value("around", points, time) - temperature), -h
