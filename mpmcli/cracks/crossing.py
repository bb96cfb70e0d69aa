"""On which side of a crack points are, by exact integers: a line of sight crosses a chain or it does not.

Positions are whole numbers of 2⁻²⁴ cells from the first node of the grid, in which every test is exact: points on a
chain, chains along lines of nodes and lines of sight through points of a chain have one answer each, that does not
depend on the direction of the chain, and shifts by whole cells change nothing. A line of sight goes from the particle
to the node; two points see the same side of a crack if it crosses the chain an even number of times (Nairn 2003).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.grid import Grid
from mpmcli.cracks.chain import END, START, Chain

Array = np.ndarray

BITS = 24
UNIT = float(1 << BITS)
"""Whole numbers per cell."""


class Segments(NamedTuple):
    """The segments of all chains, crack after crack, each chain from its start to its end.

    ax, ay, bx, by : (n,) end points, A before B in the order of (x, y) [2⁻²⁴ cells]
    crack : (n,) index of the crack
    along : (n,) 1 where A comes first on the way from the chain's start, else −1
    normal : (n, 2) unit normal from below the crack to above
    at : (n, 2) the first point on the way [length]
    """

    ax: Array
    ay: Array
    bx: Array
    by: Array
    crack: Array
    along: Array
    normal: Array
    at: Array


@compiled_too
def whole(x: Any, origin: Any, inverse_cell: Any) -> Any:
    """Position along an axis in units of 2⁻²⁴ cells from the grid's first node."""
    return np.int64(np.floor((x - origin) * inverse_cell * UNIT + 0.5))


@compiled_too
def is_left(ax: Any, ay: Any, bx: Any, by: Any, x: Any, y: Any) -> Any:
    """Whether a point is on the left of the line from A to B; what is on the line is."""
    return (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0


@compiled_too
def crosses(ax: Any, ay: Any, bx: Any, by: Any, px: Any, py: Any, x: Any, y: Any) -> Any:
    """Whether the line of sight from (px, py) to (x, y) crosses the segment from A to B; A comes before B."""
    return is_left(ax, ay, bx, by, px, py) != is_left(ax, ay, bx, by, x, y) and is_left(
        px, py, x, y, ax, ay
    ) != is_left(px, py, x, y, bx, by)


def segments_of(chains: list[Chain], grid: Grid, beyond: float) -> Segments:
    """Return the segments of chains; behind a mouth the last one goes on by ``beyond`` [length]."""
    lines, owners = [], []
    for chain in chains:
        points = chain.X
        if not chain.tips[0]:
            points = np.column_stack([points[:, 0] + beyond * chain.direction(START), points])
        if not chain.tips[1]:
            points = np.column_stack([points, points[:, -1] + beyond * chain.direction(END)])
        lines.append(np.stack([points[:, :-1], points[:, 1:]]))
        owners.append(np.full(points.shape[1] - 1, chain.index))
    ends, crack = np.concatenate(lines, axis=2), np.concatenate(owners)
    origin = (grid.lower - grid.pad * grid.cell)[:, None]
    first, last = np.floor((ends - origin) / grid.cell[:, None] * UNIT + 0.5).astype(np.int64)
    ordered = (first[0] < last[0]) | ((first[0] == last[0]) & (first[1] <= last[1]))
    a, b = np.where(ordered, first, last), np.where(ordered, last, first)
    way = ends[1] - ends[0]
    way /= np.maximum(np.hypot(*way), np.finfo(float).tiny)
    normal = np.ascontiguousarray(np.stack([-way[1], way[0]], axis=1))
    return Segments(
        a[0], a[1], b[0], b[1], crack, np.where(ordered, 1, -1), normal, np.ascontiguousarray(ends[0].T)
    )


class Hash(NamedTuple):
    """Which segments may lie between a particle and a node that it sees, by the particle's cell.

    low : (2,) first cell of the box that holds all of them, counted from the grid's first node
    place : (ny, nx) place of each cell of the box in ``first``, −1 without segments
    first : (cells + 1,) where the segments of each cell begin
    segment : their indices, ascending in each cell
    """

    low: Array
    place: Array
    first: Array
    segment: Array


def hash_segments(segments: Segments, reach: int) -> Hash:
    """List the segments within ``reach`` cells of each cell."""
    low = np.stack([np.minimum(segments.ax, segments.bx), np.minimum(segments.ay, segments.by)]) >> BITS
    high = np.stack([np.maximum(segments.ax, segments.bx), np.maximum(segments.ay, segments.by)]) >> BITS
    low, high = low - reach, high + reach
    corner = low.min(axis=1)
    nx, ny = (high.max(axis=1) - corner + 1).tolist()
    wide = high - low + 1
    count = wide[0] * wide[1]
    segment = np.repeat(np.arange(len(count)), count)
    inner = np.arange(len(segment)) - np.repeat(np.cumsum(count) - count, count)
    x = low[0, segment] + inner % wide[0, segment] - corner[0]
    y = low[1, segment] + inner // wide[0, segment] - corner[1]
    cell = y * nx + x
    order = np.argsort(cell, kind="stable")
    cells, first = np.unique(cell[order], return_index=True)
    place = np.full(nx * ny, -1, dtype=np.int64)
    place[cells] = np.arange(len(cells))
    return Hash(corner, place.reshape(ny, nx), np.append(first, len(order)).astype(np.int64), segment[order])
