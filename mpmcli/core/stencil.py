"""The stencil: which nodes a particle sees, with values S and gradients G of its shape function.

Kernels work on blocks of particles. A shape function fills small buffers for one block (vectorised over the
particles), then the transfer verbs read them one particle at a time. The buffers of a block stay in the first-level
cache, so that every shape function runs through the same transfer kernels and nothing is stored per particle.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.dispatch import generic
from mpmcli.core.grid import unfold
from mpmcli.core.kernel import inline, kernel

Array = np.ndarray

BLOCK = {1: 64, 2: 64, 3: 16}
"""Particles per block for each number of axes."""

OUTSIDE_GRID, DOMAIN_TOO_WIDE = 1, 2
"""Values of ``status[0]``; ``status[1]`` is the particle."""


class Stencil(NamedTuple):
    """Buffers for ``slots`` blocks at work side by side, with m nodes per stencil and B particles per block.

    base : (slots, B) flat index of each stencil's first node, unsigned
    S : (slots, m, B) shape function values [-]
    G : (slots, d·m, B) their gradients, axis by axis [1/length]
    Q, R : (slots, d, B) vectors gathered at the particles
    W : (slots, rows, B) one-dimensional weights and other work space of the shape functions
    offsets : (m,) flat offset of each stencil node from the first, unsigned
    status : (2,) what went wrong in the last step (0: nothing), and for which particle
    """

    base: Array
    S: Array
    G: Array
    Q: Array
    R: Array
    W: Array
    offsets: Array
    status: Array


def allocate_stencil(dimensions: int, width: int, offsets: Array, slots: int) -> Stencil:
    """Buffers for a shape function that spans ``width`` nodes per axis."""
    m, block = width**dimensions, BLOCK[dimensions]
    return Stencil(
        base=np.zeros((slots, block), dtype=np.uint64),
        S=np.zeros((slots, m, block)),
        G=np.zeros((slots, dimensions * m, block)),
        Q=np.zeros((slots, dimensions, block)),
        R=np.zeros((slots, dimensions, block)),
        W=np.zeros((slots, 2 * dimensions * width + 2 * dimensions * dimensions + dimensions, block)),
        offsets=offsets,
        status=np.zeros(2, dtype=np.int64),
    )


@generic
def fill(shape: Any, grid: Any, X: Any, F: Any, size: Any, field: Any, first: Any, n: Any, base: Any, S: Any,
         G: Any, W: Any, status: Any) -> Any:  # fmt: skip
    """Fill the buffers of one block: particles ``first … first+n−1`` (unsigned).

    ``G`` is None where only values are needed. ``X`` (d, N), ``F`` (nF, N), ``size`` (d, N); ``field`` (N,) or None
    (one velocity field). Overwrites ``base`` (B,), ``S`` (m, B), ``G`` (d·m, B), ``W``.
    """


@inline
def place(grid, first, n, lowest, field, base, W, status):
    """Turn lowest stencil nodes into flat indices, and coordinates into distances from them.

    ``W`` rows ``0…d−1`` hold the lowest node of each axis as a float (what ``floor`` gave). A stencil that would leave
    the grid (or a coordinate that is not a number) sets ``status`` and is put at the first node, so that no memory
    outside the grid is ever touched.
    """
    d = len(grid.inverse_cell)
    zero = np.uint64(0)
    for k in range(n):
        base[k] = zero
    for a in range(d):
        last = grid.last_base[a]
        stride = grid.stride[a]
        outside = zero
        for k in range(n):
            i = np.uint64(np.int64(W[lowest + a, k]))
            outside |= np.uint64(i > last)
            base[k] += i * stride
        if outside > zero:
            for k in range(n):
                if np.uint64(np.int64(W[lowest + a, k])) > last:
                    status[0] = OUTSIDE_GRID
                    status[1] = np.int64(first + k)
            for k in range(n):
                base[k] = zero
            return
    if field is not None:
        for k in range(n):
            base[k] += np.uint64(field[first + k]) * grid.field_stride


@inline
def tensor_product(grid, n, W, S, G):
    """Values and gradients from one-dimensional weights.

    Rows ``a·width + i`` of ``W`` hold the weight of node i along axis a, rows ``(d + a)·width + i`` its slope.
    """
    d = len(grid.inverse_cell)
    w = grid.width
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    if d == 1:
        for i in range(w):
            for k in range(n):
                S[i, k] = W[i, k]
            if G is not None:
                for k in range(n):
                    G[i, k] = W[w + i, k]
    elif d == 2:
        m = w * w
        for j in range(w):
            for i in range(w):
                row = j * w + i
                for k in range(n):
                    S[row, k] = W[i, k] * W[w + j, k]
                if G is not None:
                    for k in range(n):
                        G[row, k] = W[two * w + i, k] * W[w + j, k]
                        G[m + row, k] = W[i, k] * W[three * w + j, k]
    else:
        m = w * w * w
        for l in range(w):
            for j in range(w):
                for i in range(w):
                    row = (l * w + j) * w + i
                    for k in range(n):
                        S[row, k] = W[i, k] * W[w + j, k] * W[two * w + l, k]
                    if G is not None:
                        for k in range(n):
                            wx, wy, wz = W[i, k], W[w + j, k], W[two * w + l, k]
                            G[row, k] = W[three * w + i, k] * wy * wz
                            G[m + row, k] = wx * W[(three + one) * w + j, k] * wz
                            G[two * m + row, k] = wx * wy * W[(three + two) * w + l, k]


@kernel
def fill_block(shape, grid, X, F, size, stencil):
    """Values and gradients for at most a block of particles, into slot 0 (set-up and tests)."""
    n = np.uint64(X.shape[1])
    fill(
        shape, unfold(grid), X, F, size, None, np.uint64(0), n, stencil.base[0], stencil.S[0], stencil.G[0],
        stencil.W[0], stencil.status,
    )  # fmt: skip
