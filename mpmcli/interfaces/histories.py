"""Where particles remember the interfaces that they belong to, and which were bonded at the start."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.contact.choice import ContactChoice
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.interfaces.base import OPENINGS
from mpmcli.interfaces.memory import UNSET
from mpmcli.interfaces.touch import gaps_at_nodes, with_images

Array = np.ndarray


def start_histories(choice: ContactChoice, particles: Particles, half: Array, grid: Grid) -> Array:
    """Give the particles their histories: those of every interface that was bonded, where it was, know no opening.

    That is one number per interface, or three where its law depends on the openings of the past.

    ``half`` (d, N) are half sizes of the boxes around the particles [length].

    Returns
    -------
    rows : (fields, fields) row of a pair's history on particles of the first field that tells whether it is broken,
        −1 where it has none; where the law keeps openings, they have the rows before it
    """
    laws, table = choice.laws, choice.table
    pairs = [(a, b) for a, b in np.argwhere(table >= 0).tolist() if laws[table[a, b]].is_interface]
    rows = np.full(table.shape, -1, dtype=np.int64)
    numbers = {(a, b): OPENINGS * laws[table[a, b]].keeps_history + 1 for a, b in pairs}
    for a, b in pairs:
        rows[a, b] = rows[a].max() + numbers[a, b]
    if particles.interface is None:
        kept = np.full((int(rows.max()) + 1, particles.count), UNSET)
        for a, b in pairs:
            if a < b:
                found = bonded_particles(choice, particles, half, grid, (a, b))
                for mine, other in ((a, b), (b, a)):
                    its = found[particles.velocity_field[found] == mine]
                    last = rows[mine, other]
                    kept[last + 1 - numbers[mine, other] : last + 1, its] = 0.0
        particles.interface = kept
    return rows


def bonded_particles(
    choice: ContactChoice, particles: Particles, half: Array, grid: Grid, pair: tuple[int, int]
) -> Array:
    """Return the particles of two fields nearest to nodes at which these are bonded at the start."""
    p, shape = particles, tuple(grid.cells + 1)
    law, widest = choice.laws[choice.table[pair]], choice.model.interface.initial_gap
    near = with_images(
        p.X, half, p.velocity_field, grid.lower, grid.upper, grid.periodic, (2.0 + widest) * grid.cell
    )
    nodes, gaps = gaps_at_nodes(*near, pair, grid.lower, grid.cell, shape, within=widest)
    bonded = nodes[np.isfinite(gaps) & is_bonded(law, nodes, grid.lower, grid.cell, shape, grid.periodic)]
    index = np.rint((p.X - grid.lower[:, None]) / grid.cell[:, None]).astype(np.int64)
    nearest = np.cumprod([1, *shape[:-1]]) @ index
    return np.flatnonzero(np.isin(nearest, bonded) & np.isin(p.velocity_field, pair))


def is_bonded(
    law: Any, nodes: Array, lower: Array, cell: Array, shape: tuple[int, ...], periodic: Sequence[int] = ()
) -> Array:
    """(n,) whether a law bonds its sides at these nodes of a grid, the first axis fastest, if they touch there.

    Nodes at the upper side of a periodic axis are those at its lower side.
    """
    if law.bonded is None:
        return np.ones(len(nodes), dtype=bool)
    index = np.array(np.unravel_index(nodes, shape, order="F"))
    for a in periodic:
        index[a] %= shape[a] - 1
    place = lower[:, None] + cell[:, None] * index
    found: Array = np.broadcast_to(law.bonded(*place), len(nodes)) > 0.0
    return found
