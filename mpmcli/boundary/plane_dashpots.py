"""Dashpots on grid planes: nodes on a plane and beyond it resist their velocity by the impedance of the matter."""

from collections.abc import Callable, Sequence

import numpy as np

from mpmcli.boundary.base import Array, LoadModel
from mpmcli.boundary.place import beyond
from mpmcli.core.dofs import node_of
from mpmcli.core.grid import Grid


class PlaneDashpots:
    """Forces −Z A v of the nodes on planes, with the area A that matter ends on and its impedance Z.

    Forces take at most all momentum along their axis, those of images included: nodes that see little matter would be
    unstable.

    Parameters
    ----------
    loads : pairs of a load on a plane, and its impedance (N, d) along each axis, by identity [pressure/velocity]
    grid : the grid
    areas : gives −Σ_p w_p V_p ∇S_pi (dofs, d) for numbers w by identity (N,); overwritten by the next call
    complete : completes sums (dofs, 1) beside symmetry planes and periodic sides; None without any
    """

    def __init__(
        self, loads: Sequence[tuple[LoadModel, Array]], grid: Grid, areas: Callable[[Array], Array],
        complete: Callable[[Array], None] | None = None,
    ):  # fmt: skip
        self._grid, self._areas, self._complete = grid, areas, complete
        self._planes = [(load, load.loaded_plane(), _different(Z)) for load, Z in loads]
        self._dofs: list[Array] = []
        self._version = -1

    def add(self, time: float, mp: Array, f: Array, dt: float) -> None:
        """Add the forces of a step ``dt`` at ``time`` to ``f`` (dofs, d).

        ``mp`` (dofs, 1 + d) are its first masses and momenta.
        """
        grid = self._grid
        if grid.active_version != self._version:
            self._version = grid.active_version
            nodes = node_of(grid.active, grid.node_count)
            self._dofs = [grid.active[beyond(grid, nodes, plane)] for _, plane, _ in self._planes]
        for (load, plane, Z), dofs in zip(self._planes, self._dofs, strict=True):
            inward = 1.0 if plane.side_on(grid) == "lower" else -1.0
            mass = mp[dofs, 0]
            for axes, of_particles in Z:
                drag = np.maximum(inward * self._areas(of_particles)[dofs, plane.index], 0.0)
                drag *= load.acts_at(time)  # its kernels always run
                most = np.maximum(mass, self._whole(drag, dofs) * dt)
                rate = np.divide(drag, most, out=np.zeros_like(mass), where=mass > 0.0)
                for axis in axes:
                    f[dofs, axis] -= rate * mp[dofs, 1 + axis]

    def _whole(self, drag: Array, dofs: Array) -> Array:
        """Return what nodes (n,) of real particles have, with that of those that they are one with or mirror."""
        if self._complete is None:
            return drag
        sums = np.zeros((self._grid.dof_count, 1))
        sums[dofs, 0] = drag
        self._complete(sums)
        return sums[dofs, 0]


def _different(Z: Array) -> list[tuple[list[int], Array]]:
    """Return the columns that differ, each with the axes that have it."""
    found: list[tuple[list[int], Array]] = []
    for axis, column in enumerate(Z.T):
        same = next((axes for axes, other in found if np.array_equal(other, column)), None)
        if same is None:
            found.append(([axis], column.copy()))
        else:
            same.append(axis)
    return found
