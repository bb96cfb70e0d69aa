"""Regions made of regions: unions, intersections and differences."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

import numpy as np

from mpmcli.core.registry import OneOf
from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.vectors import Count

AnyRegion = Annotated[Region, OneOf(REGIONS)]
SomeRegions = Annotated[tuple[AnyRegion, ...], Count(1, noun="regions")]


class Combination(Region):
    """Base of regions made of regions, which stand in the fields ``parts``."""

    dimensions: ClassVar[frozenset[int]] = frozenset({1, 2, 3})
    parts: ClassVar[tuple[str, ...]] = ("regions",)

    def members(self) -> Iterator[tuple[tuple[str | int, ...], Region]]:
        """Yield the regions that it is made of, each with its place in the model."""
        for name in self.parts:
            found = getattr(self, name)
            if isinstance(found, tuple):
                yield from (((name, index), region) for index, region in enumerate(found))
            else:
                yield (name,), found

    def misfits(self, d: int) -> Iterator[tuple[tuple[str | int, ...], str]]:
        yield from super().misfits(d)
        for place, member in self.members():
            if member.gives_particles:
                kind = member.kind  # type: ignore[attr-defined]
                words = f"a region of kind '{kind}' is a list of particles and cannot be combined"
                yield (*place, "kind"), words
            for inner, words in member.misfits(d):
                yield (*place, *inner), words

    def step(self) -> float:
        return max(member.step() for _, member in self.members())

    def files(self) -> list[str]:
        return [name for _, member in self.members() for name in member.files()]

    def notes(self) -> list[str]:
        return [note for _, member in self.members() for note in member.notes()]


@REGIONS.register
class Union(Combination):
    """The points of any of several regions."""

    kind: Literal["union"]
    regions: SomeRegions
    """The regions to put together; they may overlap."""

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


@REGIONS.register
class Intersection(Combination):
    """The points that several regions have in common."""

    kind: Literal["intersection"]
    regions: SomeRegions
    """The regions of which only the common part counts."""

    def _inside(self, points: Array) -> Array:
        return np.logical_and.reduce([region.contains(points) for region in self.regions])

    def _bounds(self, d: int) -> tuple[Array, Array]:
        lower, upper = zip(*(region.bounds(d) for region in self.regions), strict=True)
        low = np.max(lower, axis=0)
        return low, np.maximum(np.min(upper, axis=0), low)


@REGIONS.register
class Difference(Combination):
    """The points of one region that are in none of some others."""

    parts = ("region", "subtract")

    kind: Literal["difference"]
    region: AnyRegion
    """The region to take from."""
    subtract: SomeRegions
    """The regions to take away; their borders go with them."""

    def _inside(self, points: Array) -> Array:
        taken = np.logical_or.reduce([region.contains(points) for region in self.subtract])
        return self.region.contains(points) & ~taken

    def _bounds(self, d: int) -> tuple[Array, Array]:
        return self.region.bounds(d)
