"""What a step of heat conduction does to the temperatures of a small block: growth, and the waves that it removes.

One step of a block at rest is a matrix between nodes. Its spectral radius gives the largest stable Fourier number
DΔt/Δx². Fluxes through faces of bodies act across half a particle, from the temperature at the particle next to the
face; they lower the limit along each axis that has such faces.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from mpmcli.core.bisection import bisect_limit
from mpmcli.core.functions import GRID_FUNCTIONS
from mpmcli.stability.growth import NEAR
from mpmcli.stability.lattice import MARGIN, axis_stencils

Array = np.ndarray

LARGEST = 0.5
"""Largest Fourier number that counts as stable: up to it, FLIP keeps temperatures within their bounds."""
RESOLUTION = 0.005
"""Limits are whole multiples of it."""
LOWEST = 0.02
"""Smallest limit that is searched for."""
TOLERANCE = 1e-6
"""Spectral radii above 1 by more than this are unstable."""
CELLS = {1: 6, 2: 4, 3: 3}
"""Cells along each edge of a block that stands for large bodies, by number of axes."""
POSITIONS = {1: 21, 2: 6, 3: 2}
"""Positions within half a cell, of which the worst one counts, by number of axes; the first is nearly the worst."""


@dataclass(frozen=True)
class Conduction:
    """What conducts heat: particles, their shape function, and the transfer of temperatures.

    Attributes
    ----------
    grid_functions, domain : of the shape function, as in ``shapes.ShapeEntry``
    particles : particles per cell and axis
    replaces : particles take the nodal temperature (FMPM), and not its change (FLIP)
    order : order k of the full-capacity loop
    axes_with_faces : number of axes along which temperatures are held, or films act, at faces of the body
    are_opposite : such faces are at both ends of an axis
    coupling : share of the conductance of a held face that these faces have, below 1 behind films
    cells : cells along each edge of the body, as far as it matters: faces of thin bodies lower the limit further
    """

    grid_functions: str
    domain: str
    particles: int
    replaces: bool = False
    order: int = 1
    axes_with_faces: int = 0
    are_opposite: bool = True
    coupling: float = 1.0
    cells: int = 6


@functools.lru_cache(maxsize=256)
def fourier_limit(conduction: Conduction, most: float = LARGEST) -> float:
    """Return the largest stable Fourier number DΔt/Δx² of a block at its worst position, ``most`` at most.

    Without faces the limit hardly depends on the number of axes.
    """
    d = max(1, conduction.axes_with_faces)
    along = np.append(np.linspace(0.0, 0.5, POSITIONS[d]), NEAR)
    steps = [_Step.of(conduction, float(offset), d) for offset in along]

    def holds(number: int) -> bool:
        return all(step.radius(number * RESOLUTION) <= 1.0 + TOLERANCE for step in steps)

    lowest, highest = round(LOWEST / RESOLUTION), round(most / RESOLUTION)
    start = highest if not conduction.axes_with_faces else highest // 2
    with threadpool_limits(1, user_api="blas"):  # the matrices are small, and threads that wait burn time
        return (bisect_limit(holds, start, lowest, highest)[0] or 0) * RESOLUTION


@dataclass(frozen=True)
class _Step:
    """The matrices of a step between nodes; eigenvalues are those of the step of particles, apart from 0 and 1."""

    smoothing: Array
    """S⁺S: nodal values to particles and back."""
    loop: Array
    """Sum of the increments of the full-capacity loop."""
    conduction: Array
    """c⁻¹ times the conductance between nodes, for D = Δx = 1."""
    replaces: bool

    @classmethod
    def of(cls, conduction: Conduction, offset: float, dimensions: int) -> _Step:
        """The step of a block whose corner is at ``offset`` (in cells) from a node along all axes."""
        c, K, M = _axis_matrices(conduction, offset, min(conduction.cells, CELLS[dimensions]))
        capacity, back = (functools.reduce(np.kron, [A] * dimensions) for A in (c, M))
        conductance = sum(
            functools.reduce(np.kron, [K if a == b else M for b in range(dimensions)])
            for a in range(dimensions)
        )
        smoothing = back / capacity[:, None]
        increment = loop = np.eye(len(capacity))
        for _ in range(conduction.order - 1):
            increment = increment - smoothing @ increment
            loop = loop + increment
        return cls(smoothing, loop, conductance / capacity[:, None], conduction.replaces)

    def radius(self, fourier: float) -> float:
        """Return the spectral radius of the step."""
        one = np.eye(len(self.loop))
        change = fourier * self.conduction
        step = (
            self.loop @ (one + change) @ self.smoothing
            if self.replaces
            else one + self.loop @ change @ self.smoothing
        )
        return float(np.abs(np.linalg.eigvals(step)).max())


def _axis_matrices(conduction: Conduction, offset: float, cells: int) -> tuple[Array, Array, Array]:
    """Capacities (n,), conductances (n, n) and SᵀS (n, n) of one axis; the capacity of a particle is 1/particles."""
    n = conduction.particles
    S, G, _ = (
        A[0]
        for A in axis_stencils(conduction.grid_functions, conduction.domain, n, cells, np.array([offset]))
    )
    c = S.sum(axis=0) / n
    kept = c > 1e-12
    S, G, c = S[:, kept], G[:, kept], c[kept]
    K = -G.T @ G / n
    if conduction.axes_with_faces:
        nodes = np.arange(-MARGIN, cells + 2 + MARGIN)[kept]
        value = GRID_FUNCTIONS[conduction.grid_functions][0]
        half_size = 0.5 / n
        for particle, face in ((0, offset), (-1, cells + offset))[: 1 + conduction.are_opposite]:
            K -= np.outer(value(face - nodes), S[particle]) * (conduction.coupling / half_size)
    return c, K, S.T @ S / n


def filter_factor(conduction: Conduction, wavelength: float) -> float:
    """Return the factor a by which I − S⁺S changes a wave of this length in cells, for endless rows on grid lines.

    A step of FMPM(k) removes the part aᵏ of the wave.
    """
    S, _, _ = (
        A[0]
        for A in axis_stencils(
            conduction.grid_functions, conduction.domain, conduction.particles, 1, np.zeros(1)
        )
    )
    phases = np.exp(2j * math.pi / wavelength * np.arange(S.shape[1]))
    return float(1.0 - np.mean(np.abs(S @ phases) ** 2))


SHORTEST_WAVE, LONGEST_WAVE = 2.0, 1e12
"""Wavelengths in cells between which the finest wave is searched."""


def finest_wave(conduction: Conduction, steps: float) -> float:
    """Return the finest wavelength in cells of which FMPM(k) keeps the share 1/e after so many steps.

    (1 − aᵏ)^N is about 1/e for N aᵏ = 1; λ ≈ 2.7 N^(1/(2k)) for hats.
    """
    if steps <= 1.0:
        return SHORTEST_WAVE
    factor = steps ** (-1.0 / conduction.order)
    low, high = math.log(SHORTEST_WAVE), math.log(LONGEST_WAVE)
    for _ in range(60):
        middle = 0.5 * (low + high)
        if filter_factor(conduction, math.exp(middle)) > factor:
            low = middle
        else:
            high = middle
    return math.exp(high)
