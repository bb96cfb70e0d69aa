"""Impulses of all contacts: the momentum changes that laws ask for, applied to momenta or to velocity increments."""

from typing import NamedTuple

import numpy as np

from mpmcli.contact import increments
from mpmcli.contact.fields_in_contact import field_at, is_rigid
from mpmcli.contact.laws.impulse import is_soft, law_impulse, law_impulse_at_end, leave, slip_work
from mpmcli.core.compiled.kernel import inline, kernel, prange

Array = np.ndarray


class ImpulseRows(NamedTuple):
    """What the corrections of a step find and keep, a row for each contact.

    dp0 : (k, d) Δp_α(0) of the last calculation [momentum]
    dp : (k, d) momentum that it adds to α
    total, found : (k, d) scratch of FMPM increments
    start : (k, d) Δp⁽¹⁾, what the correction of the extrapolated momenta added
    prior, net : (k, d) what ``increments`` follows through the FMPM loop
    slip : (k, d) velocity of β relative to α before contact
    separation_now : (k,) separation at the end of the step, if the sides moved on as they do [length]
    push : (k,) normal part of the forces without contact, for laws with finite stiffness [force]
    drive : (k,) impulse that takes overlap back [momentum]
    friction : (k,) energy that friction takes out in the step [energy]
    state : (k,) APART, SLIDING, STICKING or BROKEN
    """

    dp0: Array
    dp: Array
    total: Array
    found: Array
    start: Array
    prior: Array
    net: Array
    slip: Array
    separation_now: Array
    push: Array
    drive: Array
    friction: Array
    state: Array


def allocate_rows(room: int, dimensions: int) -> ImpulseRows:
    """Make room for the impulses of contacts."""
    vectors = {name: np.zeros((room, dimensions)) for name in ImpulseRows._fields[:8]}
    numbers = {name: np.zeros(room) for name in ("separation_now", "push", "drive", "friction")}
    return ImpulseRows(**vectors, **numbers, state=np.zeros(room, dtype=np.int64))


class Place(NamedTuple):
    """Where in the step contact acts: flags say which arrays count, so that one compiled version serves all places.

    stage : contacts of this stage act
    after_forces : on updated momenta, where the forces of the step are known
    of_velocity : on velocities ``v`` (dofs, d) rather than on momenta
    of_increment : ``v`` is an FMPM increment Δv(ℓ)
    evolving : as the "Evolving" method does, else by "Net" (``increments``)
    displacement_only : contact wherever the separation is negative
    drives : the impulses ``ImpulseRows.drive`` are to be left between the sides (``overlap``)
    springs_act : the forces of the step are known and act, so that laws with finite stiffness press on increments
    dt : time step [time]
    advance : time over which the separation still closes (Nairn 2023, Eq. 3.56) [time]
    """

    stage: int
    after_forces: bool
    of_velocity: bool
    of_increment: bool
    evolving: bool
    displacement_only: bool
    drives: bool
    springs_act: bool
    dt: float
    advance: float


class Tallies(NamedTuple):
    """Where the sums of a step go.

    pair : (fields, fields) number of each pair of fields
    weight : (k, at least) share of a contact that belongs to real particles
    force : (pairs, d) impulse on the earlier field
    area : (pairs,) area of contacts that touch
    error : (d,) momentum that one-sided contacts create
    rigid_work : (fields,) work that rigid fields do
    """

    pair: Array
    weight: Array
    force: Array
    area: Array
    error: Array
    rigid_work: Array


@inline
def relative_momentum(axes, alpha, first, last, rigid, nodes, mp, v, of_velocity, out):
    """Δp_α(0), the momentum that takes α to the common velocity, into ``out`` (d,); returns the reduced mass.

    β are the other deformable fields among the entries ``first`` to ``last`` of the nodes, or the ``rigid`` one alone,
    whose mass is infinite (Nairn et al. 2020, Eqs. 8 and 50). Velocities are p/m of ``mp`` (dofs, 1 + d), or with
    ``of_velocity`` those of ``v`` (dofs, d).
    """
    m_alpha = mp[alpha, 0]
    m_beta = 0.0
    for a in range(len(axes)):
        out[a] = 0.0
    for e in range(first, last):
        i = nodes.dof[e]
        if i != alpha and (rigid or not is_rigid(nodes, i)):
            m_beta += mp[i, 0]
            for a in range(len(axes)):
                if of_velocity:
                    out[a] += mp[i, 0] * v[i, a]
                else:
                    out[a] += mp[i, 1 + a]
    reduced = m_alpha if rigid else m_alpha * m_beta / (m_alpha + m_beta)
    for a in range(len(axes)):
        mine = v[alpha, a] if of_velocity else mp[alpha, 1 + a] / m_alpha
        out[a] = reduced * (out[a] / m_beta - mine)
    return reduced


@inline
def normal_force(axes, alpha, first, last, rigid, nodes, mp, f, n):
    """Normal part of m_red (f_β/m_β − f_α/m_α) along ``n`` (d,); a rigid body feels no force."""
    m_alpha, m_beta = mp[alpha, 0], 0.0
    mine, theirs = 0.0, 0.0
    for a in range(len(axes)):
        mine += f[alpha, a] * n[a]
    if rigid:
        return -mine
    for e in range(first, last):
        i = nodes.dof[e]
        if i != alpha and not is_rigid(nodes, i):
            m_beta += mp[i, 0]
            for a in range(len(axes)):
                theirs += f[i, a] * n[a]
    return (m_alpha * theirs - m_beta * mine) / (m_alpha + m_beta)


@inline
def impulse_of(law, axes, wanted, normal, gap, gap_now, push, area, reduced, here, bond, out):
    """Impulse of a contact by its law into ``out`` (d,) [momentum]; returns the state of the contact.

    ``gap`` is the separation at the start of the step, ``gap_now`` that which decides on contact of hard sides
    [length]. A spring acts once in a step: as a hard contact elsewhere, it would never be pressed.
    """
    if not is_soft(law):
        return law_impulse(
            law, axes, wanted, normal, gap_now, area, reduced, here.dt, here.displacement_only, bond, out
        )
    if here.after_forces or (here.of_increment and here.springs_act):
        return law_impulse_at_end(
            law, axes, wanted, normal, gap, push, area, reduced, here.dt, here.displacement_only, bond, out
        )
    return leave(axes, out)


@kernel
def find_impulses(law, axes, which, count, fields, nodes, geometry, rows, here, mp, f, v):
    """Find the momentum change Δp of α at every contact of one stage that law ``which`` governs, into ``rows.dp``.

    ``here`` is a ``Place``. After the momentum update ``f`` (dofs, d) holds the forces without contact, whose
    normal parts are kept in ``rows.push`` for laws with finite stiffness. With ``here.of_velocity`` the velocities are
    ``v`` (dofs, d), else p/m. On an FMPM increment ``v`` holds Δv(ℓ), and ``rows.prior`` and ``rows.net`` follow it:
    by "Net" the law sees the total of all velocities before any correction, by "Evolving" what earlier corrections
    left of them (``increments``).
    """
    # unfolded: numba drops what a parallel loop writes through a tuple
    separation_now, push, state = rows.separation_now, rows.push, rows.state
    for k in prange(count):
        if fields.law[k] != which or fields.stage[k] != here.stage or fields.pair[k]:
            continue
        alpha, first, last, rigid = fields.alpha[k], fields.first[k], fields.last[k], fields.rigid[k]
        normal, area, bond = geometry.normal[k], geometry.area[k], geometry.bond[k]
        dp0 = rows.dp0[k]
        reduced = relative_momentum(axes, alpha, first, last, rigid, nodes, mp, v, here.of_velocity, dp0)
        if here.of_increment:
            increments.total_increment(axes, rows.prior[k], dp0, rows.total[k])
            wanted, given = rows.total[k], rows.found[k]
        else:
            wanted, given = dp0, rows.dp[k]
            gap = geometry.separation[k]
            if here.advance > 0.0:
                for a in range(len(axes)):
                    gap += dp0[a] * normal[a] * here.advance / reduced
            separation_now[k] = gap
            if here.drives:
                for a in range(len(axes)):
                    dp0[a] -= rows.drive[k] * normal[a]
        if here.after_forces and is_soft(law):
            push[k] = normal_force(axes, alpha, first, last, rigid, nodes, mp, f, normal)
        state[k] = impulse_of(
            law, axes, wanted, normal, geometry.separation[k], separation_now[k], push[k], area, reduced, here, bond,
            given,
        )  # fmt: skip
        if here.of_increment:
            increments.finish_increment(
                axes, here.evolving, dp0, wanted, given, rows.prior[k], rows.net[k], rows.dp[k]
            )


@kernel
def start_increments(axes, count, evolving, dp0, dp, prior, net):
    """After the lumped correction of all contacts: see ``increments.start_increments``."""
    for k in prange(count):
        increments.start_increments(axes, evolving, dp0[k], dp[k], prior[k], net[k])


@kernel
def add_to_momenta(axes, count, fields, dp, here, mp, f):
    """p += Δp, and after the forces f += Δp/Δt, for the contacts of one stage."""
    for k in prange(count):
        if fields.stage[k] == here.stage:
            i, j = fields.alpha[k], fields.partner[k]
            for a in range(len(axes)):
                mp[i, 1 + a] += dp[k, a]
                if here.after_forces:
                    f[i, a] += dp[k, a] / here.dt
                if fields.both[k]:
                    mp[j, 1 + a] -= dp[k, a]
                    if here.after_forces:
                        f[j, a] -= dp[k, a] / here.dt


@kernel
def add_to_velocities(axes, count, fields, dp, here, mp, v):
    """v += Δp/m for the contacts of one stage; ``v`` (dofs, d)."""
    for k in prange(count):
        if fields.stage[k] == here.stage:
            i, j = fields.alpha[k], fields.partner[k]
            for a in range(len(axes)):
                v[i, a] += dp[k, a] / mp[i, 0]
                if fields.both[k]:
                    v[j, a] -= dp[k, a] / mp[j, 0]


@inline
def take_out(axes, count, fields, dp, p):
    """p −= Δp for momenta ``p`` (dofs, d), all stages."""
    for k in range(count):
        for a in range(len(axes)):
            p[fields.alpha[k], a] -= dp[k, a]
            if fields.both[k]:
                p[fields.partner[k], a] += dp[k, a]


@kernel
def find_slip(axes, count, fields, nodes, mp, v, of_velocity, slip):
    """Velocity of β relative to α into ``slip`` (k, d), from ``v`` (dofs, d) with ``of_velocity``, else from p/m."""
    for k in prange(count):
        reduced = relative_momentum(
            axes, fields.alpha[k], fields.first[k], fields.last[k], fields.rigid[k], nodes, mp, v, of_velocity,
            slip[k],
        )  # fmt: skip
        for a in range(len(axes)):
            slip[k, a] /= reduced


@inline
def share_of_work(axes, fields, k, nodes, mp):
    """What of the pair's work a contact counts: all if it serves both sides, else the part of α."""
    if fields.both[k] or fields.rigid[k]:
        return 1.0
    others = 0.0
    for e in range(fields.first[k], fields.last[k]):
        i = nodes.dof[e]
        if i != fields.alpha[k] and not is_rigid(nodes, i):
            others += mp[i, 0]
    return others / (others + mp[fields.alpha[k], 0])


@inline
def tally(axes, count, fields, nodes, geometry, rows, after, mp, bonded, sums):
    """Sum up a step: returns the friction work, and adds up impulses and areas in ``sums`` (``Tallies``).

    Work is taken out by the tangential part of the final Δp (``rows.net``), with the mean of the relative velocities
    before (``rows.slip``) and ``after`` (k, d); not where ``bonded`` (k,), or None, says that there is no friction.
    """
    work = 0.0
    for k in range(count):
        alpha, beta = field_at(nodes, fields.alpha[k]), field_at(nodes, fields.partner[k])
        net, weight = rows.net[k], sums.weight[k]
        pair = sums.pair[alpha, beta]
        part = weight if fields.both[k] or fields.rigid[k] else 0.5 * weight
        sign = part if alpha < beta else -part
        taken = slip_work(axes, geometry.normal[k], net, rows.slip[k], after[k])
        for a in range(len(axes)):
            sums.force[pair, a] += sign * net[a]
            if fields.rigid[k]:
                i = fields.partner[k]
                sums.rigid_work[beta] += weight * net[a] * mp[i, 1 + a] / mp[i, 0]
            elif not fields.both[k]:
                sums.error[a] += weight * net[a]
        rows.friction[k] = taken * share_of_work(axes, fields, k, nodes, mp)
        if bonded is not None and bonded[k]:
            rows.friction[k] = 0.0
        work += weight * rows.friction[k]
        if rows.state[k] > 0:
            sums.area[pair] += part * geometry.area[k]
    return work
