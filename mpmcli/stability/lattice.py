"""A small elastic block on the grid: its particles' stencils at any place within the cells."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.core.functions import hat, hat_integral, quadratic_spline, quadratic_spline_integral

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
    """

    grid_functions: str
    domain: str
    particles: int
    cell: tuple[float, ...] = (1.0,)
    lame: float = 1.0
    shear: float = 0.0
    is_endless: bool = False

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
    """At P places, of N particles and n nodes: S (P, N, n), G (d, P, N, n), Σ_p S (P, n, 1), and what finds ``reach``.

    Nodes have mass at one of the places at least; where they have none, their mass counts as 1, and S and G vanish.
    """

    S: Array
    G: Array
    mass: Array
    find_reach: Callable[[], Array]

    @functools.cached_property
    def reach(self) -> Array:
        """S·(x_i − X_p) (d, P, N, n), which velocity gradients ask for."""
        return self.find_reach()


def stencils(lattice: Lattice, offsets: Array) -> Stencils:
    """The tensor products of the axes, at nodes that have mass; ``offsets`` (P, d) of the block in cells."""
    along = [
        axis_stencils(lattice.grid_functions, lattice.domain, lattice.particles, lattice.edge, offset)
        for offset in offsets.T
    ]
    if lattice.is_endless:
        along = [
            (_repeated(S, lattice.edge), _repeated(G, lattice.edge), _repeated(R, lattice.edge))
            for S, G, R in along
        ]

    def product(*factors: Array) -> Array:
        return functools.reduce(_kron, factors)

    values = [S for S, _, _ in along]
    value = product(*values)
    mass = value.sum(axis=-2, keepdims=True)
    has_mass = mass > 1e-12
    kept = has_mass.any(axis=(0, 1))
    seen = has_mass[..., kept]

    def of_nodes(all_nodes: Array) -> Array:
        return all_nodes[..., kept] * seen

    def along_each(others: list[Array]) -> Array:
        """For each axis the product in which the values along it have made room for ``others``."""
        products = [product(*values[:a], other, *values[a + 1 :]) for a, other in enumerate(others)]
        return of_nodes(np.stack(products))

    return Stencils(
        of_nodes(value),
        along_each([G / cell for (_, G, _), cell in zip(along, lattice.cell, strict=True)]),
        np.where(seen, mass[..., kept], 1.0).swapaxes(1, 2),
        lambda: along_each([R * cell for (_, _, R), cell in zip(along, lattice.cell, strict=True)]),
    )


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


def _of_arrays(function: Any) -> Callable[[Array], Array]:
    """A compiled function of numbers as a plain one of arrays, without its compiler."""
    return np.vectorize(function.py_func, otypes=[np.float64])


GRID_FUNCTIONS = {
    "linear": (_of_arrays(hat), _of_arrays(hat_integral)),
    "quadratic": (_of_arrays(quadratic_spline), _of_arrays(quadratic_spline_integral)),
}
DOMAINS = ("point", "box", "corners", "corners_and_middles")
