"""Axes along which a body has no free face: both its faces are held by conditions, walls or rigid bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray

NEAR = 0.5
"""A condition holds a face that lies within so many cells of it at the start."""


def held_axes(scene: Any, body: Any) -> Array:
    """Axes (d,) along which both faces of the body's box are held at the start."""
    return np.asarray(held_faces(scene, body).all(axis=0))


def held_faces(scene: Any, body: Any) -> Array:
    """Lower and upper faces (2, d) of the body's box that are held at the start.

    Symmetry planes, walls and velocity conditions on planes hold the face they lie at, velocity conditions on a box
    around the body both faces, rigid bodies those that they cover, and the axis of symmetry the one that lies there.
    """
    bounds = _bounds(scene, body)
    held: Array = np.zeros((2, len(bounds[0])), dtype=bool)
    near = NEAR * np.asarray(scene.grid.cell, dtype=float)
    if scene.analysis.kind == "axisymmetric":
        held[0, 0] = bounds[0, 0] <= near[0]
    holders = _holders_of(scene)
    for a in range(len(near)):
        positions = holders.positions[holders.axes == a]
        held[:, a] |= (np.abs(bounds[:, a, None] - positions) <= near[a]).any(axis=1)
    for box, along in holders.boxes:
        if (box[0] <= bounds[0]).all() and (bounds[1] <= box[1]).all():
            held[:, along] = True
    return held | _covered(bounds, holders.rigid, near).any(axis=0)


@dataclass(frozen=True)
class _Holders:
    """What holds faces in a scene.

    Attributes
    ----------
    axes, positions : (n,) axis and position [length] of the planes
    boxes : corners of boxes within which velocity conditions hold, and the axis along which they do
    rigid : (r, 2, d) lowest and highest corners of rigid bodies within the grid [length]
    """

    axes: Array
    positions: Array
    boxes: list[tuple[tuple[Array, Array], int]]
    rigid: Array


_last: list[tuple[Any, _Holders]] = []
"""The holders of the last scene: they are the same for each of its bodies."""


def _holders_of(scene: Any) -> _Holders:
    if _last and _last[0][0] is scene:
        return _last[0][1]
    planes = [plane for condition in scene.boundary for plane in _planes(condition)]
    boxes = [(_box(condition), _axis(getattr(condition, "direction", None))) for condition in scene.boundary]
    models = scene.materials
    rigid = [_bounds(scene, body) for body in scene.bodies if models[body.material].kind == "rigid"]
    holders = _Holders(
        np.array([axis for axis, _ in planes], dtype=np.int64),
        np.array([position for _, position in planes], dtype=np.float64),
        [(box, along) for box, along in boxes if box is not None and along is not None],
        np.array(rigid, dtype=np.float64).reshape(-1, 2, len(scene.grid.cell)),
    )
    _last[:] = [(scene, holders)]
    return holders


def rigid_bodies_hold_no_free_axis(scene: Any, body: Any) -> bool:
    """Whether each rigid body covers a face of the body at the start, along an axis along which both faces are held."""
    bounds, held = _bounds(scene, body), held_axes(scene, body)
    near = NEAR * np.asarray(scene.grid.cell, dtype=float)
    covered: Array = np.asarray(_covered(bounds, _holders_of(scene).rigid, near).any(axis=1))
    return all(axes.any() and not (axes & ~held).any() for axes in covered)


def _bounds(scene: Any, body: Any) -> Array:
    """Lowest and highest corner (2, d) of a body within the grid."""
    low, high = body.region.bounds(len(scene.grid.lower))
    return np.array([np.maximum(low, scene.grid.lower), np.minimum(high, scene.grid.upper)], dtype=float)


def _planes(condition: Any) -> list[tuple[int, float]]:
    """Axis and position of the plane that a condition holds along its normal, if it does."""
    if condition.kind == "symmetry":
        return [(condition.plane.index, float(condition.plane.at))]
    if condition.kind == "wall":
        a = _axis(condition.normal)
        return (
            []
            if a is None or isinstance(condition.position, tuple)
            else [(a, float(condition.position(t=0.0)))]
        )
    plane = getattr(getattr(condition, "on", None), "plane", None)
    if plane is not None and _axis(condition.direction) == plane.index:
        return [(plane.index, float(plane.at))]
    return []


def _box(condition: Any) -> tuple[Array, Array] | None:
    """Corners of the box in which a velocity condition holds all nodes."""
    box = getattr(getattr(condition, "on", None), "box", None)
    if box is None:
        return None
    return np.asarray(box.lower, dtype=float), np.asarray(box.upper, dtype=float)


def _axis(direction: Any) -> int | None:
    """Number of the axis that a direction, a name or a vector, is along."""
    if direction is None:
        return None
    from mpmcli.boundary.place import unit_vector

    along = np.flatnonzero(unit_vector(direction, 3))
    return int(along[0]) if len(along) == 1 else None


def _covered(bounds: Array, rigid: Array, near: Array) -> Array:
    """Faces (r, 2, d) of a box that each rigid body's box (r, 2, d) touches and covers."""
    low, high = rigid[:, 0], rigid[:, 1]
    covers = (low <= bounds[0] + near) & (bounds[1] - near <= high)
    found = np.zeros(rigid.shape, dtype=bool)
    for a in range(bounds.shape[1]):
        others = np.delete(covers, a, axis=1).all(axis=1)
        found[:, 0, a] = others & (np.abs(bounds[0, a] - high[:, a]) <= near[a])
        found[:, 1, a] = others & (np.abs(bounds[1, a] - low[:, a]) <= near[a])
    return found
