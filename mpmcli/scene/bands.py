"""Widths of the bands in which the grid lets strain localise, for materials that soften.

All particles of a cell have nearly the same strain. A crack is therefore as wide as a cell, however many particles a
cell has.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.core.errors import Problem
from mpmcli.core.particles import Particles
from mpmcli.scene.own_numbers import own_keys, row_of, values_of_rows, with_numbers


def band_problems(scene: Any) -> list[Problem]:
    """Return what materials have against the widths of cells."""
    largest = float(np.max(scene.grid.cell))
    found: dict[str, str | None] = {}
    for body in scene.bodies:
        model = scene.materials[body.material]
        if not model.bands:
            continue
        if own_keys(body, model):
            place, model = _first_to_crack(body, model)
            found[f"bodies.{body.name}.region.file"] = words = model.band_problem(largest)
            if words is not None:
                found[f"bodies.{body.name}.region.file"] = f"{place}: {words}"
        else:
            found[f"materials.{body.material}"] = model.band_problem(largest)
    return [Problem(path, words, code="cell_size") for path, words in found.items() if words is not None]


def _first_to_crack(body: Any, material: Any) -> tuple[str, Any]:
    """Return where the row of a body's file stands that allows the narrowest bands only, and its model."""
    columns = body.region.numbers(own_keys(body, material))
    (widest,) = values_of_rows(material, columns, lambda model: (model.widest_band,))
    row = int(widest.argmin())
    return body.region.place_of(row, next(iter(columns))), with_numbers(material, row_of(columns, row))


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
