"""What limits of the time step need to know of bodies: where they are, and how fast they and their waves are."""

import math
from typing import Any

import numpy as np

from mpmcli.core.expressions import Expression
from mpmcli.materials.thermal import coupled_wave_speed
from mpmcli.scene.own_numbers import fastest_wave, lightest_density, own_keys

Array = np.ndarray

SAMPLES = 17
"""Points along each axis of a body's box at which its velocity is evaluated."""


def deformable(scene: Any) -> list[tuple[Any, Any]]:
    """Return the deformable bodies and their materials."""
    models = [(body, scene.materials[body.material]) for body in scene.bodies]
    return [(body, model) for body, model in models if model.kind != "rigid"]


def bounds_in_grid(scene: Any, body: Any) -> Array:
    """Return the lowest and the highest corner (2, d) of the part of a body's box that is in the grid."""
    low, high = body.region.bounds(scene.dimensions)
    return np.array([np.maximum(low, scene.grid.lower), np.minimum(high, scene.grid.upper)], dtype=float)


def wave_speed_of(scene: Any, body: Any, material: Any) -> float:
    """Return the largest wave speed of a body at the start, adiabatic where heat and strain are coupled [velocity]."""
    if own_keys(body, material):
        return fastest_wave(scene, body)
    speed = coupled_wave_speed(material, scene.analysis.kind, scene.is_adiabatic)
    return speed * math.sqrt(material.density / lightest_density(body, material))


def largest_wave_speed(scene: Any) -> float:
    """Return the largest wave speed of the deformable bodies at the start [velocity], 0 without any."""
    return max((wave_speed_of(scene, *each) for each in deformable(scene)), default=0.0)


def largest_speed(scene: Any) -> float:
    """Return the largest initial speed of all bodies [velocity]."""
    return max(math.hypot(*V) for body in scene.bodies for V in start_velocities(scene, body).T)


def start_velocities(scene: Any, body: Any) -> Array:
    """Return the initial velocity (d, n) of a body at points spread over it, 0 where it is not finite [velocity]."""
    components = body.velocity or [0.0] * scene.dimensions
    if all(not isinstance(value, Expression) or value.is_constant for value in components):
        points = np.zeros((3, 1))
    else:
        along = [np.linspace(low, high, SAMPLES) for low, high in bounds_in_grid(scene, body).T]
        points = np.zeros((3, SAMPLES**scene.dimensions))
        points[: scene.dimensions] = [axis.ravel() for axis in np.meshgrid(*along)]
        if not body.region.gives_particles:
            inside = body.region.contains(points[: scene.dimensions])
            points = points[:, inside] if inside.sum() >= SAMPLES else points
    x, y, z = points
    values = [value(x, y, z, 0.0) if isinstance(value, Expression) else float(value) for value in components]
    found = np.array([np.broadcast_to(value, x.shape) for value in values], dtype=np.float64)
    return np.where(np.isfinite(found), found, 0.0)
