"""Axes along which a body has no free face: both its faces are held by conditions, walls or rigid bodies."""

from __future__ import annotations

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
    for condition in scene.boundary:
        for a, position in _planes(condition):
            held[:, a] |= np.abs(bounds[:, a] - position) <= near[a]
        box, along = _box(condition), _axis(getattr(condition, "direction", None))
        if (
            box is not None
            and along is not None
            and bool((box[0] <= bounds[0]).all() and (bounds[1] <= box[1]).all())
        ):
            held[:, along] = True
    for other in scene.bodies:
        if scene.materials[other.material].kind == "rigid":
            held[_covered(bounds, _bounds(scene, other), near)] = True
    return held


def rigid_bodies_hold_no_free_axis(scene: Any, body: Any) -> bool:
    """Whether each rigid body covers a face of the body at the start, along an axis along which both faces are held."""
    bounds, held = _bounds(scene, body), held_axes(scene, body)
    near = NEAR * np.asarray(scene.grid.cell, dtype=float)
    rigid = [other for other in scene.bodies if scene.materials[other.material].kind == "rigid"]
    covered = [_covered(bounds, _bounds(scene, other), near).any(axis=0) for other in rigid]
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
    """Faces (2, d) of a box that a rigid body's box touches and covers."""
    covers = (rigid[0] <= bounds[0] + near) & (bounds[1] - near <= rigid[1])
    found = np.zeros(bounds.shape, dtype=bool)
    for a in range(bounds.shape[1]):
        if np.delete(covers, a).all():
            found[0, a] = abs(bounds[0, a] - rigid[1, a]) <= near[a]
            found[1, a] = abs(bounds[1, a] - rigid[0, a]) <= near[a]
    return found
