"""Impulses of all interfaces, applied as those of contacts are, and what becomes of their energy."""

import numpy as np

from mpmcli.contact import increments
from mpmcli.contact.coupled_pairs import is_settled, take_total, wanted_by_pair
from mpmcli.contact.fields_in_contact import is_rigid
from mpmcli.contact.impulses import relative_momentum, share_of_work
from mpmcli.contact.laws.impulse import TINIEST, dot, is_soft, law_impulse, law_impulse_at_end, leave
from mpmcli.core.compiled.kernel import called_once, inline, kernel, prange
from mpmcli.interfaces.base import (
    BREAKS,
    held_impulse,
    jump_impulse,
    openings,
    remember,
    stored_energy,
    tangents,
    traction,
)
from mpmcli.interfaces.independent import compliance_of, slip_of
from mpmcli.interfaces.memory import keep_history

Array = np.ndarray


@inline
def relative_force(axes, alpha, first, last, rigid, nodes, mp, f, out):
    """m_red (f_β/m_β − f_α/m_α) into ``out`` (d,); a rigid body feels no force."""
    m_alpha, m_beta = mp[alpha, 0], 0.0
    for a in range(len(axes)):
        out[a] = 0.0
    if not rigid:
        for e in range(first, last):
            i = nodes.dof[e]
            if i != alpha and not is_rigid(nodes, i):
                m_beta += mp[i, 0]
                for a in range(len(axes)):
                    out[a] += f[i, a]
    for a in range(len(axes)):
        if rigid:
            out[a] = -f[alpha, a]
        else:
            out[a] = (m_alpha * out[a] - m_beta * f[alpha, a]) / (m_alpha + m_beta)


@inline
def joint_impulse(
    law, closed, axes, wanted, normal, area, gap, gap_now, jump, aside, mass, force, history, reduced, here, acts,
    oscillates, out,
):  # fmt: skip
    """Impulse of a contact into ``out`` (d,): of the law while it holds, of the contact law ``closed`` after.

    ``acts``: the forces of the step are known; before that only perfect directions do anything. ``gap`` is the
    separation at the start of the step, ``gap_now`` that which decides on contact.
    """
    if history[BREAKS] > 0.5:
        if acts:
            push = dot(axes, force, normal)
            return law_impulse_at_end(
                closed,
                axes,
                wanted,
                normal,
                gap,
                push,
                area,
                reduced,
                here.dt,
                here.displacement_only,
                0.0,
                out,
            )
        if is_soft(closed):  # a spring acts once in a step (``contact.impulses.impulse_of``)
            return leave(axes, out)
        return law_impulse(
            closed, axes, wanted, normal, gap_now, area, reduced, here.dt, here.displacement_only, 0.0, out
        )
    if acts:
        state = jump_impulse(
            law, axes, wanted, normal, jump, force, area, reduced, here.dt, history, oscillates, out
        )
        if not oscillates:
            go_to_node(law, axes, normal, area, jump, aside, mass, history, reduced, here.dt, out)
        return state
    return held_impulse(law, axes, wanted, normal, out)


@inline
def go_to_node(law, axes, n, area, jump, aside, mass, history, reduced, dt, out):
    """Add to the impulse ``out`` (d,) what a share of ``aside`` (d,) asks for, by direction.

    An implicit step adds the velocities at the node to the jump, which is that at the interface beside the node. Stiff
    springs are unstable with FMPM of high order unless both belong to one place; soft ones keep the jump of the
    interface. The share is φ²/(1 + φ²) with the ``mass`` per area of a node on the interface: it is the same at all
    nodes across, which share its area such that these parts of their tractions cancel.
    """
    if dot(axes, aside, aside) == 0.0:
        return
    along, (normal, tangential) = dot(axes, aside, n), tangents(law, axes, n, jump, history)
    compliance = compliance_of(area * dt, dt / max(reduced, TINIEST))
    of_normal = share_of(normal * compliance) * share_of(normal * compliance_of(dt, dt / max(mass, TINIEST)))
    of_tangential = share_of(tangential * compliance) * share_of(
        tangential * compliance_of(dt, dt / max(mass, TINIEST))
    )
    for a in range(len(axes)):
        out[a] += reduced / dt * (of_normal * along * n[a] + of_tangential * (aside[a] - along * n[a]))


@inline
def share_of(square):
    """φ²/(1 + φ²), also where φ² is no number any more."""
    return 1.0 - 1.0 / (1.0 + square)


@kernel
def find_jump_impulses(
    law, closed, axes, which, count, fields, nodes, geometry, rows, jumps, here, acts, oscillates, mp, f, v
):
    """Find the momentum change Δp of α at every contact that the interface law ``which`` governs, into ``rows.dp``.

    As ``contact.impulses.find_impulses``, with the contact law ``closed`` of what is broken. ``acts``: the forces of
    the step are known.
    """
    state, separation_now = rows.state, rows.separation_now
    for k in prange(count):
        if fields.law[k] != which or fields.stage[k] != here.stage or fields.pair[k]:
            continue
        alpha, first, last, rigid = fields.alpha[k], fields.first[k], fields.last[k], fields.rigid[k]
        dp0 = rows.dp0[k]
        reduced = relative_momentum(axes, alpha, first, last, rigid, nodes, mp, v, here.of_velocity, dp0)
        if here.after_forces:
            relative_force(axes, alpha, first, last, rigid, nodes, mp, f, jumps.force[k])
        if here.of_increment:
            increments.total_increment(axes, rows.prior[k], dp0, rows.total[k])
            wanted, given = rows.total[k], rows.found[k]
        else:
            wanted, given = dp0, rows.dp[k]
            separation_now[k] = geometry.separation[k]
        state[k] = joint_impulse(
            law, closed, axes, wanted, geometry.normal[k], geometry.area[k], geometry.separation[k],
            separation_now[k], jumps.jump[k], jumps.aside[k], jumps.mass[k], jumps.force[k], jumps.history[k],
            reduced, here, acts, oscillates, given,
        )  # fmt: skip
        if here.of_increment:
            increments.finish_increment(
                axes, False, dp0, wanted, given, rows.prior[k], rows.net[k], rows.dp[k]
            )


@called_once
def find_pair_impulses(
    law, closed, axes, which, count, fields, begin, changed, turn, nodes, geometry, rows, jumps, here, acts,
    oscillates, mp, f,
):  # fmt: skip
    """``contact.coupled_pairs.find_pair_impulses``, one round, for the pairs that interface law ``which`` governs."""
    for k in range(count):
        if not fields.pair[k] or fields.law[k] != which or is_settled(fields.slot[k], changed, turn):
            continue
        wanted, found = rows.dp[k], rows.found[k]
        reduced = wanted_by_pair(axes, k, fields, begin, turn > 0, rows, mp, wanted)
        if here.after_forces:
            alpha, first, last = fields.alpha[k], fields.first[k], fields.last[k]
            relative_force(axes, alpha, first, last, False, nodes, mp, f, jumps.force[k])
        rows.state[k] = joint_impulse(
            law, closed, axes, wanted, geometry.normal[k], geometry.area[k], geometry.separation[k],
            rows.separation_now[k], jumps.jump[k], jumps.aside[k], jumps.mass[k], jumps.force[k],
            jumps.history[k], reduced, here, acts, oscillates, found,
        )  # fmt: skip
        take_total(axes, k, rows)


@kernel
def close_step(
    law, axes, which, count, fields, nodes, normals, areas, before, nets, jumps, ends, memory, after, share, pair, dt,
    late, widest, farthest, mp, sums,
):  # fmt: skip
    """Jumps at the end of the step, what interfaces took out of the bodies, store and have spent, and histories.

    ``before`` and ``after`` (k, d) are the relative velocities before the impulses ``nets`` (k, d) and those that these
    leave. The share ``late`` of the work is found with the latter, as that of the stresses is: the two agree in sum,
    not at each node. ``normals`` (k, d) and ``areas`` (k,) are those of ``Geometry``, alone because to hand over all
    the rows of contacts takes longer than the work on a few of them.
    Interfaces that open by more than ``widest`` or slip by more than ``farthest`` are lost; the latter break, with the
    energy that they store.

    Adds to ``sums`` (5, pairs), the share ``share`` (k,) of each contact to its ``pair`` (k,): work, stored energy,
    energy spent in the step, area that broke in it, and how many interfaces are lost. ``memory``, if any, says which
    particles remember it.
    """
    for k in range(count):
        if fields.law[k] != which:
            continue
        normal, area, history, end = normals[k], areas[k], jumps.history[k], ends.end[k]
        now, held = ends.now[k], ends.scratch[k]
        for a in range(len(axes)):
            end[a] = jumps.jump[k, a] + after[k, a] * dt
        now[0], now[1] = 0.0, 0.0
        if history[BREAKS] > 0.5:
            if memory is not None:
                keep_history(memory, fields, nodes, k, ends.apart[k], history, now)
            continue
        part = share_of_work(axes, fields, k, nodes, mp)
        net, work = nets[k], 0.0
        held_impulse(law, axes, net, normal, held)
        for a in range(len(axes)):
            slip = (1.0 - late) * before[k, a] + late * after[k, a]
            work += part * (net[a] - held[a]) * slip
        openings(law, axes, normal, jumps.jump[k], now)
        spent = area * remember(law, axes, normal, jumps.jump[k], history)
        lost = False
        if history[BREAKS] < 0.5:
            opening = dot(axes, jumps.jump[k], normal)
            slips = slip_of(axes, normal, jumps.jump[k], opening) > farthest
            lost = slips or opening > widest
            if slips:
                spent += area * stored_energy(law, axes, normal, jumps.jump[k], history)
                history[BREAKS] = 1.0
        mine, weight = pair[k], share[k]
        sums[0, mine] += weight * work
        sums[2, mine] += weight * spent
        if history[BREAKS] > 0.5:
            sums[3, mine] += weight * area
        else:
            sums[1, mine] += weight * area * stored_energy(law, axes, normal, end, history)
        if lost and weight > 0.0:
            sums[4, mine] += 1.0
        if memory is not None:
            keep_history(memory, fields, nodes, k, ends.apart[k], history, now)


@kernel
def find_tractions(law, axes, which, count, fields, geometry, jumps, end, out):
    """Traction on α at the jumps ``end`` (k, d) of the step's end, into ``out`` (k, d); zero where it is broken."""
    for k in prange(count):
        if fields.law[k] == which:
            if jumps.history[k, BREAKS] > 0.5:
                for a in range(len(axes)):
                    out[k, a] = 0.0
            else:
                traction(law, axes, geometry.normal[k], end[k], jumps.history[k], out[k])
