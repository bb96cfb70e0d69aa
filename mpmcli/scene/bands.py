"""Widths of the bands in which the grid lets strain localise, for materials that soften.

All particles of a cell have nearly the same strain. A crack is therefore as wide as a cell, however many particles a
cell has.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.core.errors import Problem
from mpmcli.core.particles import Particles


def band_problems(scene: Any) -> list[Problem]:
    """Return what materials have against the widths of cells."""
    used = {body.material for body in scene.bodies}
    largest = float(np.max(scene.grid.cell))
    words = {
        name: model.band_problem(largest)
        for name, model in scene.materials.items()
        if model.bands and name in used
    }
    return [
        Problem(f"materials.{name}", message, code="cell_size") for name, message in words.items() if message
    ]


def set_bands(scene: Any, particles: Particles, models: Sequence[Any]) -> None:
    """Write the widths to the histories that want them: those of cells, and of particles where there is no axis."""
    d, n = particles.X.shape
    widths = np.empty((3, n))
    widths[:d] = np.array(scene.grid.cell)[:, None]
    if d < 3:
        face = np.prod(2.0 * particles.size, axis=0)
        widths[d:] = (particles.vol0 / face) ** (1.0 / (3 - d))
    for index, model in enumerate(models):
        mine = particles.material == index
        for name, width in zip(model.bands, widths, strict=False):
            particles.H[model.history.index(name), mine] = width[mine]
