"""Unions of regions."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.members import AnyRegion, Combination
from mpmcli.geometry.vectors import Count


@REGIONS.register
class Union(Combination):
    """The points of any of several regions."""

    kind: Literal["union"]
    regions: Annotated[tuple[AnyRegion, ...], Count(1, noun="regions")]
    """The regions to put together; they may overlap."""

    def members(self) -> list[tuple[tuple[str | int, ...], Region]]:
        return [(("regions", index), region) for index, region in enumerate(self.regions)]

    def _inside(self, points: Array) -> Array:
        d, n = points.shape
        inside = np.zeros(n, dtype=bool)
        if n == 0:
            return inside
        low, high = points.min(axis=1), points.max(axis=1)
        for region in self.regions:
            lower, upper = region.bounds(d)
            margin = 1e-6 * (upper - lower)
            if (lower - margin <= high).all() and (upper + margin >= low).all():
                inside |= region.contains(points)
        return inside

    def _bounds(self, d: int) -> tuple[Array, Array]:
        lower, upper = zip(*(region.bounds(d) for region in self.regions), strict=True)
        return np.min(lower, axis=0), np.max(upper, axis=0)
