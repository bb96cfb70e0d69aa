"""Axes along which a body has no free face: conditions, walls or rigid bodies hold both faces."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from mpmcli.boundary.place import along_axis, unit_vector
from mpmcli.stability.bodies import bounds_in_grid, deformable

Array = np.ndarray

NEAR = 0.5
"""A face is held by what lies within so many cells of it at the start."""
LOWER, UPPER = 0, 1


def held_axes(scene: Any) -> dict[str, Array]:
    """Return the axes (d,) along which both faces of the box of each deformable body are held at the start.

    Symmetry planes, walls, velocity conditions on planes, rigid bodies, and the axis of symmetry hold the faces that
    they cover, velocity conditions on a box around the body both faces.
    """
    near, holders = NEAR * np.asarray(scene.grid.cell, dtype=float), list(_holders(scene))
    found: dict[str, Array] = {}
    for body, _ in deformable(scene):
        bounds = bounds_in_grid(scene, body)
        held = np.zeros(bounds.shape, dtype=bool)
        for axis, side, box in holders:
            face = bounds.copy()
            face[:, axis] = bounds[side, axis]
            held[side, axis] |= ((box[0] <= face[0] + near) & (face[1] - near <= box[1])).all()
        found[body.name] = np.asarray(held.all(axis=0))
    return found


def _holders(scene: Any) -> Iterator[tuple[int, int | slice, Array]]:
    """Yield axis and side of the faces that something holds, and the box (2, d) in which it does."""
    d = scene.dimensions

    def of_plane(axis: int, at: float) -> Iterator[tuple[int, int, Array]]:
        box = np.array([[-np.inf] * d, [np.inf] * d])
        box[:, axis] = at
        return ((axis, side, box) for side in (LOWER, UPPER))

    if scene.analysis.kind == "axisymmetric":
        yield from of_plane(0, 0.0)
    for condition in scene.conditions_on("velocity"):
        if not condition.acts_always:
            continue
        on = getattr(condition, "on", condition)  # a symmetry plane is a place itself
        plane, box = getattr(on, "plane", None), getattr(on, "box", None)
        normal = getattr(condition, "normal", None) or getattr(condition, "direction", None)
        axis = None if normal is None else along_axis(unit_vector(normal, d))
        if plane is not None and (axis == plane.index or condition.kind == "symmetry"):
            yield from of_plane(plane.index, float(plane.at))
        elif condition.kind == "wall" and axis is not None and not isinstance(condition.position, tuple):
            yield from of_plane(axis, float(condition.position(t=0.0)))
        elif box is not None and axis is not None:
            near = NEAR * np.asarray(scene.grid.cell)
            yield axis, slice(None), np.array([box.lower + near, box.upper - near])
    for body in scene.bodies:
        if scene.materials[body.material].kind == "rigid":
            bounds = bounds_in_grid(scene, body)
            for axis, side in np.ndindex(d, 2):  # its upper face holds lower faces
                box = bounds.copy()
                box[:, axis] = bounds[1 - side, axis]
                yield axis, side, box
