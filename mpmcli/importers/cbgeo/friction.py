"""Friction constraints: Coulomb friction at nodes that a velocity constraint holds along the same axis."""

from __future__ import annotations

from dataclasses import dataclass

from mpmcli.core.errors import SceneError
from mpmcli.importers.cbgeo.constraints import members, rows_of
from mpmcli.importers.cbgeo.source import FrictionConstraint
from mpmcli.importers.cbgeo.work import Keys, Work


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
    for at, given in members(work.given.source.mesh.boundary_conditions.friction_constraints, keys):
        try:
            table = rows_of(work, given, at, 4)
        except SceneError as error:
            work.refuse(error)
            continue
        if table is not None:
            axes = table.whole(1)
            for row, (node, numbers) in enumerate(zip(table.whole(0), table.rows, strict=True)):
                sign, friction = numbers[2:]
                if friction < 0:
                    work.refuse(table.fault(row, f"the friction coefficient {friction:g} is below 0"))
                    return {}
                found[node] = Rough(at, axes[row], 1 if sign > 0 else -1, friction)
        elif isinstance(given, FrictionConstraint):
            found |= _of_set(work, given, at)
    return {node: rough for node, rough in found.items() if rough.friction > 0.0}


def _of_set(work: Work, given: FrictionConstraint, keys: Keys) -> dict[int, Rough]:
    nodes, axis = work.nodes_of(given.nset_id, keys), work.axis(given.dir, keys)
    for name in ("sign_n", "friction"):
        if getattr(given, name) is None:
            work.fault(keys, f"'{name}' is missing")
    if nodes is None or axis is None or given.sign_n is None or given.friction is None:
        return {}
    rough = Rough(keys, axis, 1 if given.sign_n > 0 else -1, given.friction)
    return dict.fromkeys(nodes.tolist(), rough)
