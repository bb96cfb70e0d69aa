"""The stencil: which nodes a particle sees, with values S and gradients G of its shape function.

A shape function fills two small buffers for one particle; the transfer verbs read them at once, from the first-level
cache. So every shape function runs through the same transfer kernels, and nothing is stored per particle.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.dispatch import generic
from mpmcli.core.grid import LineGeometry, PlaneGeometry, SpaceGeometry, unfold
from mpmcli.core.kernel import inline, kernel
from mpmcli.core.lanes import pack, store

Array = np.ndarray

OUTSIDE_GRID, DOMAIN_TOO_WIDE = 1, 2
"""Values of ``status[0]``; ``status[1]`` is the particle."""


class Stencil(NamedTuple):
    """Buffers for ``slots`` bands or chunks at work side by side; m = w^d nodes per stencil.

    S : (slots, m) shape function values [-]
    G : (slots, d·m) their gradients, axis by axis [1/length]
    W : (slots, rows) work space of the shape functions
    offsets : (m,) flat offset of each stencil node from the first, unsigned
    status : (2,) what went wrong in the last step (0: nothing), and for which particle
    """

    S: Array
    G: Array
    W: Array
    offsets: Array
    status: Array


MOST_POINTS = 3
"""Points per axis at which a shape function evaluates grid functions, at most."""


def allocate_stencil(dimensions: int, width: int, offsets: Array, slots: int) -> Stencil:
    """Buffers for a shape function that spans ``width`` nodes per axis."""
    m = width**dimensions
    return Stencil(
        S=np.zeros((slots, m)),
        G=np.zeros((slots, dimensions * m)),
        W=np.zeros((slots, MOST_POINTS**dimensions * dimensions * width)),
        offsets=offsets,
        status=np.zeros(2, dtype=np.int64),
    )


def across_of(width: int) -> tuple[np.uint64, ...]:
    """The node numbers 0 … w − 1 along an axis: a tuple, whose length compiled code knows."""
    return tuple(np.uint64(i) for i in range(width))


# fmt: off
@generic
def fill(shape: Any, grid: Any, across: Any, X: Any, F: Any, size: Any, p: Any, S: Any, G: Any, W: Any, status: Any) -> Any:  # noqa: E501
    """Fill the buffers for particle ``p`` and return the flat index of its stencil's first node (unsigned).

    ``grid`` is a geometry of ``core.grid``; ``X`` (d, N), ``F`` (nF, N), ``size`` (d, N). ``G`` is None where only
    values are needed. Overwrites ``S`` (m,), ``G`` (d·m,), ``W``.
    """


@generic
def axis_weights(shape: Any, x: Any, l: Any) -> Any:
    """One axis of a tensor-product shape function at ``x`` with half-size ``l``, both in cells.

    Returns the lowest node, and tuples of the values and slopes at the nodes from there on.
    """
# fmt: on


@inline
def first_node(grid, lowest, p, status):
    """Flat index of the node with these indices (floats).

    A stencil that would leave the grid (or a coordinate that is not a number) sets ``status`` and is put at the first
    node, so that no memory outside the grid is ever touched.
    """
    base = np.uint64(0)
    for a in range(len(grid.inverse_cell)):
        i = np.uint64(np.int64(lowest[a]))
        if i > grid.last_base[a]:
            status[0] = OUTSIDE_GRID
            status[1] = np.int64(p)
            return np.uint64(0)
        base += i * grid.stride[a]
    return base


@generic
def fill_tensor_product(grid: Any, shape: Any, across: Any, X: Any, size: Any, p: Any, S: Any, G: Any, status: Any) -> Any:  # noqa: E501  # fmt: skip
    """``fill`` for shape functions that are products of one-dimensional ones (see ``axis_weights``)."""


@fill_tensor_product.register(LineGeometry)
def _(grid, shape, across, X, size, p, S, G, status):
    hx = grid.inverse_cell[0]
    bx, wx, gx = axis_weights(shape, (X[0, p] - grid.origin[0]) * hx, size[0, p] * hx)
    for i in range(len(across)):
        S[i] = wx[i]
        if G is not None:
            G[i] = gx[i] * hx
    return first_node(grid, (bx,), p, status)


@fill_tensor_product.register(PlaneGeometry)
def _(grid, shape, across, X, size, p, S, G, status):
    w = len(across)
    hx, hy = grid.inverse_cell
    bx, wx, gx = axis_weights(shape, (X[0, p] - grid.origin[0]) * hx, size[0, p] * hx)
    by, wy, gy = axis_weights(shape, (X[1, p] - grid.origin[1]) * hy, size[1, p] * hy)
    values = pack(wx)
    for j in range(w):
        store(S, j * w, wy[j] * values)
    if G is not None:
        slopes = hx * pack(gx)
        for j in range(w):
            store(G, j * w, wy[j] * slopes)
            store(G, (w + j) * w, (gy[j] * hy) * values)
    return first_node(grid, (bx, by), p, status)


@fill_tensor_product.register(SpaceGeometry)
def _(grid, shape, across, X, size, p, S, G, status):
    w = len(across)
    hx, hy, hz = grid.inverse_cell
    bx, wx, gx = axis_weights(shape, (X[0, p] - grid.origin[0]) * hx, size[0, p] * hx)
    by, wy, gy = axis_weights(shape, (X[1, p] - grid.origin[1]) * hy, size[1, p] * hy)
    bz, wz, gz = axis_weights(shape, (X[2, p] - grid.origin[2]) * hz, size[2, p] * hz)
    values = pack(wx)
    for k in range(w):
        for j in range(w):
            store(S, (k * w + j) * w, (wy[j] * wz[k]) * values)
    if G is not None:
        slopes = hx * pack(gx)
        for k in range(w):
            for j in range(w):
                row = (k * w + j) * w
                store(G, row, (wy[j] * wz[k]) * slopes)
                store(G, w * w * w + row, (gy[j] * hy * wz[k]) * values)
                store(G, 2 * w * w * w + row, (wy[j] * (gz[k] * hz)) * values)
    return first_node(grid, (bx, by, bz), p, status)


@kernel
def fill_stencils(shape, grid, across, X, F, size, stencil, base, S, G):
    """Stencils of all particles at once, for set-up and tests: ``base`` (N,), ``S`` (N, m), ``G`` (N, d·m)."""
    for p in range(X.shape[1]):
        base[p] = fill(
            shape, unfold(grid), across, X, F, size, np.uint64(p), S[p], G[p], stencil.W[0], stencil.status
        )
