"""Constraints of nodes as conditions on planes and boxes of the grid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.importers.base import Expression
from mpmcli.importers.cbgeo.constraints import Held, directions, first_holds, velocities
from mpmcli.importers.cbgeo.friction import frictions
from mpmcli.importers.cbgeo.mesh import AXES, RegularGrid, cover
from mpmcli.importers.cbgeo.reading import Array
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
        work.note("not_supported", keys, words)
    _refuse_others(work)


def _hold(work: Work, held: Held, nodes: Array, direction: Array, friction: tuple[int, float] | None) -> None:
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
        value: float | Expression
        if friction is not None:
            # towards the material
            inward = -friction[0] * direction
            value = _signed(held.value, -friction[0])
            if (
                along.size and inward[along[0]] < 0
            ):  # an axis reads better; on a plane its sign does not matter
                inward, value = (-inward, _signed(value, -1.0)) if spot.side is not None else (inward, value)
            same = {"kind": "velocity", "on": spot.place(grid), "direction": _towards(inward), "value": value}
            same["friction"] = friction[1]
            if (
                spot.side is not None
                and friction[0] * direction[spot.side[0]] * (1 if spot.side[1] else -1) <= 0
            ):
                words = f"friction with an outward normal that points into the mesh at its {spot.name(grid, ())} side"
                work.note("not_supported", held.keys, words)
        elif along.size and held.value == 0.0 and spot.side is not None and spot.side[0] == along[0]:
            same = {"kind": "symmetry", "plane": spot.plane(grid)}
        else:
            value = held.value
            if along.size:
                value = _signed(value, float(direction[along[0]]))
            towards = np.abs(direction) if along.size else direction
            same = {
                "kind": "velocity",
                "on": spot.place(grid),
                "direction": _towards(towards),
                "value": value,
            }
        if any({k: v for k, v in condition.items() if k != "name"} == same for condition in boundary):
            continue
        plain = spot.name(grid, ())
        if not along.size:
            plain += " oblique"
        elif spot.on_side(grid)[0] != along[0]:
            plain += f" {AXES[along[0]]}"
        boundary.append({"name": free_name(plain, taken), **same})


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
            work.note("not_supported", (*keys, name), words)
