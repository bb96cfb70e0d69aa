"""What particles remember of the interfaces near them, from one step to the next."""

from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.fields_in_contact import field_at
from mpmcli.contact.near_particles import NEAREST
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.particles import determinant_of_particle
from mpmcli.interfaces.base import BREAKS, OPENINGS

Array = np.ndarray

UNSET = -1.0
"""Largest opening of particles that no interface has reached yet; what they know of breaks, if never bonded or
broken."""


@inline
def row_of_history(rows, field, alpha, beta):
    """``Sides.row`` of what a particle of ``field`` keeps of the interface of two fields, −1 if nothing."""
    if field == alpha:
        return rows[alpha, beta]
    return rows[beta, alpha] if field == beta else -1


@inline
def first_row(row, keeps):
    """First row of a history whose last one is ``row``; ``keeps``: openings are in it."""
    return row - OPENINGS if keeps else row


@inline
def add_history(kept, row, keeps, p, S, matter, history):
    """Add what particle ``p`` keeps up to ``row`` of ``kept`` (rows, N) to ``history`` (3,), times its share S V of a
    node; returns that share, 0 if no interface has reached the particle."""
    first = first_row(row, keeps)
    if kept[first, p] <= UNSET:
        return 0.0
    w = S * determinant_of_particle(matter.F, p) * matter.vol0[p]
    for j in range(row - first):
        history[j] += w * max(kept[first + j, p], 0.0)
    history[BREAKS] += w * max(kept[row, p], 0.0)
    return w


@inline
def add_histories(kept, rows, keeps, slot, alpha, beta, near, matter, history):
    """``add_history`` of all particles of two fields that a node sees: for nodes that are the nearest of none."""
    share = 0.0
    at = near.head[slot]
    while at >= 0:
        p = near.particle[at]
        row = row_of_history(rows, matter.field[p], alpha, beta)
        if row >= 0:
            share += add_history(kept, row, keeps, p, near.S[at], matter, history)
        at = near.next[at]
    return share


class Memory(NamedTuple):
    """Which particles remember the interfaces of a law: whether it ``keeps`` openings, ``Sides.row``, the particles
    near nodes, their fields and histories (rows, N)."""

    keeps: bool
    row: Array
    near: Any
    field: Array
    kept: Any


@inline
def keep_history(memory, fields, nodes, k, apart, history, now):
    """Give the particles nearest to an interface its openings of the step; what broke stays broken."""
    near, kept = memory.near, memory.kept
    if apart or not (memory.keeps or history[BREAKS] > 0.5):
        return
    alpha, beta = field_at(nodes, fields.alpha[k]), field_at(nodes, fields.partner[k])
    at = near.head[fields.slot[k]]
    while at >= 0:
        if near.flag[at] & NEAREST:
            p = near.particle[at]
            row = row_of_history(memory.row, memory.field[p], alpha, beta)
            if row >= 0:
                first = first_row(row, memory.keeps)
                is_new = kept[first, p] <= UNSET
                for j in range(row - first):
                    kept[first + j, p] = max(history[j] if is_new else kept[first + j, p], now[j])
                if history[BREAKS] > 0.5:
                    kept[row, p] = 1.0
        at = near.next[at]
