"""Which particles cracks cut, and on which side of its cracks a particle sees a node.

Of the cracks between a node and any particle that sees it the two of lowest index count, c₁ < c₂: the particle is on
side 1·(c₁ lies between them) + 2·(c₂ lies between them) of the node (Nairn 2023, chapter 1).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.chunks import CHUNKS
from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.grid import Grid, unfold
from mpmcli.core.order import CellOrder, or_shifted
from mpmcli.core.transfer.cut import Cut, first_rows, make_cut
from mpmcli.core.transfer.stencil import fill
from mpmcli.cracks.chain import Chain
from mpmcli.cracks.crossing import (
    BITS,
    UNIT,
    Hash,
    Segments,
    allocate_segments,
    crosses,
    find_segments,
    hash_segments,
    is_left,
    whole,
)
from mpmcli.cracks.points import AllPoints, Points

Array = np.ndarray

DRIFT = 1
"""Cells that chains and particles may move between two sorts."""
SLACK = 0.2
"""Cells that they may move before candidates are listed anew."""
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
    S, G : (c, m), (c, 2 m) shape function values and gradients
    number : (c, m) how many cracks lie between particle and node
    crack, segment : (c, m, 2) the two of lowest index, and the segment that is crossed
    side : (c, m) side of the node, unsigned
    """

    particle: Array
    ranges: Array
    close: Array
    seen: Array
    corner: Array
    place: Array
    S: Array
    G: Array
    number: Array
    crack: Array
    segment: Array
    side: Array


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
        base = fill(
            shape, geometry, across, X, F, size, p, S, candidates.G[q], stencil.W[slot], stencil.status
        )
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
                        candidates.crack[q, j, number[j]] = crack
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
def name_nodes(candidates, offsets, nodes):
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
                name_crack(nodes, slot, candidates.crack[q, j, k])
            if number > 2:
                nodes.third[slot] = 1
    return count


@inline
def sees_crack_node(geometry, reach, X, p, nodes):
    """Whether a crack node is in the reach of particle ``p`` [cells]."""
    columns = np.int64(geometry.stride[1])
    x = (X[0, p] - geometry.origin[0]) * geometry.inverse_cell[0]
    y = (X[1, p] - geometry.origin[1]) * geometry.inverse_cell[1]
    for row in range(np.int64(math.ceil(y - reach)), np.int64(math.floor(y + reach)) + 1):
        for column in range(np.int64(math.ceil(x - reach)), np.int64(math.floor(x + reach)) + 1):
            if nodes.slot_of_node[row * columns + column] >= 0:
                return True
    return False


@inline
def find_sides(
    shape, grid, across, X, F, size, stencil, reach, candidates, nodes, entries, points, origin, cell, counts
):
    """Name the crack nodes, find the sides of all candidates and list their entries.

    ``counts`` (2,) receives the number of crack nodes, and of those with the others around faces.

    Nodes are few and each counts on those before it: serial. ``reach`` is how far particles see [cells].
    """
    geometry = unfold(grid)
    counts[0] = name_nodes(candidates, stencil.offsets, nodes)
    counts[1] = name_face_nodes(points, origin, cell, np.int64(geometry.stride[1]), nodes, counts[0])
    for q in range(len(candidates.particle)):
        p, offsets = candidates.particle[q], stencil.offsets
        side, number = candidates.side[q], candidates.number[q]
        for a in range(2):
            candidates.place[q, a] = X[a, p]
        for j in range(offsets.shape[0]):
            side[j] = 0
        if candidates.seen[q] == NEAR:
            for j in range(offsets.shape[0]):
                for k in range(min(number[j], 2)):
                    at = nodes.slot_of_node[np.int64(candidates.corner[q] + offsets[j])]
                    crack = candidates.crack[q, j, k]
                    if crack == nodes.crack[at, 0]:
                        side[j] += np.uint8(1)
                    elif crack == nodes.crack[at, 1]:
                        side[j] += np.uint8(2)
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
                candidates.G[q],
                stencil.W[0],
                stencil.status,
            )
            for j in range(offsets.shape[0]):
                number[j] = 0
    list_entries(candidates, stencil.offsets, nodes, counts[1], entries)


@inline
def find_distances(X, origin, inverse_cell, segments, table, away):
    """How far particles are from the boxes around segments, along the axis where it is more, into ``away`` (N,).

    In cells; infinite where the hash lists no segment near.
    """
    for p in range(X.shape[1]):
        away[p] = np.inf
        x, y = whole(X[0, p], origin[0], inverse_cell[0]), whole(X[1, p], origin[1], inverse_cell[1])
        row, column = (y >> BITS) - table.low[1], (x >> BITS) - table.low[0]
        if row < 0 or column < 0 or row >= table.place.shape[0] or column >= table.place.shape[1]:
            continue
        cell = table.place[row, column]
        if cell < 0:
            continue
        nearest = np.int64(1) << 62
        for at in range(table.first[cell], table.first[cell + 1]):
            s = table.segment[at]
            ax, ay, bx, by = segments.ax[s], segments.ay[s], segments.bx[s], segments.by[s]
            dx = max(min(ax, bx) - x, x - max(ax, bx))
            dy = max(min(ay, by) - y, y - max(ay, by))
            nearest = min(nearest, max(dx, dy))
        away[p] = nearest / UNIT


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


class Entries(NamedTuple):
    """Candidates and the crack nodes that they see, node after node.

    first : (slots + 1, at least) where the entries of each node begin
    row, column : (entries, at least) candidate and node of its stencil
    """

    first: Array
    row: Array
    column: Array


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
                        entries.column[first[at]] = j
                        first[at] += 1
        if turn == 0:
            for slot in range(count):
                first[slot + 1] += first[slot]
    for slot in range(count, 0, -1):
        first[slot] = first[slot - 1]
    first[0] = 0


class CrackSides:
    """Tells the sides of nodes on which particles are, in every step.

    Parameters
    ----------
    chains : of all cracks
    cuts : (cracks, bodies) whether a crack cuts a body
    order, grid : of the simulation
    follows : particle domains follow the deformation, and reach farther than half the stencil

    Attributes
    ----------
    points : of all chains
    candidates, nodes, entries : of the step
    segments, hash : of the chains in the step
    drift : how far points have moved since the candidates were listed, at most [cells]
    """

    def __init__(self, chains: list[Chain], cuts: Array, order: CellOrder, grid: Grid, follows: bool):
        self.chains, self._cuts = chains, cuts
        self._order, self._grid, self._follows = order, grid, follows
        self.points = AllPoints(chains)
        self._origin = grid.lower - grid.pad * grid.cell
        self._counts = np.zeros(2, dtype=np.int64)
        self.drift = 0.0
        self._version, self._listed_at = -1, 0.0
        self.segments: Segments
        self.candidates: Candidates
        self.entries: Entries
        nothing = np.zeros(0, dtype=np.int64)
        self.nodes = CrackNodes(
            np.full(grid.node_count, -1, dtype=np.int32), nothing, nothing.reshape(0, 2), nothing
        )
        self.hash: Hash

    @property
    def count(self) -> int:
        """Number of crack nodes: the first ones of ``nodes``."""
        return int(self._counts[0])

    @property
    def listed(self) -> int:
        """Number of all nodes that ``nodes`` and ``entries`` list."""
        return int(self._counts[1])

    @property
    def _reach(self) -> float:
        """How far a particle sees along an axis [cells]."""
        w = self._grid.width
        return w - 1.0 if self._follows else 0.5 * w

    def sorted(self) -> Array:
        """Note that particles were sorted; returns the nodes (n,), sorted, that may have further sides from now on."""
        grid, w = self._grid, self._grid.width
        self._list_candidates()
        corner, mark = self._around(w - 2 + DRIFT, w - 1 + DRIFT)
        self._make_room(int(np.count_nonzero(mark)) + 8 * self.points.get().X.shape[1])
        rows, columns = np.nonzero(mark)
        x, y = columns + corner[0], rows + corner[1]
        inside = (x >= 0) & (y >= 0) & (x < grid.shape[0]) & (y < grid.shape[1])
        return np.asarray(y[inside] * grid.shape[0] + x[inside])

    def _around(self, below: int, above: int) -> tuple[Array, Array]:
        """Mark the cells around the segments, so many below and above; returns the first cell of the box of marks."""
        cells = hash_segments(self.segments, 0)
        mark = np.pad(cells.place >= 0, ((below, above), (below, above)))
        for axis in range(2):
            spread = mark.copy()
            for shift in range(-below, above + 1):
                or_shifted(spread, mark, axis, shift)
            mark = spread
        return cells.low - below, mark

    def _find_segments(self, points: Points, segments: Segments) -> None:
        beyond = (self._grid.width + 2) * float(self._grid.cell.max())
        find_segments(points, beyond, self._origin, self._grid.cell, segments)

    def _distances(self, X: Array, segments: Segments, far: float) -> Array:
        """How far particles are from segments (N,), where it is not more than ``far`` [cells]."""
        away = np.empty(X.shape[1])
        table = hash_segments(segments, math.ceil(far))
        find_distances(X, self._origin, 1.0 / self._grid.cell, segments, table, away)
        return away

    def _list_candidates(self) -> None:
        """List the particles near cracks, and the segments near each cell."""
        grid, X = self._grid, self._order.particles.X
        self.segments = allocate_segments(self.points.get())
        self._find_segments(self.points.get(), self.segments)
        near, far = self._reach + 2 * SLACK, 2.0 * self._reach + 2 * SLACK
        away = self._distances(X, self.segments, far)
        points = self.points.get()
        if (
            np.abs(points.faces - points.X) > SLACK * grid.cell[:, None]
        ).any():  # to stay with the matter of each
            for face in range(2):
                of_face = allocate_segments(points)
                self._find_segments(points._replace(X=points.faces[face]), of_face)
                away = np.minimum(away, self._distances(X, of_face, far))
        self.hash = hash_segments(self.segments, math.ceil(near))
        particle = np.flatnonzero(away <= far).astype(np.uint64)
        c, m, d = len(particle), grid.width**grid.dimensions, grid.dimensions
        self.candidates = Candidates(
            particle=particle,
            ranges=first_rows(particle, self._order.chunks),
            close=away[particle] <= near,
            seen=np.zeros(c, dtype=np.uint8),
            corner=np.zeros(c, dtype=np.uint64),
            place=np.zeros((c, d)),
            S=np.zeros((c, m)),
            G=np.zeros((c, d * m)),
            number=np.zeros((c, m), dtype=np.uint8),
            crack=np.zeros((c, m, 2), dtype=np.int32),
            segment=np.zeros((c, m, 2), dtype=np.int32),
            side=np.zeros((c, m), dtype=np.uint8),
        )
        longest = int(np.diff(self.hash.first).max(initial=0))
        self._kept = np.zeros((CHUNKS, longest), dtype=np.int64)
        self.entries = Entries(
            np.zeros(len(self.nodes.node) + 1, dtype=np.int64),
            np.zeros(c * m, dtype=np.int32),
            np.zeros(c * m, dtype=np.int32),
        )
        self._version, self._listed_at, self.drift = self._order.version, self._order.drift, 0.0

    def _make_room(self, most: int) -> None:
        self._clear()
        self.nodes = self.nodes._replace(
            node=np.zeros(most, dtype=np.int64),
            crack=np.zeros((most, 2), dtype=np.int64),
            third=np.zeros(most, dtype=np.uint8),
        )
        self.entries = self.entries._replace(first=np.zeros(most + 1, dtype=np.int64))

    def part_all(self) -> None:
        """Let the first crack part all candidates from the first node of their stencils, in a step that is not run."""
        c, grid = self.candidates, self._grid
        cell = np.floor((self._order.particles.X - self._origin[:, None]) / grid.cell[:, None]).astype(
            np.uint64
        )
        c.corner[:] = np.array(grid.stride, dtype=np.uint64) @ cell[:, c.particle]
        c.seen[:], c.number[:, 0], c.S[:, 0] = NEAR, 1, 1.0

    def _clear(self) -> None:
        self.nodes.slot_of_node[self.nodes.node[: self._counts[1]]] = -1
        self._counts[:] = 0

    def find_cut(self, transfer: Any, F: Array) -> Cut | None:
        """Find the sides of this step; ``F`` (nF, N) are the deformation gradients that its stencils are built from."""
        if self._version != self._order.version:  # a run that goes on from a checkpoint
            self.sorted()
        elif max(self.drift, self._order.drift - self._listed_at) > SLACK:
            self._list_candidates()
        self._clear()
        self._find_segments(self.points.get(), self.segments)
        p, c, stencil = transfer.particles, self.candidates, transfer.stencil
        operator = (transfer.shape.parameters, transfer.geometry, transfer.across, p.X, F, p.size, stencil)
        find_crossings[transfer.parallel](
            *operator,
            np.int64(self._reach * UNIT),
            c,
            p.body,
            self._cuts,
            self.segments,
            self.hash,
            self._kept,
        )
        find_sides(
            *operator, self._reach, c, self.nodes, self.entries, self.points.get(), self._origin, self._grid.cell,
            self._counts,
        )  # fmt: skip
        if self.count == 0:
            return None
        rows = np.flatnonzero(c.side.any(axis=1))
        return make_cut(transfer, c.particle[rows], c.corner[rows], c.S[rows], c.G[rows], c.side[rows])
