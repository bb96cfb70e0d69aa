"""Where particles remember the interfaces that they belong to, and which were not bonded at the start."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcli.contact.choice import ContactChoice
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.interfaces.base import BREAKS, HISTORY
from mpmcli.interfaces.jump import UNSET
from mpmcli.interfaces.touch import gaps_at_nodes

Array = np.ndarray


def start_histories(choice: ContactChoice, particles: Particles, half: Array, grid: Grid) -> Array:
    """Give the particles their histories, if a law has some or an interface is not bonded everywhere.

    ``half`` (d, N) are half sizes of the boxes around the particles [length].

    Returns
    -------
    rows : (fields, fields) first row of a pair's history on particles of the first field, −1 where it has none
    """
    laws, table = choice.laws, choice.table
    pairs = [(a, b) for a, b in np.argwhere(table >= 0).tolist() if laws[table[a, b]].is_interface]
    apart = {(a, b): particles_apart(choice, particles, half, grid, (a, b)) for a, b in pairs if a < b}
    some_apart = any(len(found) for found in apart.values()) or particles.interface is not None
    rows = np.full(table.shape, -1, dtype=np.int64)
    for a, b in pairs:
        if some_apart or laws[table[a, b]].keeps_history:
            rows[a, b] = HISTORY * np.count_nonzero(rows[a] >= 0)
    if (rows >= 0).any() and particles.interface is None:
        kept = np.full((int(rows.max()) + HISTORY, particles.count), UNSET)
        kept[BREAKS::HISTORY] = 0.0
        for (a, b), found in apart.items():
            for mine, other in ((a, b), (b, a)):
                its = found[particles.velocity_field[found] == mine]
                row = rows[mine, other]
                kept[row : row + HISTORY, its] = 0.0
                kept[row + BREAKS, its] = 1.0
        particles.interface = kept
    return rows


def particles_apart(
    choice: ContactChoice, particles: Particles, half: Array, grid: Grid, pair: tuple[int, int]
) -> Array:
    """Return the particles of two fields nearest to nodes at which these are not bonded at the start."""
    p, shape = particles, tuple(grid.cells + 1)
    law, widest = choice.laws[choice.table[pair]], choice.model.interface.initial_gap
    nodes, gaps = gaps_at_nodes(
        p.X, half, p.velocity_field, pair, grid.lower, grid.cell, shape, within=widest
    )
    apart = nodes[~(np.isfinite(gaps) & is_bonded(law, nodes, grid.lower, grid.cell, shape))]
    if len(apart) == 0:
        return apart
    index = np.rint((p.X - grid.lower[:, None]) / grid.cell[:, None]).astype(np.int64)
    nearest = np.cumprod([1, *shape[:-1]]) @ index
    return np.flatnonzero(np.isin(nearest, apart) & np.isin(p.velocity_field, pair))


def is_bonded(law: Any, nodes: Array, lower: Array, cell: Array, shape: tuple[int, ...]) -> Array:
    """(n,) whether a law bonds its sides at these nodes of a grid, the first axis fastest, if they touch there."""
    if law.bonded is None:
        return np.ones(len(nodes), dtype=bool)
    place = lower[:, None] + cell[:, None] * np.array(np.unravel_index(nodes, shape, order="F"))
    found: Array = np.broadcast_to(law.bonded(*place), len(nodes)) > 0.0
    return found
