"""Which particles cracks cut, and on which side of its cracks a particle sees a node: step by step."""

import math
from typing import Any

import numpy as np

from mpmcli.core.compiled.bound import TypedCalls
from mpmcli.core.grid import Grid
from mpmcli.core.marks import spread
from mpmcli.core.order import CellOrder
from mpmcli.core.transfer.cut import Cut
from mpmcli.cracks.chain import Chain
from mpmcli.cracks.crack_nodes import ROUND_OFF, Reach, find_sides
from mpmcli.cracks.crossing import (
    Hash,
    Segments,
    allocate_segments,
    find_distances,
    find_segments,
    hash_segments,
)
from mpmcli.cracks.points import AllPoints, Points
from mpmcli.cracks.sights import (
    CUT,
    LISTED,
    NODES,
    THIRD,
    Candidates,
    Crossings,
    CutRows,
    Scratch,
    Sights,
    allocate_crossings,
    allocate_cut,
    allocate_nodes,
    allocate_sights,
    cut_of,
)

Array = np.ndarray

DRIFT = 1
"""Cells that chains and particles may move between two sorts."""
SLACK = 0.2
"""Cells that they may move before candidates are listed anew."""
GRID_FUNCTIONS = {"linear": 1.0, "quadratic": 1.5}
"""How far grid functions reach from their node [cells]."""


class CrackSides:
    """Tells the sides of nodes on which particles are, in every step.

    Parameters
    ----------
    chains : of all cracks
    cuts : (cracks, bodies) whether a crack cuts a body
    order, grid : of the simulation
    shape : ``ShapeEntry`` of the scene

    Attributes
    ----------
    points : of all chains
    candidates : particles near cracks
    nodes, sights, crossings : of the step
    segments, hash : of the chains in the step; where segments are near cells
    reach : how far particles see, with stencils of the width that they have now
    drift : how far points have moved since the candidates were listed, at most [cells]
    """

    def __init__(self, chains: list[Chain], cuts: Array, order: CellOrder, grid: Grid, shape: Any):
        self.chains, self._cuts = chains, cuts
        self._order, self._grid, self._shape = order, grid, shape
        self.points = AllPoints(chains, float(grid.cell.min()))
        self._origin = grid.lower - grid.pad * grid.cell
        self._counts = np.zeros(6, dtype=np.int64)
        self.drift = 0.0
        self._version, self._listed_at = -1, 0.0
        self._beyond = (grid.width + 2) * float(grid.cell.max())
        self._call = TypedCalls()
        self.segments: Segments
        self.hash: Hash
        self.candidates: Candidates
        self.reach: Reach
        self.sights: Sights
        self.crossings: Crossings
        self._cut: CutRows
        self._scratch: Scratch
        self._mark = np.zeros(grid.node_count, dtype=np.uint8)
        self.nodes = allocate_nodes(grid.node_count, 0)

    @property
    def count(self) -> int:
        """Number of crack nodes: the first ones of ``nodes``."""
        return int(self._counts[NODES])

    @property
    def listed(self) -> int:
        """Number of all nodes that ``nodes`` lists."""
        return int(self._counts[LISTED])

    @property
    def third(self) -> int:
        """Number of crack nodes at which a third crack is left out."""
        return int(self._counts[THIRD])

    @property
    def weights(self) -> Array:
        """(at least, c, m) shape function values of cut particles, the first rows of ``sights``."""
        return self._cut.S

    @property
    def near(self) -> Array:
        """Room for the longest list of the hash, see ``crossing.list_near``."""
        return self._scratch.near

    @property
    def counts(self) -> Array:
        """(6,) all counts of the step, as ``sights`` has them."""
        return self._counts

    def _find_reach(self) -> Reach:
        w, shape = self._grid.width, self._shape
        follows = shape.follows_deformation  # such domains reach farther than half the stencil
        most = w - 1.0 if follows else 0.5 * w
        return Reach(GRID_FUNCTIONS.get(shape.grid_functions, most), shape.domain != "point", follows, most)

    def forget(self) -> None:
        """Let the next step list candidates anew: chains and particles have been set back."""
        self._version = -1

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
        return cells.low - below, spread(mark, below, above)

    def _find_segments(self, points: Points, segments: Segments) -> None:
        find_segments(points, self._beyond, self._origin, self._grid.cell, segments)

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
        self.reach = self._find_reach()
        reach = self.reach.most
        near, far = reach + 2 * SLACK, 2.0 * reach + 2 * SLACK
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
        particle = np.flatnonzero((away <= far) & is_cut).astype(np.uint32)
        # rounded down: what may be parted is never passed over
        self.candidates = Candidates(particle, (away[particle] - ROUND_OFF).astype(np.float32))
        c, m = len(particle), grid.width**grid.dimensions
        close = int(np.count_nonzero(away[particle] <= near + 10.0 * ROUND_OFF))
        self._clear()
        longest = int(np.diff(self.hash.first).max(initial=0))
        times, crossed, number = np.zeros((3, m), dtype=np.int64)
        self._scratch = Scratch(np.zeros((longest, 7), dtype=np.int64), times, crossed, number, self._mark)
        self.sights = allocate_sights(c, m)
        bands, chunks = self._order.bands.first, self._order.chunks
        self._cut = allocate_cut(close, m, X.shape[1], len(bands), len(chunks))
        self.crossings = allocate_crossings(close * m * min(len(self.chains), 2))
        self._version, self._listed_at, self.drift = self._order.version, self._order.drift, 0.0

    def _make_room(self, most: int) -> None:
        self._clear()
        self.nodes = allocate_nodes(0, most)._replace(slot_of_node=self.nodes.slot_of_node)

    def part_all(self) -> None:
        """Move all particles of a simulation that is not run to where the first crack parts them from nodes."""
        X, cell = self.chains[0].X[:, :2], self._grid.cell
        way = (X[:, 1] - X[:, 0]) / cell
        beside = ROUND_OFF * np.array([-way[1], way[0]]) / np.hypot(*way)
        self._order.particles.X[:] = (X.mean(axis=1) + beside * cell)[:, None]

    def _clear(self) -> None:
        self.nodes.slot_of_node[self.nodes.node[: self.listed]] = -1
        self._counts[:] = 0

    def find_cut(self, transfer: Any, F: Array) -> Cut | None:
        """Find the sides of this step; ``F`` (nF, N) are the deformation gradients that its stencils are built from."""
        order, grid = self._order, self._grid
        if self._version != order.version:
            self.sorted()
        elif max(self.drift, order.drift - self._listed_at) > SLACK:
            self._list_candidates()
        p = transfer.particles
        moved = self.drift + (order.drift - self._listed_at)
        self._call(
            find_sides, transfer.shape.parameters, transfer.geometry, transfer.across, p.X, F, p.size,
            transfer.stencil, order.bands.first, order.chunks, p.velocity_field, p.body, grid.fields, grid.sides,
            self._cuts, self.candidates, self.points.get(), self._beyond, self._origin, grid.cell, self.reach, moved,
            self.segments, self.hash, self._scratch, self.nodes, self.sights, self._cut, self.crossings, self._counts,
            key=len(transfer.across),
        )  # fmt: skip
        return cut_of(self.sights, self._cut, int(self._counts[CUT])) if self.count > 0 else None
