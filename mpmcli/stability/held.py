"""Axes along which a body has no free face: conditions, walls or rigid bodies hold both faces."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray

NEAR = 0.5
"""A face is held by what lies within so many cells of it at the start."""


class Holders:
    """What holds faces of bodies in a scene.

    Symmetry planes, walls and velocity conditions on planes hold the face they lie at, velocity conditions on a box
    around the body both faces, rigid bodies those that they cover, and the axis of symmetry the one that lies there.
    """

    def __init__(self, scene: Any):
        self._grid = scene.grid
        self._near = NEAR * np.asarray(scene.grid.cell, dtype=float)
        conditions = [each for each in scene.conditions_on("velocity") if each.acts_always]
        planes = [plane for condition in conditions for plane in _planes(condition)]
        if scene.analysis.kind == "axisymmetric":
            planes.append((0, 0.0))
        self._axes = np.array([axis for axis, _ in planes], dtype=np.int64)
        self._positions = np.array([position for _, position in planes], dtype=np.float64)
        self._boxes = [box for box in map(_box, conditions) if box is not None]
        rigid = [
            self._bounds(body) for body in scene.bodies if scene.materials[body.material].kind == "rigid"
        ]
        self._rigid = np.array(rigid, dtype=np.float64).reshape(-1, 2, len(self._near))

    def held_axes(self, body: Any) -> Array:
        """Return the axes (d,) along which both faces of the body's box are held at the start."""
        bounds = self._bounds(body)
        held = self._covered(bounds)
        for a, near in enumerate(self._near):
            positions = self._positions[self._axes == a]
            held[:, a] |= (np.abs(bounds[:, a, None] - positions) <= near).any(axis=1)
        for low, high, along in self._boxes:
            if (low <= bounds[0]).all() and (bounds[1] <= high).all():
                held[:, along] = True
        return np.asarray(held.all(axis=0))

    def _bounds(self, body: Any) -> Array:
        """Lowest and highest corner (2, d) of a body within the grid."""
        low, high = body.region.bounds(len(self._grid.lower))
        return np.array([np.maximum(low, self._grid.lower), np.minimum(high, self._grid.upper)], dtype=float)

    def _covered(self, bounds: Array) -> Array:
        """Faces (2, d) of a box that the boxes of rigid bodies touch and cover."""
        low, high = self._rigid[:, 0], self._rigid[:, 1]
        covers = (low <= bounds[0] + self._near) & (bounds[1] - self._near <= high)
        found = np.zeros(bounds.shape, dtype=bool)
        for a, near in enumerate(self._near):
            others = np.delete(covers, a, axis=1).all(axis=1)
            found[0, a] = (others & (np.abs(bounds[0, a] - high[:, a]) <= near)).any()
            found[1, a] = (others & (np.abs(bounds[1, a] - low[:, a]) <= near)).any()
        return found


def _planes(condition: Any) -> list[tuple[int, float]]:
    """Axis and position of the plane that a condition holds along its normal, if it does."""
    if condition.kind == "symmetry":
        return [(condition.plane.index, float(condition.plane.at))]
    if condition.kind == "wall":
        a = _axis(condition.normal)
        if a is None or isinstance(condition.position, tuple):
            return []
        return [(a, float(condition.position(t=0.0)))]
    plane = getattr(getattr(condition, "on", None), "plane", None)
    if plane is not None and _axis(condition.direction) == plane.index:
        return [(plane.index, float(plane.at))]
    return []


def _box(condition: Any) -> tuple[Array, Array, int] | None:
    """Corners of the box in which a velocity condition holds all nodes, and the axis along which it does."""
    box = getattr(getattr(condition, "on", None), "box", None)
    along = _axis(getattr(condition, "direction", None))
    if box is None or along is None:
        return None
    return np.asarray(box.lower, dtype=float), np.asarray(box.upper, dtype=float), along


def _axis(direction: Any) -> int | None:
    """Number of the axis that a direction, a name or a vector, is along."""
    if direction is None:
        return None
    from mpmcli.boundary.place import unit_vector

    along = np.flatnonzero(unit_vector(direction, 3))
    return int(along[0]) if len(along) == 1 else None
