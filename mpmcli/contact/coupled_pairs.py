"""Impulses of nodes of three or more fields, pair by pair.

``three_or_more: pairs`` does so where at most two pairs are in contact, and lumps the fields elsewhere (Nairn et al.
2020, section 3.4). ``coupled`` takes all pairs, each in turn on what the others do to it, until nothing changes, as
blocked Gauss-Seidel iterations for many bodies in contact do (Jourdan, Alart and Jean 1998). Momentum is conserved.
Such nodes are few: these loops are serial.
"""

import numpy as np

from mpmcli.contact.impulses import impulse_of, normal_force, relative_momentum
from mpmcli.contact.laws.impulse import is_soft
from mpmcli.core.compiled.kernel import called_once, inline

Array = np.ndarray

ROUNDS = 400
"""Most rounds in which pairs that share a field take turns; each round shrinks what is left by a mass ratio."""

LEFT_OUT = -1
"""Instead of the last round in which impulses at a node changed: its pairs do not act."""

CONVERGED = 1e-14
"""A node is settled when its impulses change by no more than this share."""


@called_once
def start_pairs(axes, count, fields, nodes, geometry, rows, here, mp, v):
    """Δp_α(0) of every pair by itself into ``rows.dp0``, with the total of earlier FMPM increments; clears
    ``rows.total`` and ``rows.dp``.

    ``here`` is a ``impulses.Place``.
    """
    for k in range(count):
        if not fields.pair[k]:
            continue
        dp0, normal = rows.dp0[k], geometry.normal[k]
        alpha, first, last = fields.alpha[k], fields.first[k], fields.last[k]
        reduced = relative_momentum(axes, alpha, first, last, False, nodes, mp, v, here.of_velocity, dp0)
        if not here.of_increment:
            rows.separation_now[k] = geometry.separation[k]
        for a in range(len(axes)):
            if here.of_increment:
                dp0[a] += rows.prior[k, a]
            else:
                rows.separation_now[k] += dp0[a] * normal[a] * here.advance / reduced
            rows.total[k, a] = rows.dp[k, a] = 0.0
        if here.drives:
            for a in range(len(axes)):
                dp0[a] -= rows.drive[k] * normal[a]


@called_once
def find_pair_impulses(
    law, axes, which, fields, begin, changed, first, rounds, alone, nodes, geometry, rows, here, mp, f
):  # fmt: skip
    """Find the impulses ``rows.total`` of all pairs that law ``which`` governs; ``found`` is scratch.

    Round 0 takes each pair by itself. Later ones take those of the nodes that ``choose_pairs`` has chosen, each on what
    the others at its node do to it; of them so many ``rounds`` from ``first`` on, or fewer if impulses converge.
    ``changed`` (slots,) is the last round in which impulses at a node changed. Where no other law takes turns, the law
    is ``alone``, and rounds end here; else ``end_round`` ends them.
    """
    for turn in range(first, first + rounds):
        all_settled = True
        for slot in range(len(changed)):
            if is_settled(slot, changed, turn):
                continue
            all_settled = False
            for k in range(begin[slot], begin[slot + 1]):
                if not fields.pair[k] or fields.law[k] != which:
                    continue
                wanted = rows.dp[k]
                reduced = wanted_by_pair(axes, k, fields, begin, turn > 0, rows, mp, wanted)
                if here.after_forces and is_soft(law):
                    rows.push[k] = normal_force(
                        axes, fields.alpha[k], fields.first[k], fields.last[k], False, nodes, mp, f,
                        geometry.normal[k],
                    )  # fmt: skip
                rows.state[k] = impulse_of(
                    law, axes, wanted, geometry.normal[k], geometry.separation[k], rows.separation_now[k],
                    rows.push[k], geometry.area[k], reduced, here, geometry.bond[k], rows.found[k],
                )  # fmt: skip
                take_total(axes, k, rows)
            if turn > 0 and alone:
                end_round_at(axes, slot, fields, begin, changed, turn, rows)
        if all_settled:
            break


@inline
def magnitude(axes, a):
    """Return the sum of the magnitudes of the components."""
    total = 0.0
    for i in range(len(axes)):
        total += abs(a[i])
    return total


@inline
def is_settled(slot, changed, turn):
    """Return whether no impulse at a node has changed in the round before, so that none will, or it is left out."""
    return turn > 0 and changed[slot] < turn - 1


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
def take_total(axes, k, rows):
    """Let ``rows.total`` of a pair be ``rows.found``, and ``rows.dp`` by how much that changes it."""
    for a in range(len(axes)):
        rows.dp[k, a] = rows.found[k, a] - rows.total[k, a]
        rows.total[k, a] = rows.found[k, a]


@inline
def end_round_at(axes, slot, fields, begin, changed, turn, rows):
    """Note whether a round changed the impulses of a node."""
    change, size = 0.0, 0.0
    for k in range(begin[slot], begin[slot + 1]):
        if fields.pair[k]:
            change += magnitude(axes, rows.dp[k])
            size += magnitude(axes, rows.total[k])
    if change > CONVERGED * size:
        changed[slot] = turn


@called_once
def end_round(axes, fields, begin, changed, turn, rows):
    """``end_round_at`` all nodes, once the pairs of all laws have had their turn; returns whether all are settled."""
    all_settled = True
    for slot in range(len(changed)):
        if not is_settled(slot, changed, turn):
            end_round_at(axes, slot, fields, begin, changed, turn, rows)
            all_settled = all_settled and changed[slot] < turn
    return all_settled


@called_once
def choose_pairs(fields, begin, most, state, changed):
    """Choose the nodes where one to ``most`` pairs are in contact, in ``changed`` (slots,); returns whether any is."""
    some = False
    for slot in range(len(changed)):
        touching = 0
        for k in range(begin[slot], begin[slot + 1]):
            if fields.pair[k] and state[k] > 0:
                touching += 1
        chosen = 0 < touching <= most
        changed[slot] = 0 if chosen else LEFT_OUT
        some = some or chosen
    return some


@called_once
def finish_pairs(axes, count, fields, begin, changed, rows, here, mp):
    """Momentum changes of pairs from their totals; at each node either pairs or lumped contacts act.

    Where pairs are not chosen their rows become zero; where they are, those of the lumped contacts. "Evolving"
    follows what is left of Δp_α(0) after all pairs of a node.
    """
    prior, net, dp = rows.prior, rows.net, rows.dp
    for k in range(count):
        chosen = changed[fields.slot[k]] != LEFT_OUT
        if fields.pair[k] and chosen and here.evolving:
            wanted_by_pair(axes, k, fields, begin, True, rows, mp, rows.found[k])
            for a in range(len(axes)):
                rows.dp0[k, a] = rows.found[k, a]
        lumped = not fields.pair[k] and fields.stage[k] == 0 and not fields.alone[k]
        if fields.pair[k]:
            for a in range(len(axes)):
                full = rows.total[k, a] if chosen else 0.0
                dp[k, a] = full
                if here.of_increment:
                    if here.evolving:
                        prior[k, a] = rows.dp0[k, a] - full
                        net[k, a] += full
                    else:
                        prior[k, a] = rows.dp0[k, a]
                        dp[k, a] = full - net[k, a]
                        net[k, a] = full
        elif lumped and chosen:
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
        if (fields.pair[k] and not chosen) or (lumped and chosen):
            rows.state[k] = 0
