"""A small elastic block on the grid: stencils of its particles at any position within the cells."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from mpmcli.core.functions import GRID_FUNCTIONS

Array = np.ndarray

MARGIN = 3
MANY = 4
"""With so many particles per cell and axis a block of one cell must do; its limits are a tenth lower."""


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
    """

    grid_functions: str
    domain: str
    particles: int
    cell: tuple[float, ...] = (1.0,)
    lame: float = 1.0
    shear: float = 0.0
    is_endless: bool = False
    dashpots: tuple[tuple[int, tuple[float, ...]], ...] = ()

    @property
    def dimensions(self) -> int:
        """Number of axes."""
        return len(self.cell)

    @property
    def edge(self) -> int:
        """Cells along each edge of the block."""
        if self.dimensions == 1:
            return 6
        return 2 if self.particles < MANY else 1

    @property
    def count(self) -> int:
        """Number of particles."""
        return (self.edge * self.particles) ** self.dimensions


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
    drag : (d, P, n, N) deceleration of nodes by dashpots on faces per velocity of particles along each axis, or None
    """

    S: Array
    G: Array
    reach: Array
    mass: Array
    drag: Array | None = None


def stencils(lattice: Lattice, offsets: Array) -> Stencils:
    """Return the tensor products of the axes, at nodes that have mass; ``offsets`` (P, d) of the block in cells."""
    along = [
        axis_stencils(lattice.grid_functions, lattice.domain, lattice.particles, lattice.edge, offset)
        for offset in offsets.T
    ]
    if lattice.is_endless:
        n = lattice.edge
        along = [(_repeated(S, n), _repeated(G, n), _repeated(R, n)) for S, G, R in along]
    values = [S for S, _, _ in along]
    value = functools.reduce(_kron, values)
    mass = value.sum(axis=-2, keepdims=True)
    has_mass = mass > 1e-12
    kept = has_mass.any(axis=(0, 1))
    seen = has_mass[..., kept]

    def along_each(others: list[Array]) -> Array:
        """For each axis the product in which the values along it have made room for ``others``."""
        products = [functools.reduce(_kron, [*values[:a], A, *values[a + 1 :]]) for a, A in enumerate(others)]
        return np.stack(products)[..., kept] * seen

    made = Stencils(
        value[..., kept] * seen,
        along_each([G / cell for (_, G, _), cell in zip(along, lattice.cell, strict=True)]),
        along_each([R * cell for (_, _, R), cell in zip(along, lattice.cell, strict=True)]),
        np.where(seen, mass[..., kept], 1.0).swapaxes(1, 2),
    )
    if lattice.dashpots:
        made.drag = np.zeros((lattice.dimensions, len(offsets), made.mass.shape[1], lattice.count))
        for axis, impedances in lattice.dashpots:
            at = face_values(lattice, offsets[:, axis])
            faces = functools.reduce(_kron, [*values[:axis], at, *values[axis + 1 :]])[..., kept] * seen
            total = faces.sum(axis=-1, keepdims=True)  # nodes without mass leave their part to the others
            faces = np.divide(faces, total, out=np.zeros_like(faces), where=total > 0.0)
            area = lattice.particles / lattice.cell[axis]  # over the volume of a particle
            for along_axis, impedance in enumerate(impedances):
                made.drag[along_axis] += impedance * area * faces.swapaxes(1, 2) / made.mass
    return made


def face_values(lattice: Lattice, offsets: Array) -> Array:
    """Return the grid functions (P, N, n) at both faces of the block across an axis, for the particles behind them."""
    value, _ = GRID_FUNCTIONS[lattice.grid_functions]
    nodes = np.arange(-MARGIN, lattice.edge + 2 + MARGIN)
    found = np.zeros((len(offsets), lattice.edge * lattice.particles, len(nodes)))
    for row, face in ((0, 0.0), (-1, float(lattice.edge))):
        found[:, row] += value(face + offsets[:, None] - nodes)
    return found


def _kron(A: Array, B: Array) -> Array:
    """The Kronecker products of stacks of matrices (P, …); numpy's own takes ten times as long."""
    product = A[:, :, None, :, None] * B[:, None, :, None, :]
    return product.reshape(len(A), A.shape[1] * B.shape[1], -1)


def axis_stencils(
    grid_functions: str, domain: str, particles: int, cells: int, offsets: Array
) -> tuple[Array, Array, Array]:
    """Return S, G and S·(x_i − X_p) (P, N, n) of one axis in cells, for particles that fill ``cells`` cells.

    Particles and nodes are evenly spaced: each distance between them is evaluated once.
    """
    l = 0.5 / particles
    nodes = np.arange(-MARGIN, cells + 2 + MARGIN)
    apart = np.arange(cells * particles)[:, None] - particles * nodes
    x = (np.arange(apart.min(), apart.max() + 1) + 0.5) / particles + offsets[:, None]
    value, integral = GRID_FUNCTIONS[grid_functions]
    if domain == "point":
        h = 1e-6
        S, G = value(x), (value(x + h) - value(x - h)) / (2 * h)
    elif domain == "box":
        S, G = (integral(x + l) - integral(x - l)) / (2 * l), (value(x + l) - value(x - l)) / (2 * l)
    else:
        S, G = 0.5 * (value(x + l) + value(x - l)), (value(x + l) - value(x - l)) / (2 * l)
        if domain == "corners_and_middles":
            S = S / 3.0 + 2.0 / 3.0 * value(x)
    place = apart - apart.min()
    return S[:, place], G[:, place], (-S * x)[:, place]


def _repeated(A: Array, period: int) -> Array:
    """Nodes that are a multiple of ``period`` apart made one, (P, N, period)."""
    return np.stack([A[..., node::period].sum(axis=-1) for node in range(period)], axis=-1)


DOMAINS = ("point", "box", "corners", "corners_and_middles")
