"""Which velocity fields meet at which node.

A contact is seen from one field, α, against β: the other field of a node with two, all others lumped at a node with
more (Nairn et al. 2020, Eq. 50), or one rigid field. At a node with two fields that share a normal one contact serves
both sides; otherwise each field has a contact of its own.
"""

from typing import NamedTuple

import numpy as np

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.dofs import field_of, side_of

Array = np.ndarray


class Rules(NamedTuple):
    """What fields do when they meet.

    law : (fields, fields) index of the law of each pair
    skipped, screened : (laws,) whether a law leaves fields alone; whether it passes over small mass ratios
    rigid : (fields,) whether a field belongs to a rigid body
    mass_ratio : smallest share of the mass at a node that counts
    explicit : nodes of three or more fields get their impulses pair by pair where that can be done
    coupled : they always are, so that lumped contacts are not needed
    shares_normal : one normal serves both sides
    """

    law: Array
    skipped: Array
    screened: Array
    rigid: Array
    mass_ratio: float
    explicit: bool
    coupled: bool
    shares_normal: bool


class FieldsInContact(NamedTuple):
    """The pairs of fields in contact: one row per contact, (k,) each.

    slot : contact node, as counted by ``ContactNodes``
    alpha, partner : degrees of freedom of α and of the field of β with most volume
    first, last : the entries of the node among which β is (all others but α, or the rigid one alone)
    law : index of the law
    stage : contacts of one stage act at once, those of the next on what comes of it
    rigid : β is a rigid body
    alone : β is the partner alone, else all other deformable fields lumped
    pair : one of the pairs at a node of three or more fields that gets an impulse of its own
    both : the contact acts on both sides, else on α alone
    order : +1 if α comes before its partner, or the partner is rigid; else −1
    """

    slot: Array
    alpha: Array
    partner: Array
    first: Array
    last: Array
    law: Array
    stage: Array
    rigid: Array
    alone: Array
    pair: Array
    both: Array
    order: Array


def allocate_fields(room: int) -> FieldsInContact:
    """Make room for pairs of fields."""
    integers = {name: np.zeros(room, dtype=np.int64) for name in FieldsInContact._fields}
    flags = {name: np.zeros(room, dtype=bool) for name in ("rigid", "alone", "pair", "both")}
    return FieldsInContact(**(integers | flags | {"order": np.zeros(room)}))


class NodeTable(NamedTuple):
    """Contact nodes of a step, and the velocity fields that meet at each.

    node : (slots,) node indices; side · node_count + node on further sides
    first : (slots + 1,) where the entries of each node begin
    dof : (entries,) degrees of freedom with mass
    volume : (entries, at least) volume Ω of each field at its node [volume]
    rigid : (fields,) whether a field belongs to a rigid body
    node_count : nodes of the grid
    """

    node: Array
    first: Array
    dof: Array
    volume: Array
    rigid: Array
    node_count: int


@inline
def field_at(nodes, dof):
    """Return the velocity field of a degree of freedom; ``nodes`` is a ``NodeTable``."""
    return field_of(dof, nodes.node_count, nodes.rigid.shape[0])


@inline
def is_rigid(nodes, dof):
    """Return whether a degree of freedom belongs to a rigid body; ``nodes`` is a ``NodeTable``."""
    return nodes.rigid[field_at(nodes, dof)]


@inline
def put_contact(m, k, slot, alpha, partner, first, last, law):
    """Write row ``k`` of the fields ``m``: a contact of α with others lumped, on α alone."""
    m.slot[k] = slot
    m.alpha[k] = alpha
    m.partner[k] = partner
    m.first[k], m.last[k] = first, last
    m.law[k] = law
    m.stage[k] = 0
    m.rigid[k] = m.alone[k] = m.pair[k] = m.both[k] = False
    m.order[k] = 1.0


@inline
def passes_over(rules, law, mass, total):
    """Return whether a law leaves a field with ``mass`` of the ``total`` alone."""
    share = mass / total
    is_small = share < rules.mass_ratio or share > 1.0 - rules.mass_ratio
    return rules.skipped[law] or (is_small and rules.screened[law])


@inline
def list_contacts(rules, nodes, mp, m, begin):
    """Write the contacts of all contact nodes into ``m``.

    ``begin`` (slots + 1,) receives where the contacts of each node begin.

    Returns their number, in how many stages they act, and whether some are pairs at nodes of three or more fields.
    """
    first, dof, volume, slots = nodes.first, nodes.dof, nodes.volume, nodes.node.shape[0]
    k, last_stage, has_pairs = 0, 0, False
    for slot in range(slots):
        begin[slot] = k
        low, high = first[slot], first[slot + 1]
        soft = 0
        for e in range(low, high):
            if not is_rigid(nodes, dof[e]):
                soft += 1
        if soft == 2 or (soft > 2 and not rules.coupled):
            total = 0.0
            for e in range(low, high):
                if not is_rigid(nodes, dof[e]):
                    total += mp[dof[e], 0]
            both = soft == 2 and rules.shares_normal
            for e in range(low, high):
                field = field_at(nodes, dof[e])
                if rules.rigid[field]:
                    continue
                partner = -1
                for other in range(low, high):
                    if other == e or is_rigid(nodes, dof[other]):
                        continue
                    if partner < 0 or volume[other] > volume[partner]:
                        partner = other
                law = rules.law[field, field_at(nodes, dof[partner])]
                if passes_over(rules, law, mp[dof[e], 0], total):
                    if both:
                        break
                    continue
                put_contact(m, k, slot, dof[e], dof[partner], low, high, law)
                m.alone[k] = soft == 2
                m.both[k] = both
                m.order[k] = 1.0 if dof[e] < dof[partner] else -1.0
                k += 1
                if both:
                    break
        if soft > 2 and rules.explicit:
            for e in range(low, high):
                for other in range(e + 1, high):
                    if is_rigid(nodes, dof[e]) or is_rigid(nodes, dof[other]):
                        continue
                    law = rules.law[field_at(nodes, dof[e]), field_at(nodes, dof[other])]
                    if passes_over(rules, law, mp[dof[e], 0], mp[dof[e], 0] + mp[dof[other], 0]):
                        continue
                    put_contact(m, k, slot, dof[e], dof[other], other, other + 1, law)
                    m.alone[k] = True
                    m.pair[k] = has_pairs = True
                    m.both[k] = True
                    k += 1
        stage = 0
        for r in range(low, high):
            if not is_rigid(nodes, dof[r]):
                continue
            stage += 1
            for e in range(low, high):
                field = field_at(nodes, dof[e])
                law = rules.law[field, field_at(nodes, dof[r])]
                if rules.rigid[field] or rules.skipped[law]:
                    continue
                put_contact(m, k, slot, dof[e], dof[r], r, r + 1, law)
                m.stage[k] = stage
                m.rigid[k] = True
                m.alone[k] = True
                k += 1
        side = side_of(nodes.node[slot], nodes.node_count, 1)
        if side > 0:  # what no crack cuts meets one side after the other
            for row in range(begin[slot], k):
                if not m.pair[row]:
                    m.stage[row] += side
        for row in range(begin[slot], k):
            last_stage = max(last_stage, m.stage[row])
    begin[slots] = k
    return k, 1 + last_stage, has_pairs


@inline
def most_contacts(rules, nodes):
    """Upper bound of the number of contacts of these nodes."""
    most = 0
    for slot in range(nodes.node.shape[0]):
        soft, hard = 0, 0
        for e in range(nodes.first[slot], nodes.first[slot + 1]):
            if is_rigid(nodes, nodes.dof[e]):
                hard += 1
            else:
                soft += 1
        most += soft + soft * hard
        if rules.explicit:
            most += soft * (soft - 1) // 2
    return most
