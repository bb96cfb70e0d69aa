"""Which particles cracks cut, and on which side of its cracks a particle sees a node: step by step."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mpmcli.core.chunks import CHUNKS
from mpmcli.core.grid import Grid
from mpmcli.core.order import CellOrder, or_shifted
from mpmcli.core.transfer.cut import Cut, first_rows, make_cut
from mpmcli.cracks.chain import Chain
from mpmcli.cracks.crack_nodes import (
    NEAR,
    Candidates,
    CrackNodes,
    CutRows,
    Entries,
    find_crossings,
    find_sides,
)
from mpmcli.cracks.crossing import (
    UNIT,
    Hash,
    Segments,
    allocate_segments,
    find_distances,
    find_segments,
    hash_segments,
)
from mpmcli.cracks.points import AllPoints, Points

Array = np.ndarray

DRIFT = 1
"""Cells that chains and particles may move between two sorts."""
SLACK = 0.2
"""Cells that they may move before candidates are listed anew."""


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
        self.points = AllPoints(chains, float(grid.cell.min()))
        self._origin = grid.lower - grid.pad * grid.cell
        self._counts = np.zeros(3, dtype=np.int64)
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
        """List the particles near cracks, of bodies that some crack cuts, and the segments near each cell."""
        grid, X = self._grid, self._order.particles.X
        is_cut: Array = np.logical_or.reduce(self._cuts, axis=0)[self._order.particles.body]
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
        # faces move with what their crack may cut: not with a wedge between them
        particle = np.flatnonzero((away <= far) & is_cut).astype(np.uint64)
        c, m, d = len(particle), grid.width**grid.dimensions, grid.dimensions
        self.candidates = Candidates(
            particle=particle,
            ranges=first_rows(particle, self._order.chunks),
            close=away[particle] <= near,
            seen=np.zeros(c, dtype=np.uint8),
            corner=np.zeros(c, dtype=np.uint64),
            place=np.zeros((c, d)),
            S=np.zeros((c, m)),
            number=np.zeros((c, m), dtype=np.uint8),
            segment=np.zeros((c, m, min(len(self.chains), 2)), dtype=np.int32),
            side=np.zeros((c, m), dtype=np.uint8),
        )
        longest = int(np.diff(self.hash.first).max(initial=0))
        self._kept = np.zeros((CHUNKS, longest), dtype=np.int64)
        self.entries = Entries(
            np.zeros(len(self.nodes.node) + 1, dtype=np.int64),
            np.zeros(c * m, dtype=np.int32),
            np.zeros(c * m, dtype=np.uint8),
        )
        most = int(np.count_nonzero(self.candidates.close))  # untouched room costs nothing
        self._cut = CutRows(np.empty(most, dtype=np.int64), np.empty((most, d * m)))
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
            *operator, self._reach, c, self.segments, self.nodes, self.entries, self.points.get(), self._origin,
            self._grid.cell, self._cut, self._counts,
        )  # fmt: skip
        if self.count == 0:
            return None
        rows, G = self._cut.row[: self._counts[2]], self._cut.G[: self._counts[2]].copy()
        return make_cut(transfer, c.particle[rows], c.corner[rows], c.S[rows], G, c.side[rows])
