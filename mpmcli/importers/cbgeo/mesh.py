"""Regular grids in mesh files: rectangular cells of one size, along the axes or turned with all that lies in them."""

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.core.errors import SceneError
from mpmcli.importers.cbgeo.reading import Array, Table

TOLERANCE = 1e-4
"""How far nodes may lie from those of the regular grid, in cells: mesh files have few digits."""
AXES = ("x", "y", "z")
CELL_TYPES = {
    "ED2Q4": (2, "linear"),
    "ED2Q16G": (2, "ugimp"),
    "ED3H8": (3, "linear"),
    "ED3H64": (3, "ugimp"),
    "ED3H64G": (3, "ugimp"),
}
"""Number of axes and shape function of each type of cell that a regular grid may have."""
OTHER_CELLS = {
    "ED2T3": "triangles",
    "ED2T6": "triangles",
    "ED2Q8": "cells with nodes in the middle of their edges",
    "ED2Q9": "cells with nodes in the middle of their edges",
    "ED3H20": "cells with nodes in the middle of their edges",
}


@dataclass(frozen=True)
class RegularGrid:
    """A regular grid in its own axes.

    Attributes
    ----------
    lower, cell : (d,)
        Lowest corner in the grid's axes, and edges of a cell.
    counts : (d,)
        Cells along each axis.
    axes : (d, d)
        Columns are the directions of the grid's axes in the source.
    nodes : (n, d)
        Indices of each node of the file along the axes.
    cells : (m, d)
        Indices of each cell of the file.
    """

    lower: Array
    cell: Array
    counts: Array
    axes: Array
    nodes: Array
    cells: Array

    @property
    def d(self) -> int:
        """Number of axes."""
        return len(self.cell)

    @property
    def upper(self) -> Array:
        """Highest corner."""
        return rounded(self.lower + self.cell * self.counts)

    @property
    def is_turned(self) -> bool:
        """Whether the grid's axes are not those of the source."""
        return bool((self.axes != np.eye(self.d)).any())

    @property
    def angle(self) -> float:
        """Degrees from the source's x to the grid's, in two dimensions."""
        return float(rounded(np.degrees(np.arctan2(self.axes[1, 0], self.axes[0, 0]))))

    def inside(self, vectors: Array) -> Array:
        """Components (…, d) of vectors of the source along the grid's axes."""
        if not self.is_turned:
            return vectors
        turned = vectors @ self.axes
        turned[np.abs(turned) < 1e-9 * max(1.0, float(np.abs(turned).max(initial=0.0)))] = 0.0
        return turned

    def place(self, index: Array) -> Array:
        """Coordinates of nodes by their indices (…, d)."""
        return rounded(self.lower + self.cell * index)


def rounded(values: Any) -> Array:
    """Numbers without the last digits that arithmetic leaves."""
    return np.vectorize(lambda value: float(f"{value:.11g}"), otypes=[float])(values) + 0.0


def read_grid(table: Table, d: int, shape: str = "linear") -> RegularGrid:
    """Recognise the regular grid in a mesh file: its first row counts nodes and cells, which follow.

    Cells of GIMP (``ugimp``) list their corners and then the nodes around them; those at the border are left out.

    Raises SceneError with the line where the mesh is no regular grid, and why.
    """
    if len(table.rows[0]) != 2:
        raise table.fault(0, "the first row must give the numbers of nodes and of cells")
    corners = 2**d
    n, m = (int(count) for count in table.rows[0])
    if n < corners or m < 1:
        raise table.fault(0, f"a mesh needs at least {corners} nodes and one cell")
    if len(table.rows) != 1 + n + m:
        words = f"the first row counts {n} nodes and {m} cells, but {len(table.rows) - 1} rows follow"
        raise table.fault(0, words)
    for row in range(1, 1 + n):
        if len(table.rows[row]) not in (d, 3):
            raise table.fault(
                row, f"{d} coordinates are needed for a node, not {len(table.rows[row])} numbers"
            )
    for row in range(1 + n, 1 + n + m):
        numbers = table.rows[row]
        wanted = corners if shape == "linear" else 4**d
        if len(numbers) not in (corners, wanted):
            raise table.fault(row, f"{wanted} nodes are needed for a cell, not {len(numbers)}")
        if not all(number.is_integer() and 0 <= number < n for number in numbers):
            raise table.fault(row, f"the nodes of a cell are whole numbers from 0 to {n - 1}")
    x = np.array([numbers[:d] for numbers in table.rows[1 : 1 + n]], dtype=float)
    corner = np.array([numbers[:corners] for numbers in table.rows[1 + n :]], dtype=int)
    edges = x[corner[0, [1, 3, 4][:d]]] - x[corner[0, 0]]
    axes = _axes(edges, table, 1 + n)
    local = x @ axes
    lower, cell, counts, nodes = _lattice(local, np.abs(edges @ axes).max(axis=0), table)
    cells = _cells(corner, nodes, counts, table, 1 + n)
    if len(cells) != counts.prod() and shape == "linear":
        raise _irregular(table, None, f"it has {len(cells)} cells, a full box has {counts.prod()}")
    lower = np.where(np.abs(lower) < 1e-6 * cell, 0.0, lower)
    return RegularGrid(rounded(lower), rounded(cell), counts, axes, nodes, cells)


def _irregular(table: Table, row: int | None, words: str) -> SceneError:
    return table.fault(row, f"the mesh is no regular grid: {words}")


def _axes(edges: Array, table: Table, row: int) -> Array:
    """Directions (columns) of the edges of the first cell, in the order nearest to x, y, z."""
    d = len(edges)
    length = np.linalg.norm(edges, axis=1)
    if not (length > 0).all():
        raise _irregular(table, row, "an edge of this cell has no length")
    units = edges / length[:, None]
    if not np.allclose(units @ units.T, np.eye(d), rtol=0, atol=TOLERANCE):
        raise _irregular(table, row, "the edges of this cell are not at right angles")
    order = max(itertools.permutations(range(d)), key=lambda p: sum(abs(units[p[k], k]) for k in range(d)))
    axes = np.array([units[k] * np.sign(units[k, i] or 1.0) for i, k in enumerate(order)]).T
    if np.allclose(axes, np.eye(d), rtol=0, atol=TOLERANCE):
        return np.eye(d)
    return _exact_turn(axes)


def _exact_turn(axes: Array) -> Array:
    """The rotation nearest to axes that a file gives with few digits; in two dimensions of a rounded angle."""
    if len(axes) == 2:
        angle = np.arctan2(axes[1, 0], axes[0, 0])
        degrees = float(np.degrees(angle))
        angle = np.radians(round(degrees, 4)) if abs(degrees - round(degrees, 4)) < 1e-5 else angle
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, -s], [s, c]])
    u, _, v = np.linalg.svd(axes)
    return np.asarray(u @ v)


def _lattice(x: Array, edge: Array, table: Table) -> tuple[Array, Array, Array, Array]:
    """Lowest corner, cell, counts and indices of nodes (n, d) in the grid's axes."""
    lower, upper = x.min(axis=0), x.max(axis=0)
    if not (edge > 0).all():
        raise _irregular(table, None, "its first cell is flat")
    whole = np.round((upper - lower) / edge)
    if not (whole >= 1).all() or whole.prod() > 1e9:
        raise _irregular(table, None, "its cells differ in size")
    counts = whole.astype(int)
    cell = (upper - lower) / counts
    at = (x - lower) / cell
    nodes = np.round(at).astype(int)
    off = np.abs(at - nodes).max(axis=1)
    if off.max() > TOLERANCE:
        row = int(np.argmax(off > TOLERANCE))
        shape = " × ".join(f"{h:.4g}" for h in cell)
        raise _irregular(table, 1 + row, f"this node does not lie on the lines of cells of {shape}")
    key = np.ravel_multi_index(tuple(nodes.T), tuple(counts + 1))
    order = np.argsort(key, kind="stable")
    double = np.flatnonzero(np.diff(key[order]) == 0)
    if double.size:
        row = int(order[double[0] + 1])
        raise _irregular(table, 1 + row, f"this node lies where node {int(order[double[0]])} is")
    if len(x) != (counts + 1).prod():
        for axis, name in enumerate(AXES[: x.shape[1]]):
            steps = np.diff(np.unique(nodes[:, axis]))
            if steps.max() > 1:
                least, most = cell[axis] * steps.min(), cell[axis] * steps.max()
                raise _irregular(table, None, f"its cells are {least:.4g} to {most:.4g} long along {name}")
        full = " × ".join(str(c + 1) for c in counts)
        raise _irregular(
            table, None, f"it has {len(x)} nodes, a full box of {full} has {(counts + 1).prod()}"
        )
    return lower, cell, counts, nodes


def _cells(corner: Array, nodes: Array, counts: Array, table: Table, first: int) -> Array:
    """Indices (m, d) of the cells."""
    d = nodes.shape[1]
    at = nodes[corner]
    cells = at.min(axis=1)
    code = ((at - cells[:, None, :]) * 2 ** np.arange(d)).sum(axis=2)
    within = (at - cells[:, None, :] <= 1).all(axis=(1, 2))
    whole = within & (np.sort(code, axis=1) == np.arange(2**d)).all(axis=1)
    if not whole.all():
        row = int(np.argmin(whole))
        raise _irregular(table, first + row, "these nodes are not the corners of one cell")
    key = np.ravel_multi_index(tuple(cells.T), tuple(counts))
    if len(np.unique(key)) != len(key):
        order = np.argsort(key, kind="stable")
        row = int(order[np.flatnonzero(np.diff(key[order]) == 0)[0] + 1])
        raise _irregular(table, first + row, "this cell is there twice")
    return np.asarray(cells)


def cover(index: Array) -> list[tuple[Array, Array]]:
    """Boxes (lowest, highest index) that together hold these indices (n, d) and no others, each index once."""
    left = {tuple(row) for row in index.tolist()}
    found: list[tuple[Array, Array]] = []
    for start in sorted(left, key=lambda row: row[::-1]):
        if start not in left:
            continue
        low, high = list(start), list(start)
        for axis in range(len(start)):
            while _layer(low, high, axis) <= left:
                high[axis] += 1
        box = set(itertools.product(*(range(a, b + 1) for a, b in zip(low, high, strict=True))))
        left -= box
        found.append((np.array(low), np.array(high)))
    return found


def _layer(low: list[int], high: list[int], axis: int) -> set[tuple[int, ...]]:
    """Indices next to a box, towards the upper side of an axis."""
    ranges = [range(a, b + 1) for a, b in zip(low, high, strict=True)]
    ranges[axis] = range(high[axis] + 1, high[axis] + 2)
    return set(itertools.product(*ranges))
