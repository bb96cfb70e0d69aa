"""Constraints of nodes as conditions on planes and boxes of the grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.core.errors import SceneError
from mpmcli.importers.base import Expression
from mpmcli.importers.cbgeo.mesh import AXES, RegularGrid, cover, rounded
from mpmcli.importers.cbgeo.reading import Array
from mpmcli.importers.cbgeo.source import NodeConstraint, VelocityConstraint
from mpmcli.importers.cbgeo.work import Keys, Work

SIDES = {
    2: {(0, 0): "left", (0, 1): "right", (1, 0): "bottom", (1, 1): "top"},
    3: {(0, 0): "left", (0, 1): "right", (1, 0): "front", (1, 1): "back", (2, 0): "bottom", (2, 1): "top"},
}
"""Names of the sides of the grid by axis and whether it is the upper one."""
MAX_PLACES = 20
"""Boxes of one set of nodes."""


@dataclass(frozen=True)
class Spot:
    """A side of the grid, or a box of nodes (lowest, highest index)."""

    side: tuple[int, int] | None = None
    box: tuple[Array, Array] | None = None

    def name(self, grid: RegularGrid, taken: Any) -> str:
        """A name that is not taken."""
        return free_name(SIDES[grid.d].get(self.on_side(grid), "nodes"), taken)

    def on_side(self, grid: RegularGrid) -> tuple[int, int]:
        """The side of the grid on which it lies; (-1, 0) if it lies on none."""
        if self.side is not None:
            return self.side
        assert self.box is not None
        low, high = self.box
        for axis, upper in SIDES[grid.d]:
            edge = grid.counts[axis] if upper else 0
            if low[axis] == high[axis] == edge:
                return axis, upper
        return -1, 0

    def place(self, grid: RegularGrid) -> dict[str, Any]:
        """Where a condition acts."""
        if self.side is not None:
            return {"plane": self.plane(grid)}
        assert self.box is not None
        low, high = (grid.place(corner).tolist() for corner in self.box)
        return {"box": {"lower": low, "upper": high}}

    def plane(self, grid: RegularGrid) -> dict[str, Any]:
        """The plane of a side."""
        assert self.side is not None
        axis, upper = self.side
        return {"axis": AXES[axis], "at": float((grid.upper if upper else grid.lower)[axis])}


def free_name(plain: str, taken: Any) -> str:
    """The name, or with a number behind it if it is taken."""
    name, count = plain, 1
    while name in taken:
        count += 1
        name = f"{plain} {count}"
    return name


def spots(index: Array, grid: RegularGrid) -> list[Spot] | None:
    """Sides and boxes that hold these nodes (n, d) and no others; None if they are too many."""
    found = []
    rest = np.ones(len(index), dtype=bool)
    for side in SIDES[grid.d]:
        axis, upper = side
        on_it = index[:, axis] == (grid.counts[axis] if upper else 0)
        if on_it.sum() == (grid.counts + 1).prod() // (grid.counts[axis] + 1):
            found.append(Spot(side=side))
            rest &= ~on_it
    if rest.any():
        boxes = cover(index[rest])
        if len(boxes) > MAX_PLACES:
            return None
        found += [Spot(box=box) for box in boxes]
    return found


@dataclass(frozen=True)
class Held:
    """Nodes with the same value along one axis of their own."""

    keys: Keys
    nodes: Array
    axis: int
    value: float | Expression


def directions(work: Work, nodes: Array, axis: int) -> list[tuple[Array, Array]]:
    """Groups of nodes, and the unit vector of their axis in the grid's axes."""
    turns = euler_turns(work)
    vectors = np.array(
        [(turns[n][:, axis] if n in turns else np.eye(work.grid.d)[axis]) for n in nodes.tolist()]
    )
    local = rounded(work.grid.inside(vectors))
    local[np.abs(local) < 1e-6] = 0.0
    snapped = np.where(np.abs(np.abs(local) - 1.0) < 1e-6, np.sign(local), local)
    different, which = np.unique(np.round(snapped, 6), axis=0, return_inverse=True)
    which = which.ravel()
    return [(nodes[which == i], snapped[which == i][0]) for i in range(len(different))]


def euler_turns(work: Work) -> dict[int, Array]:
    """Rotation matrices of nodes that have axes of their own; angles in radians about z, x, z."""
    name = work.given.source.mesh.boundary_conditions.nodal_euler_angles
    if name is None:
        return {}
    d = work.grid.d
    keys = ("mesh", "boundary_conditions", "nodal_euler_angles")
    table = work.folder.table(name, (1 + d,), *keys)
    turns = {}
    for row, (node, angles) in enumerate(zip(table.whole(0), table.array(slice(1, 1 + d)), strict=True)):
        if node >= len(work.grid.nodes):
            raise table.fault(row, f"there is no node {node}")
        turns[node] = _about_z(angles.sum()) if d == 2 else _about_z_x_z(*angles)
    return turns


def _about_z(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def _about_z_x_z(alpha: float, beta: float, gamma: float) -> Array:
    first, last = np.eye(3), np.eye(3)
    first[:2, :2], last[:2, :2] = _about_z(alpha), _about_z(beta)
    middle = np.eye(3)
    middle[1:, 1:] = _about_z(gamma)
    return np.asarray(first @ middle @ last)


def members(work: Work, given: Any, keys: Keys) -> list[tuple[Keys, Any]]:
    """The constraints of a list, of one mapping, or of a file's name, with their keys."""
    if isinstance(given, tuple):
        return [((*keys, index), member) for index, member in enumerate(given)]
    return [(keys, given)]


def rows_of(work: Work, given: Any, keys: Keys, columns: int) -> Any:
    """The table of a constraint that is given by a file, or None."""
    name = given if isinstance(given, str) else getattr(given, "file", None)
    if name is None:
        return None
    at = keys if isinstance(given, str) else (*keys, "file")
    table = work.folder.table(name, (columns,), *at)
    nodes = table.whole(0)
    high = next((i for i, node in enumerate(nodes) if node >= len(work.grid.nodes)), None)
    if high is not None:
        raise table.fault(high, f"there is no node {nodes[high]} ({len(work.grid.nodes)} nodes)")
    axes = table.whole(1)
    wrong = next((i for i, axis in enumerate(axes) if axis >= work.grid.d), None)
    if wrong is not None:
        raise table.fault(wrong, f"there is no axis {axes[wrong]} in {work.grid.d}D")
    return table


def velocities(work: Work) -> list[Held]:
    """Velocity constraints, those of files grouped by direction and value."""
    keys: Keys = ("mesh", "boundary_conditions", "velocity_constraints")
    found: list[Held] = []
    for at, given in members(work, work.given.source.mesh.boundary_conditions.velocity_constraints, keys):
        try:
            table = rows_of(work, given, at, 3)
        except SceneError as error:
            work.refuse(error)
            continue
        if table is not None:
            found += _grouped(table, at)
        elif isinstance(given, VelocityConstraint):
            found += _velocity(work, given, at)
    return found


def _grouped(table: Any, keys: Keys) -> list[Held]:
    nodes, axes, values = np.array(table.whole(0)), np.array(table.whole(1)), table.array(slice(2, 3))[:, 0]
    pairs = dict.fromkeys(zip(axes.tolist(), values.tolist(), strict=True))
    return [Held(keys, np.unique(nodes[(axes == a) & (values == v)]), a, v) for a, v in pairs]


def _velocity(work: Work, given: VelocityConstraint, keys: Keys) -> list[Held]:
    nodes, axis = work.nodes_of(given.nset_id, keys), work.axis(given.dir, keys)
    if given.velocity is None:
        work.fault(keys, "'velocity' is missing")
    if nodes is None or axis is None or given.velocity is None:
        return []
    value = work.times(given.velocity, given.math_function_id, keys)
    return [] if value is None else [Held(keys, nodes, axis, value)]


def first_holds(work: Work, all_held: Sequence[Held]) -> list[Held]:
    """Leave out nodes that an earlier constraint holds at another value in the same direction."""
    values: dict[tuple[int, int], float | Expression] = {}
    found = []
    for held in all_held:
        before = [values.setdefault((node, held.axis), held.value) for node in held.nodes.tolist()]
        kept = np.array([value == held.value for value in before], dtype=bool)
        if not kept.all():
            words = f"{int((~kept).sum())} nodes that an earlier constraint holds at another velocity keep that one"
            work.note("changed", held.keys, words)
        if kept.any():
            found.append(Held(held.keys, held.nodes[kept], held.axis, held.value))
    return found


def add_conditions(work: Work) -> None:
    """Translate all constraints of nodes."""
    for held in first_holds(work, velocities(work)):
        for nodes, direction in directions(work, held.nodes, held.axis):
            _hold(work, held, nodes, direction)
    _refuse_others(work)


def _hold(work: Work, held: Held, nodes: Array, direction: Array) -> None:
    grid, boundary = work.grid, work.scene.setdefault("boundary", [])
    places = spots(grid.nodes[nodes], grid)
    if places is None:
        words = (
            f"a set of {len(nodes)} nodes that are neither planes nor at most {MAX_PLACES} boxes of the grid"
        )
        work.note("not_supported", held.keys, words)
        return
    along = np.flatnonzero(np.abs(direction) == 1.0)
    for spot in places:
        taken = {condition["name"]: condition for condition in boundary}
        same: dict[str, Any]
        if along.size and held.value == 0.0 and spot.side is not None and spot.side[0] == along[0]:
            same = {"kind": "symmetry", "plane": spot.plane(grid)}
        else:
            value = held.value
            if along.size:
                value = _signed(value, float(direction[along[0]]))
            towards = AXES[along[0]] if along.size else direction.tolist()
            same = {"kind": "velocity", "on": spot.place(grid), "direction": towards, "value": value}
        if any({k: v for k, v in condition.items() if k != "name"} == same for condition in boundary):
            continue
        plain = spot.name(grid, ())
        axis_name = f"{plain} {AXES[along[0]]}" if along.size else f"{plain} oblique"
        name = plain if same["kind"] == "symmetry" else axis_name
        boundary.append({"name": free_name(name, taken), **same})


def _signed(value: float | Expression, sign: float) -> float | Expression:
    if sign > 0 or value == 0.0:
        return value
    return Expression(f"-({value})") if isinstance(value, Expression) else -value


def _refuse_others(work: Work) -> None:
    """Constraints that have no counterpart."""
    given = work.given.source.mesh.boundary_conditions
    keys: Keys = ("mesh", "boundary_conditions")
    reasons = {
        "particles_velocity_constraints": "particles with a prescribed velocity; hold nodes or a face of a body",
        "acceleration_constraints": "prescribed accelerations of nodes; prescribe their velocity",
        "pressure_constraints": "pore pressures: mpmcli has one phase",
    }
    for name, words in reasons.items():
        if getattr(given, name):
            work.note("not_supported", (*keys, name), words)
    for name in ("friction_constraints", "absorbing_constraints"):
        for at, member in members(work, getattr(given, name), (*keys, name)):
            if isinstance(member, NodeConstraint | str):
                work.note("not_supported", at, "this version of mpmcli has no such condition")
