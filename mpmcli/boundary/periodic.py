"""Periodic axes: nodes one period apart are one node, and particles that pass a side enter at the other one."""

from collections.abc import Mapping

import numpy as np

from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.transfer.nodal_field import ActiveNodes, Correction

Array = np.ndarray


class PeriodicSides(Correction):
    """Completes the sums that scatters leave: nodes one or more periods apart all get the total.

    Parameters
    ----------
    grid : the grid, whose active nodes are complete with those that they are one with
    nodes : the nodes in use of the field, if these are not the degrees of freedom of the grid
    """

    def __init__(self, grid: Grid, nodes: ActiveNodes | None = None):
        self._grid, self._nodes = grid, grid if nodes is None else nodes
        self._version = -1
        self._copies = self._origins = np.zeros(0, dtype=np.int64)
        self._rounds: list[tuple[Array, Array]] = []

    def complete_extrapolated(self, mp: Array, replaces_values: bool) -> None:
        """Complete mass and momentum ``mp`` (dofs, 1 + d), the first sums of a step."""
        self.complete_scalars(mp)

    def complete(self, sums: Array, weight: float) -> None:
        """Complete ``sums`` (dofs, d) of vectors."""
        self.complete_scalars(sums)

    def complete_scalars(self, sums: Array) -> None:
        """Complete ``sums`` (dofs, c), in an order that depends on the nodes alone."""
        if self._nodes.active_version != self._version:
            self._renew()
        for copies, origins in self._rounds:
            sums[origins] += sums[copies]
        sums[self._copies] = sums[self._origins]

    def _renew(self) -> None:
        """Find the copies among the active nodes, in rounds in which no node is the origin of two of them."""
        active = self._nodes.active
        self._version = self._nodes.active_version
        origins = self._grid.without_periods(active)
        found = np.flatnonzero(origins != active)
        self._copies, self._origins = active[found], origins[found]
        order = np.argsort(self._origins, kind="stable")
        ordered = self._origins[order]
        rank = np.arange(len(order)) - np.searchsorted(ordered, ordered)
        self._rounds = [
            (self._copies[order[rank == r]], ordered[rank == r]) for r in range(int(rank.max(initial=-1)) + 1)
        ]

    def copies(self) -> tuple[Array, float]:
        """Return the nodes that are copies of others, as a whole."""
        return self._copies, 1.0


def enter_again(grid: Grid, particles: Particles, X0: Array | None) -> list[int]:
    """Move particles beyond a periodic side by whole periods into the grid, and return the axes along which any were.

    ``X0`` (d, n), positions at time 0 by identity, and those that contact keeps move with them, so that displacements
    stay those travelled.
    """
    moved = []
    for axis in grid.periodic:
        x, period = particles.X[axis], float(grid.upper[axis] - grid.lower[axis])
        turns = np.floor((x - grid.lower[axis]) / period)
        gone = np.flatnonzero(turns)
        if len(gone):
            x[gone] -= turns[gone] * period
            if X0 is not None:
                X0[axis, particles.id[gone]] -= turns[gone] * period
            if particles.X0 is not None:
                particles.X0[axis, gone] -= turns[gone] * period
            moved.append(axis)
    return moved


class StartPositions:
    """Positions at time 0, which enter again with their particles and so belong to a checkpoint.

    Parameters
    ----------
    X0 : (d, n) by identity [length]
    """

    def __init__(self, X0: Array):
        self._X0 = X0

    def memory(self) -> dict[str, Array]:
        """Return them."""
        return {"X0": self._X0}

    def recall(self, memory: Mapping[str, Array]) -> None:
        """Take them back."""
        self._X0[...] = memory["X0"]
