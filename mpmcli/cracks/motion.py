"""Faces of cracks move with the matter of their side."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mpmcli.contact.laws.impulse import TINIEST
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import inline
from mpmcli.cracks.chain import VISIBLE
from mpmcli.cracks.crossing import BITS, crosses, whole
from mpmcli.cracks.points import AllPoints
from mpmcli.cracks.sides import CrackSides

Array = np.ndarray

BESIDE = 2.0**-10
"""How far from the plane a face is when it looks at nodes [cells]."""
AVERAGE, MASS, FIXED = 0, 1, 2
SHARPEST, LONGEST, SHORTEST, OUTSIDE = 0, 1, 2, 3
"""Places in ``FaceMotion.found``."""
WAYS = {"average": AVERAGE, "mass": MASS, "fixed": FIXED}
"""How planes move: ``moves`` of a crack."""


@inline
def sum_motion(count, candidates, entries, mass, X, L, dt, nodes, lattice, out):
    """Mass, momentum at the node and Σ S m L of each side of every crack node, into ``out`` (slots, sides, 7).

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
    """Velocity and spin of a point ``face`` (2,) of a face into ``out`` (3,); returns the mass of its matter.

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
    out[0] = out[1] = out[2] = 0.0
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
            out[2] += 0.5 * N * (here[5] - here[4]) / m
            mass += N * m
            total += N
        if total > 0.0:
            break
    for a in range(3):
        out[a] = out[a] / total if total > 0.0 else 0.0
    return mass


@compiled_too
def move_point(k, before, end, at_tip, way, dt, points, sums, nodes, segments, table, lattice, new):
    """Move point ``k`` of a chain with the matter of its sides; returns how far a face went [cells], −1 without matter.

    ``before`` (2,) is where the one before it was, ``end`` the end of the chain. ``new`` (2, 3) receives velocities and
    spins of the faces.
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
    if above == 0.0 and below == 0.0:
        return -1.0
    for a in range(3):  # a side without matter follows the other
        if above == 0.0:
            new[0, a] = new[1, a]
        elif below == 0.0:
            new[1, a] = new[0, a]
    return move_faces(k, at_tip, way, above, below, dt, points, lattice, new)


@compiled_too
def move_faces(k, at_tip, way, above, below, dt, points, lattice, new):
    """Move point ``k`` with the velocities ``new`` (2, 3) of its faces; returns how far a face went [cells].

    ``above`` and ``below`` are the weights of the faces in the velocity that both have in common.
    """
    farthest = 0.0
    for a in range(2):
        common = (above * new[0, a] + below * new[1, a]) / (above + below)
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


@compiled_too
def follow(k, begin, end, at_tip, way, dt, points, lattice, matter, spin, new):
    """Move point ``k``, which has no matter, with its neighbours that have some; returns how far a face went [cells].

    Between two of them it keeps its place; beyond the last one it moves with that as one rigid body, so that what lies
    outside of the matter has neither stretch nor bend. A chain without any matter stays. ``matter`` (n,) tells which
    points have some, ``spin`` (2, n) how their faces turn.
    """
    first, last = k, k
    while first >= begin and not matter[first]:
        first -= 1
    while last < end and not matter[last]:
        last += 1
    if first < begin and last == end:
        return 0.0
    for face in range(2):
        if first >= begin and last < end:
            for a in range(2):
                v = points.velocity[face, a]
                new[face, a] = ((last - k) * v[first] + (k - first) * v[last]) / (last - first)
        else:
            by = first if first >= begin else last
            v, turn = points.velocity[face, :, by], spin[face, by]
            x = points.faces[face, 0, k] - (points.faces[face, 0, by] - dt * v[0])
            y = points.faces[face, 1, k] - (points.faces[face, 1, by] - dt * v[1])
            new[face, 0], new[face, 1] = v[0] - turn * y, v[1] + turn * x
    return move_faces(k, at_tip, way, 1.0, 1.0, dt, points, lattice, new)


@compiled_too
def part(k, begin, end, points):
    """Put the faces of point ``k`` that have passed the plane back onto it, along its normal."""
    before, after = max(k - 1, begin), min(k + 1, end - 1)
    tx, ty = points.X[0, after] - points.X[0, before], points.X[1, after] - points.X[1, before]
    size = math.sqrt(tx * tx + ty * ty)
    for face in range(2):
        sign = 1.0 if face == 0 else -1.0
        nx, ny = -sign * ty / size, sign * tx / size
        away = (points.faces[face, 0, k] - points.X[0, k]) * nx + (
            points.faces[face, 1, k] - points.X[1, k]
        ) * ny
        if away < 0.0:
            points.faces[face, 0, k] -= away * nx
            points.faces[face, 1, k] -= away * ny


@compiled_too
def watch(begin, end, bounds, visible, points, found):
    """Tell the state of the plane of a chain, into ``found`` (4,), as ``FaceMotion.found`` has it.

    Turns beside segments shorter than ``visible`` do not count.
    """
    found[SHARPEST], found[LONGEST], found[SHORTEST], found[OUTSIDE] = 1.0, 0.0, np.inf, 0.0
    before_x, before_y = 0.0, 0.0
    for k in range(begin, end):
        x, y = points.X[0, k], points.X[1, k]
        if not (bounds[0, 0] <= x <= bounds[0, 1] and bounds[1, 0] <= y <= bounds[1, 1]):
            found[OUTSIDE] += 1.0
        if k == end - 1:
            break
        way_x, way_y = points.X[0, k + 1] - x, points.X[1, k + 1] - y
        length = math.sqrt(way_x * way_x + way_y * way_y)
        found[LONGEST] = max(found[LONGEST], length / points.longest[k])
        found[SHORTEST] = min(found[SHORTEST], (length + TINIEST) / (points.shortest[k] + TINIEST))
        scale = 1.0 / length if length > 0.0 and length >= visible else 0.0
        way_x, way_y = way_x * scale, way_y * scale
        found[SHARPEST] = min(found[SHARPEST], before_x * way_x + before_y * way_y)
        before_x, before_y = way_x, way_y


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
    apart,
    bounds,
    dt,
    points,
    sums,
    new,
    matter,
    spin,
    found,
    worst,
):
    """Move all points for a step; returns how far a face went [cells].

    ``new`` (2, 3), ``matter`` (n,) and ``spin`` (2, n) are scratch, ``worst`` (2,) receives the crack and the point
    that went farthest, ``found`` (cracks, 4) what ``watch`` tells. A distance that is no number counts as the farthest.
    """
    sum_motion(count, candidates, entries, mass, X, L, dt, nodes, lattice, sums)
    farthest = 0.0
    for crack in range(len(points.first) - 1):
        begin, end = points.first[crack], points.first[crack + 1]
        before, alone = (points.X[0, begin], points.X[1, begin]), False
        for turn in range(2):  # those with matter first
            if turn == 1 and not alone:
                break
            for k in range(begin, end):
                at_tip = (k == begin and points.tips[crack, 0]) or (k == end - 1 and points.tips[crack, 1])
                if turn == 0:
                    here = (points.X[0, k], points.X[1, k])
                    went = move_point(
                        k,
                        before,
                        end,
                        at_tip,
                        ways[crack],
                        dt,
                        points,
                        sums,
                        nodes,
                        segments,
                        table,
                        lattice,
                        new,
                    )
                    before = here
                    matter[k] = not went < 0.0
                    spin[0, k], spin[1, k] = new[0, 2], new[1, 2]
                    alone = alone or not matter[k]
                elif matter[k]:
                    continue
                else:
                    went = follow(k, begin, end, at_tip, ways[crack], dt, points, lattice, matter, spin, new)
                if not went <= farthest:
                    farthest = went
                    worst[0], worst[1] = crack, k - begin
        if apart[crack]:
            for k in range(begin, end):
                part(k, begin, end, points)
        watch(begin, end, bounds, VISIBLE * min(lattice.cell[0], lattice.cell[1]), points, found[crack])
    return farthest


class FaceMotion:
    """Moves the faces of all cracks, and the planes between them.

    Parameters
    ----------
    sides : of the step
    points : of all chains
    lattice : of the grid
    moves : how the plane of each crack moves: ``average``, ``mass`` or ``fixed``
    apart : whether faces of each crack that pass the plane are put back onto it
    bounds : (2, 2) first and last coordinate that points may have along each axis [length]

    Attributes
    ----------
    found : (cracks, 4) after a step: cosine of the sharpest turn of the plane (``SHARPEST``), largest length of a
        segment over the longest that it may have (``LONGEST``), smallest over the shortest (``SHORTEST``), points
        outside of the bounds (``OUTSIDE``)
    """

    def __init__(
        self, sides: CrackSides, points: AllPoints, lattice: Any, moves: list[str], apart: list[bool], bounds: Array
    ):  # fmt: skip
        self._sides, self._points, self._lattice = sides, points, lattice
        self._ways = np.array([WAYS[way] for way in moves], dtype=np.int64)
        self._apart, self.bounds = np.array(apart), bounds
        self._sums = np.zeros((0, 2 if len(moves) == 1 else 4, 7))
        self._new = np.zeros((2, 3))
        self._matter, self._spin = np.zeros(0, dtype=np.bool_), np.zeros((2, 0))
        self._worst = np.zeros(2, dtype=np.int64)
        self.found = np.zeros((len(moves), 4))

    def move(self, p: Any, X: Array, dt: float) -> tuple[float, int, int]:
        """Move all chains by a step, after which the particles ``p`` are at ``X`` (2, N).

        Returns the farthest that a face went [cells], and the crack and the point that did.
        """
        sides, points = self._sides, self._points.get()
        if len(self._sums) < sides.listed:
            self._sums = np.zeros((sides.listed + sides.listed // 4, *self._sums.shape[1:]))
        if len(self._matter) != points.X.shape[1]:
            self._matter, self._spin = np.zeros(points.X.shape[1], dtype=np.bool_), np.zeros_like(points.X)
        farthest = move_points(
            sides.listed, sides.candidates, sides.entries, p.mass, X, p.L, sides.nodes, sides.segments, sides.hash,
            self._lattice, self._ways, self._apart, self.bounds, dt, points, self._sums, self._new, self._matter,
            self._spin, self.found, self._worst,
        )  # fmt: skip
        crack, point = self._worst.tolist()
        return float(farthest), crack, point
