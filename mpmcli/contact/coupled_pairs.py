"""Impulses of nodes of three or more fields, pair by pair.

``three_or_more: pairs`` does so where at most two pairs are in contact, and lumps the fields elsewhere (Nairn et al.
2020, section 3.4). ``coupled`` takes all pairs, each in turn on what the others do to it, until nothing changes, as
blocked Gauss-Seidel iterations for many bodies in contact do (Jourdan, Alart and Jean 1998). Momentum is conserved.
Such nodes are few: these loops are serial.
"""

from __future__ import annotations

import numpy as np

from mpmcli.contact.impulses import relative_momentum
from mpmcli.contact.laws.impulse import law_impulse
from mpmcli.core.compiled.kernel import inline

Array = np.ndarray

SWEEPS = 40
"""Most rounds in which pairs that share a field take turns; each round shrinks what is left by a mass ratio."""

CONVERGED = 1e-14
"""Rounds end when the impulses of all pairs together change by less than this share."""


@inline
def start_pairs(axes, count, fields, nodes, geometry, rows, here, mp, v):
    """Δp_α(0) of every pair by itself into ``rows.dp0``, with the total of earlier FMPM increments; clears
    ``rows.total``.

    ``here`` is a ``impulses.Place``.
    """
    for k in range(count):
        if not fields.pair[k]:
            continue
        dp0, normal = rows.dp0[k], geometry.normal[k]
        reduced = relative_momentum(
            axes,
            fields.alpha[k],
            fields.first[k],
            fields.last[k],
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
def find_pair_impulses(law, axes, which, count, fields, begin, chosen, coupled, geometry, rows, here, mp):
    """Find the impulses ``rows.total`` of all pairs that law ``which`` governs; ``dp`` and ``found`` are scratch.

    With ``coupled`` only pairs of nodes that ``chosen`` (slots,) marks, each on what the others at its node do to it.
    Returns by how much totals changed and how large they are, sums of magnitudes.
    """
    change, size = 0.0, 0.0
    for k in range(count):
        if not fields.pair[k] or fields.law[k] != which or (coupled and not chosen[fields.slot[k]]):
            continue
        wanted, found = rows.dp[k], rows.found[k]
        reduced = wanted_by_pair(axes, k, fields, begin, coupled, rows, mp, wanted)
        rows.state[k] = law_impulse(
            law, axes, wanted, geometry.normal[k], rows.separation_now[k], geometry.area[k], reduced, here.dt,
            here.displacement_only, geometry.bond[k], found,
        )  # fmt: skip
        moved, whole = take_total(axes, found, rows.total[k])
        change, size = change + moved, size + whole
    return change, size


@inline
def wanted_by_pair(axes, k, fields, begin, coupled, rows, mp, wanted):
    """Δp_α(0) of a pair, with ``coupled`` after what the others there do to it, into ``wanted``; returns m_red."""
    i, j, slot = fields.alpha[k], fields.partner[k], fields.slot[k]
    reduced = mp[i, 0] * mp[j, 0] / (mp[i, 0] + mp[j, 0])
    for a in range(len(axes)):
        wanted[a] = rows.dp0[k, a]
    if coupled:
        for other in range(begin[slot], begin[slot + 1]):
            if other == k or not fields.pair[other]:
                continue
            for end in range(2):
                at = fields.alpha[other] if end == 0 else fields.partner[other]
                sign = 1.0 if end == 0 else -1.0
                for a in range(len(axes)):
                    if at == j:
                        wanted[a] += sign * reduced * rows.total[other, a] / mp[j, 0]
                    elif at == i:
                        wanted[a] -= sign * reduced * rows.total[other, a] / mp[i, 0]
    return reduced


@inline
def take_total(axes, found, total):
    """Let ``total`` (d,) be ``found``; returns by how much it changed and how large it is, sums of magnitudes."""
    change, size = 0.0, 0.0
    for a in range(len(axes)):
        change += abs(found[a] - total[a])
        size += abs(found[a])
        total[a] = found[a]
    return change, size


@inline
def choose_pairs(slots, fields, begin, most, state, chosen):
    """Mark the nodes where one to ``most`` pairs are in contact: ``chosen`` (slots,)."""
    for slot in range(slots):
        touching = 0
        for k in range(begin[slot], begin[slot + 1]):
            if fields.pair[k] and state[k] > 0:
                touching += 1
        chosen[slot] = 0 < touching <= most


@inline
def finish_pairs(axes, count, fields, chosen, rows, here):
    """Momentum changes of pairs from their totals; at each node either pairs or lumped contacts act.

    Where pairs are not chosen their rows become zero; where they are, those of the lumped contacts.
    """
    prior, net, dp = rows.prior, rows.net, rows.dp
    for k in range(count):
        slot = fields.slot[k]
        lumped = not fields.pair[k] and fields.stage[k] == 0 and not fields.alone[k]
        if fields.pair[k]:
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
        if (fields.pair[k] and not chosen[slot]) or (lumped and chosen[slot]):
            rows.state[k] = 0
