"""Nodes whose particles lie on several sides of cracks, and the particles that see them.

Of the cracks between a node and any particle that sees it the two of lowest index count, c₁ < c₂: the particle is on
side 1·(c₁ lies between them) + 2·(c₂ lies between them) of the node (Nairn 2023, chapter 1).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.grid import unfold
from mpmcli.core.transfer.stencil import fill
from mpmcli.cracks.crossing import BITS, crosses, is_left, whole

Array = np.ndarray

FAR, NEAR = 0, 1
"""Whether a candidate sees crack nodes, so that its weights are known."""


class Candidates(NamedTuple):
    """Particles near cracks, by ascending place in memory; m nodes per stencil.

    particle : (c,) places in memory, unsigned
    ranges : first of each chunk of particles and the end, unsigned
    close : (c,) whether a crack may part it from nodes
    seen : (c,) ``NEAR`` where the rest is known
    corner : (c,) first node of the stencil, unsigned
    place : (c, 2) position at the start of the step [length]
    S : (c, m) shape function values
    number : (c, m) how many cracks lie between particle and node
    segment : (c, m, 2) of the two of lowest index the segment that is crossed; (c, m, 1) in scenes with one crack
    side : (c, m) side of the node, unsigned
    """

    particle: Array
    ranges: Array
    close: Array
    seen: Array
    corner: Array
    place: Array
    S: Array
    number: Array
    segment: Array
    side: Array


class CutRows(NamedTuple):
    """Candidates that see nodes on other sides, the first ones of the arrays.

    row : (at least, c) places among the candidates
    G : (at least, c, 2 m) gradients of their shape functions
    """

    row: Array
    G: Array


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


class Entries(NamedTuple):
    """Candidates and the crack nodes that they see, node after node.

    first : (slots + 1, at least) where the entries of each node begin
    row, column : (entries, at least) candidate and node of its stencil
    """

    first: Array
    row: Array
    column: Array


@inline
def find_crossings_in_chunk(
    shape, geometry, across, X, F, size, stencil, slot, reach, candidates, body, cuts, segments, table, kept
):
    """``find_crossings`` for the candidates of chunk ``slot``; ``kept`` (n,) is scratch for segments."""
    ranges = candidates.ranges
    for q in range(np.int64(ranges[slot]), np.int64(ranges[slot + np.uint64(1)])):
        p = candidates.particle[q]
        w = len(across)
        cx = np.int64(np.floor((X[0, p] - geometry.origin[0]) * geometry.inverse_cell[0]))
        cy = np.int64(np.floor((X[1, p] - geometry.origin[1]) * geometry.inverse_cell[1]))
        row, column = cy - table.low[1], cx - table.low[0]
        candidates.seen[q] = FAR
        if (
            not candidates.close[q]
            or row < 0
            or column < 0
            or row >= table.place.shape[0]
            or column >= table.place.shape[1]
        ):
            continue
        cell = table.place[row, column]
        if cell < 0:
            continue
        px = whole(X[0, p], geometry.origin[0], geometry.inverse_cell[0])
        py = whole(X[1, p], geometry.origin[1], geometry.inverse_cell[1])
        left, right, bottom, top = px - reach, px + reach, py - reach, py + reach
        n = 0
        for at in range(table.first[cell], table.first[cell + 1]):
            s = table.segment[at]
            if not cuts[segments.crack[s], body[p]]:
                continue
            ax, ay, bx, by = segments.ax[s], segments.ay[s], segments.bx[s], segments.by[s]
            if max(ax, bx) < left or min(ax, bx) > right or max(ay, by) < bottom or min(ay, by) > top:
                continue
            mine = is_left(ax, ay, bx, by, px, py)
            if (
                is_left(ax, ay, bx, by, left, bottom) == mine
                and is_left(ax, ay, bx, by, right, bottom) == mine
                and is_left(ax, ay, bx, by, left, top) == mine
                and is_left(ax, ay, bx, by, right, top) == mine
            ):
                continue
            kept[n] = s
            n += 1
        if n == 0:
            continue
        S, number = candidates.S[q], candidates.number[q]
        base = fill(shape, geometry, across, X, F, size, p, S, None, stencil.W[slot], stencil.status)
        candidates.corner[q] = base
        candidates.seen[q] = NEAR
        columns = np.int64(geometry.stride[1])
        x0, y0 = np.int64(base) % columns, np.int64(base) // columns
        for j in range(w * w):
            number[j] = 0
            if S[j] <= 0.0:
                continue
            x, y = (x0 + j % w) << BITS, (y0 + j // w) << BITS
            k = 0
            while k < n:
                crack = segments.crack[kept[k]]
                times, crossed = 0, np.int64(-1)
                while k < n and segments.crack[kept[k]] == crack:
                    s = kept[k]
                    k += 1
                    if crosses(segments.ax[s], segments.ay[s], segments.bx[s], segments.by[s], px, py, x, y):
                        times += 1
                        if times < 3:  # of three the middle one, from whichever end the chain is followed
                            crossed = s
                if times % 2 == 1:
                    if number[j] < 2:
                        candidates.segment[q, j, number[j]] = crossed
                    number[j] += 1


@kernel
def find_crossings(
    shape, grid, across, X, F, size, stencil, reach, candidates, body, cuts, segments, table, kept
):
    """Weigh the candidates that cracks may part from nodes, and find these cracks.

    ``reach`` is how far particles see, ``cuts`` (cracks, bodies) says which bodies a crack cuts, ``table`` is a
    ``Hash``, ``kept`` (chunks, most) scratch.
    """
    for c in prange(candidates.ranges.shape[0] - 1):
        slot = np.uint64(c)
        find_crossings_in_chunk(
            shape, unfold(grid), across, X, F, size, stencil, slot, reach, candidates, body, cuts, segments, table,
            kept[slot],
        )  # fmt: skip


@inline
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


@inline
def name_nodes(candidates, offsets, segments, nodes):
    """List the nodes that cracks part from particles, with their cracks; returns how many."""
    count = 0
    for q in range(len(candidates.particle)):
        if candidates.seen[q] == FAR:
            continue
        for j in range(len(offsets)):
            number = candidates.number[q, j]
            if number == 0:
                continue
            i = np.int64(candidates.corner[q] + offsets[j])
            slot = np.int64(nodes.slot_of_node[i])
            if slot < 0:
                slot = np.int64(count)
                nodes.slot_of_node[i] = slot
                nodes.node[slot] = i
                nodes.crack[slot, 0] = nodes.crack[slot, 1] = -1
                nodes.third[slot] = 0
                count += 1
            for k in range(min(number, 2)):
                name_crack(nodes, slot, segments.crack[candidates.segment[q, j, k]])
            if number > 2:
                nodes.third[slot] = 1
    return count


@inline
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
                if column < 0 or row < 0 or column >= columns or row >= rows:
                    continue
                i = row * columns + column
                if nodes.slot_of_node[i] < 0:
                    nodes.slot_of_node[i] = count
                    nodes.node[count] = i
                    nodes.crack[count, 0] = nodes.crack[count, 1] = -1
                    nodes.third[count] = 0
                    count += 1
    return count


@inline
def sees_crack_node(geometry, reach, X, p, nodes):
    """Whether a crack node is in the reach of particle ``p`` [cells]."""
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


@inline
def list_entries(candidates, offsets, nodes, count, entries):
    """Write the entries of the ``count`` crack nodes, in the order of the candidates."""
    first = entries.first
    for slot in range(count + 1):
        first[slot] = 0
    for turn in range(2):
        for q in range(len(candidates.particle)):
            if candidates.seen[q] == FAR:
                continue
            for j in range(len(offsets)):
                if candidates.S[q, j] > 0.0:
                    at = nodes.slot_of_node[np.int64(candidates.corner[q] + offsets[j])]
                    if at >= 0 and turn == 0:
                        first[at + 1] += 1
                    elif at >= 0:
                        entries.row[first[at]] = q
                        entries.column[first[at]] = np.uint8(j)
                        first[at] += 1
        if turn == 0:
            for slot in range(count):
                first[slot + 1] += first[slot]
    for slot in range(count, 0, -1):
        first[slot] = first[slot - 1]
    first[0] = 0


@inline
def find_sides(
    shape, grid, across, X, F, size, stencil, reach, candidates, segments, nodes, entries, points, origin, cell, cut,
    counts,
):  # fmt: skip
    """Name the crack nodes, find the sides of all candidates, and list their entries and the ones that are ``cut``.

    ``counts`` (3,) receives the number of crack nodes, of those with the others around faces, and of cut candidates.

    Nodes are few and each counts on those before it: serial. ``reach`` is how far particles see [cells].
    """
    geometry = unfold(grid)
    counts[0] = name_nodes(candidates, stencil.offsets, segments, nodes)
    counts[1] = name_face_nodes(points, origin, cell, np.int64(geometry.stride[1]), nodes, counts[0])
    rows = 0
    for q in range(len(candidates.particle)):
        p, offsets, parted = candidates.particle[q], stencil.offsets, False
        side, number = candidates.side[q], candidates.number[q]
        for a in range(2):
            candidates.place[q, a] = X[a, p]
        for j in range(offsets.shape[0]):
            side[j] = 0
        if candidates.seen[q] == NEAR:
            for j in range(offsets.shape[0]):
                for k in range(min(number[j], 2)):
                    at = nodes.slot_of_node[np.int64(candidates.corner[q] + offsets[j])]
                    crack = segments.crack[candidates.segment[q, j, k]]
                    if crack == nodes.crack[at, 0]:
                        side[j] += np.uint8(1)
                    elif crack == nodes.crack[at, 1]:
                        side[j] += np.uint8(2)
                parted = parted or side[j] > 0
            if parted:
                cut.row[rows] = q
                fill(
                    shape, geometry, across, X, F, size, p, stencil.S[0], cut.G[rows], stencil.W[0], stencil.status
                )  # fmt: skip
                rows += 1
        elif sees_crack_node(geometry, reach, X, p, nodes):
            candidates.seen[q] = NEAR
            candidates.corner[q] = fill(
                shape,
                geometry,
                across,
                X,
                F,
                size,
                p,
                candidates.S[q],
                None,
                stencil.W[0],
                stencil.status,
            )
            for j in range(offsets.shape[0]):
                number[j] = 0
    counts[2] = rows
    list_entries(candidates, stencil.offsets, nodes, counts[1], entries)
