"""Damage of the interfaces that particles remember, so that what broke stays visible after nodes lose sight of it."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import kernel
from mpmcli.core.particles import Particles
from mpmcli.interfaces.base import BREAKS, HISTORY, damage
from mpmcli.interfaces.jump import Sides
from mpmcli.interfaces.memory import UNSET, first_row

Array = np.ndarray


def damage_of_particles(table: Array, laws: Mapping[int, Any], sides: Sides, particles: Particles) -> Array:
    """Return the largest damage of the interfaces that each particle remembers (N,), 0 where it knows none.

    Parameters
    ----------
    table : (fields, fields) index of the law of each pair of fields
    laws : parameters of interface laws by index
    sides : which pairs have an interface, and where particles keep its history
    """
    out = np.zeros(particles.count)
    if particles.interface is None:
        return out
    for mine, other in zip(*np.nonzero(sides.row >= 0), strict=True):
        which, history = int(table[mine, other]), np.zeros(HISTORY)
        find_damages[False](
            laws[which], int(mine), int(sides.row[mine, other]), bool(sides.keeps[which]),
            particles.velocity_field, particles.interface, history, out,
        )  # fmt: skip
    return out


@kernel
def find_damages(law, mine, row, keeps, field, kept, history, out):
    """Raise ``out`` (N,) to the damage of the interface whose history ends at ``row`` of ``kept`` (rows, N).

    Only particles of the velocity field ``mine`` that the interface has reached count; ``history`` (3,) is scratch, of
    which the openings must be 0 unless the law ``keeps`` them.
    """
    first = first_row(row, keeps)
    for p in range(out.shape[0]):
        if field[p] == mine and kept[first, p] > UNSET:
            for j in range(row - first):
                history[j] = kept[first + j, p]
            history[BREAKS] = kept[row, p]
            lost = 1.0 if history[BREAKS] > 0.5 else damage(law, history)
            out[p] = max(out[p], lost)
