"""Growth of perturbations of a small block of particles, per time step.

One step of the linearised equations of a block is a matrix that depends on the position of the block within a cell. A
block at rest is as stable as this matrix, a moving one as the product of the matrices on its way. The surface belongs
to the block because it decides: between free nodes of little mass and particles that hardly reach them, FMPM(k) is
unstable at time steps at which an endless row of particles is stable.
"""

import functools
import math
from dataclasses import replace

import numpy as np

from mpmcli.stability.lattice import Lattice
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
MOST_NUMBERS = 200_000
"""Matrices of several steps are made at once while they have no more numbers than this."""
PERIODS = 2**15
"""Enough of them for neither the norm nor growth with a power of time to matter."""


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
    period = scheme.period(courant)
    schemes = (scheme, replace(scheme, kind="flip"))[: 1 + (period > 1)]
    kinds = [LinearStep(lattice, each, courant) for each in schemes]
    is_lenient = speed >= FAST or (speed == 0.0 and scheme.velocity_gradient)
    allowed = FAST_GROWTH if is_lenient else GROWTH
    with np.errstate(over="ignore", invalid="ignore"):
        if speed == 0.0:
            offsets = np.append(np.linspace(0.0, 0.5, POSITIONS[lattice.dimensions]), NEAR)
            passed, *flip = [step.matrices(offsets) for step in kinds]
            for matrices in flip:
                passed = passed @ np.linalg.matrix_power(matrices, period - 1)
            steps = period
        else:
            passed, steps = _in_motion(kinds, period, speed * courant / lattice.cell[0])
        power = np.linalg.matrix_power(passed * math.exp(-allowed * steps), PERIODS)
        return bool(np.abs(power).max() <= 1.0)  # not if it is not a number


def _in_motion(kinds: list[LinearStep], period: int, cells_per_step: float) -> tuple[Array, int]:
    """Return the product of the matrices on a way along the diagonal of the cells, and how many they are.

    All steps are of the first kind, or those at the end of a period, with the second one between. Of a period that is
    longer than the way, the end is the last step of the way.
    """
    cells = math.ceil(FEWEST_STEPS * cells_per_step)
    steps = max(6, round(cells / cells_per_step))
    period = min(period, steps)
    steps = period * round(steps / period)
    along = cells * (np.arange(steps) + 0.5) / steps % 1.0
    passed, number = np.eye(kinds[0].size), 0
    for offsets in np.array_split(along, math.ceil(steps * passed.size / MOST_NUMBERS)):
        for matrices in zip(*(kind.matrices(offsets) for kind in kinds), strict=True):
            number += 1
            passed = matrices[number % period > 0] @ passed
    return passed, steps
