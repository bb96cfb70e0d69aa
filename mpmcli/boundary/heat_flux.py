"""Power per area into the surface of a body, through the faces of its particles."""

from typing import Annotated, Any, Literal

from mpmcli.boundary.base import LOADS, Array
from mpmcli.boundary.face_heat import FaceHeat
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Varying


@LOADS.register
class HeatFlux(FaceHeat):
    """Heats a face of a body with a given power per current area."""

    kind: Literal["heat_flux"] = "heat_flux"
    """Kind of load."""
    flux: Annotated[Expression, Varying("heat_flux")]
    """Power per area into the body, a number or an expression of x, y, z (of the face at the start) and t."""

    def heat_flux_at(self, points: Array, time: float, temperature: Array) -> tuple[Any, Any]:
        """Return the flux, which does not depend on the temperature of the surface."""
        return self.value("flux", points, time), 0.0
