"""Nodes of three or more fields settled pair by pair.

``three_or_more: pairs`` does so where at most two pairs are in contact, and lumps the fields elsewhere (Nairn et al.
2020, section 3.4). ``coupled`` settles all pairs: each in turn on what the others do to it, until nothing changes, as
blocked Gauss-Seidel iterations for many bodies in contact do (Jourdan, Alart and Jean 1998). Momentum is conserved.
Such nodes are few: these loops are serial.
"""

from __future__ import annotations

import numpy as np

from mpmcli.contact.momenta import relative_momentum
from mpmcli.contact.settle import settle
from mpmcli.core.kernel import inline

Array = np.ndarray

SWEEPS = 40
"""Most rounds in which pairs that share a field settle in turn; each round shrinks what is left by a mass ratio."""

SETTLED = 1e-14
"""Rounds end when the impulses of all pairs together change by less than this share."""


@inline
def find_pair_impulses(
    axes, count, members, node_count, dof, rigid_field, mp, v, of_velocity, prior, of_increment, normal, separation,
    separation_now, advance, drive, drives, dp0, total,
):  # fmt: skip
    """Δp_α(0) of every pair by itself into ``dp0``, with the total of earlier FMPM increments; clears ``total``.

    Flags say which arrays count, as in ``momenta.settle_stage``.
    """
    for k in range(count):
        if not members.pair[k]:
            continue
        reduced = relative_momentum(
            axes, members.alpha[k], members.first[k], members.last[k], False, rigid_field, node_count, dof, mp, v,
            of_velocity, dp0[k],
        )  # fmt: skip
        if not of_increment:
            separation_now[k] = separation[k]
        for a in range(len(axes)):
            if of_increment:
                dp0[k, a] += prior[k, a]
            else:
                separation_now[k] += dp0[k, a] * normal[k, a] * advance / reduced
            total[k, a] = 0.0
        if drives:
            for a in range(len(axes)):
                dp0[k, a] -= drive[k] * normal[k, a]


@inline
def settle_pairs(
    law, which, axes, count, members, begin, chosen, coupled, mp, normal, separation_now, area, bond, dt,
    displacement_only, dp0, wanted, found, total, state,
):  # fmt: skip
    """Settle every pair that law ``which`` governs into ``total`` (k, d); ``wanted`` and ``found`` (k, d) are scratch.

    With ``coupled`` only pairs of nodes that ``chosen`` (slots,) marks, each on what the others at its node do to it.
    Returns by how much totals changed and how large they are, sums of magnitudes.
    """
    change, size = 0.0, 0.0
    for k in range(count):
        slot = members.slot[k]
        if not members.pair[k] or members.law[k] != which or (coupled and not chosen[slot]):
            continue
        i, j = members.alpha[k], members.partner[k]
        reduced = mp[i, 0] * mp[j, 0] / (mp[i, 0] + mp[j, 0])
        for a in range(len(axes)):
            wanted[k, a] = dp0[k, a]
        if coupled:
            for other in range(begin[slot], begin[slot + 1]):
                if other == k or not members.pair[other]:
                    continue
                for end in range(2):
                    at = members.alpha[other] if end == 0 else members.partner[other]
                    sign = 1.0 if end == 0 else -1.0
                    for a in range(len(axes)):
                        if at == j:
                            wanted[k, a] += sign * reduced * total[other, a] / mp[j, 0]
                        elif at == i:
                            wanted[k, a] -= sign * reduced * total[other, a] / mp[i, 0]
        state[k] = settle(
            law, axes, wanted[k], normal[k], separation_now[k], area[k], reduced, dt, displacement_only, bond[k],
            found[k],
        )  # fmt: skip
        for a in range(len(axes)):
            change += abs(found[k, a] - total[k, a])
            size += abs(found[k, a])
            total[k, a] = found[k, a]
    return change, size


@inline
def choose_pairs(slots, members, begin, most, state, chosen):
    """Mark the nodes where one to ``most`` pairs are in contact: ``chosen`` (slots,)."""
    for slot in range(slots):
        touching = 0
        for k in range(begin[slot], begin[slot + 1]):
            if members.pair[k] and state[k] > 0:
                touching += 1
        chosen[slot] = 0 < touching <= most


@inline
def finish_pairs(
    axes, count, members, begin, chosen, prior, net, of_increment, evolving, dp0, total, dp, state
):
    """Momentum changes of pairs from their totals; at each node either pairs or lumped contacts act.

    Where pairs are not chosen their rows become zero; where they are, those of the lumped contacts. ``prior``, ``net``,
    ``of_increment`` and ``evolving`` are those of ``momenta.settle_stage``.
    """
    for k in range(count):
        slot = members.slot[k]
        lumped = not members.pair[k] and members.stage[k] == 0 and not members.alone[k]
        if members.pair[k]:
            for a in range(len(axes)):
                full = total[k, a] if chosen[slot] else 0.0
                dp[k, a] = full
                if of_increment:
                    if evolving:
                        prior[k, a] = dp0[k, a] - full
                        net[k, a] += full
                    else:
                        prior[k, a] = dp0[k, a]
                        dp[k, a] = full - net[k, a]
                        net[k, a] = full
        elif lumped and chosen[slot]:
            for a in range(len(axes)):
                if not of_increment:
                    dp[k, a] = 0.0
                elif evolving:
                    net[k, a] -= dp[k, a]
                    prior[k, a] += dp[k, a]
                    dp[k, a] = 0.0
                else:  # what lumped contacts of earlier increments did is taken back: the totals of the pairs hold it
                    dp[k, a] -= net[k, a]
                    net[k, a] = 0.0
        if (members.pair[k] and not chosen[slot]) or (lumped and chosen[slot]):
            state[k] = 0
