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
def recall_history(sides, slot, alpha, beta, near, matter, kept, apart, history):
    """History of an interface from the particles near it, ``kept`` (rows, N), into ``history`` (3,).

    It is that of the particles whose nearest node this is, or else of all that the node sees: the mean by their
    shares S V. Particles that no interface has reached count for nothing; broken is an
    interface of whose matter more than half is, or of matter that was not bonded (``apart``).
    """
    for j in range(HISTORY):
        history[j] = 0.0
    for nearest in range(2):
        share = 0.0
        at = near.head[slot]
        while at >= 0:
            p = near.particle[at]
            if nearest == 1 or near.flag[at] & NEAREST:
                row = row_of_history(sides.row, matter.field[p], alpha, beta)
                if row >= 0 and kept[row, p] > UNSET:
                    w = near.S[at] * determinant_of_particle(matter.F, p) * matter.vol0[p]
                    share += w
                    for j in range(HISTORY):
                        history[j] += w * max(kept[row + j, p], 0.0)
            at = near.next[at]
        if share > 0.0:
            for j in range(HISTORY):
                history[j] /= share
            break
    history[BREAKS] = 1.0 if apart or history[BREAKS] > 0.5 else 0.0


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
