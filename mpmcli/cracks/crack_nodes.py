"""Nodes whose particles lie on several sides of cracks, and the particles that see them.

Of the cracks between a node and any particle that sees it the two of lowest index count, c₁ < c₂: the particle is on
side 1·(c₁ lies between them) + 2·(c₂ lies between them) of the node (Nairn 2023, chapter 1).
"""

import math
from typing import NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import called_once
from mpmcli.core.dofs import dof_of
from mpmcli.core.grid import unfold
from mpmcli.core.transfer.stencil import fill
from mpmcli.cracks.crossing import (
    AX,
    AY,
    BITS,
    CRACK,
    DX,
    DY,
    MINE,
    OF,
    S,
    cell_of,
    find_segments,
    list_near,
    whole,
)
from mpmcli.cracks.sights import CROSSINGS, CUT, LISTED, NODES, SIGHTS, THIRD

ROUND_OFF = 1e-6
"""Cells by which distances may be wrong: positions are whole numbers of 2⁻²⁴ cells."""


class Reach(NamedTuple):
    """How far particles see along an axis [cells].

    nodes : of the grid functions themselves
    domain : a particle sees them from its domain, else from its middle alone
    follows : the domain follows the deformation
    most : as far as stencils go, whatever particles do
    """

    nodes: float
    domain: bool
    follows: bool
    most: float


@compiled_too
def reach_of(reach, inverse_cell, F, size, p):
    """How far particle ``p`` sees along the axis where it is more, at most [cells]."""
    x, y = 0.0, 0.0
    if reach.follows:
        x = abs(F[0, p]) * size[0, p] + abs(F[1, p]) * size[1, p]
        y = abs(F[2, p]) * size[0, p] + abs(F[3, p]) * size[1, p]
    elif reach.domain:
        x, y = size[0, p], size[1, p]
    return min(reach.nodes + max(x * inverse_cell[0], y * inverse_cell[1]) + ROUND_OFF, reach.most)


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


@compiled_too
def cross_nodes(near, k, last, x0, y0, across, times, crossed):
    """Count how often lines of sight to the nodes of a stencil cross one crack: segments ``k`` to ``last`` of a list.

    The first node is at (x0, y0) from the point whose list ``near`` is. ``crossed`` (m,) receives the segment that
    stands for all: of three the middle one, from whichever end the chain is followed. See ``crossing.crosses``.
    """
    for j in range(len(times)):
        times[j] = 0
    for at in range(k, last):
        ax, ay, dx, dy = near[at, AX], near[at, AY], near[at, DX], near[at, DY]
        bx, by, mine = ax + dx, ay + dy, near[at, MINE] - 1
        # where a node is of the segment, and A and B of its line of sight: signs alone tell
        area, of_a, of_b, j = dx * (y0 - ay) - dy * (x0 - ax), x0 * ay - y0 * ax, x0 * by - y0 * bx, 0
        for _ in across:
            here, a, b = area, of_a, of_b
            for _ in across:
                if ((here ^ mine) & (a ^ b)) < 0:
                    times[j] += 1
                    if times[j] < 3:
                        crossed[j] = near[at, S]
                here -= dy << BITS
                a += ay << BITS
                b += by << BITS
                j += 1
            area += dx << BITS
            of_a -= ax << BITS
            of_b -= bx << BITS


# fmt: off
@compiled_too
def find_crossings(shape, geometry, across, X, F, size, stencil, reach, moved, candidates, body, cuts, segments, table, scratch, nodes, sights, cut, crossings, counts):  # noqa: E501
    """Find the lines of sight that cross cracks, and name the crack nodes; returns how many particles have some.

    These get rows of ``sights`` and of ``cut``. Candidates see nothing that is farther than their reach; they, and the
    segments, may have ``moved`` so far since they were listed [cells].
    """
    rows, found, count, columns = 0, 0, 0, np.int64(geometry.stride[1])
    near, times, crossed, number = scratch.near, scratch.times, scratch.crossed, scratch.number
    for q in range(len(candidates.particle)):
        p, away = candidates.particle[q], candidates.away[q] - moved
        if away > reach.most or away > reach_of(reach, geometry.inverse_cell, F, size, p):
            continue
        px = whole(X[0, p], geometry.origin[0], geometry.inverse_cell[0])
        py = whole(X[1, p], geometry.origin[1], geometry.inverse_cell[1])
        cell = cell_of(table, px >> BITS, py >> BITS)
        if cell < 0:
            continue
        weights = cut.S[rows]
        base = fill(shape, geometry, across, X, F, size, p, weights, cut.G[rows], stencil.W[0], stencil.status)
        x0, y0 = (np.int64(base) % columns << BITS) - px, (np.int64(base) // columns << BITS) - py
        n = list_near(segments, table, cell, px, py, x0, y0, len(across) - 1, cuts, np.int64(body[p]), near)
        if n == 0:
            continue
        before, k = found, 0
        for j in range(len(number)):
            number[j] = 0
        while k < n:
            crack, last = near[k, CRACK], k
            while last < n and near[last, CRACK] == crack:
                last += 1
            cross_nodes(near, k, last, x0, y0, across, times, crossed)
            k = last
            for j in range(len(number)):
                if times[j] % 2 == 0 or weights[j] <= 0.0:
                    continue
                i = np.int64(base + stencil.offsets[j])
                count = list_node(nodes, i, count)
                slot = nodes.slot_of_node[i]
                if number[j] < 2:
                    name_crack(nodes, slot, crack)
                    crossings.row[found], crossings.column[found] = rows, j
                    crossings.segment[found] = crossed[j]
                    found += 1
                else:
                    nodes.third[slot] = 1
                number[j] += 1
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
def place_sight(row, p, base, weights, side, X, offsets, sides, fields, field, nodes, sights):
    """Write row ``row`` of ``sights`` of a particle that is on the sides ``side`` (m,) of its nodes."""
    sights.particle[row], sights.corner[row] = p, base
    sights.place[row, 0], sights.place[row, 1] = X[0, p], X[1, p]
    e = np.int64(sights.first[row])
    for j in range(len(offsets)):
        slot = np.int64(nodes.slot_of_node[np.int64(base + offsets[j])])
        if slot >= 0 and weights[j] > 0.0:
            sights.column[e], sights.at[e], sights.S[e] = (
                j,
                (slot * sides + side[j]) * fields + field,
                weights[j],
            )
            e += 1
    sights.first[row + 1] = e


@compiled_too
def keep_cut(tried, offsets, X, field, sides, fields, segments, nodes, side, sights, cut, crossings, counts):
    """Keep those of the ``tried`` first rows that see nodes on other sides: others only see third cracks."""
    rows, at, kept = 0, 0, 0
    for r in range(tried):
        p, base, parted = np.uint64(sights.particle[r]), np.uint64(sights.corner[r]), False
        for j in range(len(offsets)):
            side[j] = 0
        while at < counts[CROSSINGS] and crossings.row[at] == r:
            column, s = crossings.column[at], crossings.segment[at]
            at += 1
            slot = nodes.slot_of_node[np.int64(base + offsets[column])]
            bit = 1 if segments.whole[s, OF] == nodes.crack[slot, 0] else 2
            if bit == 2 and segments.whole[s, OF] != nodes.crack[slot, 1]:
                continue
            side[column] += bit
            parted = True
            crossings.row[kept], crossings.column[kept], crossings.segment[kept] = rows, column, s
            kept += 1
        if not parted:
            continue
        if rows < r:
            for j in range(len(offsets)):
                cut.S[rows, j] = cut.S[r, j]
            for j in range(2 * len(offsets)):
                cut.G[rows, j] = cut.G[r, j]
        of_field = np.int64(field[p])
        place_sight(rows, p, base, cut.S[rows], side, X, offsets, sides, fields, of_field, nodes, sights)
        for j in range(len(offsets)):
            i = np.int64(base + offsets[j])
            cut.dof[rows, j] = dof_of(i, of_field, side[j], len(nodes.slot_of_node), fields)
        cut.mask[p] = 1
        rows += 1
    counts[CUT], counts[CROSSINGS] = rows, kept


@compiled_too
def mark_cells(count, nodes, reach, columns, mark, value):
    """Write ``value`` into the cells from which particles may see one of the ``count`` listed nodes: (n,) by corner."""
    far, lines = math.ceil(reach), len(mark) // columns
    for slot in range(count):
        x, y = nodes.node[slot] % columns, nodes.node[slot] // columns
        for line in range(max(y - far - 1, 0), min(y + far + 1, lines)):
            for column in range(max(x - far - 1, 0), min(x + far + 1, columns)):
                mark[line * columns + column] = value


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


@called_once
def find_sides(
    shape, grid, across, X, F, size, stencil, bands, chunks, field, body, fields, sides, cuts, candidates, points,
    beyond, origin, cell, reach, moved, segments, table, scratch, nodes, sights, cut, crossings, counts,
):  # fmt: skip
    """Find the segments, the crack nodes, and the sides of all particles that see them: one call, see ``CrackSides``.

    ``counts`` (6,) holds the counts of the step before and receives those of this one. Nodes are few, and the place of
    each depends on those before it: serial.
    """
    geometry, side, weights = unfold(grid), scratch.number, stencil.S[0]
    clear_step(nodes, sights, cut.mask, counts)
    find_segments(points, beyond, origin, cell, segments)
    tried = find_crossings(
        shape, geometry, across, X, F, size, stencil, reach, moved, candidates, body, cuts, segments, table,
        scratch, nodes, sights, cut, crossings, counts,
    )  # fmt: skip
    columns = np.int64(geometry.stride[1])
    counts[LISTED] = name_face_nodes(points, origin, cell, columns, nodes, counts[NODES])
    keep_cut(
        tried, stencil.offsets, X, field, sides, fields, segments, nodes, side, sights, cut, crossings, counts
    )
    for j in range(len(stencil.offsets)):
        side[j] = 0
    rows = counts[CUT]
    mark_cells(counts[LISTED], nodes, reach.most, columns, scratch.mark, 1)
    for q in range(len(candidates.particle)):
        p = candidates.particle[q]
        x = np.int64((X[0, p] - geometry.origin[0]) * geometry.inverse_cell[0])
        y = np.int64((X[1, p] - geometry.origin[1]) * geometry.inverse_cell[1])
        inside = 0 <= x < columns and 0 <= y * columns < len(scratch.mark)
        if not inside or scratch.mark[y * columns + x] == 0 or cut.mask[p] == 1:
            continue
        if sees_listed(geometry, reach_of(reach, geometry.inverse_cell, F, size, p), X, p, nodes):
            base = fill(shape, geometry, across, X, F, size, p, weights, None, stencil.W[0], stencil.status)
            place_sight(
                rows,
                p,
                base,
                weights,
                side,
                X,
                stencil.offsets,
                sides,
                fields,
                np.int64(field[p]),
                nodes,
                sights,
            )
            rows += 1
    mark_cells(counts[LISTED], nodes, reach.most, columns, scratch.mark, 0)
    counts[SIGHTS] = rows
    for slot in range(counts[NODES]):
        counts[THIRD] += nodes.third[slot]
    list_first_rows(sights.particle, counts[CUT], bands, cut.bands)
    list_first_rows(sights.particle, counts[CUT], chunks, cut.chunks)
