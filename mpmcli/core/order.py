"""Sorting particles by cell: bands for deterministic parallel scatters, and the list of nodes in use.

Bands are slabs of H rows of cells along the last axis. In space they are tiles of H × H columns of cells, cut along the
two axes along which the particles extend farthest. Since the last sort no particle may have drifted more than
``MAX_DRIFT`` cells along any axis; then a particle of a band touches at most w − 1 rows of nodes below the band and w
above it (w: stencil width), and bands of one colour (every second one along each cut axis) never touch the same node if
H ≥ 2w − 1.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.chunks import CHUNKS, chunks_of_lines
from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.grid import Grid
from mpmcli.core.marks import spread
from mpmcli.core.particles import Particles

MAX_DRIFT = 1.0 - 1e-6
"""Cells that a particle may travel between two sorts: one, less than round-off in the location of cells can bridge."""

SLABS = 64
"""Parts of the keys that are sorted side by side, at most."""

Array = np.ndarray


class Bands(NamedTuple):
    """Bands of particles, colour after colour: those of one colour are scattered side by side."""

    first: Array
    """(bands + 1,) first particle of each band and the end, unsigned."""
    turn: Array
    """(bands,) the bands in the order of their colours, unsigned."""
    colours: Array
    """(colours + 1,) where each colour begins in ``turn``, and the end."""


class CellOrder:
    """Keeps particles sorted by cell (x fastest), with bands, chunks and the grid's active nodes up to date.

    Attributes
    ----------
    bands : the bands of particles
    cut : (1 or 2,) axes along which bands follow each other
    chunks : (CHUNKS + 1,) first particle of each chunk of lines of cells and the end, unsigned
    drift : largest distance travelled since the last sort [cells]
    version : counts the sorts
    parallel : whether the last sort ran parallel kernels
    """

    def __init__(self, particles: Particles, grid: Grid):
        self.particles = particles
        self.grid = grid
        self.version = 0
        self.drift = 0.0
        self.parallel = False
        none = np.zeros(0, dtype=np.uint64)
        self.cut = np.zeros(0, dtype=np.int64)
        self.bands = Bands(np.zeros(1, dtype=np.uint64), none, np.zeros(1, dtype=np.int64))
        self.chunks = np.zeros(CHUNKS + 1, dtype=np.uint64)

    @property
    def is_stale(self) -> bool:
        """Whether a particle may have left the reach of its band."""
        return self.drift > MAX_DRIFT

    def memory(self) -> dict[str, Any]:
        """Return what a checkpoint keeps of it."""
        kept = ("cut", "chunks", "drift", "version")
        return {name: np.asarray(getattr(self, name)) for name in kept} | self.bands._asdict()

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Take it back."""
        self.bands = Bands(*(memory[name] for name in Bands._fields))
        self.cut, self.chunks = memory["cut"], memory["chunks"]
        self.drift, self.version = float(memory["drift"]), int(memory["version"])

    def sort(self, parallel: bool) -> None:
        """Sort all particle arrays by cell and rebuild bands, chunks and active nodes."""
        particles, grid = self.particles, self.grid
        self.parallel = parallel
        d, count = particles.X.shape
        cell = np.empty((d, count), dtype=np.int64)
        locate_cells[parallel](particles.X, grid.lower, 1.0 / grid.cell, grid.cells, cell)
        low, high = cell.min(axis=1).tolist(), cell.max(axis=1).tolist()
        extent = [h - i + 1 for i, h in zip(low, high, strict=True)]
        tiling = tiling_of(tuple(extent), 2 * grid.width - 1)
        key = sum(places[cell[a] - low[a]] for a, places in enumerate(tiling.places))
        starts, order = sort_by_key(key, tiling.keys, parallel)
        field = particles.velocity_field
        if not np.array_equal(order, np.arange(count)):
            for name, array in particles.arrays().items():
                if array.size:
                    setattr(particles, name, array.take(order, axis=-1))
        self.bands, self.cut = tiling.bands(starts), tiling.cut
        self.chunks = tiling.chunks(starts)
        if grid.fields == 1:
            grid.active = self._reach(tiling.by_cell(starts[1:] > starts[:-1]), low, extent)
        else:
            grid.active = self._reach_of_fields(cell, field)
            if grid.mirrors:
                grid.active = grid.with_images(grid.active)
        if grid.periodic:
            grid.active = grid.with_periods(grid.active)
        grid.active_version += 1
        self.version += 1
        self.drift = 0.0

    def forget(self) -> None:
        """Let the next step sort, because particles have jumped."""
        self.drift = np.inf

    def jumped(self, axes: list[int]) -> None:
        """Let the next step sort if particles that have jumped by a period along ``axes`` may have left their reach.

        They leave their band along cut axes. Along others, the nodes in use have those that particles see at the other
        side, unless the reach of a cell at a side ends at that of the grid.
        """
        if axes and (np.isin(axes, self.cut).any() or self.grid.width > self.grid.pad + 1):
            self.forget()

    def drop(self, kept: Array) -> None:
        """Fit bands and chunks to the particles of the mask ``kept`` (N,), which are sorted at the next step."""
        left = np.concatenate([np.zeros(1, dtype=np.uint64), np.cumsum(kept, dtype=np.uint64)])
        self.bands, self.chunks = self.bands._replace(first=left[self.bands.first]), left[self.chunks]
        self.drift = np.inf

    @property
    def slots(self) -> int:
        """How many bands or chunks exist: each needs stencil buffers of its own."""
        return max(len(self.bands.first), len(self.chunks)) - 1

    def _reach_of_fields(self, cell: Array, field: Array) -> Array:
        """The same field by field, as degrees of freedom; ``cell`` (d, N) and ``field`` (N,) of the particles."""
        n, d = self.grid.fields, cell.shape[0]
        low = np.full((n, d), np.iinfo(np.int64).max)
        high = np.full((n, d), -1, dtype=np.int64)
        _bound_cells(cell, field, low, high)
        extent = np.maximum(high - low + 1, 0)
        begin = np.concatenate([[0], np.cumsum(np.prod(extent, axis=1))])
        occupied = np.zeros(begin[-1], dtype=bool)
        _mark_cells(cell, field, low, extent, begin, occupied)
        return np.concatenate(
            [
                self._reach(occupied[begin[f] : begin[f + 1]], low[f].tolist(), extent[f].tolist())
                + f * self.grid.node_count
                for f in range(n)
                if begin[f] < begin[f + 1]
            ]
        )

    def _reach(self, occupied: Array, low: list[int], extent: list[int]) -> Array:
        """Every node that particles in the occupied cells of a box may touch before the next sort."""
        grid = self.grid
        below, above = grid.width - 1, grid.width
        first = [max(i + grid.pad - below, 0) for i in low]
        ends = (i + n + grid.pad + above for i, n in zip(low, extent, strict=True))
        box = [min(end, count) - i for i, end, count in zip(first, ends, grid.shape, strict=True)]
        mark = np.zeros(box[::-1], dtype=bool)
        at = [
            slice(i + grid.pad - f, i + grid.pad - f + n) for i, f, n in zip(low, first, extent, strict=True)
        ]
        mark[tuple(at[::-1])] = occupied.reshape(extent[::-1])
        place = np.flatnonzero(spread(mark, below, above))
        nodes = place + sum(i * stride for i, stride in zip(first, grid.stride, strict=True))
        inner = 1
        for a in range(1, grid.dimensions):
            inner *= box[a - 1]
            nodes += place // inner * (grid.stride[a] - box[a - 1] * grid.stride[a - 1])
        return nodes


class Tiling:
    """The order in which the cells of a box are sorted: band after band, and in each band x fastest.

    Parameters
    ----------
    extent : cells of the box along each axis
    least : smallest height of bands whose neighbours but one touch no common node [cells]

    Attributes
    ----------
    cut : axes that are cut into bands
    places : per axis, what a cell with this index along it adds to its place in the order
    keys : number of places; some are empty, since all bands have the same height
    """

    def __init__(self, extent: tuple[int, ...], least: int):
        d = len(extent)
        self.cut = np.sort(np.argsort(extent, kind="stable")[-2:]) if d == 3 else np.array([d - 1])
        high = tile_height if d == 3 else band_height
        height = [high(n, least) if a in self.cut else n for a, n in enumerate(extent)]
        self._counts = [-(-n // h) for n, h in zip(extent, height, strict=True)]
        self._length = height[0] if d > 1 else 1
        self._band = int(np.prod(height))
        self.keys = self._band * int(np.prod(self._counts))
        self.places = []
        inner, outer = 1, self._band
        for n, h, count in zip(extent, height, self._counts, strict=True):
            index = np.arange(n)
            self.places.append(index % h * inner + index // h * outer)
            inner, outer = inner * h, outer * count
        self._turn, self._colours = self._take_turns()

    def _take_turns(self) -> tuple[Array, Array]:
        index = np.indices([self._counts[a] for a in self.cut[::-1]])
        colour = sum(index[i].ravel() % 2 << i for i in range(len(index)))
        turn = np.argsort(colour, kind="stable")
        return turn.astype(np.uint64), np.searchsorted(colour[turn], np.arange(2 ** len(index) + 1))

    def bands(self, starts: Array) -> Bands:
        """Return the bands of particles whose places in the order begin at ``starts`` (keys + 1,)."""
        return Bands(starts[:: self._band].astype(np.uint64), self._turn, self._colours)

    def chunks(self, starts: Array) -> Array:
        """Return the chunks of lines of cells of the same particles, as ``chunks_of_lines`` does."""
        lines = starts[:: self._length]
        return chunks_of_lines(lines[:-1][lines[1:] > lines[:-1]], int(starts[-1]))

    def by_cell(self, values: Array) -> Array:
        """Return of ``values`` (keys,) those of the cells of the box, x fastest."""
        place = self.places[0]
        for of_axis in self.places[1:]:
            place = of_axis[(...,) + (None,) * place.ndim] + place
        return values[place]


tiling_of = lru_cache(maxsize=8)(Tiling)
"""A moving body occupies boxes of few different extents."""


def band_height(rows: int, least: int) -> int:
    """Height of the bands: at least ``least`` rows, chosen so that two workers finish together."""

    def rows_in_sequence(height: int) -> int:
        count = -(-rows // height)
        return height * (-(-((count + 1) // 2) // 2) + -(-(count // 2) // 2))

    candidates = range(least, max(2 * least, 10))
    return min(candidates, key=lambda h: (rows_in_sequence(h), h))


def tile_height(rows: int, least: int) -> int:
    """Height of tiles: at least ``least`` rows where there are two or more, of which as many as possible are made."""
    return -(-rows // max(1, rows // least))


@kernel
def locate_cells(X, lower, inverse_cell, cells, cell):
    """Cell of each particle along each axis, (d, N); a particle on the upper border belongs to the last cell."""
    for p in prange(X.shape[1]):
        for a in range(X.shape[0]):
            i = np.int64(np.floor((X[a, p] - lower[a]) * inverse_cell[a]))
            cell[a, p] = min(max(i, 0), cells[a] - 1)


def sort_by_key(key: Array, keys: int, parallel: bool) -> tuple[Array, Array]:
    """Stable counting sort of ``key`` (N,) in 0 … keys − 1.

    Returns the first place of each key and the end, (keys + 1,), and the old places in new order, (N,).
    """
    shift = np.uint64(max(0, (keys - 1).bit_length() - SLABS.bit_length() + 1))
    slabs = ((keys - 1) >> int(shift)) + 1
    starts, order = np.zeros(keys + 1, dtype=np.int64), np.empty(len(key), dtype=np.int64)
    count, first = np.empty((CHUNKS, slabs), dtype=np.uint64), np.empty(slabs + 1, dtype=np.uint64)
    part, place = np.empty(len(key), dtype=np.uint64), np.empty(keys, dtype=np.uint64)
    counting_sort[parallel](key.view(np.uint64), shift, count, first, part, place, starts, order)
    return starts, order


@kernel
def counting_sort(key, shift, count, first, part, place, starts, order):
    """Sort by slabs of 2^``shift`` keys, then each slab by its keys; both stably, so that the order is unique.

    ``starts`` (keys + 1,) zero on entry, ``order`` (N,): the results of ``sort_by_key``. Work space: ``count`` (blocks,
    slabs), ``first`` (slabs + 1,), ``part`` (N,), ``place`` (keys,).
    """
    blocks, slabs = count.shape
    n, keys = key.shape[0], place.shape[0]
    one = np.uint64(1)
    for b in prange(blocks):
        for s in range(slabs):
            count[b, s] = 0
        for p in range(np.uint64(n * b // blocks), np.uint64(n * (b + 1) // blocks)):
            count[b, key[p] >> shift] += 1
    total = np.uint64(0)
    for s in range(slabs):
        first[s] = total
        for b in range(blocks):
            here = count[b, s]
            count[b, s] = total
            total += here
    first[slabs] = total
    for b in prange(blocks):
        for p in range(np.uint64(n * b // blocks), np.uint64(n * (b + 1) // blocks)):
            s = key[p] >> shift
            part[count[b, s]] = p
            count[b, s] += one
    for s in prange(slabs):
        low, high = np.uint64(s) << shift, min((np.uint64(s) + one) << shift, np.uint64(keys))
        for i in range(first[s], first[s + 1]):
            starts[key[part[i]] + one] += 1
        total = first[s]
        for k in range(low, high):
            place[k] = total
            total += np.uint64(starts[k + one])
            starts[k + one] = total
        for i in range(first[s], first[s + 1]):
            p = part[i]
            order[place[key[p]]] = p
            place[key[p]] += one


@inline
def _bound_cells(cell, field, low, high):
    """Smallest and largest cell of each field along each axis, ``low`` and ``high`` (fields, d)."""
    for p in range(cell.shape[1]):
        f = field[p]
        for a in range(cell.shape[0]):
            low[f, a] = min(low[f, a], cell[a, p])
            high[f, a] = max(high[f, a], cell[a, p])


@inline
def _mark_cells(cell, field, low, extent, begin, occupied):
    """Mark the cells with particles of each field within its box, x fastest; the box of field f begins at ``begin``."""
    for p in range(cell.shape[1]):
        f = field[p]
        at = 0
        for a in range(cell.shape[0] - 1, -1, -1):
            at = at * extent[f, a] + cell[a, p] - low[f, a]
        occupied[begin[f] + at] = True
