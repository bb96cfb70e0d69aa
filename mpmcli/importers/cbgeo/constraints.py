"""Constraints of nodes as the source has them: sets and files, axes of their own, the first of several; friction."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.core.errors import SceneError
from mpmcli.importers.base import Expression
from mpmcli.importers.cbgeo.mesh import rounded
from mpmcli.importers.cbgeo.reading import Array, Keys, Table
from mpmcli.importers.cbgeo.work import Work


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
    table = work.given.table(name, (1 + d,), *keys)
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


def members(given: Any, keys: Keys) -> list[tuple[Keys, Any]]:
    """The constraints of a list, of one mapping, or of a file's name, with their keys."""
    listed = isinstance(given, tuple)
    return [((*keys, index), member) for index, member in enumerate(given)] if listed else [(keys, given)]


def with_tables(work: Work, given: Any, keys: Keys, columns: int) -> Iterator[tuple[Keys, Any, Table | None]]:
    """Yield constraints with their keys and, of those that a file gives, the table; its faults are noted."""
    for at, member in members(given, keys):
        try:
            table = _table(work, member, at, columns)
        except SceneError as error:
            work.made.refuse(error)
        else:
            yield at, member, table


def _table(work: Work, given: Any, keys: Keys, columns: int) -> Table | None:
    """The table of a constraint that is given by a file, or None."""
    name = given if isinstance(given, str) else getattr(given, "file", None)
    if name is None:
        return None
    at = keys if isinstance(given, str) else (*keys, "file")
    table = work.given.table(name, (columns,), *at)
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
    constraints = work.given.source.mesh.boundary_conditions.velocity_constraints
    for at, given, table in with_tables(work, constraints, keys, 3):
        if table is not None:
            found += _grouped(table, at)
        elif place := work.nodes_and_axis(given, at, "velocity"):
            value = work.times(given.velocity, given.math_function_id, at)
            found += [] if value is None else [Held(at, *place, value)]
    return found


def _grouped(table: Table, keys: Keys) -> list[Held]:
    nodes, axes, values = np.array(table.whole(0)), np.array(table.whole(1)), table.array(slice(2, 3))[:, 0]
    pairs = dict.fromkeys(zip(axes.tolist(), values.tolist(), strict=True))
    return [Held(keys, np.unique(nodes[(axes == a) & (values == v)]), a, v) for a, v in pairs]


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


@dataclass(frozen=True)
class Rough:
    """Friction of a node: across which of its axes, the sign of the outward normal along it, and the coefficient."""

    keys: Keys
    axis: int
    sign: int
    friction: float


def frictions(work: Work) -> dict[int, Rough]:
    """Friction by node; the last constraint of a node counts, as in CB-Geo."""
    keys: Keys = ("mesh", "boundary_conditions", "friction_constraints")
    found: dict[int, Rough] = {}
    constraints = work.given.source.mesh.boundary_conditions.friction_constraints
    for at, given, table in with_tables(work, constraints, keys, 4):
        if table is not None:
            axes = table.whole(1)
            for row, (node, numbers) in enumerate(zip(table.whole(0), table.rows, strict=True)):
                sign, friction = numbers[2:]
                if sign not in {-1, 1}:
                    work.made.refuse(table.fault(row, f"the sign of the normal is -1 or 1, not {sign:g}"))
                    return {}
                if friction < 0:
                    work.made.refuse(table.fault(row, f"the friction coefficient {friction:g} is below 0"))
                    return {}
                found[node] = Rough(at, axes[row], int(sign), friction)
        elif place := work.nodes_and_axis(given, at, "sign_n", "friction"):
            nodes, axis = place
            rough = Rough(at, axis, given.sign_n, given.friction)
            found |= dict.fromkeys(nodes.tolist(), rough)
    return {node: rough for node, rough in found.items() if rough.friction > 0.0}
