"""Faces of cracks move with the matter of their side."""

import math
from typing import Any

import numpy as np

from mpmcli.contact.laws.impulse import TINIEST
from mpmcli.core.compiled.bound import TypedCalls
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import called_once
from mpmcli.core.grid import Grid
from mpmcli.cracks.chain import FOLDED, SHRUNK, STRETCHED, VISIBLE
from mpmcli.cracks.crossing import BITS, CRACK, cell_of, crosses, list_near, whole
from mpmcli.cracks.sides import CrackSides
from mpmcli.cracks.sights import LISTED, SIGHTS

Array = np.ndarray

BESIDE = 2.0**-10
"""How far from the plane a face is when it looks at nodes [cells]."""
AVERAGE, MASS, FIXED = 0, 1, 2
SHARPEST, LONGEST, SHORTEST, OUTSIDE = 0, 1, 2, 3
"""Places in ``FaceMotion.found``."""
WAYS = {"average": AVERAGE, "mass": MASS, "fixed": FIXED}
"""How planes move: ``moves`` of a crack."""


WEIGHT, MOMENTUM, RATE = 0, 1, 3
SUMS = 7
"""Sums over the matter of a side, by column: mass, momentum at the node, Σ S m L."""


@compiled_too
def sum_motion(rows, sights, width, places, mass, X, L, dt, lattice, out):
    """Mass, momentum at the node and Σ S m L of each side of every listed node, into ``out`` (places, SUMS).

    Momenta are those of the motion of the step, to ``X`` (2, N): the velocities that FLIP carries may differ from it.
    """
    for at in range(places):
        for a in range(SUMS):
            out[at, a] = 0.0
    for row in range(rows):
        p, corner = sights.particle[row], np.int64(sights.corner[row])
        was_x, was_y = sights.place[row, 0], sights.place[row, 1]
        left = lattice.origin[0] + corner % lattice.shape[0] * lattice.cell[0] - was_x
        y = lattice.origin[1] + corner // lattice.shape[0] * lattice.cell[1] - was_y
        vx, vy = (X[0, p] - was_x) / dt, (X[1, p] - was_y) / dt
        xx, xy, yx, yy = L[0, p], L[1, p], L[2, p], L[3, p]
        m, x, j, end_of_line = mass[p], left, 0, width
        for e in range(sights.first[row], sights.first[row + 1]):
            while j < sights.column[e]:
                j += 1
                x += lattice.cell[0]
                if j == end_of_line:
                    x, end_of_line = left, end_of_line + width
                    y += lattice.cell[1]
            w, total = sights.S[e] * m, out[sights.at[e]]
            total[WEIGHT] += w
            total[MOMENTUM] += w * (vx + xx * x + xy * y)
            total[MOMENTUM + 1] += w * (vy + yx * x + yy * y)
            total[RATE] += w * xx
            total[RATE + 1] += w * xy
            total[RATE + 2] += w * yx
            total[RATE + 3] += w * yy


@compiled_too
def side_seen(near, count, x, y, crack):
    """Side of a node, at (x, y) from a point, on which the point is; ``crack`` (2,) are the node's cracks.

    ``near`` are the ``count`` segments near the point. −1 where a crack parts the point from a node that has no cracks:
    its matter is none of the point's.
    """
    side, k = 0, 0
    while k < count:
        which, times = near[k, CRACK], 0
        while k < count and near[k, CRACK] == which:
            if crosses(near, k, x, y):
                times += 1
            k += 1
        if times % 2 == 1:
            if crack[0] < 0:
                return -1
            side += 1 if which == crack[0] else (2 if which == crack[1] else 0)
    return side


@compiled_too
def face_velocity(
    chain, plane, normal, face, sides, sums, nodes, segments, table, near, lattice, moves, out
):  # fmt: skip
    """Velocity and spin of a point ``face`` (2,) of a face of crack ``chain`` into ``out`` (3,); returns its mass.

    It is the mean of what the sides of the four nodes around tell of the point, from their velocities and gradients:
    exact for affine motion, whichever nodes there are. The matter is that of the fields that ``moves`` (cracks, fields)
    names. ``plane`` (2,) is the point of the plane beside it, ``normal`` (2,) points from the plane to the face.
    """
    # it looks from its own side of the plane, wherever the faces have gone
    inverse_x, inverse_y = 1.0 / lattice.cell[0], 1.0 / lattice.cell[1]
    face_x, face_y = face[0] - lattice.origin[0], face[1] - lattice.origin[1]
    tiny_x, tiny_y = BESIDE * lattice.cell[0] * normal[0], BESIDE * lattice.cell[1] * normal[1]
    away = (face[0] - plane[0]) * normal[0] + (face[1] - plane[1]) * normal[1]
    back = min(away, 0.0)
    x, y = face[0] - back * normal[0] + tiny_x, face[1] - back * normal[1] + tiny_y
    cx, cy = np.int64(np.floor(face_x * inverse_x)), np.int64(np.floor(face_y * inverse_y))
    out[0] = out[1] = out[2] = 0.0
    px, py = whole(x, lattice.origin[0], inverse_x), whole(y, lattice.origin[1], inverse_y)
    fields = moves.shape[1]
    count = list_near(
        segments, table, cell_of(table, cx, cy), px, py, (cx << BITS) - px, (cy << BITS) - py, 1, moves, -1, near
    )  # fmt: skip
    total, mass = 0.0, 0.0
    for turn in range(2):  # crack nodes first: then others, which see matter of one face alone
        for j in range(4):
            nx, ny = cx + j % 2, cy + j // 2
            if nx < 0 or ny < 0 or nx >= lattice.shape[0] or ny >= lattice.shape[1]:
                continue
            slot = nodes.slot_of_node[ny * lattice.shape[0] + nx]
            if slot < 0 or (turn == 0 and nodes.crack[slot, 0] < 0):
                continue
            side = side_seen(near, count, (nx << BITS) - px, (ny << BITS) - py, nodes.crack[slot])
            if side < 0:
                continue
            m, v, w, spin = 0.0, 0.0, 0.0, 0.0
            dx, dy = face_x - nx * lattice.cell[0], face_y - ny * lattice.cell[1]
            for field in range(fields):
                if moves[chain, field]:
                    here = sums[(slot * sides + side) * fields + field]
                    m += here[WEIGHT]
                    v += here[MOMENTUM] + here[RATE] * dx + here[RATE + 1] * dy
                    w += here[MOMENTUM + 1] + here[RATE + 2] * dx + here[RATE + 3] * dy
                    spin += here[RATE + 2] - here[RATE + 1]
            if m <= 0.0:
                continue
            N = max(1.0 - abs(dx) * inverse_x, 0.0) * max(1.0 - abs(dy) * inverse_y, 0.0)
            part = N / m
            out[0] += part * v
            out[1] += part * w
            out[2] += 0.5 * part * spin
            mass += N * m
            total += N
        if total > 0.0:
            break
    for a in range(3):
        out[a] = out[a] / total if total > 0.0 else 0.0
    return mass


@compiled_too
def move_point(
    chain, k, before, end, at_tip, way, dt, points, sides, sums, nodes, segments, table, near, lattice, moves, new
):  # fmt: skip
    """Move point ``k`` of a chain with the matter of its sides; returns how far a face went [cells], −1 without matter.

    ``before`` (2,) is where the one before it was, ``end`` the end of the chain. ``new`` (2, 3) receives velocities and
    spins of the faces.
    """
    after = min(k + 1, end - 1)
    tx, ty = points.X[0, after] - before[0], points.X[1, after] - before[1]
    size = math.sqrt(tx * tx + ty * ty)
    plane = (points.X[0, k], points.X[1, k])
    above = face_velocity(
        chain, plane, (-ty / size, tx / size), (points.faces[0, 0, k], points.faces[0, 1, k]), sides, sums, nodes,
        segments, table, near, lattice, moves, new[0],
    )  # fmt: skip
    below = face_velocity(
        chain, plane, (ty / size, -tx / size), (points.faces[1, 0, k], points.faces[1, 1, k]), sides, sums, nodes,
        segments, table, near, lattice, moves, new[1],
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


@called_once
def move_points(
    counts, sights, width, sides, mass, X, L, nodes, segments, table, near, lattice, moves, ways, apart, bounds, dt,
    points, smooth, respaces, stretch, sums, new, matter, spin, found, worst,
):  # fmt: skip
    """Move all points for a step; returns how far a face went [cells].

    ``new`` (2, 3), ``matter`` (n,) and ``spin`` (2, n) are scratch, ``worst`` (2,) receives the crack and the point
    that went farthest, ``found`` (cracks, 4) what ``watch`` tells. A distance that is no number counts as the farthest.
    Also returns whether ``found`` asks for action: of cracks outside, of those that ``respaces`` names, or whose planes
    were ``smooth``. ``stretch`` (2, cracks) is the most that segments of the others were stretched and shrunk.
    """
    places = counts[LISTED] * sides * moves.shape[1]
    sum_motion(counts[SIGHTS], sights, width, places, mass, X, L, dt, lattice, sums)
    farthest, acts = 0.0, False
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
                        crack, k, before, end, at_tip, ways[crack], dt, points, sides, sums, nodes, segments, table,
                        near, lattice, moves, new,
                    )  # fmt: skip
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
        state = found[crack]
        watch(begin, end, bounds, VISIBLE * min(lattice.cell[0], lattice.cell[1]), points, state)
        acts = acts or state[OUTSIDE] > 0.0 or (smooth[crack] and state[SHARPEST] < FOLDED)
        if respaces[crack]:
            acts = acts or state[LONGEST] > 1.0 or state[SHORTEST] < 1.0
        else:
            stretch[0, crack] = max(stretch[0, crack], STRETCHED * state[LONGEST])
            stretch[1, crack] = min(stretch[1, crack], SHRUNK * state[SHORTEST])
    return farthest, acts


class FaceMotion:
    """Moves the faces of all cracks, and the planes between them.

    Parameters
    ----------
    sides : of the step
    grid, lattice : of the simulation
    fields : (cracks, fields) whether a crack cuts bodies of a velocity field, with whose matter it moves
    moves : how the plane of each crack moves: ``average``, ``mass`` or ``fixed``
    apart : whether faces of each crack that pass the plane are put back onto it
    respaces : whether segments of each crack that are too long or too short are divided or joined
    stretch : (2, cracks) the most that segments of the others were stretched and shrunk, which it keeps up to date
    bounds : (2, 2) first and last coordinate that points may have along each axis [length]

    Attributes
    ----------
    found : (cracks, 4) after a step: cosine of the sharpest turn of the plane (``SHARPEST``), largest length of a
        segment over the longest that it may have (``LONGEST``), smallest over the shortest (``SHORTEST``), points
        outside of the bounds (``OUTSIDE``)
    acts : whether any of it asks for action
    """

    def __init__(
        self, sides: CrackSides, grid: Grid, lattice: Any, fields: Array, moves: list[str], apart: list[bool],
        respaces: Array, stretch: Array, bounds: Array,
    ):  # fmt: skip
        self._sides, self._grid, self._lattice, self._fields = sides, grid, lattice, fields
        self._ways = np.array([WAYS[way] for way in moves], dtype=np.int64)
        self._apart, self._respaces, self._stretch, self.bounds = np.array(apart), respaces, stretch, bounds
        self.acts = False
        self._sums = np.zeros((0, SUMS))
        self._new = np.zeros((2, 3))
        self._call = TypedCalls()
        self._matter, self._spin = np.zeros(0, dtype=np.bool_), np.zeros((2, 0))
        self._worst = np.zeros(2, dtype=np.int64)
        self.found = np.zeros((len(moves), 4))

    def move(self, p: Any, X: Array, dt: float) -> tuple[float, int, int]:
        """Move all chains by a step, after which the particles ``p`` are at ``X`` (2, N).

        Returns the farthest that a face went [cells], and the crack and the point that did.
        """
        sides, grid, points = self._sides, self._grid, self._sides.points.get()
        places = sides.listed * grid.sides * self._fields.shape[1]
        if len(self._sums) < places:
            self._sums = np.zeros((places + places // 4, SUMS))
        if len(self._matter) != points.X.shape[1]:
            self._matter, self._spin = np.zeros(points.X.shape[1], dtype=np.bool_), np.zeros_like(points.X)
        farthest, self.acts = self._call(
            move_points, sides.counts, sides.sights, grid.width, grid.sides, p.mass, X, p.L, sides.nodes,
            sides.segments, sides.hash, sides.near, self._lattice, self._fields, self._ways, self._apart, self.bounds,
            dt, points, sides.points.smooth, self._respaces, self._stretch, self._sums, self._new, self._matter,
            self._spin, self.found, self._worst,
        )  # fmt: skip
        return float(farthest), int(self._worst[0]), int(self._worst[1])
