"""Sides that stick while they touch."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from mpmcli.contact.laws.base import LAWS
from mpmcli.contact.laws.impulse import contact_law, sliding_traction
from mpmcli.contact.laws.stiffness import PressedModel, with_stiffness


@LAWS.register
class Stick(PressedModel):
    """No sliding while in contact: friction without limit. ``perfect`` holds sides together always."""

    kind: Literal["stick"]

    def parameters(self) -> Rough:
        """Its stiffness."""
        return Rough(stiffness=self.spring)


@with_stiffness
@contact_law()
class Rough(NamedTuple):
    """Contact stiffness D_c [pressure/length]."""

    stiffness: float


@sliding_traction.register(Rough)
def _(law: Any, N: Any, stick: Any, speed: Any) -> Any:
    return stick
