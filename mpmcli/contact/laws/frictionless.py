"""Sides that slide freely."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from mpmcli.contact.laws.base import LAWS
from mpmcli.contact.laws.impulse import contact_law, sliding_traction
from mpmcli.contact.laws.stiffness import PressedModel, with_stiffness


@LAWS.register
class Frictionless(PressedModel):
    """No penetration, no friction: S_slide = 0."""

    kind: Literal["frictionless"]

    def parameters(self) -> Smooth:
        """Its stiffness."""
        return Smooth(stiffness=self.spring)


@with_stiffness
@contact_law()
class Smooth(NamedTuple):
    """Contact stiffness D_c [pressure/length]."""

    stiffness: float


@sliding_traction.register(Smooth)
def _(law: Any, N: Any, stick: Any, speed: Any) -> Any:
    return 0.0
