"""Springs: what an interface does in one direction, and laws whose directions are independent of each other.

A spring is a named tuple of numbers with the generic functions below. ``opening`` is the jump along its direction,
``most`` the largest so far (springs without memory ignore it).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from mpmcli.contact.laws.impulse import HARD, STICKING, TINIEST, dot, length
from mpmcli.contact.laws.stiffness import stumpff
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.interfaces.base import (
    BREAKS,
    MOST_NORMAL,
    MOST_TANGENTIAL,
    damage,
    held_impulse,
    jump_impulse,
    openings,
    remember,
    stored_energy,
    traction,
)


@generic
def is_perfect(spring: Any) -> Any:
    """Whether the direction has no jump at all: known to the compiler."""


@generic
def pull(spring: Any, opening: Any, most: Any) -> Any:
    """Traction T at an opening [pressure]; negative where it presses."""


@generic
def stored(spring: Any, opening: Any, most: Any) -> Any:
    """Energy per area that it gives back [energy/area]."""


@generic
def settle(spring: Any, target: Any, compliance: Any, most: Any) -> Any:
    """Opening δ at the end of the step: δ + c T(δ) = ``target``, c = A Δt²/m_red = ``compliance``."""


@generic
def oscillate(spring: Any, opening: Any, free: Any, pushed: Any, compliance: Any, most: Any) -> Any:
    """c J/(A Δt) of a spring that moves by itself within the step: c times its mean traction [length].

    ``opening`` δ(0), ``free`` = Δp⁺ Δt/m_red and ``pushed`` = f Δt²/m_red are lengths (Nairn 2023, Eqs. 5.45, 5.62).
    """


class Rigid(NamedTuple):
    """A perfect direction; numba tells the classes apart, the value is never read."""

    nothing: float = 0.0


class Elastic(NamedTuple):
    """D [pressure/length] of T = D δ."""

    stiffness: float


class Independent(NamedTuple):
    """A law of two springs that do not know of each other."""

    normal: Any
    tangential: Any


@is_perfect.register(Rigid)
def _(spring):
    return True


@is_perfect.register(Elastic)
def _(spring):
    return False


@pull.register(Rigid)
@stored.register(Rigid)
def _(spring, opening, most):
    return 0.0


@settle.register(Rigid)
def _(spring, target, compliance, most):
    return 0.0


@oscillate.register(Rigid)
def _(spring, opening, free, pushed, compliance, most):
    return 0.0


@pull.register(Elastic)
def _(spring, opening, most):
    return spring.stiffness * opening


@stored.register(Elastic)
def _(spring, opening, most):
    return 0.5 * spring.stiffness * opening * opening


@settle.register(Elastic)
def _(spring, target, compliance, most):
    return target / (1.0 + compliance * spring.stiffness)


@oscillate.register(Elastic)
def _(spring, opening, free, pushed, compliance, most):
    u = spring.stiffness * compliance
    if u > HARD:  # too stiff for the step: it sticks
        return free / compliance
    c2, c3, c4 = stumpff(u)
    return 2.0 * spring.stiffness * (opening * c2 + free * c3 + pushed * (c4 - c3))


@inline
def mean_pull(spring, opening, free, pushed, compliance, most, oscillates):
    """Mean traction of a spring over the step, from its state and what moves it (``oscillate``)."""
    if oscillates:
        return oscillate(spring, opening, free, pushed, compliance, most)
    return pull(spring, settle(spring, opening + free, compliance, most), most)


# fmt: off
@jump_impulse.register(Independent)
def _(law, axes, dp, n, jump, force, area, reduced_mass, dt, history, oscillates, out):
    per_mass = dt / max(reduced_mass, TINIEST)
    compliance = area * dt * per_mass
    along, opening = dot(axes, dp, n), dot(axes, jump, n)
    pushing = dot(axes, force, n) if oscillates else 0.0
    most_normal, most_tangential = history[MOST_NORMAL], history[MOST_TANGENTIAL]
    normal = along
    if not is_perfect(law.normal):
        normal = area * dt * mean_pull(
            law.normal, opening, along * per_mass, pushing * dt * per_mass, compliance, most_normal, oscillates
        )
    if is_perfect(law.tangential):
        for a in range(len(axes)):
            out[a] = dp[a] + (normal - along) * n[a]
        return STICKING
    # along the surface the traction points where the jump would go without it
    for a in range(len(axes)):
        out[a] = (jump[a] - opening * n[a]) + (dp[a] - along * n[a]) * per_mass
    target = length(axes, out)
    if target == 0.0:
        for a in range(len(axes)):
            out[a] = normal * n[a]
        return STICKING
    start, free, pushed = 0.0, 0.0, 0.0
    for a in range(len(axes)):
        t = out[a] / target
        start += (jump[a] - opening * n[a]) * t
        free += (dp[a] - along * n[a]) * per_mass * t
        if oscillates:
            pushed += (force[a] - pushing * n[a]) * dt * per_mass * t
    drawn = area * dt * mean_pull(
        law.tangential, start, free, pushed, compliance, most_tangential, oscillates
    ) / target
    for a in range(len(axes)):
        out[a] = normal * n[a] + drawn * out[a]
    return STICKING
# fmt: on


@held_impulse.register(Independent)
def _(law, axes, dp, n, out):
    along = dot(axes, dp, n)
    for a in range(len(axes)):
        out[a] = 0.0
        if is_perfect(law.normal):
            out[a] += along * n[a]
        if is_perfect(law.tangential):
            out[a] += dp[a] - along * n[a]
    return STICKING


@traction.register(Independent)
def _(law, axes, n, jump, history, out):
    opening = dot(axes, jump, n)
    normal = pull(law.normal, opening, history[MOST_NORMAL])
    for a in range(len(axes)):
        out[a] = jump[a] - opening * n[a]
    slip = length(axes, out)
    drawn = pull(law.tangential, slip, history[MOST_TANGENTIAL]) / slip if slip > 0.0 else 0.0
    for a in range(len(axes)):
        out[a] = normal * n[a] + drawn * out[a]


@inline
def slip_of(axes, n, jump, opening):
    """Size of the jump along the surface, whose part along the normal is ``opening``."""
    square = 0.0
    for a in range(len(axes)):
        square += (jump[a] - opening * n[a]) ** 2
    return math.sqrt(square)


@stored_energy.register(Independent)
def _(law, axes, n, jump, history):
    opening = dot(axes, jump, n)
    slip = slip_of(axes, n, jump, opening)
    return stored(law.normal, opening, history[MOST_NORMAL]) + stored(
        law.tangential, slip, history[MOST_TANGENTIAL]
    )


@openings.register(Independent)
def _(law, axes, n, jump, now):
    now[0], now[1] = 0.0, 0.0


@remember.register(Independent)
def _(law, axes, n, jump, history):
    return 0.0


@damage.register(Independent)
def _(law, history):
    return history[BREAKS]
