"""Initial speeds of the bodies of a scene."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mpmcli.core.expressions import Expression

Array = np.ndarray

SAMPLES, MORE_SAMPLES = 9, 17
"""Points along each axis of a body's box, the second number for bodies that fill little of it."""


def largest_speed(scene: Any) -> float:
    """Return the largest initial speed of all bodies [velocity]."""
    velocities = [_start_velocities(scene, body) for body in scene.bodies]
    return max(math.hypot(*at_point) for of_body in velocities for at_point in of_body.T)


def start_speeds(scene: Any, body: Any) -> Array:
    """Return the largest initial speed (d,) of a body along each axis, at points spread over it [velocity]."""
    return np.abs(_start_velocities(scene, body)).max(axis=1)


def _start_velocities(scene: Any, body: Any) -> Array:
    """Velocities (d, n) at points spread over a body."""
    components = body.velocity or [0.0] * len(scene.grid.cell)
    points = _points(scene, body)
    return np.array([_values(component, points) for component in components])


def _points(scene: Any, body: Any) -> Array:
    """Points (3, n) spread over a body; one only where its velocity is the same everywhere."""
    if all(not isinstance(value, Expression) or value.is_constant for value in body.velocity or ()):
        return np.zeros((3, 1))
    points = _points_of_box(scene, body, SAMPLES)
    if body.region.gives_particles:
        return points
    for samples in (SAMPLES, MORE_SAMPLES):
        finer = _points_of_box(scene, body, samples)
        inside = finer[:, body.region.contains(finer[: len(scene.grid.cell)])]
        if inside.shape[1] >= SAMPLES:
            return inside
    return points


def _points_of_box(scene: Any, body: Any, samples: int) -> Array:
    """Points (3, n), so many along each axis of the part of a body's box that is in the grid."""
    low, high = body.region.bounds(len(scene.grid.cell))
    lower, upper = np.maximum(scene.grid.lower, low), np.minimum(scene.grid.upper, high)
    along = [np.linspace(low, high, samples) for low, high in zip(lower, upper, strict=True)]
    points = [axis.ravel() for axis in np.meshgrid(*along)]
    return np.array(points + [np.zeros_like(points[0])] * (3 - len(points)))


def _values(value: Any, points: Array) -> Array:
    """A number or an expression at the start at points; 0 where it is not finite."""
    if not isinstance(value, Expression):
        return np.full(points.shape[1], float(value))
    x, y, z = points
    found = np.broadcast_to(np.asarray(value(x, y, z, 0.0), dtype=np.float64), x.shape)
    return np.where(np.isfinite(found), found, 0.0)
