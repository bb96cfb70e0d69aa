"""Springs: what an interface does in one direction.

A spring is a named tuple of numbers with the generic functions below. ``opening`` is the jump along its direction,
``most`` the largest so far (springs without memory ignore it), c = A Δt²/m_red the *compliance* [length/pressure]: a
traction T held during a step takes c T from the opening at its end.
"""

from typing import Any, NamedTuple

from mpmcli.contact.laws.impulse import HARD
from mpmcli.contact.laws.spring import mean_opening, stumpff
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline


@generic
def is_perfect(spring: Any) -> Any:
    """Whether the direction has no jump at all: known to the compiler."""


@generic
def is_linear(spring: Any) -> Any:
    """Whether T = D δ, so that components of a vector may be found one by one: known to the compiler."""


@generic
def pull(spring: Any, opening: Any, most: Any) -> Any:
    """Traction T at an opening [pressure]; negative where it presses."""


@generic
def rate(spring: Any, opening: Any, most: Any) -> Any:
    """Slope dT/dδ at an opening [pressure/length]; negative where it softens."""


@generic
def stored(spring: Any, opening: Any, most: Any) -> Any:
    """Energy per area that it gives back [energy/area]."""


@generic
def settle(spring: Any, opening: Any, target: Any, compliance: Any, most: Any) -> Any:
    """Opening δ at the end of the step: δ + c T(δ) = ``target``.

    Where a law softens there may be several; it is the next one on the way from ``opening``, that of the start.
    """


@generic
def resist(spring: Any, opening: Any, target: Any, compliance: Any, most: Any) -> Any:
    """Traction at the end of the step, at the opening of ``settle``; damage is that of the start of the step."""


@generic
def oscillate(spring: Any, opening: Any, free: Any, pushed: Any, compliance: Any, most: Any) -> Any:
    """Mean traction J/(A Δt) of a spring that moves by itself within the step [pressure].

    ``opening`` δ(0), ``free`` = Δp⁺ Δt/m_red and ``pushed`` = f Δt²/m_red are lengths (Nairn 2023, Eqs. 5.45, 5.62).
    """


class Rigid(NamedTuple):
    """A perfect direction; numba tells the classes apart, the value is never read."""

    nothing: float = 0.0


class Elastic(NamedTuple):
    """D [pressure/length] of T = D δ."""

    stiffness: float


@is_perfect.register(Rigid)
@is_linear.register(Elastic)
def yes(spring):
    """It is."""
    return True


@is_perfect.register(Elastic)
@is_linear.register(Rigid)
def no(spring):
    """It is not."""
    return False


@pull.register(Rigid)
@rate.register(Rigid)
@stored.register(Rigid)
def _(spring, opening, most):
    return 0.0


@settle.register(Rigid)
@resist.register(Rigid)
def _(spring, opening, target, compliance, most):
    return 0.0


@oscillate.register(Rigid)
def _(spring, opening, free, pushed, compliance, most):
    return 0.0


@pull.register(Elastic)
def _(spring, opening, most):
    return spring.stiffness * opening


@rate.register(Elastic)
def _(spring, opening, most):
    return spring.stiffness


@stored.register(Elastic)
def _(spring, opening, most):
    return 0.5 * spring.stiffness * opening * opening


@settle.register(Elastic)
def _(spring, opening, target, compliance, most):
    return target / (1.0 + compliance * spring.stiffness)


@resist.register(Elastic)
def resist_by_pull(spring, opening, target, compliance, most):
    """``resist`` of springs whose traction is known from the opening."""
    return pull(spring, settle(spring, opening, target, compliance, most), most)


@oscillate.register(Elastic)
def _(spring, opening, free, pushed, compliance, most):
    u = spring.stiffness * compliance
    if u > HARD:
        return stick(free, compliance)
    c2, c3, c4 = stumpff(u)
    return 2.0 * spring.stiffness * mean_opening(opening, free, pushed, c2, c3, c4)


@inline
def stick(free, compliance):
    """Mean traction of a spring that is too stiff for the step: J = Δp⁺."""
    return free / compliance


def oscillate_nonlinear(spring, opening, free, pushed, compliance, most):
    """``oscillate`` to first order, for any law (Nairn 2023, Eqs. 5.55, 5.61–5.63).

    Where the law is too stiff for the step, φ > π/2, it sticks; where it softens as fast, it transmits nothing.
    """
    first = pull(spring, opening, most)
    slope = compliance * rate(spring, opening, most)
    mean = opening - compliance * first / 6.0 + 0.5 * free - pushed / 3.0
    traction = 0.5 * (first + pull(spring, mean, most))
    if abs(slope) <= HARD:
        end = opening - 0.5 * compliance * traction + free - 0.5 * pushed
        slope = compliance * rate(spring, end, most)
    if slope > HARD:
        return stick(free, compliance)
    return 0.0 if slope < -HARD else traction


@inline
def mean_pull(spring, opening, free, pushed, compliance, most, oscillates):
    """Mean traction of a spring over the step, from its state and what moves it (``oscillate``)."""
    if oscillates:
        return oscillate(spring, opening, free, pushed, compliance, most)
    return resist(spring, opening, opening + free, compliance, most)
