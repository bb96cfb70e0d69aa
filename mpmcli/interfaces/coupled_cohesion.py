"""The functions of cohesive laws with one damage for both modes.

With the relative openings x_n = δ_n/δ_nc and x_t = δ_t/δ_tc and λ² = x_n² + x_t², the tractions are T_n = σ_n H x_n and
T_t = σ_t H x_t, where H = S̄(λ_m)/λ_m is the secant of the shape of unit strength and opening at the largest λ so far.
"""

import math
from typing import Any, NamedTuple

from mpmcli.contact.laws.impulse import HARD, STICKING, TINIEST, dot, leave
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
from mpmcli.interfaces.cohesion import press
from mpmcli.interfaces.independent import compliance_of, slip_of
from mpmcli.interfaces.shapes.base import elastic_end, envelope_slope, secant, spent
from mpmcli.interfaces.softening import Softening, worn


class CoupledCohesion(NamedTuple):
    """The shape for unit strength and opening; σ_n, σ_t [pressure], δ_nc, δ_tc [length]; contact of closed faces."""

    shape: Any
    normal_strength: float
    tangential_strength: float
    normal_opening: float
    tangential_opening: float
    closed: Any
    pressed: float


@inline
def relative(law, normal, tangential):
    """λ of two openings."""
    return math.hypot(max(normal, 0.0) / law.normal_opening, tangential / law.tangential_opening)


@inline
def most_of(law, history):
    """λ_m, at least that of the end of the elastic part."""
    return max(history[MOST_NORMAL] / law.normal_opening, elastic_end(law.shape))


# fmt: off
@jump_impulse.register(CoupledCohesion)
def _(law, axes, dp, n, jump, force, area, reduced_mass, dt, history, oscillates, out):
    per_mass = dt / max(reduced_mass, TINIEST)
    weight = area * dt
    compliance = compliance_of(weight, per_mass)
    along, opening = dot(axes, dp, n), dot(axes, jump, n)
    target = opening + along * per_mass
    base = most_of(law, history)
    stiff_normal = law.normal_strength / law.normal_opening
    stiff_tangential = law.tangential_strength / law.tangential_opening
    normal = press(law.closed, axes, dp, n, opening, force, area, reduced_mass, dt, out) if target < 0.0 else 0.0
    if oscillates:
        for a in range(len(axes)):
            out[a] = dp[a]
        pull_oscillating(law, axes, out, n, jump, force, per_mass, dt, compliance, base, target >= 0.0)
        if target >= 0.0:
            normal = weight * dot(axes, out, n)
        drawn = dot(axes, out, n)
        for a in range(len(axes)):
            out[a] = weight * (out[a] - drawn * n[a]) + normal * n[a]
        return STICKING
    for a in range(len(axes)):
        out[a] = jump[a] - opening * n[a] + (dp[a] - along * n[a]) * per_mass
    # damage is that of the start of the step: at light nodes the jump of its end is no measure of it
    most = max(base, relative(law, opening, slip_of(axes, n, jump, opening)))
    h = secant(law.shape, most)
    if target >= 0.0:
        normal = weight * h * stiff_normal * target / (1.0 + compliance * h * stiff_normal)
    share = weight * h * stiff_tangential / (1.0 + compliance * h * stiff_tangential)
    for a in range(len(axes)):
        out[a] = normal * n[a] + share * out[a]
    return STICKING


@inline
def pull_oscillating(law, axes, dp, n, jump, force, per_mass, dt, compliance, base, is_open):
    """Mean traction of a step to first order (Nairn 2023, Eqs. 5.61, 5.62), in place of ``dp`` (d,).

    Where a mode is too stiff for the step it sticks; where the law softens as fast it transmits nothing.
    """
    along, opening, pushing = dot(axes, dp, n), dot(axes, jump, n), dot(axes, force, n)
    stiff_normal = law.normal_strength / law.normal_opening
    stiff_tangential = law.tangential_strength / law.tangential_opening
    first = secant(law.shape, max(base, relative(law, opening, slip_of(axes, n, jump, opening))))
    square = 0.0
    for a in range(len(axes)):
        slip = jump[a] - opening * n[a]
        free, pushed = (dp[a] - along * n[a]) * per_mass, (force[a] - pushing * n[a]) * dt * per_mass
        mean = slip - compliance * first * stiff_tangential * slip / 6.0 + 0.5 * free - pushed / 3.0
        square += mean * mean
    start = max(opening, 0.0)
    middle = (
        start - compliance * first * stiff_normal * start / 6.0
        + 0.5 * (along * per_mass + opening - start) - pushing * dt * per_mass / 3.0
    )
    most = max(base, relative(law, middle, math.sqrt(square)))
    then = secant(law.shape, most)
    softening = compliance * max(stiff_normal, stiff_tangential) * envelope_slope(law.shape, most)
    falls = most > base and softening < -HARD
    normal = 0.5 * stiff_normal * (first * start + then * max(middle, 0.0))
    if falls or not is_open:
        normal = 0.0
    elif compliance * first * stiff_normal > HARD:
        normal = along * per_mass / compliance
    for a in range(len(axes)):
        slip = jump[a] - opening * n[a]
        free, pushed = (dp[a] - along * n[a]) * per_mass, (force[a] - pushing * n[a]) * dt * per_mass
        mean = slip - compliance * first * stiff_tangential * slip / 6.0 + 0.5 * free - pushed / 3.0
        drawn = 0.5 * stiff_tangential * (first * slip + then * mean)
        if falls:
            drawn = 0.0
        elif compliance * first * stiff_tangential > HARD:
            drawn = free / compliance
        dp[a] = drawn + normal * n[a]
# fmt: on


@held_impulse.register(CoupledCohesion)
def _(law, axes, dp, n, out):
    return leave(axes, out)


@tangents.register(CoupledCohesion)
def _(law, axes, n, jump, history):
    opening = dot(axes, jump, n)
    most = most_of(law, history)
    if relative(law, opening, slip_of(axes, n, jump, opening)) > most:
        return 0.0, 0.0
    h = secant(law.shape, most)
    normal = h * law.normal_strength / law.normal_opening if opening >= 0.0 else 0.0
    return normal, h * law.tangential_strength / law.tangential_opening


@traction.register(CoupledCohesion)
def _(law, axes, n, jump, history, out):
    opening = dot(axes, jump, n)
    slip = slip_of(axes, n, jump, opening)
    h = secant(law.shape, max(most_of(law, history), relative(law, opening, slip)))
    normal = law.pressed * opening
    if opening > 0.0:
        normal = h * law.normal_strength * opening / law.normal_opening
    for a in range(len(axes)):
        drawn = h * law.tangential_strength * (jump[a] - opening * n[a]) / law.tangential_opening
        out[a] = normal * n[a] + drawn


@stored_energy.register(CoupledCohesion)
def _(law, axes, n, jump, history):
    opening = dot(axes, jump, n)
    slip = slip_of(axes, n, jump, opening)
    h = secant(law.shape, max(most_of(law, history), relative(law, opening, slip)))
    normal = 0.5 * law.pressed * opening * opening
    if opening > 0.0:
        normal = 0.5 * h * law.normal_strength * opening * opening / law.normal_opening
    return normal + 0.5 * h * law.tangential_strength * slip * slip / law.tangential_opening


@openings.register(CoupledCohesion)
def _(law, axes, n, jump, now):
    opening = dot(axes, jump, n)
    most = relative(law, opening, slip_of(axes, n, jump, opening))
    now[MOST_NORMAL], now[MOST_TANGENTIAL] = most * law.normal_opening, most * law.tangential_opening


@remember.register(CoupledCohesion)
def _(law, axes, n, jump, history):
    if history[BREAKS] > 0.5:
        return 0.0
    opening = dot(axes, jump, n)
    slip = slip_of(axes, n, jump, opening)
    before = history[MOST_NORMAL] / law.normal_opening
    now = relative(law, opening, slip)
    if now <= before:
        return 0.0
    history[MOST_NORMAL], history[MOST_TANGENTIAL] = now * law.normal_opening, now * law.tangential_opening
    # along a path of this mode the law spends a mean of both toughnesses
    normal, tangential = max(opening, 0.0) / law.normal_opening / now, slip / law.tangential_opening / now
    mean = (
        law.normal_strength * law.normal_opening * normal * normal
        + law.tangential_strength * law.tangential_opening * tangential * tangential
    )
    if now >= 1.0:
        history[BREAKS] = 1.0
    return mean * (spent(law.shape, now) - spent(law.shape, before))


@damage.register(CoupledCohesion)
def _(law, history):
    if history[BREAKS] > 0.5:
        return 1.0
    return worn(Softening(law.shape), history[MOST_NORMAL] / law.normal_opening)
