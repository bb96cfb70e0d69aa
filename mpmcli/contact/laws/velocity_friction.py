"""Friction that depends on the sliding speed."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.contact.laws.base import LAWS
from mpmcli.contact.laws.impulse import contact_law, sliding_traction
from mpmcli.contact.laws.stiffness import PressedModel, with_stiffness
from mpmcli.core.model import Quantity


@LAWS.register
class VelocityFriction(PressedModel):
    """Friction that changes with the sliding speed v from a static to a kinetic value, and a viscous part.

    S_slide = (μ_k + (μ_s − μ_k) exp(−v/v_c)) N + c v, solved together with the speed that it leaves
    [nairn2020, Eq. 10]. With static friction above the kinetic one sides slip in jerks, as dry ones do; below it
    friction grows with speed; with ``friction`` 0 and ``viscosity`` alone the contact is lubricated.
    """

    needs_area: ClassVar[bool] = True

    kind: Literal["velocity_friction"]
    friction: Annotated[float, Quantity("1", ge=0)]
    """Coefficient of friction μ_k at high sliding speed."""
    static_friction: Annotated[float, Quantity("1", ge=0)] | None = None
    """Coefficient of friction μ_s at rest; equal to ``friction`` if left out."""
    characteristic_speed: Annotated[float, Quantity("velocity", gt=0)] | None = None
    """Sliding speed v_c over which the coefficient changes; needed with ``static_friction``."""
    viscosity: Annotated[float, Quantity("pressure/velocity", ge=0)] = 0.0
    """Shear traction per sliding speed c."""

    @model_validator(mode="after")
    def _speed_with_static_friction(self) -> Self:
        if (self.static_friction is None) != (self.characteristic_speed is None):
            raise ValueError("give both static_friction and characteristic_speed, or neither")
        return self

    def parameters(self) -> SpeedFriction:
        """Coefficients, inverse speed, viscosity and stiffness."""
        static = self.friction if self.static_friction is None else self.static_friction
        speed = self.characteristic_speed
        return SpeedFriction(
            kinetic=self.friction,
            drop=static - self.friction,
            inverse_speed=0.0 if speed is None else 1.0 / speed,
            viscosity=self.viscosity,
            stiffness=self.spring,
        )


@with_stiffness
@contact_law(speed=True, area=True)
class SpeedFriction(NamedTuple):
    """μ_k [-], μ_s − μ_k [-], 1/v_c [1/velocity] c [pressure/velocity] and D_c [pressure/length]."""

    kinetic: float
    drop: float
    inverse_speed: float
    viscosity: float
    stiffness: float


@sliding_traction.register(SpeedFriction)
def _(law: Any, N: Any, stick: Any, speed: Any) -> Any:
    fading = math.exp(-min(700.0, speed * law.inverse_speed))
    return (law.kinetic + law.drop * fading) * N + law.viscosity * speed
