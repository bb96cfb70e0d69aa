"""What acts on nodes: concentrated forces, and the dashpots of absorbing constraints."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.importers.base import Expression
from mpmcli.importers.cbgeo.bodies import Made
from mpmcli.importers.cbgeo.conditions import SIDES, spots
from mpmcli.importers.cbgeo.constraints import members, with_tables
from mpmcli.importers.cbgeo.mesh import AXES
from mpmcli.importers.cbgeo.reading import Array, Keys
from mpmcli.importers.cbgeo.work import Work
from mpmcli.importers.scene_text import number_text

MAX_FORCES = 200
"""Nodes with a force of their own."""
SPRINGS = "the springs beside the dashpots act along the normal only"


@dataclass(frozen=True)
class Layer:
    """Numbers of an absorbing layer: factors of the dashpots along and across the normal, and its thickness."""

    a: float
    b: float
    delta: float


def add_nodal_forces(work: Work) -> None:
    """Translate concentrated forces, which each node of a set has in full."""
    keys: Keys = ("external_loading_conditions", "concentrated_nodal_forces")
    given_forces = work.given.source.external_loading_conditions.concentrated_nodal_forces
    for at, given, table in with_tables(work, given_forces, keys, 3):
        if table is not None:
            forces = np.zeros((len(work.grid.nodes), work.grid.d))
            for node, axis, numbers in zip(table.whole(0), table.whole(1), table.rows, strict=True):
                forces[node, axis] += numbers[2]
            loaded = np.flatnonzero(forces.any(axis=1))
            _add(work, at, [(node, work.grid.inside(forces[node]).tolist()) for node in loaded.tolist()])
        elif (place := work.nodes_and_axis(given, at, "force")) and given.force != 0.0:
            nodes, axis = place
            along = work.grid.inside(np.eye(work.grid.d)[axis])
            force = [work.times(given.force * part, given.math_function_id, at) for part in along.tolist()]
            if None not in force:
                _add(work, at, [(node, force) for node in nodes.tolist()])


def _add(work: Work, keys: Keys, forces: list[tuple[int, list[Any]]]) -> None:
    if len(forces) > MAX_FORCES:
        work.lacks(keys, f"forces on {len(forces)} nodes; at most {MAX_FORCES} are translated")
        return
    for node, force in forces:
        at = work.grid.place(work.grid.nodes[node]).tolist()
        work.load("force", "nodal_force", at=at, force=force)


def add_absorbing(work: Work, bodies: list[Made]) -> None:
    """Translate the dashpots of absorbing constraints, those of one side together; springs are not supported."""
    keys: Keys = ("mesh", "boundary_conditions", "absorbing_constraints")
    groups: dict[tuple[int, Layer], tuple[Keys, list[int]]] = {}
    for at, given in members(work.given.source.mesh.boundary_conditions.absorbing_constraints, keys):
        if isinstance(given, str) or given.file is not None:
            work.lacks(at, "absorbing constraints in files")
            continue
        place = work.nodes_and_axis(given, at, "delta", "a", "b")
        if place is None:
            continue
        nodes, axis = place
        for name in ("h_min", "position"):
            if getattr(given, name) is not None:
                work.note("ignored", (*at, name), "areas are those of the face of the body")
        layer = Layer(given.a, given.b, given.delta)
        groups.setdefault((axis, layer), (at, []))[1].extend(nodes.tolist())
    for (axis, layer), (at, found) in groups.items():
        _absorb(work, bodies, at, np.unique(found), axis, layer)


def _absorb(work: Work, bodies: list[Made], keys: Keys, nodes: Array, axis: int, layer: Layer) -> None:
    """Add dashpots to all boxes of material on the sides of the mesh that the nodes are."""
    found = spots(work.grid.nodes[nodes], work.grid) or []
    complete = bool(found)
    for spot in found:
        if spot.side is None or spot.side[0] != axis:
            complete = False
            continue
        at = float((work.grid.upper if spot.side[1] else work.grid.lower)[axis])
        touching = [body for body in bodies if _reaches(body, spot.side, at, 1e-6 * work.grid.cell[axis])]
        complete &= bool(touching)
        for body in touching:
            _add_layer(work, body, keys, spot.side, at, layer)
    if not complete:
        words = "absorbing nodes that are no whole side of the mesh on which a box of material lies"
        work.lacks(keys, words)


def _reaches(body: Made, side: tuple[int, int], at: float, near: float) -> bool:
    """Whether a body fills one box that ends at a coordinate on this side."""
    boxes = body.filled.boxes if body.filled is not None else []
    return len(boxes) == 1 and bool(abs(boxes[0][side[1]][side[0]] - at) < near)


def _add_layer(work: Work, body: Made, keys: Keys, side: tuple[int, int], at: float, layer: Layer) -> None:
    """Dashpots of the material's impedance, and springs of its stiffness over the thickness of the layer."""
    name = next(made["material"] for made in work.scene["bodies"] if made["name"] == body.name)
    material = work.scene["materials"][name]
    if not {"E", "nu", "density"} <= material.keys():
        work.lacks(keys, f"absorbing constraints of the material '{name}'")
        return
    E, nu, density = material["E"], material["nu"], material["density"]
    stiffness = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    face = {"body": body.name, "face": {"axis": AXES[side[0]], "side": "upper" if side[1] else "lower"}}
    waves = {}
    if (layer.a, layer.b) != (1.0, 1.0):
        waves["pressure_wave"] = layer.a * math.sqrt(stiffness / density)
        waves["shear_wave"] = layer.b * math.sqrt(E / (2 * (1 + nu) * density))
    dashpots = work.load(f"absorbing {SIDES[work.grid.d][side]}", "absorbing", on=face, **waves)
    axis = AXES[side[0]]
    way = axis if at == 0 else f"({axis} - {number_text(at)})" if at > 0 else f"({axis} + {number_text(-at)})"
    traction: list[Any] = [0] * work.grid.d
    traction[side[0]] = Expression(f"-{number_text(stiffness / layer.delta)}*{way}")
    words = f"stiffness {number_text(stiffness)} over a layer of {number_text(layer.delta)}"
    work.made.comment(("loads", len(work.scene["loads"])), words)
    work.load(f"{dashpots} springs", "traction", on=dict(face), traction=traction, coordinates="current")
    work.note("changed", keys, SPRINGS)
