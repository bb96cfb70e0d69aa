"""The stencil: which nodes a particle sees, with values S and gradients G of its shape function.

A shape function weighs the nodes of one particle; gathers and scatters use the weights at once, from the first-level
cache. So every shape function runs through the same transfer kernels, and nothing is stored per particle. The weights
are a ``Table`` of all nodes, or the ``Rows`` of a product of one-dimensional functions (``separable``).
"""

from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.grid import unfold

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


class Table(NamedTuple):
    """Weights of a stencil, node by node: ``S`` (m,) and ``G`` (d·m,) or None."""

    S: Any
    G: Any


class CutTable(NamedTuple):
    """The same of a particle that is cut: nodes of a row may be on different sides, far apart in memory."""

    S: Any
    G: Any


class Corners(NamedTuple):
    """Weights of gathers: the domain at whose corners linear grid functions are interpolated, in cells.

    middle : (d,) from the first node of the stencil
    axes : (d·d,) half-axes in columns
    inverse_cell : (d,) one over the cell size [1/length]
    """

    middle: Any
    axes: Any
    inverse_cell: Any


class StoredTable(NamedTuple):
    """Takes the place of a shape function in passes that need no gradients: its values of all particles, kept.

    first : (N,) first nodes of the stencils, unsigned
    S : (N, m) values
    """

    first: Array
    S: Array

    @staticmethod
    def columns(width: int, dimensions: int) -> int:
        """How many numbers are kept of a particle whose stencil spans ``width`` nodes per axis."""
        return int(width**dimensions)


SEEN = 1e-12
"""Share of the shape function values on a grid line above which its node is seen: less may be round-off."""

MOST_POINTS = 3
"""Points per axis at which a shape function evaluates grid functions, at most."""


def allocate_stencil(dimensions: int, width: int, offsets: Array, slots: int) -> Stencil:
    """Buffers for a shape function that spans ``width`` nodes per axis."""
    m = width**dimensions
    return Stencil(
        S=np.zeros((slots, m)),
        G=np.zeros((slots, dimensions * m)),
        W=np.zeros((slots, MOST_POINTS**dimensions * (dimensions + 1) * width)),
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
def weigh(shape: Any, grid: Any, across: Any, X: Any, F: Any, size: Any, p: Any, S: Any, G: Any, W: Any, status: Any) -> Any:  # noqa: E501
    """What sums need of particle ``p``: the first node as ``fill`` returns it, and a ``Table`` or ``Rows``.

    The arguments are those of ``fill``.
    """


@generic
def weigh_gathers(shape: Any, grid: Any, across: Any, X: Any, F: Any, size: Any, p: Any, S: Any, G: Any, W: Any, status: Any) -> Any:  # noqa: E501
    """The same for gathers alone."""


@generic
def kept_as(shape: Any) -> Any:
    """The class of the tuple that can take this shape function's place (``StoredTable`` …)."""


@generic
def keep(weights: Any, across: Any, S: Any) -> Any:
    """Complete the row ``S`` of a store, which was the buffer for the values when ``weights`` were found."""
# fmt: on


def weigh_by_table(*shapes: type) -> None:
    """Shape functions of these classes have a ``fill`` that writes values and gradients node by node."""

    def table(shape, grid, across, X, F, size, p, S, G, W, status):
        return fill(shape, grid, across, X, F, size, p, S, G, W, status), Table(S, G)

    for each in shapes:
        weigh.register(each)(table)
        weigh_gathers.register(each)(table)
        kept_as.register(each)(lambda shape: StoredTable)


@keep.register(Table)
def _(weights, across, S):
    pass


@weigh.register(StoredTable)
def _(shape, grid, across, X, F, size, p, S, G, W, status):
    return shape.first[p], Table(shape.S[p], None)


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


@inline
def is_seen(S, a, width, dimensions):
    """Whether a particle sees node ``a`` of its stencil, of value 0 < S[a] ≤ ``SEEN``; greater ones are seen anyway.

    On each grid line through the node it must have more than the share ``SEEN`` of the values there. Where S is a
    product of one function per axis, each of these is then greater than ``SEEN``: whole sides of a body, corners
    included, come into a node's sight at once.
    """
    stride = 1
    for _ in range(dimensions):
        first = a - a // stride % width * stride
        line = 0.0
        for j in range(width):
            line += S[first + j * stride]
        if S[a] <= SEEN * line:
            return False
        stride *= width
    return True


@kernel
def find_seen(S, width, dimensions, seen):
    """Which nodes of their stencils particles see, into ``seen`` (n, m) bool; ``S`` (n, m) are the values there."""
    for row in prange(S.shape[0]):
        for a in range(S.shape[1]):
            value = S[row, a]
            seen[row, a] = value > SEEN or (value > 0.0 and is_seen(S[row], a, width, dimensions))


@kernel
def fill_stencils(shape, grid, across, X, F, size, stencil, base, S, G):
    """Stencils of all particles at once, for set-up and tests: ``base`` (N,), ``S`` (N, m), ``G`` (N, d·m)."""
    for p in range(X.shape[1]):
        base[p] = fill(
            shape, unfold(grid), across, X, F, size, np.uint64(p), S[p], G[p], stencil.W[0], stencil.status
        )
