"""Volume averaging: the rate of volume and the pressure of particles, averaged over nodes and back.

Against volumetric locking and the checkerboard of pressures that comes with it: with several particles per cell the
velocities cannot keep the volume of each, but they can keep an average (Mast et al. 2012, Coombs et al. 2018, Zhao et
al. 2023). With the average A of ``core.averages``, d = tr D of every particle becomes A d before the strain update, and
the mean stress that forces come from becomes A of that of the particles. A is symmetric in volume, so that the power of
these forces is the stress power of the averaged strain rate: the pair neither takes nor gives energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmcli.core.analysis import Axisymmetric
from mpmcli.core.averages import WeightedSums, divide_sums, mean_of_rows, shift_rows
from mpmcli.core.nodes import clear_nodes

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

Array = np.ndarray


class NoAveraging:
    """Every particle keeps its own rate of volume and its own pressure."""

    def __init__(self, s: Simulation):
        self._s = s

    @property
    def L(self) -> Array:
        """Velocity gradients (nL, N) of the strain update."""
        return self._s.particles.L

    @property
    def tau(self) -> Array:
        """Kirchhoff stresses (nT, N) that forces come from."""
        return self._s.particles.tau

    def average_rates(self) -> None:
        """After velocity gradients are found."""

    def average_stresses(self) -> None:
        """Before forces are."""


class VolumeAveraging(NoAveraging):
    """``method.volumetric: averaged``; its arrays live within a step.

    Plane strain and plane stress average the rate of area, 1D analyses that of length.
    """

    def __init__(self, s: Simulation):
        super().__init__(s)
        analysis, d = s.plan.analysis, s.grid.dimensions
        hoop = isinstance(analysis, Axisymmetric)
        self._rows_of_L = np.array([*range(0, d * d, d + 1), *([4] if hoop else [])], dtype=np.uint64)
        self._rows_of_tau = np.arange(len(self._rows_of_L), dtype=np.uint64)
        self._sums = np.zeros((s.grid.dof_count, 2))
        self._mean = np.zeros(0)
        self._fit()

    def _fit(self) -> None:
        """Make the arrays of particles as long as there are particles, some of which may have been removed."""
        p = self._s.particles
        if self._mean.shape != p.mass.shape:
            self._L, self._tau, self._mean = np.zeros_like(p.L), np.zeros_like(p.tau), np.zeros(p.count)

    @property
    def L(self) -> Array:
        """Velocity gradients whose trace is averaged."""
        return self._L

    @property
    def tau(self) -> Array:
        """Stresses whose mean is averaged."""
        return self._tau

    def average_rates(self) -> None:
        """Average the rates of volume of the velocity gradients."""
        self._fit()
        self._average(self._s.particles.L, self._rows_of_L, self._L)

    def average_stresses(self) -> None:
        """Average the mean Kirchhoff stresses."""
        self._fit()
        self._average(self._s.particles.tau, self._rows_of_tau, self._tau)

    def _average(self, A: Array, rows: Array, out: Array) -> None:
        s, transfer, sums = self._s, self._s.transfer, self._sums
        active, chunks, flat = s.grid.active, s.order.chunks, sums.reshape(-1)
        mean_of_rows[s.parallel](A, rows, chunks, self._mean)
        clear_nodes[s.parallel](active, sums)
        transfer.scatter(WeightedSums(s.particles.vol0, self._mean, flat))
        s.conditions.fold_sums(sums)
        divide_sums[s.parallel](active, sums)
        shift_rows[s.parallel](*transfer.operator(chunks), flat, self._mean, rows, A, out)
