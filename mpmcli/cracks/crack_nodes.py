"""Nodes whose particles lie on several sides of cracks, and the particles that see them.

Of the cracks between a node and any particle that sees it the two of lowest index count, c₁ < c₂: the particle is on
side 1·(c₁ lies between them) + 2·(c₂ lies between them) of the node (Nairn 2023, chapter 1).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.dofs import dof_of
from mpmcli.core.grid import unfold
from mpmcli.core.transfer.cut import Cut
from mpmcli.core.transfer.stencil import fill
from mpmcli.cracks.crossing import BITS, CRACK, S, cell_of, crosses, find_segments, list_near, whole

Array = np.ndarray

NODES, LISTED, CUT, SIGHTS, CROSSINGS, THIRD = range(6)
"""Counts of a step: crack nodes, of those with the others around faces, cut particles, rows of ``Sights``, of
``Crossings``, nodes at which a third crack is left out."""


class Candidates(NamedTuple):
    """Particles near cracks, by ascending place in memory, and what was known of them when they were listed.

    particle : (c,) places in memory, unsigned
    away : (c,) distance from the boxes around segments and faces, along the axis where it is more [cells]
    """

    particle: Array
    away: Array


class Sights(NamedTuple):
    """Particles that see listed nodes, first the cut ones, each by ascending place; m nodes per stencil.

    particle : (at least, r) places in memory, unsigned
    corner : (at least, r) first node of the stencil, unsigned
    place : (at least, r, 2) position at the start of the step [length]
    S : (at least, r, m) shape function values
    at : (at least, r, m) place of the side that the particle feeds, −1 for a node that it does not see or is not listed

    The place of a side is (slot · sides + side) · fields + field, with the place of the node in ``CrackNodes``.
    """

    particle: Array
    corner: Array
    place: Array
    S: Array
    at: Array


class CutRows(NamedTuple):
    """What only cut particles have, beside their rows of ``Sights``: as in ``core.transfer.cut.Cut``.

    G : (at least, c, 2 m) gradients of their shape functions
    dof : (at least, c, m) degrees of freedom, unsigned
    mask : (N,) 1 for those that are cut
    bands, chunks : first row of each band and of each chunk of particles, and the end, unsigned
    """

    G: Array
    dof: Array
    mask: Array
    bands: Array
    chunks: Array


class Crossings(NamedTuple):
    """Lines of sight that cross cracks, of a particle and a node at most the two cracks of lowest index.

    row, column : (at least, n) row of ``Sights`` and node of its stencil
    segment : (at least, n) the segment that is crossed
    """

    row: Array
    column: Array
    segment: Array


class CrackNodes(NamedTuple):
    """Nodes whose particles lie on several sides, and after them other nodes around faces.

    slot_of_node : (n,) place in the following arrays, −1 elsewhere
    node : (slots, at least) nodes
    crack : (slots, at least, 2) their cracks c₁ and c₂, −1 without
    third : (slots, at least) 1 where a third crack was left out
    """

    slot_of_node: Array
    node: Array
    crack: Array
    third: Array


def allocate_nodes(node_count: int, most: int) -> CrackNodes:
    """Make room for crack nodes of a grid of so many nodes."""
    return CrackNodes(
        slot_of_node=np.full(node_count, -1, dtype=np.int32),
        node=np.zeros(most, dtype=np.int64),
        crack=np.zeros((most, 2), dtype=np.int64),
        third=np.zeros(most, dtype=np.uint8),
    )


def allocate_sights(most: int, m: int) -> Sights:
    """Make room for so many particles that see listed nodes; untouched room costs nothing."""
    return Sights(
        particle=np.empty(most, dtype=np.uint64),
        corner=np.empty(most, dtype=np.uint64),
        place=np.empty((most, 2)),
        S=np.empty((most, m)),
        at=np.empty((most, m), dtype=np.int32),
    )


def allocate_cut(most: int, m: int, particles: int, bands: int, chunks: int) -> CutRows:
    """Make room for so many cut particles."""
    return CutRows(
        G=np.empty((most, 2 * m)),
        dof=np.empty((most, m), dtype=np.uint64),
        mask=np.zeros(particles, dtype=np.uint8),
        bands=np.zeros(bands, dtype=np.uint64),
        chunks=np.zeros(chunks, dtype=np.uint64),
    )


def allocate_crossings(most: int) -> Crossings:
    """Make room for so many lines of sight."""
    return Crossings(
        row=np.empty(most, dtype=np.int32),
        column=np.empty(most, dtype=np.uint8),
        segment=np.empty(most, dtype=np.int32),
    )


def cut_of(sights: Sights, rows: CutRows, count: int) -> Cut:
    """The cut particles of a step, ``count`` of them, as transfers take them."""
    return Cut(
        rows.mask, sights.particle[:count], rows.bands, rows.chunks, sights.corner[:count], sights.S[:count],
        rows.G[:count], rows.dof[:count],
    )  # fmt: skip


@compiled_too
def clear_step(nodes, sights, mask, counts):
    """Forget the nodes and the cut particles of the step before."""
    for slot in range(counts[LISTED]):
        nodes.slot_of_node[nodes.node[slot]] = -1
    for row in range(counts[CUT]):
        mask[sights.particle[row]] = 0
    for k in range(len(counts)):
        counts[k] = 0


@compiled_too
def list_node(nodes, i, count):
    """Give node ``i`` a place after ``count`` others, unless it has one; returns how many there are then."""
    if nodes.slot_of_node[i] >= 0:
        return count
    nodes.slot_of_node[i] = count
    nodes.node[count] = i
    nodes.crack[count, 0] = nodes.crack[count, 1] = -1
    nodes.third[count] = 0
    return count + 1


@compiled_too
def name_crack(nodes, slot, crack):
    """Let a crack be one of the two of a node, if its index is low enough."""
    first, second = nodes.crack[slot, 0], nodes.crack[slot, 1]
    if crack in (first, second):
        return
    if first < 0 or crack < first:
        first, second, crack = crack, first, second
    elif second < 0 or crack < second:
        second, crack = crack, second
    nodes.crack[slot, 0], nodes.crack[slot, 1] = first, second
    if crack >= 0:
        nodes.third[slot] = 1


# fmt: off
@compiled_too
def find_crossings(shape, geometry, across, X, F, size, stencil, reach, clear, candidates, body, cuts, segments, table, near, nodes, sights, G, crossings, counts):  # noqa: E501
    """Find the lines of sight that cross cracks, and name the crack nodes; returns how many particles have some.

    These get rows of ``sights`` with their weights, and of ``G``. Candidates farther than ``clear`` have none [cells].
    """
    w, rows, found, count = len(across), 0, 0, 0
    columns = np.int64(geometry.stride[1])
    for q in range(len(candidates.particle)):
        if candidates.away[q] > clear:
            continue
        p = candidates.particle[q]
        px = whole(X[0, p], geometry.origin[0], geometry.inverse_cell[0])
        py = whole(X[1, p], geometry.origin[1], geometry.inverse_cell[1])
        cell = cell_of(table, px >> BITS, py >> BITS)
        n = list_near(segments, table, cell, px, py, reach, cuts, np.int64(body[p]), near)
        if n == 0:
            continue
        weights = sights.S[rows]
        base = fill(shape, geometry, across, X, F, size, p, weights, G[rows], stencil.W[0], stencil.status)
        x0, y0 = np.int64(base) % columns, np.int64(base) // columns
        before = found
        for j in range(w * w):
            if weights[j] <= 0.0:
                continue
            x, y = ((x0 + j % w) << BITS) - px, ((y0 + j // w) << BITS) - py
            k, number = 0, 0
            while k < n:
                crack = near[k, CRACK]
                times, crossed = 0, np.int64(-1)
                while k < n and near[k, CRACK] == crack:
                    if crosses(near, k, x, y):
                        times += 1
                        if times < 3:  # of three the middle one, from whichever end the chain is followed
                            crossed = near[k, S]
                    k += 1
                if times % 2 == 0:
                    continue
                i = np.int64(base + stencil.offsets[j])
                count = list_node(nodes, i, count)
                slot = nodes.slot_of_node[i]
                if number < 2:
                    name_crack(nodes, slot, crack)
                    crossings.row[found], crossings.column[found] = rows, j
                    crossings.segment[found] = crossed
                    found += 1
                else:
                    nodes.third[slot] = 1
                number += 1
        if found > before:
            sights.particle[rows], sights.corner[rows] = p, base
            rows += 1
    counts[NODES], counts[CROSSINGS] = count, found
    return rows
# fmt: on


@compiled_too
def name_face_nodes(points, origin, cell, columns, nodes, count):
    """List the nodes around the faces, too, after the ``count`` crack nodes; returns how many there are then.

    Faces that have parted by more than particles see stay with their matter by these.
    """
    rows = len(nodes.slot_of_node) // columns
    for face in range(2):
        for k in range(points.X.shape[1]):
            x = np.int64(np.floor((points.faces[face, 0, k] - origin[0]) / cell[0]))
            y = np.int64(np.floor((points.faces[face, 1, k] - origin[1]) / cell[1]))
            for j in range(4):
                column, row = x + j % 2, y + j // 2
                if column >= 0 and row >= 0 and column < columns and row < rows:
                    count = list_node(nodes, row * columns + column, count)
    return count


@compiled_too
def place_sight(row, p, base, side, X, offsets, sides, fields, field, nodes, sights):
    """Complete row ``row`` of ``sights`` of a particle that is on the sides ``side`` (m,) of its nodes."""
    sights.particle[row], sights.corner[row] = p, base
    sights.place[row, 0], sights.place[row, 1] = X[0, p], X[1, p]
    for j in range(len(offsets)):
        slot = np.int64(nodes.slot_of_node[np.int64(base + offsets[j])])
        seen = slot >= 0 and sights.S[row, j] > 0.0
        sights.at[row, j] = (slot * sides + side[j]) * fields + field if seen else -1


@compiled_too
def keep_cut(tried, offsets, X, field, sides, fields, segments, nodes, side, sights, cut, crossings, counts):
    """Keep those of the ``tried`` first rows that see nodes on other sides: others only see third cracks."""
    rows, at, kept = 0, 0, 0
    for r in range(tried):
        p, base, parted, begin = sights.particle[r], sights.corner[r], False, kept
        for j in range(len(offsets)):
            side[j] = 0
        while at < counts[CROSSINGS] and crossings.row[at] == r:
            column, s = crossings.column[at], crossings.segment[at]
            at += 1
            slot = nodes.slot_of_node[np.int64(base + offsets[column])]
            bit = 1 if segments.crack[s] == nodes.crack[slot, 0] else 2
            if bit == 2 and segments.crack[s] != nodes.crack[slot, 1]:
                continue
            side[column] += bit
            parted = True
            crossings.row[kept], crossings.column[kept], crossings.segment[kept] = rows, column, s
            kept += 1
        if not parted:
            kept = begin
            continue
        if rows < r:
            for j in range(len(offsets)):
                sights.S[rows, j] = sights.S[r, j]
            for j in range(2 * len(offsets)):
                cut.G[rows, j] = cut.G[r, j]
        of_field = np.int64(field[p])
        place_sight(rows, p, base, side, X, offsets, sides, fields, of_field, nodes, sights)
        for j in range(len(offsets)):
            i = np.int64(base + offsets[j])
            cut.dof[rows, j] = dof_of(i, of_field, side[j], len(nodes.slot_of_node), fields)
        cut.mask[p] = 1
        rows += 1
    counts[CUT], counts[CROSSINGS] = rows, kept


@compiled_too
def sees_listed(geometry, reach, X, p, nodes):
    """Whether a listed node is in the reach of particle ``p`` [cells]."""
    columns = np.int64(geometry.stride[1])
    rows = len(nodes.slot_of_node) // columns
    x = (X[0, p] - geometry.origin[0]) * geometry.inverse_cell[0]
    y = (X[1, p] - geometry.origin[1]) * geometry.inverse_cell[1]
    left, right = max(math.ceil(x - reach), 0), min(math.floor(x + reach) + 1, int(columns))
    for row in range(max(math.ceil(y - reach), 0), min(math.floor(y + reach) + 1, int(rows))):
        for column in range(left, right):
            if nodes.slot_of_node[row * columns + column] >= 0:
                return True
    return False


@compiled_too
def list_first_rows(particle, count, ranges, out):
    """First row of each band or chunk of particles, and the end, among the first ``count`` rows."""
    row = 0
    for b in range(len(ranges)):
        while row < count and particle[row] < ranges[b]:
            row += 1
        out[b] = row


@inline
def find_sides(
    shape, grid, across, X, F, size, stencil, bands, chunks, field, body, fields, sides, cuts, candidates, points,
    beyond, origin, cell, reach, clear, segments, table, near, side, nodes, sights, cut, crossings, counts,
):  # fmt: skip
    """Find the segments, the crack nodes, and the sides of all particles that see them: one call, see ``CrackSides``.

    ``counts`` (6,) holds the counts of the step before and receives those of this one. Nodes are few, and the place of
    each depends on those before it: serial. ``near`` and ``side`` are scratch.
    """
    geometry = unfold(grid)
    clear_step(nodes, sights, cut.mask, counts)
    find_segments(points, beyond, origin, cell, segments)
    whole_reach = np.int64(reach * (1 << BITS))
    tried = find_crossings(
        shape, geometry, across, X, F, size, stencil, whole_reach, clear, candidates, body, cuts, segments, table,
        near, nodes, sights, cut.G, crossings, counts,
    )  # fmt: skip
    columns = np.int64(geometry.stride[1])
    counts[LISTED] = name_face_nodes(points, origin, cell, columns, nodes, counts[NODES])
    keep_cut(
        tried, stencil.offsets, X, field, sides, fields, segments, nodes, side, sights, cut, crossings, counts
    )
    for j in range(len(stencil.offsets)):
        side[j] = 0
    rows = counts[CUT]
    for q in range(len(candidates.particle)):
        p = candidates.particle[q]
        if cut.mask[p] == 0 and sees_listed(geometry, reach, X, p, nodes):
            base = fill(
                shape, geometry, across, X, F, size, p, sights.S[rows], None, stencil.W[0], stencil.status
            )
            place_sight(
                rows, p, base, side, X, stencil.offsets, sides, fields, np.int64(field[p]), nodes, sights
            )
            rows += 1
    counts[SIGHTS] = rows
    for slot in range(counts[NODES]):
        counts[THIRD] += nodes.third[slot]
    list_first_rows(sights.particle, counts[CUT], bands, cut.bands)
    list_first_rows(sights.particle, counts[CUT], chunks, cut.chunks)
