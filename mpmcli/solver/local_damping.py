"""Local damping of a scene: its force at all nodes, and the energy that it takes from matter."""

import numpy as np

from mpmcli.boundary.grid_conditions import GridConditions
from mpmcli.boundary.rigid import RigidBodies
from mpmcli.core.chunks import CHUNKS
from mpmcli.core.grid import Grid
from mpmcli.core.transfer.local_damping import damp_locally, drag_at_nodes

Array = np.ndarray


class LocalDamping:
    """Forces against the velocity of nodes, by a share of their unbalanced force.

    Reactions balance the forces along held directions, which have no part in it. Nor has contact: the velocity fields
    and sides of one node are damped as one body, on which their contact forces cancel, and nodes with a rigid body or
    with friction on a plane are not damped, because reactions are not known yet.

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
        self._version = -1
        self._together = np.zeros(0, dtype=np.int64)

    def add(
        self, factor: float, rate: float, dt: float, grid: Grid, conditions: GridConditions | None,
        rigid: RigidBodies | None, parallel: bool,
    ) -> None:  # fmt: skip
        """Add the forces; ``factor`` is the share, ``rate`` that of grid damping, which acts afterwards."""
        mp, f = grid.mp, grid.f
        nodes, share, free_mp, free_f = _special_nodes(grid, self._several(grid), conditions, rigid)
        _, all_taken = drag_at_nodes(mp[nodes], f[nodes], factor, rate, dt, self._least)
        one, whole_mp, whole_f = _as_one(grid.node_of(nodes), free_mp, free_f)
        drag, taken = drag_at_nodes(whole_mp, whole_f, factor, rate, dt, self._least)
        part = np.divide(free_mp[:, 0], whole_mp[one, 0], out=np.zeros(len(nodes)), where=free_mp[:, 0] > 0.0)
        taken = part * taken[one]
        new = f[nodes] - part[:, None] * drag[one]
        self._factor[0] = factor
        damp_locally[parallel](
            grid.active, grid.active_chunks, mp, f, self._factor, rate, dt, self._least, self.taken
        )
        f[nodes] = new
        self.taken[0] += float((share * taken - all_taken).sum())

    def _several(self, grid: Grid) -> Array:
        """Return the degrees of freedom (n,) of nodes with several velocity fields or sides."""
        if grid.active_version != self._version:
            self._version, dofs = grid.active_version, grid.active
            if grid.fields * grid.sides > 1:
                _, which, count = np.unique(grid.node_of(dofs), return_inverse=True, return_counts=True)
                self._together = dofs[count[which] > 1]
        return self._together


def _as_one(node: Array, mp: Array, f: Array) -> tuple[Array, Array, Array]:
    """Return which row (n,) of the others is whose, then sums (k, 1 + d) and (k, d) of rows of the same node."""
    different, one = np.unique(node, return_inverse=True)
    whole_mp, whole_f = (np.zeros((len(different), a.shape[1])) for a in (mp, f))
    np.add.at(whole_mp, one, mp)
    np.add.at(whole_f, one, f)
    return one, whole_mp, whole_f


def _special_nodes(
    grid: Grid, several: Array, conditions: GridConditions | None, rigid: RigidBodies | None
) -> tuple[Array, Array, Array, Array]:
    """``several`` nodes, held ones, those that images share, and those of rigid bodies, (n,) degrees of freedom.

    Then the share (n,) of each that is matter which may lose energy, and mass and momentum (n, 1 + d) and forces
    (n, d) without held components, and without anything where nothing is damped.
    """
    mp, f = grid.mp, grid.f
    found = [several]
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
        for friction in conditions.friction.values():
            at = np.searchsorted(nodes, friction.nodes)
            free_mp[at, 1:], free_f[at] = 0.0, 0.0
    if rigid is not None:
        node = grid.node_of(nodes)
        theirs = grid.node_of(rigid.dofs[mp[rigid.dofs, 0] > 0.0])
        meets_rigid = np.isin(node, theirs)
        free_mp[meets_rigid, 1:], free_f[meets_rigid] = 0.0, 0.0
    return nodes, share, free_mp, free_f
