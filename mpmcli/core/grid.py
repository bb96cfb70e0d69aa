"""The background grid: a regular lattice with ghost layers, dense arrays, and the list of nodes in use.

Node ``(ix, iy, iz)`` has the flat index ``ix + Nx·(iy + Ny·iz)`` (x fastest) and lies at ``lower + (i − pad)·cell``.
Arrays are dense but untouched pages cost nothing: only nodes in ``active`` are ever visited.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.chunks import chunks_of_nodes
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.dofs import field_of, node_of, side_of


class LineGeometry(NamedTuple):
    """What compiled code needs to know of a grid with one axis."""

    origin: tuple[float]
    """Coordinate of the first (ghost) node of each axis [length]."""
    inverse_cell: tuple[float]
    """1 / cell size [1/length]."""
    stride: tuple[int]
    """Distance in memory between neighbours along each axis (unsigned)."""
    last_base: tuple[int]
    """Largest index at which a stencil of the current width may begin (unsigned)."""
    field_stride: int
    """Distance in memory between velocity fields (unsigned)."""


class PlaneGeometry(NamedTuple):
    """The same for two axes."""

    origin: tuple[float, float]
    inverse_cell: tuple[float, float]
    stride: tuple[int, int]
    last_base: tuple[int, int]
    field_stride: int


class SpaceGeometry(NamedTuple):
    """The same for three axes."""

    origin: tuple[float, float, float]
    inverse_cell: tuple[float, float, float]
    stride: tuple[int, int, int]
    last_base: tuple[int, int, int]
    field_stride: int


class LineGrid(NamedTuple):
    """``LineGeometry`` laid flat: parallel loops cannot capture tuples within tuples."""

    origin_x: float
    inverse_x: float
    stride_x: int
    last_x: int
    field_stride: int


class PlaneGrid(NamedTuple):
    """``PlaneGeometry`` laid flat."""

    origin_x: float
    origin_y: float
    inverse_x: float
    inverse_y: float
    stride_x: int
    stride_y: int
    last_x: int
    last_y: int
    field_stride: int


class SpaceGrid(NamedTuple):
    """``SpaceGeometry`` laid flat."""

    origin_x: float
    origin_y: float
    origin_z: float
    inverse_x: float
    inverse_y: float
    inverse_z: float
    stride_x: int
    stride_y: int
    stride_z: int
    last_x: int
    last_y: int
    last_z: int
    field_stride: int


FLAT = {1: LineGrid, 2: PlaneGrid, 3: SpaceGrid}


@generic
def unfold(g: Any) -> Any:
    """The geometry, with a tuple per property, of a flat grid tuple."""


@unfold.register(LineGrid)
def _(g):
    return LineGeometry((g.origin_x,), (g.inverse_x,), (g.stride_x,), (g.last_x,), g.field_stride)


@unfold.register(PlaneGrid)
def _(g):
    return PlaneGeometry(
        (g.origin_x, g.origin_y),
        (g.inverse_x, g.inverse_y),
        (g.stride_x, g.stride_y),
        (g.last_x, g.last_y),
        g.field_stride,
    )


@unfold.register(SpaceGrid)
def _(g):
    return SpaceGeometry(
        (g.origin_x, g.origin_y, g.origin_z),
        (g.inverse_x, g.inverse_y, g.inverse_z),
        (g.stride_x, g.stride_y, g.stride_z),
        (g.last_x, g.last_y, g.last_z),
        g.field_stride,
    )


class Grid:
    """A regular grid with ``pad`` ghost layers on every side.

    Parameters
    ----------
    lower, upper, cell : (d,) corners of the user's grid and cell size [length]
    pad : ghost layers
    width : nodes per axis that the shape function's stencil spans
    fields : velocity fields
    sides : sides that a node may have; 1 unless something cuts bodies
    periodic : numbers of the axes along which nodes one period, the length of the grid, apart are one node

    Attributes
    ----------
    mirrors : axis, index of its line of nodes, and whether images lie below it, of each symmetry plane

    A degree of freedom is velocity field × node on a side of it (``core.dofs``), and all arrays and ``active`` run over
    degrees of freedom: side after side, field after field. ``active`` lists further sides only at the nodes that
    ``add_sides`` names.
    """

    def __init__(
        self,
        lower: np.ndarray,
        upper: np.ndarray,
        cell: np.ndarray,
        pad: int,
        width: int,
        fields: int = 1,
        sides: int = 1,
        periodic: tuple[int, ...] = (),
    ):
        self.lower = np.asarray(lower, dtype=np.float64)
        self.upper = np.asarray(upper, dtype=np.float64)
        self.cell = np.asarray(cell, dtype=np.float64)
        self.pad = pad
        self.width = width
        self.cells = np.rint((self.upper - self.lower) / self.cell).astype(np.int64)
        self.dimensions = len(self.cells)
        self.shape = tuple(int(n) for n in self.cells + 1 + 2 * pad)
        self.node_count = int(np.prod(self.shape))
        self.stride = tuple(int(np.prod(self.shape[:a])) for a in range(self.dimensions))
        d = self.dimensions
        self.fields = fields
        self.by_field = True
        self.sides = sides
        self.periodic = periodic
        self.mirrors: tuple[tuple[int, int, bool], ...] = ()
        self.dof_count = sides * fields * self.node_count
        self.mp = np.zeros((self.dof_count, 1 + d))
        self.f = np.zeros((self.dof_count, d))
        self.active = np.zeros(0, dtype=np.int64)
        self.active_version = 0

    def memory(self) -> dict[str, Any]:
        """Return what a checkpoint keeps of it: the nodes in use and the width of stencils."""
        version, width = np.int64(self.active_version), np.int64(self.width)
        return {"active": self.active, "active_version": version, "width": width}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Take it back."""
        self.active, self.active_version = memory["active"], int(memory["active_version"])
        self.width = int(memory["width"])

    @property
    def active(self) -> np.ndarray:
        """Degrees of freedom that particles may touch (n,), in ascending order."""
        return self._active

    @active.setter
    def active(self, active: np.ndarray) -> None:
        self._active = active
        self.active_chunks = chunks_of_nodes(active, self.shape[0] if self.dimensions > 1 else 1)

    @property
    def geometry(self) -> Any:
        """The flat tuple that kernels take, for the current stencil width."""
        return FLAT[self.dimensions](
            *(float(x) for x in self.lower - self.pad * self.cell),
            *(float(1 / c) for c in self.cell),
            *(np.uint64(s) for s in self.stride),
            *(np.uint64(n - self.width) for n in self.shape),
            field_stride=np.uint64(self.node_count),
        )

    def offsets(self) -> np.ndarray:
        """Flat offsets of the ``width**d`` stencil nodes from the stencil's first node, x fastest, (m,) unsigned."""
        offsets = np.zeros(1, dtype=np.uint64)
        for stride in self.stride:
            steps = np.arange(self.width, dtype=np.uint64) * np.uint64(stride)
            offsets = (steps[:, None] + offsets[None, :]).ravel()
        return offsets

    def coordinates(self, nodes: np.ndarray) -> np.ndarray:
        """Positions (d, n) of nodes given by flat index (n,), or of degrees of freedom [length]."""
        rest = np.asarray(nodes, dtype=np.int64)
        out = np.empty((self.dimensions, len(rest)))
        for a, count in enumerate(self.shape):
            out[a] = self.lower[a] + (rest % count - self.pad) * self.cell[a]
            rest = rest // count
        return out

    def node_of(self, dofs: np.ndarray) -> np.ndarray:
        """Return the nodes of degrees of freedom (n,)."""
        return np.asarray(node_of(dofs, self.node_count))

    def field_of(self, dofs: np.ndarray) -> np.ndarray:
        """Return the velocity fields of degrees of freedom (n,)."""
        return np.asarray(field_of(dofs, self.node_count, self.fields))

    def side_of(self, dofs: np.ndarray) -> np.ndarray:
        """Return the sides of degrees of freedom (n,)."""
        return np.asarray(side_of(dofs, self.node_count, self.fields))

    def add_sides(self, nodes: np.ndarray) -> None:
        """Let ``active``, of which side 0 is listed, run over the further sides of ``nodes`` (n,), too."""
        if self.sides > 1 and len(nodes):
            there = self.active[np.isin(self.node_of(self.active), nodes)]
            beyond = (there + side * self.fields * self.node_count for side in range(1, self.sides))
            self.active = np.concatenate([self.active, *beyond])
            self.active_version += 1

    def without_periods(self, dofs: np.ndarray) -> np.ndarray:
        """Return for degrees of freedom (n,) those within one period, lower side included, that they are one with."""
        found = np.array(dofs)
        for a in self.periodic:
            index = dofs // self.stride[a] % self.shape[a] - self.pad
            found += (index % self.cells[a] - index) * self.stride[a]
        return found

    def is_first(self, dofs: np.ndarray) -> np.ndarray:
        """Return whether degrees of freedom (n,) are within one period: of those that are one, the first is."""
        if not self.periodic:
            return np.ones(len(dofs), dtype=bool)
        return np.asarray(self.without_periods(dofs) == dofs)

    def with_periods(self, dofs: np.ndarray) -> np.ndarray:
        """Return all degrees of freedom (m,), ascending, that ``dofs`` (n,) are one with, themselves included."""
        found = np.unique(self.without_periods(dofs))
        for a in self.periodic:
            index, cells = found // self.stride[a] % self.shape[a], int(self.cells[a])
            below, above = -(self.pad // cells), (self.shape[a] - 1 - self.pad) // cells
            copies = [found]
            for turns in (*range(below - 1, 0), *range(1, above + 1)):
                at = index + turns * cells
                there = (at >= 0) & (at < self.shape[a])
                copies.append(found[there] + turns * cells * self.stride[a])
            found = np.concatenate(copies)
        return np.sort(found)

    def with_images(self, dofs: np.ndarray) -> np.ndarray:
        """Return degrees of freedom (m,), ascending: ``dofs`` (n,) and their images beyond symmetry planes.

        Of the images those at nodes that some field is at: it meets the image of the other field there.
        """
        found, there = dofs, np.unique(self.node_of(dofs))
        for axis, line, is_lower in self.mirrors:
            stride, count = self.stride[axis], self.shape[axis]
            index = found // stride % count
            image = 2 * line - index
            beyond = (image < line if is_lower else image > line) & (image >= 0) & (image < count)
            images = found[beyond] + (image - index)[beyond] * stride
            found = np.concatenate([found, images[np.isin(self.node_of(images), there)]])
        return np.unique(found)

    @property
    def used_dofs(self) -> int:
        """Number of degrees of freedom whose memory may be touched: all of side 0, and the active ones of others."""
        ordinary = self.fields * self.node_count
        return ordinary + int(np.count_nonzero(self.active >= ordinary))

    def sum_of_fields(self, array: np.ndarray, chosen: np.ndarray | None = None) -> np.ndarray:
        """Sum over the velocity fields, or those of a mask (fields,), and sides of (dof_count, …): (node_count, …)."""
        ordinary = self.fields * self.node_count
        if self.fields == 1 and self.sides == 1:
            return array
        by_field = array[:ordinary].reshape(self.fields, self.node_count, *array.shape[1:])
        total = by_field.sum(axis=0) if chosen is None else by_field[chosen].sum(axis=0)
        beyond = self.active[self.active >= ordinary]
        if chosen is not None:
            beyond = beyond[chosen[self.field_of(beyond)]]
        np.add.at(total, self.node_of(beyond), array[beyond])
        return total

    def interior(self) -> np.ndarray:
        """Flat indices of the user's nodes (no ghosts), x fastest."""
        index = np.zeros(1, dtype=np.int64)
        for stride, cells in zip(self.stride, self.cells, strict=True):
            steps = (np.arange(cells + 1) + self.pad) * stride
            index = (steps[:, None] + index[None, :]).ravel()
        return index


class SharedNodes:
    """The nodes of a grid in use, for quantities of which a node has one value for all velocity fields.

    Parameters
    ----------
    grid : the grid, whose degrees of freedom are the nodes of each field

    Attributes
    ----------
    count : number of nodes
    by_field : False
    """

    by_field = False

    def __init__(self, grid: Grid):
        self._grid = grid
        self._version = -1
        self.count = grid.node_count
        self._active = self._chunks = np.zeros(0, dtype=np.int64)

    @property
    def active(self) -> np.ndarray:
        """Nodes that particles may touch (n,), in ascending order."""
        self._renew()
        return self._active

    @property
    def active_chunks(self) -> np.ndarray:
        """First member of each chunk of them, and the end (see ``core.chunks``)."""
        self._renew()
        return self._chunks

    @property
    def active_version(self) -> int:
        """Changes whenever ``active`` does."""
        return self._grid.active_version

    def _renew(self) -> None:
        grid = self._grid
        if grid.active_version == self._version:
            return
        self._version = grid.active_version
        self._active, self._chunks = grid.active, grid.active_chunks
        if grid.fields > 1:
            self._active = np.unique(grid.node_of(grid.active))
            self._chunks = chunks_of_nodes(self._active, grid.shape[0] if grid.dimensions > 1 else 1)
