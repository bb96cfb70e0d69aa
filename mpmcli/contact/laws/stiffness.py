"""Finite contact stiffness: touching sides press on each other through a spring instead of not at all overlapping.

Between penetration that costs nothing and one that is impossible a contact changes abruptly; a spring of stiffness D_c
per area softens the change (Nairn 2023, 5.7). It acts in the calculation after the momentum update, on any law for
sides that press.
"""

from typing import Annotated

from mpmcli.contact.laws.base import LawModel
from mpmcli.contact.laws.impulse import (
    HARD,
    NARROWEST,
    TINIEST,
    Parameters,
    dot,
    end_separation,
    is_soft,
    law_impulse,
    law_impulse_at_end,
    leave,
    slide,
)
from mpmcli.contact.laws.spring import end_opening, mean_opening, stumpff
from mpmcli.core.model import Quantity

FAR = 1e150
"""Separations beyond this are no lengths, but a method's word for "always touching" or "nothing there"."""


class PressedModel(LawModel):
    """Base of laws for sides that press on each other."""

    stiffness: Annotated[float, Quantity("pressure/length", gt=0)] | None = None
    """Contact stiffness D_c: pressure per overlap; without it sides that touch are rigid."""

    @property
    def drives_apart(self) -> bool:
        """Overlap is what a spring presses with."""
        return self.stiffness is None

    @property
    def spring(self) -> float:
        """D_c [pressure/length], or 0 for rigid sides."""
        return 0.0 if self.stiffness is None else self.stiffness


# fmt: off
def spring_impulse(law, axes, dp0, n, separation, force, area, reduced_mass, dt, displacement_only, bond, out):
    """``law_impulse_at_end`` for laws with a ``stiffness``; 0 and contacts too stiff for the step are rigid."""
    pressed = dot(axes, dp0, n)
    spring = law.stiffness * area * dt
    if law.stiffness == 0.0 or spring * dt > HARD * reduced_mass or abs(separation) > FAR:
        end = end_separation(separation, pressed, force, reduced_mass, dt)
        return law_impulse(law, axes, dp0, n, end, area, reduced_mass, dt, displacement_only, bond, out)
    # an oscillator with φ² = D_c A_c Δt²/m_red; Eqs. 5.149 and 5.150 without their differences of near equals
    u = spring * dt / max(reduced_mass, TINIEST)
    c2, c3, c4 = stumpff(u)
    moved = (abs(pressed) + abs(force) * dt) * dt
    per_mass = dt / max(reduced_mass, NARROWEST * moved, TINIEST)
    free, pushed = pressed * per_mass, force * dt * per_mass
    end = end_opening(separation, free, pushed, u, c2, c3)
    impulse = 2.0 * spring * mean_opening(separation, free, pushed, c2, c3, c4)
    if end < 0.0 and (impulse < 0.0 or displacement_only):
        return slide(law, axes, dp0, n, pressed, impulse, area * dt, reduced_mass, out)
    return leave(axes, out)
# fmt: on


def has_stiffness(law):
    """Whether the stiffness is finite."""
    return law.stiffness > 0.0


def with_stiffness(parameters: Parameters) -> Parameters:
    """Class decorator of a law's parameter tuple with a field ``stiffness`` [pressure/length], 0 for rigid sides."""
    law_impulse_at_end.register(parameters)(spring_impulse)
    is_soft.register(parameters)(has_stiffness)
    return parameters
