"""Gravity, forces on nodes and tractions of particles."""

from typing import Any

import numpy as np

from mpmcli.importers.base import Expression
from mpmcli.importers.cbgeo.bodies import Made
from mpmcli.importers.cbgeo.mesh import AXES, rounded
from mpmcli.importers.cbgeo.nodal_loads import add_absorbing, add_nodal_forces
from mpmcli.importers.cbgeo.particles import as_table
from mpmcli.importers.cbgeo.reading import Array, Keys
from mpmcli.importers.cbgeo.source import SurfaceTraction
from mpmcli.importers.cbgeo.work import Work
from mpmcli.importers.scene_text import number_text

LOADING = "external_loading_conditions"


def add_loads(work: Work, bodies: list[Made]) -> None:
    """Translate all loads."""
    loading = work.given.source.external_loading_conditions
    _add_gravity(work)
    add_nodal_forces(work)
    for index, traction in enumerate(loading.particle_surface_traction):
        _add_traction(work, bodies, traction, (LOADING, "particle_surface_traction", index))
    add_absorbing(work, bodies)


def _add_gravity(work: Work) -> None:
    gravity = work.given.source.external_loading_conditions.gravity
    if not any(gravity):
        return
    d = work.grid.d
    if len(gravity) != d:
        work.fault((LOADING, "gravity"), f"{d} components are needed, not {len(gravity)}")
        return
    acting = np.flatnonzero(gravity)
    values: list[Any] = work.grid.inside(np.array(gravity, dtype=float)).tolist()
    if len(acting) == 1:
        size, sign = abs(gravity[acting[0]]), "-" if gravity[acting[0]] < 0 else ""
        work.constant("g", size)
        if not work.grid.is_turned:
            values = [Expression(f"{sign}g") if axis == acting[0] else 0 for axis in range(d)]
        elif d == 2:
            sine, cosine, other = "g*sin(turn*pi/180)", "g*cos(turn*pi/180)", "" if sign else "-"
            along_x = [sign + cosine, other + sine]
            values = [
                Expression(text) for text in (along_x if acting[0] == 0 else [sign + sine, sign + cosine])
            ]
    work.load("gravity", "gravity", acceleration=values)


def _add_traction(work: Work, bodies: list[Made], given: SurfaceTraction, keys: Keys) -> None:
    axis, members = work.axis(given.dir, keys), work.cloud.members(given.pset_id)
    if members is None:
        work.fault((*keys, "pset_id"), f"there is no particle set {given.pset_id}")
    if axis is None or members is None or not len(members) or given.traction == 0.0:
        return
    value = work.times(given.traction, given.math_function_id, keys)
    if value is None:
        return
    direction = work.grid.inside(np.eye(work.grid.d)[axis])
    rest = members
    for body in bodies:
        inside = np.intersect1d(rest, body.members)
        face = _face(work, body, inside, direction)
        if face is not None:
            _add_face(work, body, inside, face, value, direction, keys)
            rest = np.setdiff1d(rest, inside)
    if len(rest):
        _add_forces(work, rest, given, direction, keys)


def _face(work: Work, body: Made, members: Array, direction: Array) -> tuple[int, bool] | None:
    """Axis and side of a body that fills a box whose outermost particles are these; None if they are not."""
    if not len(members) or body.filled is None or len(body.filled.boxes) != 1:
        return None
    x = work.cloud.x
    order = np.argsort(-np.abs(direction), kind="stable")
    for axis in order.tolist():
        along = x[body.members, axis]
        near = 1e-6 * work.grid.cell[axis]
        for upper in (True, False) if direction[axis] >= 0 else (False, True):
            layer = along > along.max() - near if upper else along < along.min() + near
            if not layer.all() and np.array_equal(np.sort(body.members[layer]), np.sort(members)):
                return int(axis), upper
    return None


def _add_face(
    work: Work, body: Made, members: Array, face: tuple[int, bool], value: Any, direction: Array, keys: Keys
) -> None:
    assert body.filled is not None
    axis, upper = face
    d = work.grid.d
    lower, higher = body.filled.boxes[0]
    area = float(np.delete(higher - lower, axis).prod())
    ratio = float((work.cloud.volume[members] ** ((d - 1) / d)).sum()) / area
    words = "on the face; CB-Geo loads the centres of the particles beside it"
    if abs(ratio - 1) > 1e-6:
        value = _scaled(value, ratio)
        words += f". Scaled by {ratio:.6g}, because CB-Geo takes particles as square"
    work.note("changed", keys, words)
    on = {"body": body.name, "face": {"axis": AXES[axis], "side": "upper" if upper else "lower"}}
    work.load("traction", "traction", on=on, traction=_along(direction, value))


def _add_forces(work: Work, members: Array, given: SurfaceTraction, direction: Array, keys: Keys) -> None:
    """A force on each particle, as the source has it: traction × volume^((d-1)/d)."""
    d = work.grid.d
    sizes = rounded(work.cloud.volume[members] ** ((d - 1) / d))
    for size in np.unique(sizes):
        chosen = members[sizes == size]
        value = work.times(float(rounded(np.array(given.traction * size))), given.math_function_id, keys)
        if value is None:
            return
        name = work.load("traction", "particle_force")
        load = work.scene["loads"][-1]
        load |= {"on": _target(work, chosen, name), "force": _along(direction, value), "per": "particle"}
        words = f"{number_text(given.traction)} times the edge of each particle, as in CB-Geo"
        work.made.comment(("loads", len(work.scene["loads"]) - 1), words)


def _target(work: Work, members: Array, name: str) -> dict[str, Any]:
    """A box that holds these particles and no others, or a table of them."""
    x = work.cloud.x
    margin = 1e-3 * work.grid.cell
    lower, upper = rounded(x[members].min(axis=0) - margin), rounded(x[members].max(axis=0) + margin)
    inside = ((x >= lower) & (x <= upper)).all(axis=1)
    if inside.sum() == len(members):
        return {"box": {"lower": lower.tolist(), "upper": upper.tolist()}}
    file = f"{name.replace(' ', '_')}.csv"
    size = rounded(2e-2 * work.grid.cell)
    work.made.files[file] = as_table(x[members], np.full(len(members), size.prod()))
    return {"region": {"kind": "points", "file": file, "size": size.tolist()}}


def _along(direction: Array, value: Any) -> list[Any]:
    shares = [round(component, 12) for component in direction.tolist()]
    return [_scaled(value, share) if share not in (0.0, 1.0) else value if share else 0 for share in shares]


def _scaled(value: Any, factor: float) -> Any:
    if isinstance(value, Expression):
        return Expression(f"{number_text(factor)}*({value})")
    return value * factor
