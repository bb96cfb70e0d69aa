"""Coulomb friction with static and kinetic coefficients."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.contact.laws.base import LAWS
from mpmcli.contact.laws.impulse import contact_law, sliding_traction
from mpmcli.contact.laws.stiffness import PressedModel, with_stiffness
from mpmcli.core.model import Quantity


@LAWS.register
class Coulomb(PressedModel):
    """Coulomb friction: sides stick up to a traction of μ_s N and slide at μ_k N [nairn2020, Eq. 10]."""

    kind: Literal["coulomb"]
    friction: Annotated[float, Quantity("1", ge=0)]
    """Coefficient of (kinetic) friction μ_k."""
    static_friction: Annotated[float, Quantity("1", ge=0)] | None = None
    """Coefficient of static friction μ_s, not below ``friction``, to which it is equal if left out."""

    @model_validator(mode="after")
    def _static_not_below_kinetic(self) -> Self:
        if self.static_friction is not None and self.static_friction < self.friction:
            raise ValueError("static_friction must not be below friction")
        return self

    def parameters(self) -> Friction:
        """Both coefficients and the stiffness."""
        static = self.friction if self.static_friction is None else self.static_friction
        return Friction(kinetic=self.friction, static=static, stiffness=self.spring)


@with_stiffness
@contact_law()
class Friction(NamedTuple):
    """Coefficients of friction μ_k and μ_s ≥ μ_k [-], contact stiffness D_c [pressure/length]."""

    kinetic: float
    static: float
    stiffness: float


@sliding_traction.register(Friction)
def _(law: Any, N: Any, stick: Any, speed: Any) -> Any:
    return stick if stick <= law.static * N else law.kinetic * N
