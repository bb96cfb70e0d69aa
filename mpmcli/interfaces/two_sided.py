"""Springs that differ in tension and compression."""

import math
from typing import NamedTuple

from mpmcli.contact.laws.impulse import HARD
from mpmcli.contact.laws.spring import end_opening, mean_opening, stumpff
from mpmcli.core.compiled.kernel import inline
from mpmcli.interfaces.springs import (
    is_linear,
    is_perfect,
    no,
    oscillate,
    pull,
    rate,
    resist,
    resist_by_pull,
    settle,
    stick,
    stored,
)

TINY = 1e-200
NEVER = 1e300
"""φ² of what does not give way."""
SMALL = 1e-6
"""Angles whose tangents are themselves."""


class TwoSided(NamedTuple):
    """D_t of T = D_t δ where it is open, D_c where it is closed [pressure/length]."""

    tension: float
    compression: float


class OneSided(NamedTuple):
    """D_t of T = D_t δ where it is open [pressure/length]; it does not close further than δ = 0."""

    tension: float


for kind in (TwoSided, OneSided):
    is_perfect.register(kind)(no)
    is_linear.register(kind)(no)


@pull.register(TwoSided)
def _(spring, opening, most):
    return (spring.tension if opening > 0.0 else spring.compression) * opening


@pull.register(OneSided)
def _(spring, opening, most):
    return spring.tension * max(opening, 0.0)


@rate.register(TwoSided)
def _(spring, opening, most):
    return spring.tension if opening > 0.0 else spring.compression


@rate.register(OneSided)
def _(spring, opening, most):
    return spring.tension  # closed it is stiffer still


@stored.register(TwoSided)
@stored.register(OneSided)
def _(spring, opening, most):
    return 0.5 * pull(spring, opening, most) * opening


@settle.register(TwoSided)
def _(spring, opening, target, compliance, most):
    return target / (1.0 + compliance * (spring.tension if target > 0.0 else spring.compression))


@settle.register(OneSided)
def _(spring, opening, target, compliance, most):
    return max(target, 0.0) / (1.0 + compliance * spring.tension)


resist.register(TwoSided)(resist_by_pull)


@resist.register(OneSided)
def _(spring, opening, target, compliance, most):
    if target < 0.0:  # closed: all of it, as an infinitely stiff spring
        return target / compliance if compliance > TINY else 0.0
    return pull(spring, settle(spring, opening, target, compliance, most), most)


@oscillate.register(TwoSided)
def _(spring, opening, free, pushed, compliance, most):
    start = free - pushed
    opens = opening > 0.0 or (opening == 0.0 and (start > 0.0 or (start == 0.0 and pushed > 0.0)))
    before = compliance * (spring.tension if opens else spring.compression)
    after = compliance * (spring.compression if opens else spring.tension)
    if compliance <= TINY:
        return pull(spring, opening, most)
    if before > HARD:
        return stick(free, compliance)
    if opens:
        return crossing_pull(opening, start, pushed, before, after) / compliance
    return -crossing_pull(-opening, -start, -pushed, before, after) / compliance


@oscillate.register(OneSided)
def _(spring, opening, free, pushed, compliance, most):
    if compliance <= TINY:
        return pull(spring, opening, most)
    if opening <= 0.0 and free <= 0.0:  # closed, and stays so
        return stick(free, compliance)
    before = compliance * spring.tension
    if before > HARD:
        return stick(free, compliance)
    return crossing_pull(max(opening, 0.0), free - pushed, pushed, before, NEVER) / compliance


@inline
def crossing_pull(opening, start, pushed, before, after):
    """c times the mean traction of a spring that opens, or closes within the step [length].

    ``opening`` ≥ 0, ``start`` = δ′(0) per step and ``pushed`` are lengths, ``before`` and ``after`` are φ² while it
    is open and once it is closed. Where the latter exceeds (π/2)², the closed spring sticks at δ = 0 (Eq. 5.142).
    """
    c2, c3, c4 = stumpff(before)
    free = start + pushed
    if end_opening(opening, free, pushed, before, c2, c3) >= 0.0:
        return 2.0 * before * mean_opening(opening, free, pushed, c2, c3, c4)
    if after > HARD:
        return 2.0 * (opening + free) - pushed
    at = closing_time(opening, start, pushed, before)
    rest = 1.0 - at
    c2, c3, c4 = stumpff(before * at * at)
    # the mean traction is 2 ∫ (1 − τ) T dτ; the parts before and after the spring closes (Eqs. 5.104, 5.96)
    area = opening * at * (1.0 - before * at * at * c3) + at * at * (start * c2 + pushed * at * c3)
    moment = at * at * (opening * c2 + start * at * c3 + pushed * at * at * c4)
    closing = (pushed - before * opening) * at * (1.0 - before * at * at * c3) + start * (
        1.0 - before * at * at * c2
    )
    c2, c3, c4 = stumpff(after * rest * rest)
    pressed = rest * rest * (closing * rest * c3 + pushed * rest * rest * c4)
    return 2.0 * (before * (rest * area + moment) + after * pressed)


@inline
def closing_time(opening, start, pushed, u):
    """Share of the step after which an open spring closes: Eq. 5.73 in s = 2 tan(φτ/2)/φ, which is τ where φ is small.

    (w/2 − φ² δ(0)/4) s² + d s + δ(0) = 0; a spring that closes within the step does so at its smallest positive root.
    """
    a = 0.5 * pushed - 0.25 * u * opening
    root = math.sqrt(max(start * start - 4.0 * a * opening, 0.0))
    if start <= 0.0:
        s = 2.0 * opening / max(root - start, TINY * opening)
    else:
        s = (start + root) / max(-2.0 * a, TINY * start)
    phi = math.sqrt(u)
    at = 2.0 / phi * math.atan(0.5 * phi * s) if phi * s > SMALL else s
    return min(max(at, 0.0), 1.0)
