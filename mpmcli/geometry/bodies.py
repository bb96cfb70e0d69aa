"""A body as the scene asks for it, and its particles at set-up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

import numpy as np

from mpmcli.geometry.base import Region

Array = np.ndarray


class BodyRequest(Protocol):
    """What filling asks of a body of the scene."""

    name: str
    region: Region
    particles_per_axis: int | Sequence[int]
    particles_along: str
    overlap: str


@dataclass(frozen=True)
class BodyParticles:
    """The particles of one body at set-up.

    Attributes
    ----------
    name : the body's
    X : (d, n) positions [length]
    size : (d, n) half-sizes of the particles' domains along their sides [length]; read only, may share memory
    volume : (n,) length, area or volume of a particle (without thickness, area or radius); read only likewise
    key : (n,) number of each particle's sub-cell of the grid, ascending, or None for others
    parts : (d,) sub-cells per cell along each axis, or None likewise
    turn : (d, d) from the sides of the domains to the grid's axes, or None where they lie along these
    density : (n,) mass densities of the particles, or None where they have that of the material [density]
    """

    name: str
    X: Array
    size: Array
    volume: Array
    key: Array | None = None
    parts: tuple[int, ...] | None = None
    turn: Array | None = None
    density: Array | None = None

    @property
    def reach(self) -> Array:
        """How far the domains reach along the grid's axes, (d, n) [length]."""
        return self.size if self.turn is None else np.abs(self.turn) @ self.size

    @property
    def count(self) -> int:
        """Number of particles."""
        return self.X.shape[1]

    def only(self, kept: Array) -> BodyParticles:
        """The particles that the mask ``kept`` (n,) names."""
        key = None if self.key is None else self.key[kept]
        return replace(
            self,
            X=self.X[:, kept],
            size=self.size[:, kept],
            volume=self.volume[kept],
            key=key,
            density=None if self.density is None else self.density[kept],
        )


class Domains(NamedTuple):
    """Domains of the particles of some bodies, as boxes along the grid's axes.

    Attributes
    ----------
    X, half : (d, n) centres and half sizes [length]
    names, body : names of the bodies, and which of them (n,) each is of
    """

    X: Array
    half: Array
    names: list[str]
    body: Array

    @classmethod
    def of(cls, filled: Sequence[BodyParticles]) -> Domains:
        """Return those of these bodies."""
        return cls(
            np.concatenate([body.X for body in filled], axis=1),
            np.concatenate([np.broadcast_to(body.reach, body.X.shape) for body in filled], axis=1),
            [body.name for body in filled],
            np.repeat(np.arange(len(filled)), [body.count for body in filled]),
        )

    def where(self, chosen: Array) -> Domains:
        """Return those that a mask or indices name."""
        return Domains(self.X[:, chosen], self.half[:, chosen], self.names, self.body[chosen])

    def distances(self, point: Array) -> Array:
        """Return the distances (n,) from a point (d,) to them, 0 inside."""
        return np.asarray(
            np.linalg.norm(np.maximum(np.abs(self.X - point[:, None]) - self.half, 0.0), axis=0)
        )
