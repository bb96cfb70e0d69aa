"""The time step of tractions on the points of cracks, which are those of the start of a step.

Δt < 0.75 √(ρ Δx/k), with k the initial slope of the traction: a node on a crack has half a cell on either side. FMPM(k)
moves fast motion with less mass: 1/k of that was found to be stable for orders 2, 4 and 6 at two positions within a
cell, twice as much never was.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from mpmcli.scene.own_density import lightest_density
from mpmcli.stability.models import scheme_of

SHARE = 0.75
"""Longest time step over √(ρ Δx/k); with FMPM of some order over that by the order."""


@dataclass(frozen=True)
class TractionLimit:
    """Longest time step of a traction.

    Attributes
    ----------
    crack : its name
    path : of its law in the scene
    slope : largest slope of the law [pressure/length]
    step : longest time step [time]
    """

    crack: str
    path: str
    slope: float
    step: float


def limits_of_tractions(scene: Any) -> list[TractionLimit]:
    """Return the limits of all tractions of a checked scene."""
    scheme, found = scheme_of(scene), []
    share = SHARE / (scheme.order if scheme.kind == "fmpm" else 1)
    for crack in scene.cracks:
        densities = [
            lightest_density(body, scene.materials[body.material])
            for body in scene.bodies
            if scene.materials[body.material].kind != "rigid"
            and (crack.cuts is None or body.name in crack.cuts)
        ]
        for path, law in laws_of_points(crack):
            slope = max(law.slopes)
            if slope > 0.0 and densities:
                step = share * math.sqrt(min(densities) * float(min(scene.grid.cell)) / slope)
                found.append(TractionLimit(crack.name, f"cracks.{crack.name}.{path}", slope, step))
    return found


def laws_of_points(crack: Any) -> list[tuple[str, Any]]:
    """Return the laws of the points of a crack of the scene, with their keys."""
    several = len(crack.traction) > 1
    found = [
        (f"traction.{index}.law" if several else "traction.law", part.law)
        for index, part in enumerate(crack.traction)
    ]
    ends = {} if crack.growth is None else {"start": crack.growth.start, "end": crack.growth.end}
    left = {key: end.traction for key, end in ends.items() if end is not None and end.traction is not None}
    return found + [(f"growth.{key}.traction", law) for key, law in left.items()]
