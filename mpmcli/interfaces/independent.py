"""Laws whose normal and tangential directions do not know of each other: a spring for each."""

import math
from typing import Any, NamedTuple

from mpmcli.contact.laws.impulse import STICKING, TINIEST, dot, length
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
    tangents,
    traction,
)
from mpmcli.interfaces.springs import is_linear, is_perfect, mean_pull, pull, rate, stored

SOFTEST = 1e150
"""Largest compliance A Δt²/m_red: beyond it products of lengths and pressures are no numbers."""


class Independent(NamedTuple):
    """A law of two springs that do not know of each other."""

    normal: Any
    tangential: Any


@inline
def compliance_of(weight, per_mass):
    """c = A Δt²/m_red of ``weight`` = A Δt and ``per_mass`` = Δt/m_red [length/pressure]."""
    return weight * per_mass if weight < SOFTEST / per_mass else SOFTEST


@inline
def slip_of(axes, n, jump, opening):
    """Size of the jump along the surface, whose part along the normal is ``opening``."""
    square = 0.0
    for a in range(len(axes)):
        square += (jump[a] - opening * n[a]) ** 2
    return math.sqrt(square)


# fmt: off
@inline
def add_tangential_impulse(
    spring, axes, dp, along, n, jump, opening, force, pushing, weight, per_mass, compliance, dt, most, oscillates,
    normal, out,
):
    """Impulse of a tangential spring, and ``normal`` along n, into ``out`` (d,).

    ``along``, ``opening`` and ``pushing`` are the parts of ``dp``, ``jump`` and ``force`` along n.
    """
    if is_linear(spring):
        for a in range(len(axes)):
            pushed = (force[a] - pushing * n[a]) * dt * per_mass if oscillates else 0.0
            out[a] = normal * n[a] + weight * mean_pull(
                spring, jump[a] - opening * n[a], (dp[a] - along * n[a]) * per_mass, pushed, compliance, most,
                oscillates,
            )
        return
    # along the surface the traction points where the jump would go without it
    for a in range(len(axes)):
        out[a] = (jump[a] - opening * n[a]) + (dp[a] - along * n[a]) * per_mass
    target = length(axes, out)
    if target == 0.0:
        for a in range(len(axes)):
            out[a] = normal * n[a]
        return
    start, free, pushed = 0.0, target, 0.0
    for a in range(len(axes)):
        start += (jump[a] - opening * n[a]) * (out[a] / target)
        if oscillates:
            pushed += (force[a] - pushing * n[a]) * dt * per_mass * (out[a] / target)
    free = target - start
    drawn = weight * mean_pull(spring, start, free, pushed, compliance, most, oscillates)
    for a in range(len(axes)):
        out[a] = normal * n[a] + drawn * (out[a] / target)


@jump_impulse.register(Independent)
def _(law, axes, dp, n, jump, force, area, reduced_mass, dt, history, oscillates, out):
    per_mass = dt / max(reduced_mass, TINIEST)
    weight = area * dt
    compliance = compliance_of(weight, per_mass)
    along, opening = dot(axes, dp, n), dot(axes, jump, n)
    pushing = dot(axes, force, n) if oscillates else 0.0
    normal = along
    if not is_perfect(law.normal):
        normal = weight * mean_pull(
            law.normal, opening, along * per_mass, pushing * dt * per_mass, compliance, history[MOST_NORMAL],
            oscillates,
        )
    if is_perfect(law.tangential):
        for a in range(len(axes)):
            out[a] = dp[a] + (normal - along) * n[a]
    else:
        add_tangential_impulse(
            law.tangential, axes, dp, along, n, jump, opening, force, pushing, weight, per_mass, compliance, dt,
            history[MOST_TANGENTIAL], oscillates, normal, out,
        )
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


@inline
def tractions_of(axes, normal, tangential, n, jump, opening, most, out):
    """Traction ``normal`` along n, and that of the spring ``tangential`` along the surface, into ``out`` (d,)."""
    for a in range(len(axes)):
        out[a] = jump[a] - opening * n[a]
    slip = length(axes, out)
    drawn = pull(tangential, slip, most) if slip > 0.0 else 0.0
    for a in range(len(axes)):
        out[a] = normal * n[a] + (drawn * (out[a] / slip) if slip > 0.0 else 0.0)


@inline
def rise(spring, opening, most):
    """Slope of a spring's traction, 0 where it softens or is perfect."""
    return max(rate(spring, opening, most), 0.0)


@tangents.register(Independent)
def _(law, axes, n, jump, history):
    opening = dot(axes, jump, n)
    slip = slip_of(axes, n, jump, opening)
    return rise(law.normal, opening, history[MOST_NORMAL]), rise(
        law.tangential, slip, history[MOST_TANGENTIAL]
    )


@traction.register(Independent)
def _(law, axes, n, jump, history, out):
    opening = dot(axes, jump, n)
    normal = pull(law.normal, opening, history[MOST_NORMAL])
    tractions_of(axes, normal, law.tangential, n, jump, opening, history[MOST_TANGENTIAL], out)


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
