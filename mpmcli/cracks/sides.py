"""Which particles cracks cut, and on which side of its cracks a particle sees a node.

Of the cracks between a node and any particle that sees it the two of lowest index count, c₁ < c₂: the particle is on
side 1·(c₁ lies between them) + 2·(c₂ lies between them) of the node (Nairn 2023, chapter 1).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.chunks import CHUNKS
from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.grid import Grid, unfold
from mpmcli.core.order import CellOrder, or_shifted
from mpmcli.core.transfer.cut import Cut, first_rows, make_cut
from mpmcli.core.transfer.stencil import fill
from mpmcli.cracks.chain import Chain
from mpmcli.cracks.crossing import BITS, Hash, Segments, crosses, hash_segments, is_left, segments_of, whole

Array = np.ndarray

DRIFT = 1
"""Cells that chains and particles may move between two sorts."""
FAR, NEAR = 0, 1
"""Whether a candidate sees crack nodes, so that its weights are known."""


class Candidates(NamedTuple):
    """Particles near cracks, by ascending place in memory; m nodes per stencil.

    particle : (c,) places in memory, unsigned
    ranges : first of each chunk of particles and the end, unsigned
    seen : (c,) ``NEAR`` where the rest is known
    corner : (c,) first node of the stencil, unsigned
    S, G : (c, m), (c, 2 m) shape function values and gradients
    number : (c, m) how many cracks lie between particle and node
    crack, segment : (c, m, 2) the two of lowest index, and the segment that is crossed
    side : (c, m) side of the node, unsigned
    """

    particle: Array
    ranges: Array
    seen: Array
    corner: Array
    S: Array
    G: Array
    number: Array
    crack: Array
    segment: Array
    side: Array


class CrackNodes(NamedTuple):
    """Nodes whose particles lie on several sides.

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
def find_crossings_of(
    shape, geometry, across, X, F, size, stencil, slot, q, p, candidates, body, cuts, segments, table, kept
):
    """``find_crossings`` for candidate ``q``, particle ``p``; ``kept`` (n,) is scratch for segments."""
    w = len(across)
    cx = np.int64(np.floor((X[0, p] - geometry.origin[0]) * geometry.inverse_cell[0]))
    cy = np.int64(np.floor((X[1, p] - geometry.origin[1]) * geometry.inverse_cell[1]))
    row, column = cy - table.low[1], cx - table.low[0]
    candidates.seen[q] = FAR
    if row < 0 or column < 0 or row >= table.place.shape[0] or column >= table.place.shape[1]:
        return
    cell = table.place[row, column]
    if cell < 0:
        return
    px = whole(X[0, p], geometry.origin[0], geometry.inverse_cell[0])
    py = whole(X[1, p], geometry.origin[1], geometry.inverse_cell[1])
    left, right = (cx - (w - 2)) << BITS, (cx + (w - 1)) << BITS
    bottom, top = (cy - (w - 2)) << BITS, (cy + (w - 1)) << BITS
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
        return
    S, number = candidates.S[q], candidates.number[q]
    base = fill(shape, geometry, across, X, F, size, p, S, candidates.G[q], stencil.W[slot], stencil.status)
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
    shape, grid, across, X, F, size, stencil, candidates, body, cuts, segments, table, kept
):  # fmt: skip
    """Weigh the candidates that cracks may part from nodes, and find these cracks.

    ``cuts`` (cracks, bodies) says which bodies a crack cuts, ``table`` is a ``Hash``, ``kept`` (chunks, most) scratch.
    """
    for c in prange(candidates.ranges.shape[0] - 1):
        slot = np.uint64(c)
        geometry = unfold(grid)
        for q in range(np.int64(candidates.ranges[slot]), np.int64(candidates.ranges[slot + np.uint64(1)])):
            find_crossings_of(
                shape, geometry, across, X, F, size, stencil, slot, q, candidates.particle[q], candidates, body,
                cuts, segments, table, kept[slot],
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
def sees_crack_node(geometry, w, X, p, nodes):
    """Whether a crack node is in the reach of particle ``p``, wherever it lies in its cell."""
    columns = np.int64(geometry.stride[1])
    cx = np.int64(np.floor((X[0, p] - geometry.origin[0]) * geometry.inverse_cell[0]))
    cy = np.int64(np.floor((X[1, p] - geometry.origin[1]) * geometry.inverse_cell[1]))
    rows = len(nodes.slot_of_node) // columns
    for y in range(max(cy - (w - 2), 0), min(cy + w, rows)):
        for x in range(max(cx - (w - 2), 0), min(cx + w, columns)):
            if nodes.slot_of_node[y * columns + x] >= 0:
                return True
    return False


@inline
def find_sides_of(shape, geometry, across, X, F, size, stencil, slot, q, candidates, nodes):
    """``find_sides`` for candidate ``q``."""
    p, offsets = candidates.particle[q], stencil.offsets
    side, number = candidates.side[q], candidates.number[q]
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
    elif sees_crack_node(geometry, len(across), X, p, nodes):
        candidates.seen[q] = NEAR
        candidates.corner[q] = fill(
            shape, geometry, across, X, F, size, p, candidates.S[q], candidates.G[q], stencil.W[slot],
            stencil.status,
        )  # fmt: skip
        for j in range(offsets.shape[0]):
            number[j] = 0


@kernel
def find_sides(shape, grid, across, X, F, size, stencil, candidates, nodes):
    """Sides of the nodes that candidates see; those that see crack nodes and are not parted from them are weighed."""
    for c in prange(candidates.ranges.shape[0] - 1):
        slot = np.uint64(c)
        geometry = unfold(grid)
        for q in range(np.int64(candidates.ranges[slot]), np.int64(candidates.ranges[slot + np.uint64(1)])):
            find_sides_of(shape, geometry, across, X, F, size, stencil, slot, q, candidates, nodes)


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

    Attributes
    ----------
    candidates, nodes, entries : of the step; the first ``count`` crack nodes are valid
    count : number of crack nodes
    segments : of the chains in the step
    """

    def __init__(self, chains: list[Chain], cuts: Array, order: CellOrder, grid: Grid):
        self.chains, self._cuts = chains, cuts
        self._order, self._grid = order, grid
        self.count = 0
        self._version = -1
        self.segments: Segments
        self.candidates: Candidates
        self.entries: Entries
        nothing = np.zeros(0, dtype=np.int64)
        self.nodes = CrackNodes(
            np.full(grid.node_count, -1, dtype=np.int32), nothing, nothing.reshape(0, 2), nothing
        )
        self.hash: Hash

    def sorted(self) -> Array:
        """Note that particles were sorted; returns the nodes (n,), sorted, that may have further sides from now on."""
        grid, w = self._grid, self._grid.width
        self.segments = self._find_segments()
        self.hash = hash_segments(self.segments, w + DRIFT)
        self._list_candidates()
        corner, mark = self._around(w - 2 + DRIFT, w - 1 + DRIFT)
        self._most = int(np.count_nonzero(mark))
        self._make_room()
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

    def _find_segments(self) -> Segments:
        return segments_of(self.chains, self._grid, (self._grid.width + 2) * float(self._grid.cell.max()))

    def _list_candidates(self) -> None:
        grid, X = self._grid, self._order.particles.X
        cell = np.floor((X - (grid.lower - grid.pad * grid.cell)[:, None]) / grid.cell[:, None]).astype(
            np.int64
        )
        reach = 2 * (
            grid.width - 1 + DRIFT
        )  # to the nodes beyond a crack, and from them to those who see them
        corner, mark = self._around(reach, reach)
        cell -= corner[:, None]
        ny, nx = mark.shape
        inside = np.flatnonzero((cell[0] >= 0) & (cell[1] >= 0) & (cell[0] < nx) & (cell[1] < ny))
        particle = inside[mark[cell[1, inside], cell[0, inside]]].astype(np.uint64)
        c, m, d = len(particle), grid.width**grid.dimensions, grid.dimensions
        self.candidates = Candidates(
            particle=particle,
            ranges=first_rows(particle, self._order.chunks),
            seen=np.zeros(c, dtype=np.uint8),
            corner=np.zeros(c, dtype=np.uint64),
            S=np.zeros((c, m)),
            G=np.zeros((c, d * m)),
            number=np.zeros((c, m), dtype=np.uint8),
            crack=np.zeros((c, m, 2), dtype=np.int32),
            segment=np.zeros((c, m, 2), dtype=np.int32),
            side=np.zeros((c, m), dtype=np.uint8),
        )
        self._version = self._order.version

    def _make_room(self) -> None:
        self._clear()
        most, room = self._most, self.candidates.S.size
        self.nodes = self.nodes._replace(
            node=np.zeros(most, dtype=np.int64),
            crack=np.zeros((most, 2), dtype=np.int64),
            third=np.zeros(most, dtype=np.uint8),
        )
        self.entries = Entries(
            np.zeros(most + 1, dtype=np.int64),
            np.zeros(room, dtype=np.int32),
            np.zeros(room, dtype=np.int32),
        )
        longest = int(np.diff(self.hash.first).max(initial=0))
        self._kept = np.zeros((CHUNKS, longest), dtype=np.int64)

    def _clear(self) -> None:
        self.nodes.slot_of_node[self.nodes.node[: self.count]] = -1
        self.count = 0

    def find_cut(self, transfer: Any, F: Array) -> Cut | None:
        """Find the sides of this step; ``F`` (nF, N) are the deformation gradients that its stencils are built from."""
        if self._version != self._order.version:  # a run that goes on from a checkpoint
            self.sorted()
        self._clear()
        p, stencil, parallel = transfer.particles, transfer.stencil, transfer.parallel
        self.segments = self._find_segments()
        arguments = (
            transfer.shape.parameters, transfer.geometry, transfer.across, p.X, F, p.size, stencil, self.candidates,
        )  # fmt: skip
        find_crossings[parallel](*arguments, p.body, self._cuts, self.segments, self.hash, self._kept)
        self.count = name_nodes(self.candidates, stencil.offsets, self.nodes)
        if self.count == 0:
            return None
        find_sides[parallel](*arguments, self.nodes)
        list_entries(self.candidates, stencil.offsets, self.nodes, self.count, self.entries)
        c = self.candidates
        rows = np.flatnonzero(c.side.any(axis=1))
        return make_cut(transfer, c.particle[rows], c.corner[rows], c.S[rows], c.G[rows], c.side[rows])
