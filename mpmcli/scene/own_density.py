"""Densities that particles have from the file of points that fills their body."""

from __future__ import annotations

from typing import Any

from mpmcli.scene.own_numbers import own_keys


def lightest_density(body: Any, material: Any) -> float:
    """Return the smallest mass density of the particles of a body of this material."""
    own = getattr(body.region, "density", None)
    return float(material.density if own is None else own.min())


def lightness(scene: Any) -> list[float]:
    """Return the density of each material over that of its lightest particle.

    It is 1 of materials without own densities, and of those whose particles have further numbers of their own: their
    wave speeds take them into account.
    """
    found = []
    for name, material in scene.materials.items():
        bodies = [body for body in scene.bodies if body.material == name and material.kind != "rigid"]
        if any(own_keys(body, material) for body in bodies):
            bodies = []
        found.append(
            max((material.density / lightest_density(body, material) for body in bodies), default=1.0)
        )
    return found
