"""Shape functions that are products of one-dimensional ones: their stencils are kept factored, row by row.

A row is the nodes along x. The value at node a of row r is ``x[a] · values[r]``; sums over a row come first, those over
rows follow: less arithmetic than a table of all nodes, and no table to write.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.compiled.registers import each, load, pack, store, transposed
from mpmcli.core.grid import LineGeometry, PlaneGeometry, SpaceGeometry
from mpmcli.core.transfer.gather_scatter import column
from mpmcli.core.transfer.stencil import fill, first_node, keep, kept_as, weigh, weigh_gathers


class Rows(NamedTuple):
    """Weights of a stencil of w nodes per axis with R = w^(d−1) rows.

    x, slopes : w values and slopes [1/length] along x, tuples; slopes may be None
    values : (R,) or more, products of the values along the other axes
    gradients : ((d − 1)·R,) or more, their slopes along y, then along z; or None
    """

    x: Any
    slopes: Any
    values: Any
    gradients: Any


class StoredRows(NamedTuple):
    """Takes the place of a product shape function in passes that need no gradients: its ``Rows``, kept.

    first : (N,) first nodes of the stencils, unsigned
    S : (N, R + w) values of the rows, then values along x
    """

    first: Any
    S: Any

    @staticmethod
    def columns(width: int, dimensions: int) -> int:
        """How many numbers are kept of a particle whose stencil spans ``width`` nodes per axis."""
        return int(width ** (dimensions - 1) + width)


# fmt: off
@generic
def axis_weights(shape: Any, x: Any, l: Any) -> Any:
    """A product shape function along its axes at ``x`` with half-sizes ``l``, both in cells.

    ``x`` and ``l`` are registers with a component for each axis. Returns the lowest nodes, and tuples of the values and
    slopes at the nodes from there on: registers as well.
    """


@generic
def find_rows(grid: Any, shape: Any, across: Any, X: Any, size: Any, p: Any, values: Any, gradients: Any, status: Any) -> Any:  # noqa: E501
    """First node and ``Rows`` of particle ``p``, with buffers for ``values`` and ``gradients`` (or None)."""


@generic
def put_nodes(grid: Any, across: Any, rows: Any, S: Any, G: Any) -> Any:
    """Values ``S`` and gradients ``G`` (or None) of all nodes of the rows."""
# fmt: on


def product_of_axes(shape: type) -> Callable[..., Any]:
    """Decorate the ``axis_weights`` of a shape function that is their product along the axes."""

    def add(function: Callable[..., Any]) -> Callable[..., Any]:
        axis_weights.register(shape)(function)
        weigh.register(shape)(_weigh_by_rows)
        weigh_gathers.register(shape)(_weigh_by_rows)
        kept_as.register(shape)(lambda shape: StoredRows)
        fill.register(shape)(_fill_from_rows)
        return function

    return add


def _weigh_by_rows(shape, grid, across, X, F, size, p, S, G, W, status):
    return find_rows(grid, shape, across, X, size, p, S, G, status)


def _fill_from_rows(shape, grid, across, X, F, size, p, S, G, W, status):
    of_all_rows = len(across) * len(across)  # room for the values of the most rows
    base, rows = find_rows(grid, shape, across, X, size, p, W, W[of_all_rows:], status)
    put_nodes(grid, across, rows, S, G)
    return base


@keep.register(Rows)
def _(weights, across, S):
    store(S, np.uint64(S.shape[0] - len(across)), pack(weights.x))


@weigh.register(StoredRows)
def _(shape, grid, across, X, F, size, p, S, G, W, status):
    kept = shape.S[p]
    x = load(kept, np.uint64(kept.shape[0] - len(across)), across)
    return shape.first[p], Rows(each(x), None, kept, None)


@inline
def scaled(numbers, factor):
    """The members of a tuple times ``factor``."""
    return each(factor * pack(numbers))


@inline
def all_axes(grid, shape, X, size, p):
    """Lowest nodes, values and slopes [1/cell] of all axes, which go through the same arithmetic at once."""
    h = pack(grid.inverse_cell)
    x = (pack(column(grid.inverse_cell, X, p)) - pack(grid.origin)) * h
    lowest, values, slopes = axis_weights(shape, x, pack(column(grid.inverse_cell, size, p)) * h)
    return each(lowest), transposed(values), transposed(slopes)


@find_rows.register(LineGeometry)
def _(grid, shape, across, X, size, p, values, gradients, status):
    lowest, (wx,), (gx,) = all_axes(grid, shape, X, size, p)
    values[0] = 1.0
    return first_node(grid, lowest, p, status), Rows(wx, scaled(gx, grid.inverse_cell[0]), values, gradients)


@find_rows.register(PlaneGeometry)
def _(grid, shape, across, X, size, p, values, gradients, status):
    hx, hy = grid.inverse_cell
    lowest, (wx, wy), (gx, gy) = all_axes(grid, shape, X, size, p)
    store(values, np.uint64(0), pack(wy))
    if gradients is not None:
        store(gradients, np.uint64(0), hy * pack(gy))
    return first_node(grid, lowest, p, status), Rows(wx, scaled(gx, hx), values, gradients)


@find_rows.register(SpaceGeometry)
def _(grid, shape, across, X, size, p, values, gradients, status):
    w = len(across)
    hx, hy, hz = grid.inverse_cell
    lowest, (wx, wy, wz), (gx, gy, gz) = all_axes(grid, shape, X, size, p)
    along_y = pack(wy)
    for k in range(w):
        store(values, k * w, wz[k] * along_y)
    if gradients is not None:
        slopes = hy * pack(gy)
        for k in range(w):
            store(gradients, k * w, wz[k] * slopes)
            store(gradients, (w + k) * w, (gz[k] * hz) * along_y)
    return first_node(grid, lowest, p, status), Rows(wx, scaled(gx, hx), values, gradients)


@put_nodes.register(LineGeometry)
def _(grid, across, rows, S, G):
    for i in range(len(across)):
        S[i] = rows.x[i]
        if G is not None:
            G[i] = rows.slopes[i]


@put_nodes.register(PlaneGeometry)
def _(grid, across, rows, S, G):
    w = len(across)
    for j in range(w):
        for i in range(w):
            S[j * w + i] = rows.values[j] * rows.x[i]
            if G is not None:
                G[j * w + i] = rows.values[j] * rows.slopes[i]
                G[(w + j) * w + i] = rows.gradients[j] * rows.x[i]


@put_nodes.register(SpaceGeometry)
def _(grid, across, rows, S, G):
    w = len(across)
    R, m = w * w, w * w * w
    for r in range(R):
        for i in range(w):
            S[r * w + i] = rows.values[r] * rows.x[i]
            if G is not None:
                G[r * w + i] = rows.values[r] * rows.slopes[i]
                G[m + r * w + i] = rows.gradients[r] * rows.x[i]
                G[2 * m + r * w + i] = rows.gradients[R + r] * rows.x[i]
