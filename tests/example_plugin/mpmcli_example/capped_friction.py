"""Friction that the softer side limits: it shears rather than slides once the traction reaches its strength."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from mpmcli.contact.laws.base import LAWS, LawModel
from mpmcli.contact.laws.impulse import contact_law, sliding_traction
from mpmcli.core.model import PositivePressure, Quantity


@LAWS.register
class CappedFriction(LawModel):
    """Coulomb friction up to a largest shear traction, S_slide = min(μN, S_max)."""

    needs_area: ClassVar[bool] = True

    kind: Literal["capped_friction"]
    friction: Annotated[float, Quantity("1", ge=0)]
    """Coefficient of friction μ."""
    shear_strength: PositivePressure
    """Largest shear traction S_max."""

    def parameters(self) -> Capped:
        """Coefficient and strength."""
        return Capped(self.friction, self.shear_strength)


@contact_law(area=True)  # a strength is a traction, not an impulse: the contact area matters
class Capped(NamedTuple):
    """μ [-] and S_max [pressure]."""

    friction: float
    strength: float


@sliding_traction.register(Capped)
def _(law: Any, N: Any, stick: Any, speed: Any) -> Any:
    return min(law.friction * N, law.strength)
