"""Volume averaging: the rate of volume and the pressure of particles, averaged over nodes and back.

Against volumetric locking and the checkerboard of pressures that comes with it: with several particles per cell the
velocities cannot keep the volume of each, but they can keep an average (Mast et al. 2012, Coombs et al. 2018, Zhao et
al. 2023). With the average A of ``core.transfer.averages``, d = tr D of every particle becomes A d before the strain
update, and the mean stress that forces come from becomes A of that of the particles. A is symmetric in volume, so that
the power of these forces is the stress power of the averaged strain rate: the pair neither takes nor gives energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmcli.boundary.images import Images
from mpmcli.core.analysis import Analysis, Axisymmetric
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.transfer.averages import WeightedSums, divide_sums, mean_of_rows, shift_rows
from mpmcli.core.transfer.nodes import clear_nodes
from mpmcli.solver.transfer import Transfer

if TYPE_CHECKING:  # imported by scenes with periodic axes
    from mpmcli.boundary.periodic import PeriodicSides

Array = np.ndarray


class VolumeAveraging:
    """``method.volumetric: averaged``; its arrays live within a step.

    Plane strain and plane stress average the rate of area, 1D analyses that of length.

    Attributes
    ----------
    L : (nL, N) velocity gradients whose trace is averaged, after ``average_rates``
    tau : (nT, N) stresses whose mean is averaged, after ``average_stresses``
    """

    def __init__(
        self, analysis: Analysis, grid: Grid, particles: Particles, transfer: Transfer,
        images: Images | PeriodicSides | None,
    ):  # fmt: skip
        d = grid.dimensions
        hoop = isinstance(analysis, Axisymmetric)
        self._grid, self._particles, self._transfer, self._images = grid, particles, transfer, images
        self._rows_of_L = np.array([*range(0, d * d, d + 1), *([4] if hoop else [])], dtype=np.uint64)
        self._rows_of_tau = np.arange(len(self._rows_of_L), dtype=np.uint64)
        self._sums = np.zeros((grid.dof_count, 2))
        self._mean = np.zeros(0)
        self._fit()

    def nodal_arrays(self) -> dict[str, Array]:
        """Arrays over all nodes, by name."""
        return {"sums": self._sums}

    def _fit(self) -> None:
        """Make the arrays of particles as long as there are particles, some of which may have been removed."""
        p = self._particles
        if self._mean.shape != p.mass.shape:
            self.L, self.tau, self._mean = np.zeros_like(p.L), np.zeros_like(p.tau), np.zeros(p.count)

    def average_rates(self) -> None:
        """Average the rates of volume of the velocity gradients."""
        self._fit()
        self._average(self._particles.L, self._rows_of_L, self.L)

    def average_stresses(self) -> None:
        """Average the mean Kirchhoff stresses."""
        self._fit()
        self._average(self._particles.tau, self._rows_of_tau, self.tau)

    def _average(self, A: Array, rows: Array, out: Array) -> None:
        transfer, sums, parallel = self._transfer, self._sums, self._transfer.parallel
        active, chunks, flat = self._grid.active, transfer.order.chunks, sums.reshape(-1)
        mean_of_rows[parallel](A, rows, chunks, self._mean)
        clear_nodes[parallel](active, sums)
        transfer.scatter(WeightedSums(self._particles.vol0, self._mean, flat))
        if self._images is not None:
            self._images.complete_scalars(sums)
        divide_sums[parallel](active, sums)
        shift_rows[parallel](*transfer.operator(chunks), flat, self._mean, rows, A, out)
