"""Constraints of nodes as conditions on planes and boxes of the grid."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.importers.base import Expression, free_name
from mpmcli.importers.cbgeo.constraints import Held, directions, first_holds, frictions, velocities
from mpmcli.importers.cbgeo.mesh import AXES, RegularGrid, cover
from mpmcli.importers.cbgeo.reading import Array, Keys
from mpmcli.importers.cbgeo.work import Work

SIDES = {
    2: {(0, 0): "left", (0, 1): "right", (1, 0): "bottom", (1, 1): "top"},
    3: {(0, 0): "left", (0, 1): "right", (1, 0): "front", (1, 1): "back", (2, 0): "bottom", (2, 1): "top"},
}
"""Names of the sides of the grid by axis and whether it is the upper one."""
MAX_PLACES = 20
"""Boxes of one set of nodes."""


@dataclass(frozen=True)
class Spot:
    """A box of nodes (lowest, highest index), and the side of the grid that it is, if it is a whole one."""

    low: Array
    high: Array
    side: tuple[int, int] | None = None

    def name(self, grid: RegularGrid) -> str:
        """What it is called."""
        return SIDES[grid.d].get(self.on_side(grid), "nodes")

    def on_side(self, grid: RegularGrid) -> tuple[int, int]:
        """The side of the grid on which it lies; (-1, 0) if it lies on none."""
        for axis, upper in SIDES[grid.d]:
            edge = grid.counts[axis] if upper else 0
            if self.low[axis] == self.high[axis] == edge:
                return axis, upper
        return -1, 0

    def place(self, grid: RegularGrid) -> dict[str, Any]:
        """Where a condition acts."""
        if self.side is None:
            ends = {"lower": self.low, "upper": self.high}
            return {"box": {end: grid.place(corner).tolist() for end, corner in ends.items()}}
        axis, upper = self.side
        return {"plane": {"axis": AXES[axis], "at": float((grid.upper if upper else grid.lower)[axis])}}


def spots(index: Array, grid: RegularGrid) -> list[Spot] | None:
    """Sides and boxes that hold these nodes (n, d) and no others; None if they are too many."""
    found = []
    rest = np.ones(len(index), dtype=bool)
    for side in SIDES[grid.d]:
        axis, upper = side
        on_it = index[:, axis] == (grid.counts[axis] if upper else 0)
        if on_it.sum() == (grid.counts + 1).prod() // (grid.counts[axis] + 1):
            found.append(Spot(index[on_it].min(axis=0), index[on_it].max(axis=0), side))
            rest &= ~on_it
    if rest.any():
        boxes = cover(index[rest])
        if len(boxes) > MAX_PLACES:
            return None
        found += [Spot(low, high) for low, high in boxes]
    return found


def add_conditions(work: Work) -> None:
    """Translate all constraints of nodes."""
    rough = frictions(work)
    used: set[int] = set()
    for held in first_holds(work, velocities(work)):
        parts: dict[tuple[int, float] | None, list[int]] = {}
        for node in held.nodes.tolist():
            rubs = node in rough and rough[node].axis == held.axis
            parts.setdefault((rough[node].sign, rough[node].friction) if rubs else None, []).append(node)
            used |= {node} if rubs else set()
        for friction, nodes in parts.items():
            for group, direction in directions(work, np.array(nodes), held.axis):
                _hold(work, held, group, direction, friction)
    for keys in dict.fromkeys(rough[node].keys for node in rough if node not in used):
        words = "friction at nodes that no velocity constraint holds along its normal"
        work.lacks(keys, words)
    _refuse_others(work)


def _hold(work: Work, held: Held, nodes: Array, direction: Array, friction: tuple[int, float] | None) -> None:
    grid, boundary = work.grid, work.scene.setdefault("boundary", [])
    places = spots(grid.nodes[nodes], grid)
    if places is None:
        words = f"{len(nodes)} nodes that are neither planes nor at most {MAX_PLACES} boxes of the grid"
        work.lacks(held.keys, f"a set of {words}")
        return
    along = next((axis for axis in range(grid.d) if abs(direction[axis]) == 1.0), None)
    for spot in places:
        name, side = spot.name(grid), spot.side
        if friction is None and held.value == 0.0 and side is not None and side[0] == along:
            same: dict[str, Any] = {"kind": "symmetry", **spot.place(grid)}
        else:
            # with friction towards the material; else, or on a plane, an axis reads better than minus an axis
            sign = 1.0 if friction is None else -friction[0]
            if along is not None and (friction is None or side is not None):
                sign = float(direction[along])
            towards, value = _towards(sign * direction), _signed(held.value, sign)
            same = {"kind": "velocity", "on": spot.place(grid), "direction": towards, "value": value}
        if friction is not None:
            same["friction"] = friction[1]
            if side is not None and friction[0] * direction[side[0]] * (1 if side[1] else -1) <= 0:
                words = f"friction with an outward normal that points into the mesh at its {name} side"
                work.lacks(held.keys, words)
        if any({k: v for k, v in condition.items() if k != "name"} == same for condition in boundary):
            continue
        if along is None:
            name += " oblique"
        elif spot.on_side(grid)[0] != along:
            name += f" {AXES[along]}"
        boundary.append({"name": free_name(name, [made["name"] for made in boundary], " "), **same})


def _towards(direction: Array) -> str | list[float]:
    """An axis where a unit vector points along its positive side, else its components."""
    upward = np.flatnonzero(direction == 1.0)
    return AXES[int(upward[0])] if upward.size else [float(component) + 0.0 for component in direction]


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
            work.lacks((*keys, name), words)
