"""Concentrated forces on nodes."""

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.boundary.base import Array, LoadModel
from mpmcli.boundary.particle_loads import finite
from mpmcli.core.grid import Grid


class NodalForces:
    """Forces at points of the grid.

    Parameters
    ----------
    loads : models with ``nodal_force_at``
    grid : the grid
    ring : 2π in axisymmetric analyses, whose forces are those on the full ring, else 1
    """

    def __init__(self, loads: Sequence[LoadModel], grid: Grid, ring: float):
        self._loads, self._grid, self._ring = loads, grid, ring
        self._nodes = [_nodes_around(load.nodal_force_at(0.0)[0], grid) for load in loads]

    def add(self, time: float, mp: Array, f: Array) -> None:
        """Add the forces to ``f`` (dofs, d), on nodes with mass in ``mp`` (dofs, 1 + d), velocity fields by mass."""
        for load, (nodes, weights) in zip(self._loads, self._nodes, strict=True):
            if not load.acts_at(time):
                continue
            force = np.array([float(finite(each, load, time)) for each in load.nodal_force_at(time)[1]])
            dofs = nodes[:, None] + self._grid.node_count * np.arange(self._grid.fields)
            mass = mp[dofs, 0]
            total = mass.sum(axis=1)
            loaded = total > 0.0
            if not loaded.any():
                continue
            share = np.where(loaded, weights, 0.0) / weights[loaded].sum()
            parts = np.divide(mass, total[:, None], out=np.zeros_like(mass), where=loaded[:, None])
            f[dofs.ravel()] += (share[:, None] * parts).ravel()[:, None] * force / self._ring


def _nodes_around(at: Any, grid: Grid) -> tuple[Array, Array]:
    """Return the nodes around a point, and their linear functions there, without zeros."""
    place = (np.asarray(at, dtype=np.float64) - grid.lower) / grid.cell + grid.pad
    nearest = np.round(place)
    place = np.where(np.abs(place - nearest) < 1e-6, nearest, place)
    first = np.floor(place).astype(np.int64)
    nodes, weights = [], []
    for corner in itertools.product((0, 1), repeat=len(place)):
        weight = float(np.prod(np.where(np.array(corner) == 1, place - first, 1.0 - (place - first))))
        if weight > 0.0:
            strides = [math.prod(grid.shape[:a]) for a in range(len(place))]
            nodes.append(int(((first + corner) * strides).sum()))
            weights.append(weight)
    return np.array(nodes, dtype=np.int64), np.array(weights)
