"""Intersections of regions."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.members import AnyRegion, Combination
from mpmcli.geometry.vectors import Count


@REGIONS.register
class Intersection(Combination):
    """The points that several regions have in common."""

    kind: Literal["intersection"]
    regions: Annotated[tuple[AnyRegion, ...], Count(1, noun="regions")]
    """The regions of which only the common part counts."""

    def members(self) -> list[tuple[tuple[str | int, ...], Region]]:
        return [(("regions", index), region) for index, region in enumerate(self.regions)]

    def _inside(self, points: Array) -> Array:
        return np.logical_and.reduce([region.contains(points) for region in self.regions])

    def _bounds(self, d: int) -> tuple[Array, Array]:
        lower, upper = zip(*(region.bounds(d) for region in self.regions), strict=True)
        low = np.max(lower, axis=0)
        return low, np.maximum(np.min(upper, axis=0), low)
