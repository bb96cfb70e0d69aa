"""Settling contacts: momentum changes that laws ask for, applied to momenta or to velocity increments."""

from __future__ import annotations

import numpy as np

from mpmcli.contact import increments
from mpmcli.contact.settle import is_soft, leave, settle, settle_soft, slip_work
from mpmcli.core.kernel import inline, kernel, prange

Array = np.ndarray


@inline
def relative_momentum(axes, alpha, first, last, rigid, rigid_field, node_count, dof, mp, v, of_velocity, out):
    """Δp_α(0), the momentum that takes α to the common velocity, into ``out`` (d,); returns the reduced mass.

    β are the other deformable fields among the entries ``first`` to ``last`` of ``dof``, or the rigid one alone,
    whose mass is infinite (Nairn et al. 2020, Eqs. 8 and 50). Velocities are p/m of ``mp`` (dofs, 1 + d), or with
    ``of_velocity`` those of ``v`` (dofs, d).
    """
    m_alpha = mp[alpha, 0]
    m_beta = 0.0
    for a in range(len(axes)):
        out[a] = 0.0
    for e in range(first, last):
        i = dof[e]
        if i != alpha and (rigid or not rigid_field[i // node_count]):
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
def normal_force(axes, alpha, first, last, rigid, rigid_field, node_count, dof, mp, f, n):
    """Normal part of m_red (f_β/m_β − f_α/m_α); a rigid body feels no force."""
    m_alpha, m_beta = mp[alpha, 0], 0.0
    mine, theirs = 0.0, 0.0
    for a in range(len(axes)):
        mine += f[alpha, a] * n[a]
    if rigid:
        return -mine
    for e in range(first, last):
        i = dof[e]
        if i != alpha and not rigid_field[i // node_count]:
            m_beta += mp[i, 0]
            for a in range(len(axes)):
                theirs += f[i, a] * n[a]
    return (m_alpha * theirs - m_beta * mine) / (m_alpha + m_beta)


@kernel
def settle_stage(
    law, which, stage, axes, count, members, node_count, dof, rigid_field, mp, f, of_force, v, of_velocity, prior, net,
    of_increment, evolving, normal, separation, area, bond, dt, advance, displacement_only, separation_now, push, drive,
    drives, dp0, total, settled, dp, state,
):  # fmt: skip
    """Find the momentum change Δp of α at every contact of one stage that law ``which`` governs, into ``dp`` (k, d).

    Flags say which arrays count, so that one compiled version serves all places of the step. After the momentum update
    (``of_force``) ``f`` (dofs, d) holds the forces without contact, whose normal parts are kept in ``push`` (k,) for
    laws with finite stiffness. With ``of_velocity`` the velocities are ``v`` (dofs, d), else p/m. On an FMPM increment
    (``of_increment``) ``v`` holds Δv(ℓ), and the rows of ``prior`` and ``net`` (k, d) follow it: by "Net" the law sees
    the total of all velocities before any correction, by "Evolving" what earlier corrections left of them
    (``increments``); ``total`` and ``settled`` (k, d) are scratch. ``advance`` is the time over which the separation
    still closes (Nairn 2023, Eq. 3.56); what it has become is kept in ``separation_now`` (k,). With ``drives`` the
    impulses ``drive`` (k,) are to be left between the sides (``overlap``).
    """
    for k in prange(count):
        if members.law[k] != which or members.stage[k] != stage or members.pair[k]:
            continue
        reduced = relative_momentum(
            axes, members.alpha[k], members.first[k], members.last[k], members.rigid[k], rigid_field, node_count, dof,
            mp, v, of_velocity, dp0[k],
        )  # fmt: skip
        if of_increment:
            increments.total_increment(axes, prior[k], dp0[k], total[k])
            wanted, given = total[k], settled[k]
        else:
            wanted, given = dp0[k], dp[k]
            gap = separation[k]
            if advance > 0.0:
                for a in range(len(axes)):
                    gap += dp0[k, a] * normal[k, a] * advance / reduced
            separation_now[k] = gap
            if drives:
                for a in range(len(axes)):
                    dp0[k, a] -= drive[k] * normal[k, a]
        if of_force and is_soft(law):
            push[k] = normal_force(
                axes, members.alpha[k], members.first[k], members.last[k], members.rigid[k], rigid_field, node_count,
                dof, mp, f, normal[k],
            )  # fmt: skip
        if not is_soft(law):
            state[k] = settle(
                law, axes, wanted, normal[k], separation_now[k], area[k], reduced, dt, displacement_only, bond[k],
                given,
            )  # fmt: skip
        elif of_force or of_increment:
            state[k] = settle_soft(
                law, axes, wanted, normal[k], separation[k], push[k], area[k], reduced, dt, displacement_only, bond[k],
                given,
            )  # fmt: skip
        else:  # a spring acts once in a step: settled hard elsewhere, the sides would never press on it
            state[k] = leave(axes, given)
        if of_increment:
            increments.finish_increment(axes, evolving, dp0[k], wanted, given, prior[k], net[k], dp[k])


@kernel
def start_increments(axes, count, dp0, dp, evolving, prior, net):
    """After the lumped correction of all contacts: see ``increments.start_increments``."""
    for k in prange(count):
        increments.start_increments(axes, evolving, dp0[k], dp[k], prior[k], net[k])


@kernel
def add_to_momenta(axes, count, stage, members, dp, dt, mp, f, of_force):
    """p += Δp, and with ``of_force`` f += Δp/Δt, for the contacts of one stage."""
    for k in prange(count):
        if members.stage[k] == stage:
            i, j = members.alpha[k], members.partner[k]
            for a in range(len(axes)):
                mp[i, 1 + a] += dp[k, a]
                if of_force:
                    f[i, a] += dp[k, a] / dt
                if members.both[k]:
                    mp[j, 1 + a] -= dp[k, a]
                    if of_force:
                        f[j, a] -= dp[k, a] / dt


@kernel
def add_to_velocities(axes, count, stage, members, dp, mp, v):
    """v += Δp/m for the contacts of one stage; ``v`` (dofs, d)."""
    for k in prange(count):
        if members.stage[k] == stage:
            i, j = members.alpha[k], members.partner[k]
            for a in range(len(axes)):
                v[i, a] += dp[k, a] / mp[i, 0]
                if members.both[k]:
                    v[j, a] -= dp[k, a] / mp[j, 0]


@inline
def take_out(axes, count, members, dp, p):
    """p −= Δp for momenta ``p`` (dofs, d), all stages."""
    for k in range(count):
        for a in range(len(axes)):
            p[members.alpha[k], a] -= dp[k, a]
            if members.both[k]:
                p[members.partner[k], a] += dp[k, a]


@kernel
def find_slip(axes, count, members, node_count, dof, rigid_field, mp, v, of_velocity, slip):
    """Velocity of β relative to α into ``slip`` (k, d), from ``v`` (dofs, d) with ``of_velocity``, else from p/m."""
    for k in prange(count):
        reduced = relative_momentum(
            axes, members.alpha[k], members.first[k], members.last[k], members.rigid[k], rigid_field, node_count, dof,
            mp, v, of_velocity, slip[k],
        )  # fmt: skip
        for a in range(len(axes)):
            slip[k, a] /= reduced


@inline
def share_of_work(axes, members, k, rigid_field, node_count, dof, mp):
    """What of the pair's work a contact counts: all if it serves both sides, else the part of α."""
    if members.both[k] or members.rigid[k]:
        return 1.0
    others = 0.0
    for e in range(members.first[k], members.last[k]):
        if dof[e] != members.alpha[k] and not rigid_field[dof[e] // node_count]:
            others += mp[dof[e], 0]
    return others / (others + mp[members.alpha[k], 0])


@inline
def tally(
    axes, count, members, node_count, dof, rigid_field, pair, weight, normal, area, state, net, before, after, mp,
    force, touching, error, rigid_work,
):  # fmt: skip
    """Sum up a step: returns the friction work, and adds up impulses and areas.

    Work is taken out by the tangential part of the final Δp (``net``), with the mean of the relative velocities
    ``before`` and ``after`` (k, d). ``pair`` (fields, fields) numbers pairs; the impulse on the earlier field goes to
    ``force`` (pairs, d), the area of contacts that touch to ``touching`` (pairs,), the momentum that one-sided
    contacts create to ``error`` (d,), the work that rigid fields do to ``rigid_work`` (fields,). ``weight`` (k,) is the
    share of a contact that belongs to real particles.
    """
    work = 0.0
    for k in range(count):
        alpha, beta = members.alpha[k] // node_count, members.partner[k] // node_count
        row = pair[alpha, beta]
        part = weight[k] if members.both[k] or members.rigid[k] else 0.5 * weight[k]
        sign = part if alpha < beta else -part
        taken = slip_work(axes, normal[k], net[k], before[k], after[k])
        for a in range(len(axes)):
            force[row, a] += sign * net[k, a]
            if members.rigid[k]:
                i = members.partner[k]
                rigid_work[beta] += weight[k] * net[k, a] * mp[i, 1 + a] / mp[i, 0]
            elif not members.both[k]:
                error[a] += weight[k] * net[k, a]
        work += weight[k] * taken * share_of_work(axes, members, k, rigid_field, node_count, dof, mp)
        if state[k] > 0:
            touching[row] += part * area[k]
    return work
