"""All grid velocity conditions of a scene: which nodes they hold in a step, and what forces that takes."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mpmcli.boundary import impose
from mpmcli.boundary.base import Array, ConditionModel, Holder, Nodes, SurfaceNodes, is_finite
from mpmcli.boundary.clocks import Clock, ClockedHolder
from mpmcli.boundary.impose import Entries
from mpmcli.boundary.mirror import Mirror
from mpmcli.boundary.orthogonal import orthogonalise
from mpmcli.boundary.place import Place, Plane
from mpmcli.boundary.symmetry import SymmetryHolder
from mpmcli.boundary.velocity import Velocity
from mpmcli.boundary.windowed import hold
from mpmcli.core.analysis import Analysis, Axisymmetric
from mpmcli.core.errors import SimulationError
from mpmcli.core.expressions import Expression


class VelocityConditions:
    """The conditions of a scene on its grid.

    Parameters
    ----------
    conditions
        Models of the scene's ``boundary`` list, in its order.
    grid
        The grid (``base.Nodes``).
    analysis
        The kind of analysis; axisymmetric ones hold v_r = 0 on the axis by themselves.
    surface_nodes
        ``(body, Face) -> node indices`` that surface particles see now; only for conditions on body surfaces.
    clocks
        Those of conditions that events act on, by name.

    Attributes
    ----------
    names : names of the conditions, in the scene's order
    entries : what is held since the last ``select``
    impulse : (nb,) momentum given in this step along each entry's direction [momentum]
    mirror : the symmetry planes, or None
    """

    def __init__(
        self,
        conditions: Sequence[ConditionModel],
        grid: Nodes,
        analysis: Analysis,
        surface_nodes: SurfaceNodes | None = None,
        clocks: Mapping[str, Clock] | None = None,
    ):
        self.names = [condition.name for condition in conditions]
        self._grid = grid
        self._dimensions = analysis.dimensions
        self._holders: list[Holder] = [hold(condition, grid, surface_nodes) for condition in conditions]
        if clocks:
            self._holders = [
                ClockedHolder(holder, clocks[name]) if name in clocks else holder
                for name, holder in zip(self.names, self._holders, strict=True)
            ]
        if isinstance(analysis, Axisymmetric) and grid.lower[0] == 0.0:
            self._holders.append(axis_condition().holder(grid, None))
        planes = [(owner, h) for owner, h in enumerate(self._holders) if isinstance(h, SymmetryHolder)]
        self.mirror = Mirror(planes, grid) if planes else None
        self._version: Any = None
        self._keys: list[Any] | None = None
        self._found: list[Array] = []
        self._time = 0.0
        self._varying = [c for c, holder in enumerate(self._holders) if holder.varies]
        self._select_none()

    def __bool__(self) -> bool:
        """Whether any condition exists."""
        return bool(self._holders)

    @property
    def can_meet(self) -> bool:
        """Whether several conditions may hold the same node."""
        return len(self._holders) > 1

    def select(self, time: float, active: Array, active_version: Any, mp: Array | None = None) -> Entries:
        """Choose the held nodes and their values for a step that starts at ``time``; ``mirror`` knows its ghosts.

        Parameters
        ----------
        time
            Time at the start of the step.
        active
            Sorted indices (n,) of the nodes that may have mass.
        active_version
            Changes whenever ``active`` does.
        mp
            (n, 1+d) mass and momentum: contradictions at nodes without mass are passed over; None minds them.

        Returns
        -------
        Entries
            Valid until the next call; nodes without mass may be among them (the kernels pass them over).
        """
        if not self._holders:
            return self.entries
        if active_version != self._version or self._keys is None:
            self._version, self._keys = active_version, None
            for holder in self._holders:
                holder.renew(active)
        keys = [holder.key(time) for holder in self._holders]
        if keys != self._keys:
            self._find_nodes(time, keys)
            self._keys = keys
            self._put_values(time, range(len(self._holders)), mp)
        elif self._varying and time != self._time:
            self._put_values(time, self._varying, mp)
        self._time = time
        self.impulse[:] = 0.0
        return self.entries

    def impose_on_momentum(self, mp: Array, f: Array | None, dt: float) -> None:
        """Lumped conditions on p⁺ (task 2.a): see ``impose.impose_on_momentum``."""
        impose.impose_on_momentum(self.entries, mp, f, dt, self.impulse)

    def zero_increment(self, dv: Array, mp: Array) -> None:
        """Take the held components out of an FMPM increment: see ``impose.impose_on_velocity``."""
        impose.impose_on_velocity(self._at_rest, dv, mp, self.impulse)

    def impose_on_velocity(self, v: Array, mp: Array) -> None:
        """Conditions on a grid velocity: see ``impose.impose_on_velocity``."""
        impose.impose_on_velocity(self.entries, v, mp, self.impulse)

    def work(self, v: Array) -> float:
        """Work of the conditions on the bodies in this step: see ``impose.sum_work`` [energy]."""
        return float(impose.sum_work(self.entries, self._real_impulse(), v))

    def reactions(self, dt: float) -> Array:
        """Force (n_conditions, d) of each condition of the scene on the bodies in this step [force]."""
        forces = np.zeros((len(self._holders), self._dimensions))
        impose.sum_reactions(self.entries, self._real_impulse(), dt, forces)
        if self.mirror is not None:
            for plane, owner in enumerate(self.mirror.owner):
                forces[owner, self.mirror.pairs.axis[plane]] += self.mirror.impulse[plane] / dt
        return forces[: len(self.names)]

    def empty_conditions(self, mp: Array) -> list[str]:
        """Names of conditions that hold no node with mass, after ``select``; ``mp`` (n, 1+d)."""
        loaded = self.entries.owner[mp[self.entries.node, 0] > 0.0]
        return [name for c, name in enumerate(self.names) if not np.any(loaded == c)]

    def _real_impulse(self) -> Array:
        """The impulses on real particles."""
        if self._grid.periodic:
            return np.where(
                self._grid.without_periods(self.entries.node) == self.entries.node, self.impulse, 0.0
            )
        return self.impulse if self._twins.shape[0] == 0 else self.impulse * self.shares()

    def shares(self) -> Array:
        """The shares (nb,) of real particles in impulses: a ghost and its image share them as they share the mass."""
        share = np.ones_like(self.impulse)
        if self._twins.shape[0] == 0 or self.mirror is None:
            return share
        share[self._twins] = self.mirror.pairs.share[self._pairs]
        np.subtract.at(share, self._origins, share[self._twins])
        return share

    def _select_none(self) -> None:
        d = self._dimensions
        nothing = np.empty(0, dtype=np.int64)
        self._size_arrays(nothing, nothing)
        self._normal = np.empty((0, d))
        self._slots: list[Any] = []
        self._points: list[Array] = []
        self._twins = self._origins = self._pairs = nothing
        self._mixes = False

    def _size_arrays(self, node: Array, owner: Array) -> None:
        nb, d = node.shape[0], self._dimensions
        self.entries = Entries(
            node, np.empty((nb, d)), np.empty(nb), np.zeros(nb, dtype=bool), owner, (0.0,) * d
        )
        self._at_rest = self.entries._replace(value=np.zeros(nb))
        self.impulse = np.zeros(nb)
        self._wanted = np.empty(nb)
        self._leader = np.empty(nb, dtype=np.int64)
        self._held = np.empty(nb)
        self._clash = np.zeros(nb, dtype=bool)

    def _find_nodes(self, time: float, keys: list[Any]) -> None:
        """Find the nodes of the conditions whose keys changed, and sort all into entries."""
        old = self._keys or [None] * len(keys)
        found = [
            self._held_nodes(c, time) if self._keys is None or keys[c] != old[c] else self._found[c]
            for c in range(len(keys))
        ]
        self._found = found
        counts = [nodes.shape[0] for nodes in found]
        node = np.concatenate(found)
        owner = np.repeat(np.arange(len(found)), counts)
        normal = np.array([holder.direction for holder in self._holders])[owner]
        if self.mirror is None:
            origin = np.arange(node.shape[0])
            order = np.argsort(node, kind="stable")
        else:
            node, normal, origin, self._pairs = self.mirror.reflect_entries(node, normal)
            owner = owner[origin]
            order = np.lexsort((owner, node))
        place = np.empty_like(order)
        place[order] = np.arange(order.shape[0])
        ends = np.cumsum(counts)
        self._slots = [as_slice(place[end - count : end]) for end, count in zip(ends, counts, strict=True)]
        self._points = [self._grid.coordinates(nodes) for nodes in found]
        self._twins, self._origins = place[ends[-1] :], place[origin[ends[-1] :]]
        node = node[order]
        self._size_arrays(node, owner[order])
        self._normal = np.ascontiguousarray(normal[order])
        self.entries.direction[:] = self._normal
        self._mixes = bool(np.any(node[1:] == node[:-1]))

    def _held_nodes(self, condition: int, time: float) -> Array:
        """The nodes of one condition; those beyond mirrors follow their images instead."""
        nodes = self._holders[condition].nodes(time)
        return nodes if self.mirror is None else nodes[~self.mirror.beyond(nodes)]

    def _put_values(self, time: float, conditions: Sequence[int], mp: Array | None) -> None:
        """Evaluate the given conditions at ``time`` and renew the entries' values."""
        wanted = self._wanted
        for c in conditions:
            if self._points[c].shape[1] > 0:
                values = self._holders[c].values(time, self._points[c])
                if not is_finite(values):
                    raise SimulationError(f"{self._called(c)}: its velocity is not finite at time {time:g}")
                wanted[self._slots[c]] = values
        if self._twins.shape[0]:
            wanted[self._twins] = wanted[self._origins]
        if not self._mixes:
            self.entries.value[:] = wanted
            return
        e = self.entries
        clashes = self.orthogonalise()
        np.not_equal(self._leader, np.arange(self._leader.shape[0]), out=e.repeated)
        # directions that were orthogonal as given stay so: values alone are renewed from now on
        self._mixes = not np.array_equal(e.direction, self._normal)
        if clashes:
            self._report_clash(time, mp)

    def orthogonalise(self) -> int:
        """Make directions at one node orthogonal or equal, and put values; returns how many contradict each other."""
        e = self.entries
        return int(
            orthogonalise(
                e.node,
                self._normal,
                self._wanted,
                e.direction,
                e.value,
                self._leader,
                self._held,
                self._clash,
            )
        )

    def _report_clash(self, time: float, mp: Array | None) -> None:
        """Raise SimulationError if conditions contradict each other at a node with mass."""
        clashing = np.flatnonzero(self._clash)
        if mp is not None:
            clashing = clashing[mp[self.entries.node[clashing], 0] > 0.0]
        if clashing.shape[0] == 0:
            return
        node = self.entries.node[clashing[0]]
        owners = self.entries.owner[self.entries.node == node]
        names = " and ".join(dict.fromkeys(self._called(int(c)) for c in owners))
        at = ", ".join(f"{x:g}" for x in self._grid.coordinates(np.array([node]))[:, 0])
        raise SimulationError(
            f"{names} contradict each other at time {time:g}; "
            f"no velocity of the grid node at ({at}) satisfies all of them"
        )

    def _called(self, condition: int) -> str:
        if condition >= len(self.names):
            return "the axis of symmetry"
        return f"boundary condition '{self.names[condition]}'"


def axis_condition() -> Velocity:
    """v_r = 0 on the axis r = 0 and beyond, of every axisymmetric analysis that reaches it."""
    plane = Plane(axis="x", at=0.0, side="lower")
    return Velocity(name="axis", on=Place(plane=plane), direction="x", value=Expression.constant(0.0))


def as_slice(indices: Array) -> Any:
    """Ascending indices without gaps as a slice, which is faster; others as they are."""
    n = indices.shape[0]
    if n > 0 and indices[-1] - indices[0] == n - 1 and np.all(np.diff(indices) == 1):
        return slice(int(indices[0]), int(indices[-1]) + 1)
    return indices
