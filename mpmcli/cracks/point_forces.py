"""Forces on the points of chains, as forces on the matter of either side."""

from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.kernel import called_once
from mpmcli.core.dofs import dof_of
from mpmcli.core.grid import Grid
from mpmcli.cracks.chain import ABOVE, Chain
from mpmcli.cracks.crossing import BITS, UNIT, cell_of, list_near, whole
from mpmcli.cracks.motion import BESIDE, side_seen
from mpmcli.cracks.sides import CrackSides

Array = np.ndarray

CORNERS = 4
"""Nodes around a point."""


class ForceRows(NamedTuple):
    """Forces on degrees of freedom, one each per point of a chain, face, node around it and field, (n,) or (n, 2).

    dof : −1 where there is no matter
    force : [force], per radian in axisymmetric analyses
    """

    dof: Array
    force: Array


@called_once
def share_out(
    plane, normal, faces, force, nodes, segments, table, near, lattice, rigid, node_count, mp, rows
):
    """Write the forces (2, 2, P) on both faces of a chain into ``rows``: to the nodes of each side by N_i m_i.

    Returns how many faces have no matter around them. ``plane``, ``normal`` and ``faces`` as in
    ``motion.face_velocities``; masses from ``mp`` (dofs, 1 + d).
    """
    fields, points = rigid.shape[0], plane.shape[1]
    alone, at = 0, 0
    for k in range(points):
        px = np.int64(np.floor((plane[0, k] - lattice.origin[0]) / lattice.cell[0]))
        py = np.int64(np.floor((plane[1, k] - lattice.origin[1]) / lattice.cell[1]))
        cell = cell_of(table, px, py)
        for face in range(2):
            begin, total = at, 0.0
            sign = 1.0 if face == ABOVE else -1.0
            sx = whole(plane[0, k], lattice.origin[0], 1.0 / lattice.cell[0]) + np.int64(
                sign * BESIDE * UNIT * normal[0, k]
            )
            sy = whole(plane[1, k], lattice.origin[1], 1.0 / lattice.cell[1]) + np.int64(
                sign * BESIDE * UNIT * normal[1, k]
            )
            x = (faces[face, 0, k] - lattice.origin[0]) / lattice.cell[0]
            y = (faces[face, 1, k] - lattice.origin[1]) / lattice.cell[1]
            cx, cy = np.int64(np.floor(x)), np.int64(np.floor(y))
            count = list_near(
                segments, table, cell, sx, sy, (cx << BITS) - sx, (cy << BITS) - sy, 1, table.place, -1, near
            )  # fmt: skip
            for j in range(CORNERS):
                nx, ny = cx + j % 2, cy + j // 2
                inside = nx >= 0 and ny >= 0 and nx < lattice.shape[0] and ny < lattice.shape[1] and cell >= 0
                node = ny * lattice.shape[0] + nx
                N, side = (1.0 - abs(x - nx)) * (1.0 - abs(y - ny)), np.int64(0)
                if inside:  # the nodes around faces are listed
                    crack = nodes.crack[nodes.slot_of_node[node]]
                    side = side_seen(near, count, (nx << BITS) - sx, (ny << BITS) - sy, crack)
                    inside = side >= 0
                for field in range(fields):
                    rows.dof[at] = -1
                    rows.force[at, 0] = 0.0
                    if inside and not rigid[field]:
                        i = dof_of(node, field, side, node_count, fields)
                        if mp[i, 0] > 0.0 and N > 0.0:
                            rows.dof[at] = i
                            rows.force[at, 0] = N * mp[i, 0]
                            total += N * mp[i, 0]
                    at += 1
            if total <= 0.0:
                alone += 1
            for r in range(begin, at):
                share = rows.force[r, 0] / total if total > 0.0 else 0.0
                rows.force[r, 0], rows.force[r, 1] = share * force[face, 0, k], share * force[face, 1, k]
    return alone


class PointForces:
    """Forces on the points of one chain in a step, and the work that they do.

    Parameters
    ----------
    chain : the chain
    sides : of the step
    lattice : of the grid (``face_contacts.Lattice``)
    rigid : (fields,) whether a field belongs to a rigid body
    grid : of the simulation

    Attributes
    ----------
    force : (2, 2, P) on the matter above and below, as given last [force]
    alone : how many faces had no matter around them
    """

    def __init__(self, chain: Chain, sides: CrackSides, lattice: Any, rigid: Array, grid: Grid):
        self.chain = chain
        self._sides, self._lattice, self._rigid, self._grid = sides, lattice, rigid, grid
        self._rows = ForceRows(np.zeros(0, dtype=np.int64), np.zeros((0, 2)))
        self._dof = np.zeros(0, dtype=np.int64)
        self._force = np.zeros((0, 2))
        self.force = np.zeros((2, 2, 0))
        self.alone = 0

    def add_to(self, f: Array, force: Array) -> None:
        """Add forces (2, 2, P) on both faces to nodal forces (dofs, 2)."""
        chain, sides, grid = self.chain, self._sides, self._grid
        self.force = force
        room = 2 * CORNERS * len(self._rigid) * chain.count
        if len(self._rows.dof) < room:
            self._rows = ForceRows(np.zeros(room, dtype=np.int64), np.zeros((room, 2)))
        X, faces, force = (
            np.ascontiguousarray(array) for array in (chain.X, chain.faces, force)
        )  # whoever holds them
        self.alone = share_out(
            X, chain.normals(), faces, force, sides.nodes, sides.segments, sides.hash,
            sides.near, self._lattice, self._rigid, grid.node_count, grid.mp, self._rows,
        )  # fmt: skip
        met = np.flatnonzero(self._rows.dof[:room] >= 0)
        self._dof, self._force = self._rows.dof[met], self._rows.force[met]
        np.add.at(f, self._dof, self._force)

    def work(self, v: Array, dt: float) -> float:
        """Return the work of the step, with the mean velocity as ``Loads.work``; ``v`` (dofs, 2) are v⁺."""
        dof, grid = self._dof, self._grid
        mean = v[dof] - 0.5 * dt * grid.f[dof] / grid.mp[dof, :1]
        return dt * float((self._force * mean).sum())
