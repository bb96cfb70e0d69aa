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
def find_pair_impulses(axes, count, members, nodes, geometry, rows, here, mp, v):
    """Δp_α(0) of every pair by itself into ``rows.dp0``, with the total of earlier FMPM increments; clears
    ``rows.total``.

    ``here`` is a ``momenta.Place``.
    """
    for k in range(count):
        if not members.pair[k]:
            continue
        dp0, normal = rows.dp0[k], geometry.normal[k]
        reduced = relative_momentum(
            axes,
            members.alpha[k],
            members.first[k],
            members.last[k],
            False,
            nodes,
            mp,
            v,
            here.of_velocity,
            dp0,
        )
        if not here.of_increment:
            rows.separation_now[k] = geometry.separation[k]
        for a in range(len(axes)):
            if here.of_increment:
                dp0[a] += rows.prior[k, a]
            else:
                rows.separation_now[k] += dp0[a] * normal[a] * here.advance / reduced
            rows.total[k, a] = 0.0
        if here.drives:
            for a in range(len(axes)):
                dp0[a] -= rows.drive[k] * normal[a]


@inline
def settle_pairs(law, axes, which, count, members, begin, chosen, coupled, geometry, rows, here, mp):
    """Settle every pair that law ``which`` governs into ``rows.total``; rows of ``dp`` and ``settled`` are scratch.

    With ``coupled`` only pairs of nodes that ``chosen`` (slots,) marks, each on what the others at its node do to it.
    Returns by how much totals changed and how large they are, sums of magnitudes.
    """
    change, size = 0.0, 0.0
    total = rows.total
    for k in range(count):
        slot = members.slot[k]
        if not members.pair[k] or members.law[k] != which or (coupled and not chosen[slot]):
            continue
        i, j = members.alpha[k], members.partner[k]
        reduced = mp[i, 0] * mp[j, 0] / (mp[i, 0] + mp[j, 0])
        wanted, found = rows.dp[k], rows.settled[k]
        for a in range(len(axes)):
            wanted[a] = rows.dp0[k, a]
        if coupled:
            for other in range(begin[slot], begin[slot + 1]):
                if other == k or not members.pair[other]:
                    continue
                for end in range(2):
                    at = members.alpha[other] if end == 0 else members.partner[other]
                    sign = 1.0 if end == 0 else -1.0
                    for a in range(len(axes)):
                        if at == j:
                            wanted[a] += sign * reduced * total[other, a] / mp[j, 0]
                        elif at == i:
                            wanted[a] -= sign * reduced * total[other, a] / mp[i, 0]
        rows.state[k] = settle(
            law, axes, wanted, geometry.normal[k], rows.separation_now[k], geometry.area[k], reduced, here.dt,
            here.displacement_only, geometry.bond[k], found,
        )  # fmt: skip
        for a in range(len(axes)):
            change += abs(found[a] - total[k, a])
            size += abs(found[a])
            total[k, a] = found[a]
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
def finish_pairs(axes, count, members, chosen, rows, here):
    """Momentum changes of pairs from their totals; at each node either pairs or lumped contacts act.

    Where pairs are not chosen their rows become zero; where they are, those of the lumped contacts.
    """
    prior, net, dp = rows.prior, rows.net, rows.dp
    for k in range(count):
        slot = members.slot[k]
        lumped = not members.pair[k] and members.stage[k] == 0 and not members.alone[k]
        if members.pair[k]:
            for a in range(len(axes)):
                full = rows.total[k, a] if chosen[slot] else 0.0
                dp[k, a] = full
                if here.of_increment:
                    if here.evolving:
                        prior[k, a] = rows.dp0[k, a] - full
                        net[k, a] += full
                    else:
                        prior[k, a] = rows.dp0[k, a]
                        dp[k, a] = full - net[k, a]
                        net[k, a] = full
        elif lumped and chosen[slot]:
            for a in range(len(axes)):
                if not here.of_increment:
                    dp[k, a] = 0.0
                elif here.evolving:
                    net[k, a] -= dp[k, a]
                    prior[k, a] += dp[k, a]
                    dp[k, a] = 0.0
                else:  # what lumped contacts of earlier increments did is taken back: the totals of the pairs hold it
                    dp[k, a] -= net[k, a]
                    net[k, a] = 0.0
        if (members.pair[k] and not chosen[slot]) or (lumped and chosen[slot]):
            rows.state[k] = 0
