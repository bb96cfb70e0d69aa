"""Fields that do not feel each other."""

from __future__ import annotations

from typing import ClassVar, Literal, NamedTuple

from mpmcli.contact.laws.base import LAWS, LawModel
from mpmcli.contact.laws.impulse import contact_law, law_impulse, law_impulse_at_end, leave


@LAWS.register
class NoContact(LawModel):
    """No contact: the fields pass through each other."""

    skipped: ClassVar[bool] = True
    needs_normal: ClassVar[bool] = False

    kind: Literal["none"]

    def parameters(self) -> Free:
        """None."""
        return Free()


@contact_law()
class Free(NamedTuple):
    """No contact has no numbers."""


# fmt: off
@law_impulse.register(Free)
def _(law, axes, dp0, n, separation, area, reduced_mass, dt, displacement_only, bond, out):
    return leave(axes, out)


@law_impulse_at_end.register(Free)
def _(law, axes, dp0, n, separation, force, area, reduced_mass, dt, displacement_only, bond, out):
    return leave(axes, out)
# fmt: on
