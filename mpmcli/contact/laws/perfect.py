"""Fields that move as one wherever they meet."""

from __future__ import annotations

from typing import ClassVar, Literal, NamedTuple

from mpmcli.contact.laws.base import LAWS, LawModel
from mpmcli.contact.laws.impulse import contact_law, hold, law_impulse, law_impulse_at_end


@LAWS.register
class Perfect(LawModel):
    """A perfect bond: the centre of mass velocity on every shared node, also apart and in tension.

    The fields then move as if they were one, whatever the transfer method; the papers call it stick in the
    validation of contact with FMPM [nairn2026, 3.2.1].
    """

    screened: ClassVar[bool] = False
    bonds: ClassVar[bool] = True
    needs_normal: ClassVar[bool] = False

    kind: Literal["perfect"]

    def parameters(self) -> Joined:
        """None."""
        return Joined()


@contact_law()
class Joined(NamedTuple):
    """A perfect bond has no numbers."""


# fmt: off
@law_impulse.register(Joined)
def _(law, axes, dp0, n, separation, area, reduced_mass, dt, displacement_only, bond, out):
    return hold(axes, dp0, out)


@law_impulse_at_end.register(Joined)
def _(law, axes, dp0, n, separation, force, area, reduced_mass, dt, displacement_only, bond, out):
    return hold(axes, dp0, out)
# fmt: on
