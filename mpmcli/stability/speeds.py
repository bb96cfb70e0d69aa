"""How fast the bodies of a scene start."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mpmcli.core.expressions import Expression
from mpmcli.stability.held import held_axes, held_faces

Array = np.ndarray

FAST = 0.01
"""Speed over wave speed from which a body counts as moving."""
SAMPLES, MORE_SAMPLES = 9, 17
"""Points along each axis of a body's box, the second number for bodies that fill little of it."""
STILL = 1e-6
"""An end is at rest that moves at no more than this share of the speed of the other one."""


def deformable(scene: Any) -> list[tuple[Any, Any]]:
    """The deformable bodies, and what they are made of."""
    models = {body.name: scene.materials[body.material] for body in scene.bodies}
    return [(body, models[body.name]) for body in scene.bodies if models[body.name].kind != "rigid"]


def is_fast_at_first(scene: Any) -> bool:
    """Whether some body starts at ``FAST`` of the largest wave speed or more, along axes with a free face."""
    kind = scene.analysis.kind
    soft = {body.name: model for body, model in deformable(scene)}
    wave = max((model.initial_wave_speed(kind) for model in soft.values()), default=math.inf)
    for body in scene.bodies:
        speeds = start_speeds(scene, body)
        if math.hypot(*speeds) >= FAST * wave:  # only then it matters what holds it
            if body.name in soft:
                speeds = np.where(held_axes(scene, body), 0.0, speeds)
            if math.hypot(*speeds) >= FAST * wave:
                return True
    return False


def largest_speed(scene: Any) -> float:
    """Largest speed with which particles of a scene start."""
    velocities = [_start_velocities(scene, body, _points(scene, body)) for body in scene.bodies]
    return max(math.hypot(*at_point) for of_body in velocities for at_point in of_body.T)


def start_speeds(scene: Any, body: Any) -> Array:
    """Largest speed (d,) along each axis that particles of a body start with, at points spread over it."""
    return np.abs(_start_velocities(scene, body, _points(scene, body))).max(axis=1)


def swinging_axes(scene: Any, body: Any) -> Array:
    """Axes (d,) along which a body is held at one end, where it starts at rest, and moves at the other."""
    held, points = held_faces(scene, body), _points(scene, body)
    speeds = np.abs(_start_velocities(scene, body, points))
    swings = np.zeros(len(speeds), dtype=bool)
    for a in np.flatnonzero(held.sum(axis=0) == 1):
        at, along = points[a], speeds[a]
        at_held, at_free = (at.min(), at.max())[:: 1 if held[0, a] else -1]
        slowest_end, fastest_end = along[at == at_held].max(), along[at == at_free].max()
        swings[a] = fastest_end > 0.0 and slowest_end <= STILL * fastest_end
    return swings


def _start_velocities(scene: Any, body: Any, points: Array) -> Array:
    """Velocities (d, n) at points (3, n)."""
    components = body.velocity or [0.0] * len(scene.grid.cell)
    return np.array([_values(component, points) for component in components])


def _points(scene: Any, body: Any) -> Array:
    """Points (3, n) spread over a body; one only where its velocity is the same everywhere."""
    if all(not isinstance(value, Expression) or value.is_constant for value in body.velocity or ()):
        return np.zeros((3, 1))  # the same everywhere
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
