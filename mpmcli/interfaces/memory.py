"""What particles remember of the interfaces near them, from one step to the next."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.fields_in_contact import field_at
from mpmcli.contact.near_particles import NEAREST
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.particles import determinant_of_particle
from mpmcli.interfaces.base import BREAKS, HISTORY

Array = np.ndarray

UNSET = -1.0
"""Largest opening of particles that no interface has reached yet; what they know of breaks, if never bonded."""


@inline
def row_of_history(rows, field, alpha, beta):
    """First row of the history that a particle of ``field`` keeps of the interface of two fields, −1 if none."""
    if field == alpha:
        return rows[alpha, beta]
    return rows[beta, alpha] if field == beta else -1


@inline
def add_history(kept, row, p, S, matter, history):
    """Add what particle ``p`` keeps from ``row`` of ``kept`` (rows, N) on to ``history`` (3,), times its share S V of a
    node; returns that share, 0 if no interface has reached the particle."""
    if kept[row, p] <= UNSET:
        return 0.0
    w = S * determinant_of_particle(matter.F, p) * matter.vol0[p]
    for j in range(HISTORY):
        history[j] += w * max(kept[row + j, p], 0.0)
    return w


@inline
def add_histories(kept, rows, slot, alpha, beta, near, matter, history):
    """``add_history`` of all particles of two fields that a node sees: for nodes that are the nearest of none."""
    share = 0.0
    at = near.head[slot]
    while at >= 0:
        p = near.particle[at]
        row = row_of_history(rows, matter.field[p], alpha, beta)
        if row >= 0:
            share += add_history(kept, row, p, near.S[at], matter, history)
        at = near.next[at]
    return share


class Memory(NamedTuple):
    """Which particles remember the interfaces of a step: ``Sides.row``, the particles near nodes, their fields and
    histories (rows, N)."""

    row: Array
    near: Any
    field: Array
    kept: Any


@inline
def keep_history(memory, fields, nodes, k, apart, history, now):
    """Give the particles nearest to an interface its openings of the step; what broke stays broken."""
    near, kept = memory.near, memory.kept
    alpha, beta = field_at(nodes, fields.alpha[k]), field_at(nodes, fields.partner[k])
    at = -1 if apart else near.head[fields.slot[k]]
    while at >= 0:
        if near.flag[at] & NEAREST:
            p = near.particle[at]
            row = row_of_history(memory.row, memory.field[p], alpha, beta)
            if row >= 0:
                is_new = kept[row, p] <= UNSET
                for j in range(2):
                    kept[row + j, p] = max(history[j] if is_new else kept[row + j, p], now[j])
                if history[BREAKS] > 0.5:
                    kept[row + BREAKS, p] = 1.0
        at = near.next[at]
