"""Faces of cracks move with the matter of their side."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import inline
from mpmcli.cracks.crossing import BITS, crosses, whole
from mpmcli.cracks.points import AllPoints
from mpmcli.cracks.sides import CrackSides

Array = np.ndarray

BESIDE = 2.0**-10
"""How far from the plane a face is when it looks at nodes [cells]."""
AVERAGE, MASS, FIXED = 0, 1, 2
WAYS = {"average": AVERAGE, "mass": MASS, "fixed": FIXED}
"""How planes move: ``moves`` of a crack."""


@inline
def sum_motion(count, candidates, entries, mass, X, L, dt, nodes, lattice, out):
    """Mass, momentum at the node and Σ S m L of each side of every crack node, into ``out`` (slots, 4, 7).

    Momenta are those of the motion of the step, to ``X`` (2, N): the velocities that FLIP carries may differ from it.
    """
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
            was_x, was_y = candidates.place[q, 0], candidates.place[q, 1]
            dx, dy = x - was_x, y - was_y
            total[0] += w
            total[1] += w * ((X[0, p] - was_x) / dt + L[0, p] * dx + L[1, p] * dy)
            total[2] += w * ((X[1, p] - was_y) / dt + L[2, p] * dx + L[3, p] * dy)
            for a in range(4):
                total[3 + a] += w * L[a, p]


@compiled_too
def sides_at(px, py, x, y, cell, segments, table, crack):
    """Side of a node (x, y), whose cracks are ``crack`` (2,), on which a point is; ``cell`` of the hash is near.

    −1 where a crack parts the point from a node that has no cracks: its matter is none of the point's.
    """
    if cell < 0:  # no crack is near
        return 0
    side, at = 0, table.first[cell]
    while at < table.first[cell + 1]:
        which, times = segments.crack[table.segment[at]], 0
        while at < table.first[cell + 1] and segments.crack[table.segment[at]] == which:
            s = table.segment[at]
            at += 1
            if crosses(segments.ax[s], segments.ay[s], segments.bx[s], segments.by[s], px, py, x, y):
                times += 1
        if times % 2 == 1:
            if crack[0] < 0:
                return -1
            side += 1 if which == crack[0] else (2 if which == crack[1] else 0)
    return side


@compiled_too
def face_velocity(plane, normal, face, sums, nodes, segments, table, lattice, out):
    """Velocity of a point ``face`` (2,) of a face into ``out`` (2,); returns the mass that it comes from, 0 if none.

    It is the mean of what the sides of the four nodes around tell of the point, from their
    velocities and gradients: exact for affine motion, whichever nodes there are. ``plane`` (2,) is the point of the
    plane beside it, ``normal`` (2,) points from the plane to the face.
    """
    # it looks from its own side of the plane, wherever the faces have gone
    tiny_x, tiny_y = BESIDE * lattice.cell[0] * normal[0], BESIDE * lattice.cell[1] * normal[1]
    away = (face[0] - plane[0]) * normal[0] + (face[1] - plane[1]) * normal[1]
    back = min(away, 0.0)
    x, y = face[0] - back * normal[0] + tiny_x, face[1] - back * normal[1] + tiny_y
    cx = np.int64(np.floor((face[0] - lattice.origin[0]) / lattice.cell[0]))
    cy = np.int64(np.floor((face[1] - lattice.origin[1]) / lattice.cell[1]))
    out[0] = out[1] = 0.0
    row, column, cell = cy - table.low[1], cx - table.low[0], np.int64(-1)
    if row >= 0 and column >= 0 and row < table.place.shape[0] and column < table.place.shape[1]:
        cell = np.int64(table.place[row, column])
    px = whole(x, lattice.origin[0], 1.0 / lattice.cell[0])
    py = whole(y, lattice.origin[1], 1.0 / lattice.cell[1])
    total, mass = 0.0, 0.0
    for turn in range(2):  # crack nodes first: then others, which see matter of one face alone
        for j in range(4):
            nx, ny = cx + j % 2, cy + j // 2
            if nx < 0 or ny < 0 or nx >= lattice.shape[0] or ny >= lattice.shape[1]:
                continue
            slot = nodes.slot_of_node[ny * lattice.shape[0] + nx]
            if slot < 0 or (turn == 0 and nodes.crack[slot, 0] < 0):
                continue
            side = sides_at(px, py, nx << BITS, ny << BITS, cell, segments, table, nodes.crack[slot])
            if side < 0:
                continue
            here = sums[slot, side]
            m = here[0]
            if m <= 0.0:
                continue
            dx = face[0] - lattice.origin[0] - nx * lattice.cell[0]
            dy = face[1] - lattice.origin[1] - ny * lattice.cell[1]
            N = max(1.0 - abs(dx) / lattice.cell[0], 0.0) * max(1.0 - abs(dy) / lattice.cell[1], 0.0)
            out[0] += N * (here[1] + here[3] * dx + here[4] * dy) / m
            out[1] += N * (here[2] + here[5] * dx + here[6] * dy) / m
            mass += N * m
            total += N
        if total > 0.0:
            break
    for a in range(2):
        out[a] = out[a] / total if total > 0.0 else 0.0
    return mass


@compiled_too
def move_point(k, before, end, at_tip, way, dt, points, sums, nodes, segments, table, lattice, new):
    """Move point ``k`` of a chain for a step; returns how far a face went [cells].

    ``before`` (2,) is where the one before it was, ``end`` the end of the chain, ``new`` (2, 2) scratch.
    """
    after = min(k + 1, end - 1)
    tx, ty = points.X[0, after] - before[0], points.X[1, after] - before[1]
    size = math.sqrt(tx * tx + ty * ty)
    plane = (points.X[0, k], points.X[1, k])
    left = (-ty / size, tx / size)
    above = face_velocity(
        plane,
        left,
        (points.faces[0, 0, k], points.faces[0, 1, k]),
        sums,
        nodes,
        segments,
        table,
        lattice,
        new[0],
    )
    below = face_velocity(
        plane, (-left[0], -left[1]), (points.faces[1, 0, k], points.faces[1, 1, k]), sums, nodes, segments, table,
        lattice, new[1],
    )  # fmt: skip
    for a in range(2):  # a side without matter follows the other
        if above == 0.0:
            new[0, a] = new[1, a]
        elif below == 0.0:
            new[1, a] = new[0, a]
    farthest = 0.0
    for a in range(2):
        common = (above * new[0, a] + below * new[1, a]) / max(above + below, 1e-300)
        if at_tip:  # faces part behind a tip, not at it
            new[0, a] = new[1, a] = common
        for face in range(2):
            step = dt * new[face, a]
            if not abs(step) / lattice.cell[a] <= farthest:
                farthest = abs(step) / lattice.cell[a]
            points.faces[face, a, k] += step
            points.velocity[face, a, k] = new[face, a]
        if way == AVERAGE:
            points.X[a, k] = 0.5 * (points.faces[0, a, k] + points.faces[1, a, k])
        elif way == MASS:
            points.X[a, k] += common * dt
    return farthest


@inline
def move_points(
    count,
    candidates,
    entries,
    mass,
    X,
    L,
    nodes,
    segments,
    table,
    lattice,
    ways,
    dt,
    points,
    sums,
    new,
    worst,
):
    """Move all points for a step; returns how far a face went [cells].

    ``new`` (2, 2) is scratch, ``worst`` (2,) receives the crack and the point that went farthest. A distance that is
    no number counts as the farthest.
    """
    sum_motion(count, candidates, entries, mass, X, L, dt, nodes, lattice, sums)
    farthest = 0.0
    for crack in range(len(points.first) - 1):
        begin, end = points.first[crack], points.first[crack + 1]
        before = (points.X[0, begin], points.X[1, begin])
        for k in range(begin, end):
            here = (points.X[0, k], points.X[1, k])
            at_tip = (k == begin and points.tips[crack, 0]) or (k == end - 1 and points.tips[crack, 1])
            went = move_point(
                k, before, end, at_tip, ways[crack], dt, points, sums, nodes, segments, table, lattice, new
            )
            before = here
            if not went <= farthest:
                farthest = went
                worst[0], worst[1] = crack, k - begin
    return farthest


class FaceMotion:
    """Moves the faces of all cracks, and the planes between them.

    Parameters
    ----------
    sides : of the step
    points : of all chains
    lattice : of the grid
    moves : how the plane of each crack moves: ``average``, ``mass`` or ``fixed``
    """

    def __init__(self, sides: CrackSides, points: AllPoints, lattice: Any, moves: list[str]):
        self._sides, self._points, self._lattice = sides, points, lattice
        self._ways = np.array([WAYS[way] for way in moves], dtype=np.int64)
        self._sums = np.zeros((0, 4, 7))
        self._new = np.zeros((2, 2))
        self._worst = np.zeros(2, dtype=np.int64)

    def move(self, p: Any, X: Array, dt: float) -> tuple[float, int, int]:
        """Move all chains by a step, after which the particles ``p`` are at ``X`` (2, N).

        Returns the farthest that a face went [cells], and the crack and the point that did.
        """
        sides = self._sides
        if len(self._sums) < sides.listed:
            self._sums = np.zeros((2 * sides.listed, 4, 7))
        farthest = move_points(
            sides.listed, sides.candidates, sides.entries, p.mass, X, p.L, sides.nodes, sides.segments, sides.hash,
            self._lattice, self._ways, dt, self._points.get(), self._sums, self._new, self._worst,
        )  # fmt: skip
        crack, point = self._worst.tolist()
        return float(farthest), crack, point
