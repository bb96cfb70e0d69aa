"""Damage of the interfaces that particles remember, so that what broke stays visible after nodes lose sight of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import kernel
from mpmcli.core.particles import Particles
from mpmcli.interfaces.base import BREAKS, HISTORY, damage
from mpmcli.interfaces.memory import UNSET

Array = np.ndarray


def damage_of_particles(table: Array, laws: Mapping[int, Any], rows: Array, particles: Particles) -> Array:
    """Return the largest damage of the interfaces that each particle remembers (N,), 0 where it knows none.

    Parameters
    ----------
    table : (fields, fields) index of the law of each pair of fields
    laws : parameters of interface laws by index
    rows : (fields, fields) first row of a pair's history on particles of the first field, −1 where it has none
    """
    out = np.zeros(particles.count)
    if particles.interface is None:
        return out
    history = np.zeros(HISTORY)
    for mine, other in zip(*np.nonzero(rows >= 0), strict=True):
        law = laws[int(table[mine, other])]
        find_damages[False](
            law,
            int(mine),
            int(rows[mine, other]),
            particles.velocity_field,
            particles.interface,
            history,
            out,
        )
    return out


@kernel
def find_damages(law, mine, row, field, kept, history, out):
    """Raise ``out`` (N,) to the damage of the interface whose history begins at ``row`` of ``kept`` (rows, N).

    Only particles of the velocity field ``mine`` that the interface has reached count; ``history`` (3,) is scratch.
    """
    for p in range(out.shape[0]):
        if field[p] == mine and kept[row, p] > UNSET:
            for j in range(history.shape[0]):
                history[j] = kept[row + j, p]
            lost = 1.0 if history[BREAKS] > 0.5 else damage(law, history)
            out[p] = max(out[p], lost)
