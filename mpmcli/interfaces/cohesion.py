"""The functions of cohesive laws whose modes pull independently of each other."""

from typing import Any, NamedTuple

from mpmcli.contact.laws.impulse import STICKING, TINIEST, dot, law_impulse_at_end, leave
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
from mpmcli.interfaces.independent import add_tangential_impulse, compliance_of, rise, slip_of, tractions_of
from mpmcli.interfaces.mixing import fail_together
from mpmcli.interfaces.softening import has_failed, lost, lost_share, worn
from mpmcli.interfaces.springs import mean_pull, pull, stored


class Cohesion(NamedTuple):
    """Springs of both modes, how they fail together, the contact law of closed faces and its stiffness."""

    normal: Any
    tangential: Any
    mixing: Any
    closed: Any
    pressed: float


# fmt: off
@inline
def press(closed, axes, dp, n, opening, force, area, reduced_mass, dt, out):
    """Normal part of the impulse of closed faces; ``out`` (d,) is scratch."""
    law_impulse_at_end(
        closed, axes, dp, n, opening, dot(axes, force, n), area, reduced_mass, dt, False, 0.0, out
    )
    return dot(axes, out, n)


@jump_impulse.register(Cohesion)
def _(law, axes, dp, n, jump, force, area, reduced_mass, dt, history, oscillates, out):
    per_mass = dt / max(reduced_mass, TINIEST)
    weight = area * dt
    compliance = compliance_of(weight, per_mass)
    along, opening = dot(axes, dp, n), dot(axes, jump, n)
    pushing = dot(axes, force, n) if oscillates else 0.0
    free = along * per_mass
    if opening + free < 0.0:
        normal = press(law.closed, axes, dp, n, opening, force, area, reduced_mass, dt, out)
    else:
        start = max(opening, 0.0)
        normal = weight * mean_pull(
            law.normal, start, opening + free - start, pushing * dt * per_mass, compliance, history[MOST_NORMAL],
            oscillates,
        )
    add_tangential_impulse(
        law.tangential, axes, dp, along, n, jump, opening, force, pushing, weight, per_mass, compliance, dt,
        history[MOST_TANGENTIAL], oscillates, normal, out,
    )
    return STICKING
# fmt: on


@held_impulse.register(Cohesion)
def _(law, axes, dp, n, out):
    return leave(axes, out)


@tangents.register(Cohesion)
def _(law, axes, n, jump, history):
    opening = dot(axes, jump, n)
    slip = slip_of(axes, n, jump, opening)
    normal = rise(law.normal, opening, history[MOST_NORMAL]) if opening >= 0.0 else 0.0
    return normal, rise(law.tangential, slip, history[MOST_TANGENTIAL])


@traction.register(Cohesion)
def _(law, axes, n, jump, history, out):
    opening = dot(axes, jump, n)
    normal = law.pressed * opening if opening < 0.0 else pull(law.normal, opening, history[MOST_NORMAL])
    tractions_of(axes, normal, law.tangential, n, jump, opening, history[MOST_TANGENTIAL], out)


@stored_energy.register(Cohesion)
def _(law, axes, n, jump, history):
    opening = dot(axes, jump, n)
    slip = slip_of(axes, n, jump, opening)
    normal = 0.5 * law.pressed * opening * opening
    if opening > 0.0:
        normal = stored(law.normal, opening, history[MOST_NORMAL])
    return normal + stored(law.tangential, slip, history[MOST_TANGENTIAL])


@openings.register(Cohesion)
def _(law, axes, n, jump, now):
    opening = dot(axes, jump, n)
    now[MOST_NORMAL] = max(opening, 0.0)
    now[MOST_TANGENTIAL] = slip_of(axes, n, jump, opening)


@remember.register(Cohesion)
def _(law, axes, n, jump, history):
    if history[BREAKS] > 0.5:
        return 0.0
    opening = dot(axes, jump, n)
    slip = slip_of(axes, n, jump, opening)
    before = lost(law.normal, history[MOST_NORMAL]) + lost(law.tangential, history[MOST_TANGENTIAL])
    normal = max(history[MOST_NORMAL], opening)
    tangential = max(history[MOST_TANGENTIAL], slip)
    history[MOST_NORMAL], history[MOST_TANGENTIAL] = normal, tangential
    found = lost(law.normal, normal) + lost(law.tangential, tangential) - before
    if (
        has_failed(law.normal, normal)
        or has_failed(law.tangential, tangential)
        or fail_together(law.mixing, lost_share(law.normal, normal), lost_share(law.tangential, tangential))
    ):
        found += stored_energy(law, axes, n, jump, history)
        history[BREAKS] = 1.0
    return found


@damage.register(Cohesion)
def _(law, history):
    if history[BREAKS] > 0.5:
        return 1.0
    return max(worn(law.normal, history[MOST_NORMAL]), worn(law.tangential, history[MOST_TANGENTIAL]))
