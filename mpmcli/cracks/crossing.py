"""On which side of a crack points are, by exact integers: a line of sight crosses a chain or it does not.

Positions are whole numbers of 2⁻²⁴ cells from the first node of the grid, in which every test is exact: points on a
chain, chains along lines of nodes and lines of sight through points of a chain have one answer each, that does not
depend on the direction of the chain, and shifts by whole cells change nothing. A line of sight goes from the particle
to the node; two points see the same side of a crack if it crosses the chain an even number of times (Nairn 2003).
"""

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.laws.impulse import TINIEST
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import called_once
from mpmcli.cracks.points import Points

Array = np.ndarray

BITS = 24
UNIT = float(1 << BITS)
"""Whole numbers per cell."""


FROM_X, FROM_Y, TO_X, TO_Y, OF, ALONG = range(6)
NORMAL, AT = 0, 2
"""Columns of ``Segments``."""


class Segments(NamedTuple):
    """The segments of all chains, crack after crack, each chain from its start to its end.

    whole : (n, 6) end points A (``FROM_X``, ``FROM_Y``) and B (``TO_X``, ``TO_Y``), A before B in the order of (x, y)
        [2⁻²⁴ cells]; index of the crack (``OF``); 1 where A comes first on the way from the chain's start, else −1
        (``ALONG``)
    place : (n, 4) unit normal from below the crack to above (``NORMAL``), the first point on the way (``AT``) [length]
    """

    whole: Array
    place: Array


@compiled_too
def whole(x: Any, origin: Any, inverse_cell: Any) -> Any:
    """Position along an axis in units of 2⁻²⁴ cells from the grid's first node."""
    return np.int64(np.floor((x - origin) * inverse_cell * UNIT + 0.5))


@compiled_too
def is_left(ax: Any, ay: Any, bx: Any, by: Any, x: Any, y: Any) -> Any:
    """Whether a point is on the left of the line from A to B; what is on the line is."""
    return (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0


S, CRACK, AX, AY, DX, DY, MINE = range(7)
"""Columns of the list of segments near a point: index and crack, A relative to the point, B − A, its side (0, 1)."""


@compiled_too
def list_near(
    segments: Any, table: Any, cell: Any, px: Any, py: Any, x0: Any, y0: Any, cells: Any, cuts: Any, body: Any,
    near: Any,
) -> Any:  # fmt: skip
    """List in ``near`` (longest, 7) the segments that may part a point from nodes; returns how many.

    The first node is at (x0, y0) from the point (px, py), the last one so many ``cells`` farther along both axes.
    ``cell`` is the place of the point's cell in the hash ``table``, negative where no segment is near. ``cuts``
    (cracks, bodies) says which cracks count for a body; all do for a negative ``body``.
    """
    n = 0
    if cell < 0:
        return n
    left, right = min(x0, 0), max(x0 + (cells << BITS), 0)
    low, high = min(y0, 0), max(y0 + (cells << BITS), 0)
    for at in range(table.first[cell], table.first[cell + 1]):
        s = table.segment[at]
        segment = segments.whole[s]
        ax, ay = segment[FROM_X] - px, segment[FROM_Y] - py
        dx, dy = segment[TO_X] - px - ax, segment[TO_Y] - py - ay
        if ax > right or ax + dx < left or min(ay, ay + dy) > high or max(ay, ay + dy) < low:
            continue
        area, across, along = dy * ax - dx * ay, (dy * left, dy * right), (dx * low, dx * high)
        if area + along[0] >= max(across[0], across[1]) or area + along[1] < min(across[0], across[1]):
            continue  # the whole box around point and nodes is on one side of the line
        crack = segment[OF]
        if body >= 0 and not cuts[crack, body]:
            continue
        near[n, S], near[n, CRACK], near[n, MINE] = s, crack, 1 if area >= 0 else 0
        near[n, AX], near[n, AY], near[n, DX], near[n, DY] = ax, ay, dx, dy
        n += 1
    return n


@compiled_too
def crosses(near: Any, k: Any, x: Any, y: Any) -> Any:
    """Whether the line of sight from a point to (x, y), relative to it, crosses segment ``k`` of its list.

    It does if its ends are on different sides of the segment, and the ends of the segment on different sides of it;
    what is on a line is on its left.
    """
    ax, ay, dx, dy = near[k, AX], near[k, AY], near[k, DX], near[k, DY]
    if (dx * (y - ay) - dy * (x - ax) >= 0) == (near[k, MINE] == 1):
        return False
    return (x * ay - y * ax >= 0) != (x * (ay + dy) - y * (ax + dx) >= 0)


@compiled_too
def cell_of(table: Any, x: Any, y: Any) -> Any:
    """Place in the hash of a cell of the grid, −1 where no segment is near."""
    row, column = y - table.low[1], x - table.low[0]
    if row < 0 or column < 0 or row >= table.place.shape[0] or column >= table.place.shape[1]:
        return np.int64(-1)
    return np.int64(table.place[row, column])


def allocate_segments(points: Points) -> Segments:
    """Make room for the segments of chains, with one more behind each mouth."""
    count = np.diff(points.first) - 1 + np.count_nonzero(points.mouths, axis=1)
    n = int(count.sum())
    segments = Segments(np.zeros((n, 6), dtype=np.int64), np.zeros((n, 4)))
    segments.whole[:, OF] = np.repeat(np.arange(len(count)), count)
    return segments


@compiled_too
def put_segment(segments, s, x, y, x_next, y_next, origin, cell):
    """Write segment ``s`` from one point to the next."""
    ax, ay = whole(x, origin[0], 1.0 / cell[0]), whole(y, origin[1], 1.0 / cell[1])
    bx, by = whole(x_next, origin[0], 1.0 / cell[0]), whole(y_next, origin[1], 1.0 / cell[1])
    forward = ax < bx or (ax == bx and ay <= by)
    segment, place = segments.whole[s], segments.place[s]
    segment[ALONG] = 1 if forward else -1
    segment[FROM_X], segment[FROM_Y] = (ax, ay) if forward else (bx, by)
    segment[TO_X], segment[TO_Y] = (bx, by) if forward else (ax, ay)
    wx, wy = x_next - x, y_next - y
    size = max(math.sqrt(wx * wx + wy * wy), TINIEST)
    place[NORMAL], place[NORMAL + 1], place[AT], place[AT + 1] = -wy / size, wx / size, x, y


@called_once
def find_segments(points, beyond, origin, cell, segments):
    """Write the segments of all chains; behind a mouth the last one goes on by ``beyond`` [length]."""
    s = 0
    X = points.X
    for crack in range(len(points.first) - 1):
        begin, end = points.first[crack], points.first[crack + 1] - 1
        for k in range(begin - 1, end + 1):
            if k == begin - 1:
                inner, outer = begin + 1, begin
            else:
                inner, outer = end - 1, end
            if (k == begin - 1 and not points.mouths[crack, 0]) or (k == end and not points.mouths[crack, 1]):
                continue
            if begin <= k < end:
                put_segment(segments, s, X[0, k], X[1, k], X[0, k + 1], X[1, k + 1], origin, cell)
            else:
                wx, wy = X[0, outer] - X[0, inner], X[1, outer] - X[1, inner]
                part = beyond / max(math.sqrt(wx * wx + wy * wy), TINIEST)
                x, y = X[0, outer] + part * wx, X[1, outer] + part * wy
                if k == end:
                    put_segment(segments, s, X[0, outer], X[1, outer], x, y, origin, cell)
                else:
                    put_segment(segments, s, x, y, X[0, outer], X[1, outer], origin, cell)
            s += 1


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
    begin, end = segments.whole[:, FROM_X:TO_X].T, segments.whole[:, TO_X:OF].T
    low, high = np.minimum(begin, end) >> BITS, np.maximum(begin, end) >> BITS
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


@called_once
def find_distances(X, origin, inverse_cell, segments, table, away):
    """How far particles are from the boxes around segments, along the axis where it is more, into ``away`` (N,).

    In cells; infinite where the hash lists no segment near.
    """
    for p in range(X.shape[1]):
        away[p] = np.inf
        x, y = whole(X[0, p], origin[0], inverse_cell[0]), whole(X[1, p], origin[1], inverse_cell[1])
        cell = cell_of(table, x >> BITS, y >> BITS)
        if cell < 0:
            continue
        nearest = np.int64(1) << 62
        for at in range(table.first[cell], table.first[cell + 1]):
            s = table.segment[at]
            segment = segments.whole[s]
            ax, ay, bx, by = segment[FROM_X], segment[FROM_Y], segment[TO_X], segment[TO_Y]
            dx = max(min(ax, bx) - x, x - max(ax, bx))
            dy = max(min(ay, by) - y, y - max(ay, by))
            nearest = min(nearest, max(dx, dy))
        away[p] = nearest / UNIT
