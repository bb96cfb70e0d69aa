"""Conditions that act within a window of time, on a grid."""

from collections.abc import Hashable

import numpy as np

from mpmcli.boundary.base import Array, ConditionModel, Holder, Nodes, SurfaceNodes
from mpmcli.boundary.window import Windowed


def hold(condition: ConditionModel, grid: Nodes, surface_nodes: SurfaceNodes | None) -> Holder:
    """Return a condition on a grid, which holds no node while it does not act."""
    holder = condition.holder(grid, surface_nodes)
    return holder if condition.acts_always else WindowedHolder(holder, condition)


class WindowedHolder:
    """A condition on a grid that acts within a window of time."""

    def __init__(self, holder: Holder, window: Windowed):
        self._holder, self._window = holder, window
        self.direction, self.varies = holder.direction, holder.varies

    def renew(self, active: Array) -> None:
        """Take over the active nodes."""
        self._holder.renew(active)

    def key(self, time: float) -> Hashable:
        """Key of the condition; None, which no condition has, while it does not act."""
        return self._holder.key(time) if self._window.acts_at(time) else None

    def nodes(self, time: float) -> Array:
        """The held nodes."""
        return self._holder.nodes(time) if self._window.acts_at(time) else np.empty(0, dtype=np.int64)

    def values(self, time: float, coordinates: Array) -> Array | float:
        """Values at the held nodes."""
        return self._holder.values(time, coordinates) if self._window.acts_at(time) else 0.0
