"""Faces of cracks move with the matter of their side."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import inline
from mpmcli.cracks.crossing import BITS, crosses, whole
from mpmcli.cracks.sides import CrackSides

Array = np.ndarray

BESIDE = 1 << (BITS - 10)
"""How far from the plane a face sees: a thousandth of a cell, in units of positions."""
ABOVE, BELOW = 0, 1


@inline
def sum_motion(count, candidates, entries, mass, X, V, L, nodes, lattice, out):
    """Mass, momentum at the node and Σ S m L of each side of every crack node, into ``out`` (slots, 4, 7)."""
    for slot in range(count):
        for side in range(out.shape[1]):
            for a in range(7):
                out[slot, side, a] = 0.0
        x = lattice.origin[0] + nodes.node[slot] % lattice.shape[0] * lattice.cell[0]
        y = lattice.origin[1] + nodes.node[slot] // lattice.shape[0] * lattice.cell[1]
        for at in range(entries.first[slot], entries.first[slot + 1]):
            q, j = entries.row[at], entries.column[at]
            p = candidates.particle[q]
            w, total = candidates.S[q, j] * mass[p], out[slot, candidates.side[q, j]]
            dx, dy = x - X[0, p], y - X[1, p]
            total[0] += w
            total[1] += w * (V[0, p] + L[0, p] * dx + L[1, p] * dy)
            total[2] += w * (V[1, p] + L[2, p] * dx + L[3, p] * dy)
            for a in range(4):
                total[3 + a] += w * L[a, p]


@inline
def sides_at(px, py, x, y, cell, segments, table, crack):
    """Side of a node (x, y), whose cracks are ``crack`` (2,), on which a point is; ``cell`` of the hash is near."""
    side, at = 0, table.first[cell]
    while at < table.first[cell + 1]:
        which, times = segments.crack[table.segment[at]], 0
        while at < table.first[cell + 1] and segments.crack[table.segment[at]] == which:
            s = table.segment[at]
            at += 1
            if crosses(segments.ax[s], segments.ay[s], segments.bx[s], segments.by[s], px, py, x, y):
                times += 1
        if times % 2 == 1:
            side += 1 if which == crack[0] else (2 if which == crack[1] else 0)
    return side


@inline
def face_velocities(plane, normal, faces, sums, nodes, segments, table, lattice, out):
    """Velocities of the faces at the points of a chain into ``out`` (2, 2, P), and masses that gave them (2, P).

    Each is the mean of what the sides of the four nodes around tell of the point, from their velocities and gradients:
    exact for affine motion, whichever nodes there are. ``plane`` (2, P) are the points of the plane, ``normal`` (2, P)
    its normals from below to above, ``faces`` (2, 2, P).
    """
    velocity, mass = out
    for k in range(plane.shape[1]):
        cx = np.int64(np.floor((plane[0, k] - lattice.origin[0]) / lattice.cell[0]))
        cy = np.int64(np.floor((plane[1, k] - lattice.origin[1]) / lattice.cell[1]))
        row, column = cy - table.low[1], cx - table.low[0]
        for face in range(2):
            for a in range(2):
                velocity[face, a, k] = 0.0
            mass[face, k] = 0.0
        if row < 0 or column < 0 or row >= table.place.shape[0] or column >= table.place.shape[1]:
            continue
        cell = table.place[row, column]
        if cell < 0:
            continue
        for face in range(2):
            sign = 1.0 if face == ABOVE else -1.0
            px = whole(plane[0, k], lattice.origin[0], 1.0 / lattice.cell[0])
            py = whole(plane[1, k], lattice.origin[1], 1.0 / lattice.cell[1])
            px += np.int64(sign * BESIDE * normal[0, k])
            py += np.int64(sign * BESIDE * normal[1, k])
            total = 0.0
            for j in range(4):
                nx, ny = cx + j % 2, cy + j // 2
                slot = nodes.slot_of_node[ny * lattice.shape[0] + nx]
                if slot < 0:
                    continue
                side = sides_at(px, py, nx << BITS, ny << BITS, cell, segments, table, nodes.crack[slot])
                m = sums[slot, side, 0]
                if m <= 0.0:
                    continue
                dx = faces[face, 0, k] - lattice.origin[0] - nx * lattice.cell[0]
                dy = faces[face, 1, k] - lattice.origin[1] - ny * lattice.cell[1]
                N = max(1.0 - abs(dx) / lattice.cell[0], 0.0) * max(1.0 - abs(dy) / lattice.cell[1], 0.0)
                here = sums[slot, side]
                velocity[face, 0, k] += N * (here[1] + here[3] * dx + here[4] * dy) / m
                velocity[face, 1, k] += N * (here[2] + here[5] * dx + here[6] * dy) / m
                mass[face, k] += N * m
                total += N
            for a in range(2):
                if total > 0.0:
                    velocity[face, a, k] /= total


class FaceMotion:
    """Moves the faces of all cracks, and the planes between them.

    Parameters
    ----------
    sides : of the step
    lattice : of the grid
    moves : how the plane of each crack moves: ``average``, ``mass`` or ``fixed``
    """

    def __init__(self, sides: CrackSides, lattice: Any, moves: list[str]):
        self._sides, self._lattice, self._moves = sides, lattice, moves
        self._sums = np.zeros((0, 4, 7))

    def move(self, p: Any, X: Array, dt: float) -> tuple[float, int, int]:
        """Move all chains by a step, with particles ``p`` that are at ``X`` (2, N) and have velocities of its end.

        Returns the farthest that a face went [cells], and the crack and the point that did.
        """
        sides = self._sides
        if len(self._sums) < sides.count:
            self._sums = np.zeros((2 * sides.count, 4, 7))
        sum_motion(
            sides.count,
            sides.candidates,
            sides.entries,
            p.mass,
            X,
            p.V,
            p.L,
            sides.nodes,
            self._lattice,
            self._sums,
        )
        farthest = (0.0, 0, 0)
        cell = np.array(self._lattice.cell)[:, None]
        for chain, way in zip(sides.chains, self._moves, strict=True):
            tangent = chain.tangents()
            normal = np.stack([-tangent[1], tangent[0]])
            new, mass = np.zeros_like(chain.velocity), np.zeros((2, chain.count))
            face_velocities(
                chain.X, normal, chain.faces, self._sums, sides.nodes, sides.segments, sides.hash, self._lattice,
                (new, mass),
            )  # fmt: skip
            for mine, other in ((ABOVE, BELOW), (BELOW, ABOVE)):  # a side without matter follows the other
                alone = (mass[mine] == 0.0) & (mass[other] > 0.0)
                new[mine][:, alone] = new[other][:, alone]
            whole_mass = np.maximum(mass.sum(axis=0), np.finfo(float).tiny)
            common = (mass[:, None] * new).sum(axis=0) / whole_mass
            for end, is_tip in zip((0, -1), chain.tips, strict=True):  # faces part behind a tip, not at it
                if is_tip:
                    new[:, :, end] = common[:, end]
            step = 0.5 * dt * (new + chain.velocity)
            went = np.abs(step / cell).max(axis=(0, 1))
            if went.max() > farthest[0]:
                farthest = float(went.max()), chain.index, int(went.argmax())
            chain.faces += step
            chain.velocity = new
            if way == "average":
                chain.X = chain.faces.mean(axis=0)
            elif way == "mass":
                chain.X = chain.X + common * dt
        return farthest
