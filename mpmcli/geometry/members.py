"""What regions made of regions have in common."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from mpmcli.core.registry import OneOf
from mpmcli.geometry.base import REGIONS, Region

AnyRegion = Annotated[Region, OneOf(REGIONS)]


class Combination(Region):
    """Base of regions made of regions."""

    dimensions: ClassVar[frozenset[int]] = frozenset({1, 2, 3})

    def members(self) -> list[tuple[tuple[str | int, ...], Region]]:
        """The regions that it is made of, each with its place in the model."""
        raise TypeError(f"{type(self).__name__} does not name its members")

    def misfits(self, d: int) -> Iterator[tuple[tuple[str | int, ...], str]]:
        yield from super().misfits(d)
        for place, member in self.members():
            if member.gives_particles:
                kind = member.kind  # type: ignore[attr-defined]
                yield (
                    (*place, "kind"),
                    f"a region of kind '{kind}' is a list of particles and cannot be combined",
                )
            for inner, words in member.misfits(d):
                yield (*place, *inner), words

    def files(self) -> list[str]:
        return [name for _, member in self.members() for name in member.files()]

    def notes(self) -> list[str]:
        return [note for _, member in self.members() for note in member.notes()]
