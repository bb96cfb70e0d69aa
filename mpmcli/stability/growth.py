"""Growth of perturbations of a small block of particles, per time step.

One step of the linearised equations of a block is a matrix that depends on the position of the block within a cell. A
block at rest is as stable as this matrix, a moving one as the product of the matrices on its way. The surface belongs
to the block because it decides: between free nodes of little mass and particles that hardly reach them, FMPM(k) is
unstable at time steps at which an endless row of particles is stable.
"""

from __future__ import annotations

import functools
import math

import numpy as np

from mpmcli.stability.lattice import Lattice, stencils
from mpmcli.stability.linear_step import LinearStep, Scheme

Array = np.ndarray

GROWTH = 1e-3
"""Growth per step (of the logarithm of the amplitude) above which a block is unstable."""
FAST_GROWTH = 5e-3
"""The same of fast endless rows: it stays small for some thousand steps, because it begins with round-off.

It is also the bound of blocks at rest whose velocities carry gradients. With FLIP and two extrapolations per step they
grow by 0.1 to 0.2 % per step at every Courant number below the limit, at the worst position only: a smaller step is no
remedy, and moving blocks do not grow. The scene ``spinning_joint`` is quiet up to 0.9.
"""
FAST = 0.1
"""Speed over wave speed from which a row of particles is fast."""
POSITIONS = {1: 21, 2: 11}
"""Positions within half a cell (the other half mirrors it) among which the worst one is searched, by number of axes."""
NEAR = 0.01
"""A position just off the grid lines [cells]: some shape functions lose their stability where they leave them."""
FEWEST_STEPS = 40.0
"""A moving lattice is followed for so many steps at least, which take it across a whole number of cells."""
SQUARINGS = 15
"""A power of two that is large enough for neither the norm nor growth with a power of time to matter."""


@functools.lru_cache(maxsize=4096)
def is_stable(lattice: Lattice, scheme: Scheme, courant: float, speed: float = 0.0) -> bool:
    """Return whether perturbations of a lattice of particles do not grow.

    Parameters
    ----------
    lattice, scheme
        The particles, and what a step does.
    courant
        Courant number of waves, with the smallest edge of a cell.
    speed
        Speed over wave speed along the first axis; the others are crossed in the same number of steps. At 0 the lattice
        rests at its worst position within a cell.
    """
    if speed == 0.0:
        allowed = FAST_GROWTH if scheme.velocity_gradient else GROWTH
        return growth_at_rest(lattice, scheme, courant) <= allowed
    return growth_moving(lattice, scheme, courant, speed) <= (FAST_GROWTH if speed >= FAST else GROWTH)


def growth_at_rest(lattice: Lattice, scheme: Scheme, courant: float) -> float:
    """Return the largest growth per step of a lattice at rest among ``POSITIONS`` along the diagonal of a cell."""
    along = np.append(np.linspace(0.0, 0.5, POSITIONS[lattice.dimensions]), NEAR)
    at = stencils(lattice, np.repeat(along[:, None], lattice.dimensions, axis=1))
    step, period = LinearStep(lattice, scheme, courant), steps_apart(scheme, courant)
    with np.errstate(over="ignore", invalid="ignore"):
        passed = step.advance(step.identity(), at).matrices()
        if period > 1:
            flip = step.advance(step.identity(), at, is_flip=True).matrices()
            passed = passed @ np.linalg.matrix_power(flip, period - 1)
    return max(log_of_radius(matrix) for matrix in passed) / period


def growth_moving(lattice: Lattice, scheme: Scheme, courant: float, speed: float) -> float:
    """Return the growth per step of a lattice that moves along the diagonal of the cells."""
    cells_per_step = speed * courant / lattice.cell[0]
    cells = math.ceil(FEWEST_STEPS * cells_per_step)
    steps, period = max(6, round(cells / cells_per_step)), steps_apart(scheme, courant)
    steps = period * max(1, round(steps / period))
    number = np.arange(steps)
    positions = np.repeat((cells * (number + 0.5) / steps % 1.0)[:, None], lattice.dimensions, axis=1)
    passed = np.eye(1)
    with np.errstate(over="ignore", invalid="ignore"):
        matrices = LinearStep(lattice, scheme, courant).matrices(positions, (number + 1) % period != 0)
        for step, matrix in enumerate(matrices):
            passed = matrix @ passed if step else matrix
    return log_of_radius(passed) / steps


def steps_apart(scheme: Scheme, courant: float) -> int:
    """Return the period of the transfer in steps, 1 for transfers that are the same in all steps."""
    if scheme.every_steps is not None:
        return scheme.every_steps
    if scheme.every_courant is not None:
        return max(1, math.ceil(scheme.every_courant / courant - 1e-9))
    return 1


def log_of_radius(matrix: Array) -> float:
    """Return the logarithm of the spectral radius, from the power ``2**SQUARINGS``: faster than eigenvalues."""
    power, logarithm = matrix, 0.0
    for _ in range(SQUARINGS):
        scale = np.abs(power).max()
        if scale == 0.0:
            return -math.inf
        if not scale < math.inf:
            return math.inf
        power = power / scale
        logarithm = 2.0 * (logarithm + math.log(scale))
        power = power @ power
    scale = np.abs(power).max()
    return (logarithm + math.log(scale)) / 2**SQUARINGS if scale > 0.0 else -math.inf
