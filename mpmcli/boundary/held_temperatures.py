"""Temperatures held at grid nodes."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.boundary.base import Array, ConditionModel, Holder
from mpmcli.boundary.mirror import Mirror
from mpmcli.boundary.windowed import hold
from mpmcli.core.errors import SimulationError
from mpmcli.core.step import Step
from mpmcli.core.transfer.nodal_field import Correction, NodalField

CONTRADICTION = 1e-9
"""Relative difference between two values at a node that is no round-off."""


def check_temperatures(name: str, values: Array, time: float) -> None:
    """Raise SimulationError unless all temperatures that a condition holds are finite and above 0."""
    is_possible = np.isfinite(values) & (values > 0.0)
    if not is_possible.all():
        raise SimulationError(
            f"boundary condition '{name}': its temperature is {values[~is_possible].min():g} at time {time:g}; "
            "temperatures are absolute and must be above 0"
        )


class HeldTemperatures(Correction):
    """The conditions of a scene that hold temperatures of nodes.

    Parameters
    ----------
    conditions : models of the scene that act on temperature, those on faces of bodies left out
    grid : the grid
    field : the nodal field that they act on
    mirror : the symmetry planes as the field knows them, or None
    is_bath : (fields,) velocity fields that keep a temperature of their own, which no condition holds; or None

    Attributes
    ----------
    names : names of the conditions
    largest : largest temperature that is held
    heat : (conditions,) heat that each has given to the bodies in the step [energy]
    """

    def __init__(
        self, conditions: Sequence[ConditionModel], grid: Any, field: NodalField, mirror: Mirror | None,
        is_bath: Array | None = None,
    ):  # fmt: skip
        self.names = [condition.name for condition in conditions]
        self._grid, self._field, self._mirror, self._is_bath = grid, field, mirror, is_bath
        self._holders: list[Holder] = [hold(condition, grid, None) for condition in conditions]
        self._version, self._keys = -1, list[Any]()
        self._node = self._owner = self._origin = np.zeros(0, dtype=np.int64)
        self._value = np.zeros(0)
        self.heat = np.zeros(len(conditions))
        self.largest = 0.0

    def select(self, time: float) -> None:
        """Choose held nodes and their values at ``time``; call after capacities are known."""
        self.heat[:] = 0.0
        version = self._field.nodes.active_version
        if version != self._version:
            self._version, self._keys = version, []
            active = self._field.nodes.active
            if self._is_bath is not None:
                active = active[~self._is_bath[self._grid.field_of(active)]]
            for holder in self._holders:
                holder.renew(active)
        keys = [holder.key(time) for holder in self._holders]
        if keys != self._keys:
            self._keys = keys
            self._find_nodes(time)
        found = [
            np.broadcast_to(holder.values(time, points), points.shape[1:])
            for holder, points in zip(self._holders, self._points, strict=True)
        ]
        for name, values in zip(self.names, found, strict=True):
            check_temperatures(name, values, time)
        wanted = np.concatenate(found)
        self._value = wanted[self._origin]
        self.largest = float(self._value.max(initial=0.0))
        capacity = self._field.mp[self._node, 0]
        self._check(time, wanted, capacity)
        self._share = capacity if self._mirror is None else capacity * self._mirror.share_of(self._node)
        if self._grid.periodic:  # copies of a node are that node
            self._share = np.where(self._grid.without_periods(self._node) == self._node, capacity, 0.0)

    def _find_nodes(self, time: float) -> None:
        found = []
        for holder in self._holders:
            nodes = holder.nodes(time)
            found.append(nodes if self._mirror is None else nodes[~self._mirror.beyond(nodes)])
        self._points = [self._grid.coordinates(nodes) for nodes in found]
        node = np.concatenate(found)
        owner = np.repeat(np.arange(len(found)), [len(nodes) for nodes in found])
        origin = np.arange(len(node))
        if self._mirror is not None:
            node, _, origin, _ = self._mirror.reflect_entries(
                node, np.zeros((len(node), len(self._grid.shape)))
            )
        # where several conditions hold a node, the first one accounts for it
        self._all_nodes, self._all_owners, self._all_origins = node, owner[origin], origin
        _, first = np.unique(node, return_index=True)
        self._node, self._owner, self._origin = node[first], owner[origin][first], origin[first]
        self._meet = len(first) < len(node)

    def _check(self, time: float, wanted: Array, capacity: Array) -> None:
        """Raise SimulationError where two conditions want different temperatures of a node with capacity."""
        if not self._meet:
            return
        place = np.searchsorted(self._node, self._all_nodes)
        wanted = wanted[self._all_origins]
        held = self._value[place]
        clash = (np.abs(wanted - held) > CONTRADICTION * np.abs(held)) & (capacity[place] > 0.0)
        if clash.any():
            k = int(np.flatnonzero(clash)[0])
            names = [self.names[self._owner[place[k]]], self.names[self._all_owners[k]]]
            at = ", ".join(f"{x:g}" for x in self._grid.coordinates(self._all_nodes[k : k + 1])[:, 0])
            raise SimulationError(
                f"boundary conditions '{names[0]}' and '{names[1]}' contradict each other at time {time:g}: the grid "
                f"node at ({at}) would have the temperatures {held[k]:g} and {wanted[k]:g}"
            )

    def impose(self, theta: Array, counts: bool) -> None:
        """Give held nodes their value; the heat that this takes counts unless it is only for gradients."""
        if counts:
            self._count(self._value - theta[self._node, 0])
        theta[self._node, 0] = self._value

    def take(self, nodes: Array, rise: Array) -> Array:
        """Take in what values of the real particles at held ones of ``nodes`` (m,) would rise by; return which (m,)."""
        place = np.minimum(np.searchsorted(self._node, nodes), max(len(self._node) - 1, 0))
        is_held = self._node[place] == nodes if len(self._node) else np.zeros(len(nodes), dtype=bool)
        place = place[is_held]
        heat = self._field.mp[nodes[is_held], 0] * rise[is_held]
        self.heat -= np.bincount(self._owner[place], heat, minlength=len(self.heat))
        return np.asarray(is_held)

    def correct(self, step: Step, dv: Array, counts_reactions: bool) -> None:
        """Take held nodes out of an increment of the full-mass loop."""
        if counts_reactions:
            self._count(-dv[self._node, 0])
        dv[self._node, 0] = 0.0

    def _count(self, change: Array) -> None:
        self.heat += np.bincount(self._owner, self._share * change, minlength=len(self.heat))

    def idle(self) -> list[str]:
        """Names of conditions that hold no node with capacity in this step."""
        held = np.bincount(self._owner, self._share > 0.0, minlength=len(self.names))
        return [name for name, count in zip(self.names, held, strict=True) if count == 0]
