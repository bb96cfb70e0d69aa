"""A small elastic block on the grid: stencils of its particles at any position within the cells."""

import functools
from dataclasses import dataclass

import numpy as np

from mpmcli.core.functions import GRID_FUNCTIONS
from mpmcli.shapes import SHAPES

Array = np.ndarray

DOMAINS = ("point", "box", "corners", "corners_and_middles")
MARGIN = 3
"""Nodes beyond the block on either side."""
MANY = 4
"""With so many particles per cell and axis a block of one cell must do; its limits are a tenth lower."""
NO_MASS = 1e-12


@dataclass(frozen=True)
class Lattice:
    """An elastic block in units of the smallest cell, the density and the wave modulus.

    Attributes
    ----------
    grid_functions, domain : of the shape function, as in ``shapes.ShapeEntry``
    particles : particles per cell and axis
    cell : length of a cell along each axis, over the smallest one
    lame, shear : λ and μ, over the wave modulus ρc²
    is_endless : no block, but a row or a layer of particles without surface, repeated after ``edge`` cells
    dashpots : axes across which both faces of the block absorb waves, with the impedances along each axis, over ρc
    cells : cells along each edge of the block, if not as many as are usual
    """

    grid_functions: str
    domain: str
    particles: int
    cell: tuple[float, ...] = (1.0,)
    lame: float = 1.0
    shear: float = 0.0
    is_endless: bool = False
    dashpots: tuple[tuple[int, tuple[float, ...]], ...] = ()
    cells: int | None = None

    @property
    def dimensions(self) -> int:
        """Number of axes."""
        return len(self.cell)

    @property
    def edge(self) -> int:
        """Cells along each edge of the block."""
        return self.cells or (6 if self.dimensions == 1 else 2 if self.particles < MANY else 1)

    @property
    def count(self) -> int:
        """Number of particles."""
        return (self.edge * self.particles) ** self.dimensions


def particle_of(shape: str) -> Lattice | None:
    """Return a particle with a shape function of this name, or None if it is of no kind that is analysed here."""
    entry = SHAPES[shape]
    is_known = entry.grid_functions in GRID_FUNCTIONS and entry.domain in DOMAINS
    return Lattice(entry.grid_functions, entry.domain, 1) if is_known else None


@dataclass(eq=False)
class Stencils:
    """Stencils of N particles at n nodes with the block at P positions.

    Nodes have mass at one of the positions at least; where they have none, their mass counts as 1, and S, G and the
    reach vanish.

    Attributes
    ----------
    S : (P, N, n)
    G, reach : (d, P, N, n) gradients, and S·(x_i − X_p), which velocity gradients need
    mass : (P, n, 1) Σ_p S
    drag : (d, P, n, N) deceleration of nodes by dashpots on faces per velocity of particles along each axis
    """

    S: Array
    G: Array
    reach: Array
    mass: Array
    drag: Array


def stencils(lattice: Lattice, offsets: Array) -> Stencils:
    """Return the tensor products of the axes, at nodes that have mass.

    ``offsets`` (P,) of the block are the same along all axes: along the diagonal of a cell [cells].
    """
    S, G, reach, faces = axis_stencils(lattice, offsets)
    d = lattice.dimensions
    value = functools.reduce(kron, [S] * d)
    mass = value.sum(axis=-2, keepdims=True)
    kept = (mass > NO_MASS).any(axis=(0, 1))
    seen = mass[..., kept] > NO_MASS

    def with_along(axis: int, A: Array) -> Array:
        """Return the product in which the values along an axis have made room for A."""
        return functools.reduce(kron, [S] * axis + [A] + [S] * (d - axis - 1))[..., kept] * seen

    def along_each(A: Array, scale: Array) -> Array:
        return np.stack([with_along(axis, A * s) for axis, s in enumerate(scale)])

    edges = np.array(lattice.cell)
    mass = np.where(seen, mass[..., kept], 1.0).swapaxes(1, 2)
    drag = np.zeros((d, *mass.shape[:2], lattice.count if lattice.dashpots else 0))
    for axis, impedances in lattice.dashpots:
        at = with_along(axis, faces)
        total = at.sum(axis=-1, keepdims=True)  # nodes without mass leave their part to the others
        at = np.divide(at, total, out=np.zeros_like(at), where=total > 0.0).swapaxes(1, 2) / mass
        area = lattice.particles / lattice.cell[axis]  # over the volume of a particle
        drag += np.array(impedances)[:, None, None, None] * area * at
    return Stencils(value[..., kept] * seen, along_each(G, 1.0 / edges), along_each(reach, edges), mass, drag)


def kron(A: Array, B: Array) -> Array:
    """Return the Kronecker products of stacks of matrices (P, …); numpy's own takes ten times as long."""
    product = A[:, :, None, :, None] * B[:, None, :, None, :]
    return product.reshape(len(A), A.shape[1] * B.shape[1], -1)


def axis_stencils(lattice: Lattice, offsets: Array) -> list[Array]:
    """Return S, G, S·(x_i − X_p) and values at faces, (P, N, n) each, of one axis in cells.

    The last array is that of the grid functions at both faces of the block, in the rows of the particles behind them.
    """
    n, edge = lattice.particles, lattice.edge
    l = 0.5 / n
    nodes = np.arange(-MARGIN, edge + 2 + MARGIN)
    x = ((np.arange(edge * n) + 0.5) / n + offsets[:, None])[..., None] - nodes
    value, integral = GRID_FUNCTIONS[lattice.grid_functions]
    if lattice.domain == "point":
        h = 1e-6
        S, G = value(x), (value(x + h) - value(x - h)) / (2 * h)
    elif lattice.domain == "box":
        S, G = (integral(x + l) - integral(x - l)) / (2 * l), (value(x + l) - value(x - l)) / (2 * l)
    else:
        S, G = 0.5 * (value(x + l) + value(x - l)), (value(x + l) - value(x - l)) / (2 * l)
        if lattice.domain == "corners_and_middles":
            S = S / 3.0 + 2.0 / 3.0 * value(x)
    found = [S, G, -S * x, faces := np.zeros_like(S)]
    for row, face in ((0, 0.0), (-1, float(edge))):
        faces[:, row] += value(face + offsets[:, None] - nodes)
    if lattice.is_endless:  # nodes that are a multiple of the edge apart are one
        found = [np.stack([A[..., node::edge].sum(-1) for node in range(edge)], axis=-1) for A in found]
    return found
