"""Impulses between the faces of cracks, all that a step does at one place in one call.

It is the arithmetic of ``contact.impulses`` for pairs of two sides that no other pair shares: to hand so many arrays
over takes longer than the work on a few nodes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.increments import start_increments
from mpmcli.contact.laws.impulse import is_soft, law_impulse, law_impulse_at_end, leave, slip_work
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.cracks.calls import called_once

Array = np.ndarray

AXES = (0.0, 0.0)


class Pairs(NamedTuple):
    """What the impulses of a step read and write, a row for each pair: arrays of the tuples of ``contact``.

    alpha, partner : of ``FieldsInContact``
    normal, separation, area, bond : of ``Geometry``
    dp0, dp, start, prior, net, slip, separation_now, push, state : of ``ImpulseRows``
    """

    alpha: Array
    partner: Array
    normal: Array
    separation: Array
    area: Array
    bond: Array
    dp0: Array
    dp: Array
    start: Array
    prior: Array
    net: Array
    slip: Array
    separation_now: Array
    push: Array
    state: Array


def pairs_of(fields: Any, geometry: Any, rows: Any) -> Pairs:
    """Gather the arrays of contacts."""
    return Pairs(
        fields.alpha, fields.partner, geometry.normal, geometry.separation, geometry.area, geometry.bond, rows.dp0,
        rows.dp, rows.start, rows.prior, rows.net, rows.slip, rows.separation_now, rows.push, rows.state,
    )  # fmt: skip


@compiled_too
def relative_momentum(i, j, mp, out):
    """Momentum that takes side ``i`` to the common velocity of both, into ``out`` (2,); returns the reduced mass."""
    m_i, m_j = mp[i, 0], mp[j, 0]
    reduced = m_i * m_j / (m_i + m_j)
    for a in range(2):
        out[a] = reduced * (mp[j, 1 + a] / m_j - mp[i, 1 + a] / m_i)
    return reduced


@called_once
def meet(law, count, first, keeps_start, dt, pairs, mp, f):
    """Let momenta satisfy contact: those extrapolated in the step's ``first`` turn, else updated ones and forces.

    With ``keeps_start`` slip is that before the first turn, else that after it.
    """
    for k in range(count):
        i, j, n, dp0, dp = pairs.alpha[k], pairs.partner[k], pairs.normal[k], pairs.dp0[k], pairs.dp[k]
        reduced = relative_momentum(i, j, mp, dp0)
        if first and keeps_start:
            pairs.slip[k, 0], pairs.slip[k, 1] = dp0[0] / reduced, dp0[1] / reduced
        gap, area, bond = pairs.separation[k], pairs.area[k], pairs.bond[k]
        pairs.separation_now[k] = gap  # increments of FMPM see that of updated momenta
        if not first:
            for a in range(2):
                pairs.separation_now[k] += dp0[a] * n[a] * dt / reduced
        if not is_soft(law):
            pairs.state[k] = law_impulse(
                law, AXES, dp0, n, pairs.separation_now[k], area, reduced, dt, False, bond, dp
            )
        elif first:  # a spring acts once in a step
            pairs.state[k] = leave(AXES, dp)
        else:
            mine, theirs = f[i, 0] * n[0] + f[i, 1] * n[1], f[j, 0] * n[0] + f[j, 1] * n[1]
            pairs.push[k] = (mp[i, 0] * theirs - mp[j, 0] * mine) / (mp[i, 0] + mp[j, 0])
            pairs.state[k] = law_impulse_at_end(
                law, AXES, dp0, n, gap, pairs.push[k], area, reduced, dt, False, bond, dp
            )
        for a in range(2):
            mp[i, 1 + a] += dp[a]
            mp[j, 1 + a] -= dp[a]
            if not first:
                f[i, a] += dp[a] / dt
                f[j, a] -= dp[a] / dt
            else:
                pairs.start[k, a] = dp[a]
        start_increments(AXES, False, dp0, dp, pairs.prior[k], pairs.net[k])
        if first and not keeps_start:
            reduced = relative_momentum(i, j, mp, pairs.slip[k])
            for a in range(2):
                pairs.slip[k, a] /= reduced


@called_once
def close(count, pairs, crack, law, springs, keeps_start, weight, dt, mp, v, friction, force):
    """Sum up a step: writes the forces on the matter above into ``force`` (cracks, 2), and returns the friction work.

    ``crack`` and ``law`` (k,) are those of the pairs. ``v`` (dofs, 2) are the velocities at its end; the relative ones
    that the impulses leave go into ``pairs.prior``, whose rows are free now. ``weight`` (k,) are shares of real
    particles, all of them where it has no rows; ``springs`` (laws,) are laws without friction.
    """
    work = 0.0
    for k in range(force.shape[0]):
        force[k, 0] = force[k, 1] = 0.0
    for k in range(count):
        i, j, after = pairs.alpha[k], pairs.partner[k], pairs.prior[k]
        m_i, m_j = mp[i, 0], mp[j, 0]
        reduced = m_i * m_j / (m_i + m_j)
        for a in range(2):
            after[a] = reduced * (m_j * v[j, a] / m_j - v[i, a]) / reduced
            if keeps_start:
                pairs.net[k, a] += pairs.start[k, a]
        share = 1.0 if weight.shape[0] == 0 else weight[k]
        friction[k] = 0.0
        if not springs[law[k]]:
            friction[k] = slip_work(AXES, pairs.normal[k], pairs.net[k], pairs.slip[k], after)
        work += share * friction[k]
        for a in range(2):
            force[crack[k], a] -= share * pairs.net[k, a]
    for k in range(force.shape[0]):
        force[k, 0], force[k, 1] = force[k, 0] / dt, force[k, 1] / dt
    return work
