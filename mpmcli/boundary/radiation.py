"""Heat radiation between the surface of a body and what is around it."""

from typing import Annotated, Any, ClassVar, Literal, cast

from pydantic import BeforeValidator, Field, ValidationInfo

from mpmcli.boundary.base import LOADS, Array
from mpmcli.boundary.face_heat import FaceHeat
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Quantity, Varying

STEFAN_BOLTZMANN = "5.670374419e-8 W/m^2/K^4"


def _read_constant(value: Any, info: ValidationInfo) -> Any:
    """The constant in the units of the scene where none is given."""
    if value is not None:
        return value
    scene: Any = info.context
    try:
        return scene.number(STEFAN_BOLTZMANN, "power/area/temperature^4")
    except (ValueError, AttributeError):
        words = (
            f"the Stefan–Boltzmann constant, {STEFAN_BOLTZMANN}, needs units: {{length: …, mass: …, time: …}}"
        )
        raise ValueError(f"{words}; or give stefan_boltzmann") from None


@LOADS.register
class Radiation(FaceHeat):
    """Heats a face of a body by radiation with εσ(T_a⁴ − T⁴) per area, or cools it."""

    positive: ClassVar[tuple[str, ...]] = ("around",)

    kind: Literal["radiation"] = "radiation"
    """Kind of load."""
    emissivity: Annotated[float, Quantity("1", gt=0, le=1)]
    """Emissivity ε of the surface."""
    around: Annotated[Expression, Varying("temperature")]
    """Temperature T_a around the body, a number or an expression of x, y, z (of the face at the start) and t."""
    stefan_boltzmann: Annotated[
        float,
        Quantity("power/area/temperature^4", gt=0, lt=1e30),
        BeforeValidator(_read_constant),
        Field(validate_default=True),
    ] = cast(float, None)
    """Stefan–Boltzmann constant σ, 5.670374419e-8 W/m²K⁴ by default; scenes without units must give it."""

    def heat_flux_at(self, points: Array, time: float, temperature: Array) -> tuple[Any, Any]:
        """Return εσ(T_a⁴ − T_s⁴) and −4εσT_s³."""
        factor = self.emissivity * self.stefan_boltzmann
        around = self.value("around", points, time)
        return factor * (around**4 - temperature**4), -4.0 * factor * temperature**3
