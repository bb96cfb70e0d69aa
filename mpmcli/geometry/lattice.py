"""Lattices of sub-cells that bodies are filled along: the grid's, or one along a region's own sides."""

from typing import Protocol

import numpy as np

from mpmcli.geometry.base import Region

Array = np.ndarray


class GridBox(Protocol):
    """What filling asks of the grid: corners and cell size, (d,) each [length]."""

    lower: Array
    upper: Array
    cell: Array


class GridLattice:
    """The sub-cells of the grid that may be inside a region.

    Sub-cell s of an axis has its centre at ``lower + (s + ½) cell/parts``.

    Attributes
    ----------
    step : (d,) edges of a sub-cell [length]
    first, last : (d,) first and one past the last sub-cell; beyond the grid if the region is
    total : (d,) sub-cells of the whole grid
    size : (d,) half edges of the particles' domains along their sides [length]
    turn : (d, d) from the sides of the domains to the grid's axes, or None where they lie along these
    parts : (d,) sub-cells per cell along each axis, or None of other lattices than the grid's
    """

    turn: Array | None = None

    def __init__(self, region: Region, grid: GridBox, parts: tuple[int, ...], mirrored: bool):
        self._region, self._origin = region, np.asarray(grid.lower)
        self.step, self.parts = np.asarray(grid.cell) / parts, parts
        step, self.size = self.step, 0.5 * self.step
        self.total = np.rint((np.asarray(grid.upper) - grid.lower) / step).astype(np.int64)
        lower, upper = region.bounds(len(step))
        lower = np.where(np.isfinite(lower), lower, grid.lower)
        upper = np.where(np.isfinite(upper), upper, grid.upper)
        if mirrored:
            lower[0] = max(lower[0], 0.0)
        margin = 1e-6
        first = np.ceil(np.clip((lower - grid.lower) / step - 0.5 - margin, -1e15, 1e15))
        last = np.floor(np.clip((upper - grid.lower) / step - 0.5 + margin, -1e15, 1e15)) + 1
        self.first, self.last = first.astype(np.int64), last.astype(np.int64)

    @property
    def misses_the_grid(self) -> bool:
        """No sub-cell of the grid can be inside."""
        first, last = self.first, self.last
        return bool((last <= first).any() or (first >= self.total).any() or (last <= 0).any())

    @property
    def within(self) -> float:
        """How many of the sub-cells lie in the grid."""
        kept = np.minimum(self.last, self.total) - np.maximum(self.first, 0)
        return float(np.prod(kept.astype(float)))

    def centres_inside(self, index: Array) -> tuple[Array, Array]:
        """Centres (d, n) of the sub-cells (d, m) that are inside the region, and which these are, (m,)."""
        X = _centres(self._origin, index, self.step)
        inside = self._region.contains(X)
        return np.ascontiguousarray(X[:, inside]), inside


class OwnLattice:
    """Sub-cells that share the box around a region, before it is turned and moved, without rest.

    Their edges are as near to ``cell/parts`` as whole numbers of them allow; so they fill a box exactly wherever it
    stands. Attributes as those of ``GridLattice``.

    Raises ValueError if the region has no end.
    """

    misses_the_grid, parts = False, None

    def __init__(self, region: Region, grid: GridBox, parts: tuple[int, ...]):
        self._region = region
        usual = np.asarray(grid.cell) / parts
        self._origin, upper = region.own_bounds(len(usual))
        extent = upper - self._origin
        if not np.isfinite(extent).all():
            raise ValueError("an unbounded region has no sides that particles can lie along")
        count = np.maximum(np.rint(np.minimum(extent / usual, 1e15)), 1.0)
        self.step = extent / count
        self.first, self.last = np.zeros(len(usual), dtype=np.int64), count.astype(np.int64)
        self.total = np.rint((np.asarray(grid.upper) - grid.lower) / usual).astype(np.int64)
        turn = region.turn(len(usual))
        if is_by_right_angles(turn):
            self.turn, self.size = None, np.abs(turn) @ (0.5 * self.step)
        else:
            self.turn, self.size = turn, 0.5 * self.step

    @property
    def within(self) -> float:
        """How many sub-cells the grid has room for, at most all."""
        return float(min(np.prod(self.total.astype(float)), np.prod(self.last.astype(float))))

    def centres_inside(self, index: Array) -> tuple[Array, Array]:
        """Centres (d, n) of the sub-cells (d, m) that are inside the region, and which these are, (m,)."""
        own = _centres(self._origin, index, self.step)
        inside = self._region.holds(own)
        return np.ascontiguousarray(self._region.place(own[:, inside])), inside


def _centres(origin: Array, index: Array, step: Array) -> Array:
    return np.stack([low + (i + 0.5) * h for low, i, h in zip(origin, index, step, strict=True)])


def is_by_right_angles(turn: Array) -> bool:
    """Whether a turn (d, d) leaves sides along the grid's axes along them."""
    return bool(((np.abs(turn) == 0.0) | (np.abs(turn) == 1.0)).all())
