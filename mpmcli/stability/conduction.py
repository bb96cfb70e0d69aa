"""What a step of heat conduction does to the temperatures of a small block: growth, and the waves that it removes.

One step of a block at rest is a matrix between nodes. Its spectral radius gives the largest stable Fourier number
DΔt/Δx². Fluxes through faces of bodies act across half a particle, from the temperature at the particle next to the
face; they lower the limit along each axis that has such faces, which count as held at both ends.
"""

import functools
import math
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from mpmcli.core.bisection import bisect_limit
from mpmcli.stability.growth import NEAR
from mpmcli.stability.lattice import Lattice, kron, stencils

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
WAVES = np.geomspace(2.0, 1e6, 4000)
"""Wavelengths in cells among which the finest wave is searched."""


@dataclass(frozen=True)
class Conduction:
    """What conducts heat: particles, their shape function, and the transfer of temperatures.

    Attributes
    ----------
    row : particles along each axis of the body, in as many cells as matter: faces of thin bodies lower the limit
    replaces : particles take the nodal temperature (FMPM), and not its change (FLIP)
    order : order k of the full-capacity loop
    axes_with_faces : number of axes along which temperatures are held, or films act, at faces of the body
    """

    row: Lattice
    replaces: bool = False
    order: int = 1
    axes_with_faces: int = 0


@functools.lru_cache(maxsize=256)
def fourier_limit(conduction: Conduction) -> float:
    """Return the largest stable Fourier number DΔt/Δx² of a block at its worst position, ``LARGEST`` at most.

    Without faces the limit hardly depends on the number of axes.
    """
    smoothing, loop, conductance = _matrices(conduction, max(1, conduction.axes_with_faces))
    one = np.eye(loop.shape[-1])

    def holds(number: int) -> bool:
        change = number * RESOLUTION * conductance
        step = loop @ (one + change) @ smoothing if conduction.replaces else one + loop @ change @ smoothing
        return bool(np.abs(np.linalg.eigvals(step)).max() <= 1.0 + TOLERANCE)

    lowest, highest = round(LOWEST / RESOLUTION), round(LARGEST / RESOLUTION)
    start = highest if not conduction.axes_with_faces else highest // 2
    with threadpool_limits(1, user_api="blas"):  # the matrices are small, and threads that wait burn time
        return (bisect_limit(holds, start, lowest, highest)[0] or 0) * RESOLUTION


def _matrices(conduction: Conduction, dimensions: int) -> tuple[Array, Array, Array]:
    """Return matrices (P, n, n) between nodes of a block whose corner is at P positions along the diagonal of a cell.

    They are S⁺S, the sum of the increments of the full-capacity loop, and the conductance over the capacity for
    D = Δx = 1. Eigenvalues are those of the step of particles, apart from 0 and 1.
    """
    conductance_of_half = 2.0 * conduction.row.particles
    faces = ((0, (conductance_of_half,)),) if conduction.axes_with_faces else ()
    row = replace(conduction.row, cells=min(conduction.row.edge, CELLS[dimensions]), dashpots=faces)
    at = stencils(row, np.append(np.linspace(0.0, 0.5, POSITIONS[dimensions]), NEAR))
    S, G = at.S, at.G[0]
    M, K = S.swapaxes(1, 2) @ S / at.mass, -G.swapaxes(1, 2) @ G / at.mass
    if faces:
        K -= at.drag[0] @ S
    smoothing = functools.reduce(kron, [M] * dimensions)
    axes = range(dimensions)
    conductance = sum(functools.reduce(kron, [K if a == b else M for b in axes]) for a in axes)
    increment = loop = np.eye(smoothing.shape[-1])
    for _ in range(conduction.order - 1):
        increment = increment - smoothing @ increment
        loop = loop + increment
    return smoothing, loop, np.asarray(conductance)


def filter_factor(conduction: Conduction, wavelength: Array | float) -> Array:
    """Return the factor a by which I − S⁺S changes waves of these lengths in cells, for endless rows on grid lines.

    A step of FMPM(k) removes the part aᵏ of the wave.
    """
    S = stencils(replace(conduction.row, cells=1), np.zeros(1)).S[0]
    phases = np.exp(2j * math.pi * np.divide.outer(np.arange(S.shape[1]), wavelength))
    return 1.0 - np.mean(np.abs(S @ phases) ** 2, axis=0)


def finest_wave(conduction: Conduction, steps: float) -> float:
    """Return the finest wavelength in cells of which FMPM(k) keeps the share 1/e after so many steps.

    (1 − aᵏ)^N is about 1/e for N aᵏ = 1; λ ≈ 2.7 N^(1/(2k)) for hats.
    """
    factor = max(steps, 1.0) ** (-1.0 / conduction.order)
    return float(np.interp(-factor, -filter_factor(conduction, WAVES), WAVES))
