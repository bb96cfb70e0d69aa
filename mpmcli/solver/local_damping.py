"""Local damping of a scene: its force at all nodes, and the energy that it takes from matter."""

from __future__ import annotations

import numpy as np

from mpmcli.boundary.grid_conditions import GridConditions
from mpmcli.boundary.rigid import RigidBodies
from mpmcli.core.chunks import CHUNKS
from mpmcli.core.grid import Grid
from mpmcli.core.transfer.local_damping import damp_locally, drag_at_nodes

Array = np.ndarray


class LocalDamping:
    """Forces against the velocity of nodes, by a share of their unbalanced force.

    Reactions balance the forces along held directions, which have no part in it.

    Parameters
    ----------
    least_mass
        Nodes of a mass up to this one are left out.

    Attributes
    ----------
    taken : (chunks,) energy taken in the step
    """

    def __init__(self, least_mass: float) -> None:
        self._least = least_mass
        self.taken = np.zeros(CHUNKS)
        self._factor = np.zeros(1)

    def add(
        self, factor: float, rate: float, dt: float, grid: Grid, conditions: GridConditions | None,
        rigid: RigidBodies | None, parallel: bool,
    ) -> None:  # fmt: skip
        """Add the forces; ``factor`` is the share, ``rate`` that of grid damping, which acts afterwards."""
        mp, f = grid.mp, grid.f
        nodes, share, free_mp, free_f = _special_nodes(mp, f, conditions, rigid)
        _, all_taken = drag_at_nodes(mp[nodes], f[nodes], factor, rate, dt, self._least)
        drag, taken = drag_at_nodes(free_mp, free_f, factor, rate, dt, self._least)
        new = f[nodes] - drag
        self._factor[0] = factor
        damp_locally[parallel](
            grid.active, grid.active_chunks, mp, f, self._factor, rate, dt, self._least, self.taken
        )
        f[nodes] = new
        self.taken[0] += float((share * taken - all_taken).sum())


def _special_nodes(
    mp: Array, f: Array, conditions: GridConditions | None, rigid: RigidBodies | None
) -> tuple[Array, Array, Array, Array]:
    """Held nodes, nodes that images share, and nodes of rigid bodies, (n,).

    Then the share (n,) of each that is matter which may lose energy, and mass and momentum (n, 1 + d) and forces
    (n, d) without held components.
    """
    found = [np.zeros(0, dtype=np.int64)]
    if conditions is not None:
        entries = conditions.conditions.entries
        found.append(entries.node)
        if conditions.images is not None:
            images, of_images = conditions.images.mirror.shared()
            found.append(images)
    if rigid is not None:
        found.append(rigid.dofs)
    nodes = np.unique(np.concatenate(found))
    share = np.ones(len(nodes))
    free_mp, free_f = mp[nodes], f[nodes]
    if conditions is not None:
        once = ~entries.repeated
        at, e = np.searchsorted(nodes, entries.node[once]), entries.direction[once]
        for vectors in (free_mp[:, 1:], free_f):
            np.subtract.at(vectors, at, (vectors[at] * e).sum(axis=1)[:, None] * e)
        if conditions.images is not None:
            share[np.searchsorted(nodes, images)] = of_images
    if rigid is not None:
        share[np.searchsorted(nodes, rigid.dofs)] = 0.0
    return nodes, share, free_mp, free_f
