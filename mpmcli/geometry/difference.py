"""Differences of regions."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.members import AnyRegion, Combination
from mpmcli.geometry.vectors import Count


@REGIONS.register
class Difference(Combination):
    """The points of one region that are in none of some others."""

    kind: Literal["difference"]
    region: AnyRegion
    """The region to take from."""
    subtract: Annotated[tuple[AnyRegion, ...], Count(1, noun="regions")]
    """The regions to take away; their borders go with them."""

    def members(self) -> list[tuple[tuple[str | int, ...], Region]]:
        others: list[tuple[tuple[str | int, ...], Region]]
        others = [(("subtract", index), region) for index, region in enumerate(self.subtract)]
        return [(("region",), self.region), *others]

    def _inside(self, points: Array) -> Array:
        taken = np.logical_or.reduce([region.contains(points) for region in self.subtract])
        return self.region.contains(points) & ~taken

    def _bounds(self, d: int) -> tuple[Array, Array]:
        return self.region.bounds(d)
