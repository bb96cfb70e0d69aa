"""A small elastic block on the grid: its particles' stencils at any place within the cells."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Array = np.ndarray

MARGIN = 3
VARIANCE_PLACES = 20
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
    """S, G and S·(x_i − X_p) (P, N, n) of one axis in cells, for particles that fill ``cells`` cells at each offset."""
    l = 0.5 / particles
    X = (np.arange(cells * particles) + 0.5) / particles + offsets[:, None]
    nodes = np.arange(-MARGIN, cells + 2 + MARGIN)
    x = X[..., None] - nodes
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
    return S, G, -S * x


def variance(lattice: Lattice) -> float:
    """Σ_i S (x_i − X)² along an axis [cells²], the mean over all places within a cell."""
    places = (np.arange(VARIANCE_PLACES) + 0.5) / VARIANCE_PLACES
    S, _, _ = axis_stencils(lattice.grid_functions, lattice.domain, lattice.particles, 1, places)
    X = 0.5 / lattice.particles + places
    nodes = np.arange(-MARGIN, 3 + MARGIN)
    return float((S[:, 0] * (nodes - X[:, None]) ** 2).sum(axis=1).mean())


def _repeated(A: Array, period: int) -> Array:
    """Nodes that are a multiple of ``period`` apart made one, (P, N, period)."""
    return np.stack([A[..., node::period].sum(axis=-1) for node in range(period)], axis=-1)


def _hat(r: Array) -> Array:
    return np.maximum(0.0, 1.0 - np.abs(r))


def _hat_integral(r: Array) -> Array:
    s = np.clip(r, -1.0, 1.0)
    return s - 0.5 * s * np.abs(s)


def _spline(r: Array) -> Array:
    a = np.abs(r)
    return np.where(a < 0.5, 0.75 - a * a, 0.5 * np.maximum(0.0, 1.5 - a) ** 2)


def _spline_integral(r: Array) -> Array:
    a = np.minimum(np.abs(r), 1.5)
    return np.sign(r) * np.where(a < 0.5, 0.75 * a - a**3 / 3.0, 0.5 - (1.5 - a) ** 3 / 6.0)


GRID_FUNCTIONS = {"linear": (_hat, _hat_integral), "quadratic": (_spline, _spline_integral)}
DOMAINS = ("point", "box", "corners", "corners_and_middles")
