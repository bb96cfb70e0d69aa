"""Where the faces of boxes of particles lie within their cells, while the boxes move and deform."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.analysis import F_COMPONENTS
from mpmcli.shapes import SHAPES
from mpmcli.stability.blocks import Block
from mpmcli.stability.growth import NEAR, limit_at_rest
from mpmcli.stability.linear_step import Scheme
from mpmcli.stability.scene_limit import limit_of_row, one_thread

Array = np.ndarray

REACH = 0.2
"""Half of the cells over which the particles of a face may be spread along its normal."""
PLACES_PER_CELL = 48
"""Places of faces are rounded to so many."""
ROUND_OFF = 1e-6

Places = tuple[float, ...]
"""Places within a cell, 0 to ½ and mirrored."""


class Face(NamedTuple):
    """Between which places its particles end [cells of the grid], and their largest speed along its normal."""

    low: float
    high: float
    speed: float


Faces = dict[tuple[int, int], Face]
"""Faces by axis and side, 0 or 1."""


class Boxes:
    """The faces of particles that fill boxes at the start.

    Parameters
    ----------
    scene : the checked scene
    particles : as they start
    members : (N,) those of each box
    sides : of each box, axis and side (0 or 1) of the faces that are looked at
    """

    def __init__(
        self,
        scene: Any,
        particles: Any,
        members: Sequence[Array],
        sides: Sequence[Sequence[tuple[int, int]]],
    ):
        self.lower = np.asarray(scene.grid.lower, dtype=float)
        self.cell = np.asarray(scene.grid.cell, dtype=float)
        self.count = len(members)
        self._most = int(particles.id.max())
        self._stretches = SHAPES[scene.method.shape].follows_deformation
        self._faces: list[tuple[int, int, int]] = []
        self.start, ids = [], []
        near = ROUND_OFF * self.cell
        for number, (inside, of_box) in enumerate(zip(members, sides, strict=True)):
            low, high = _sides(particles, inside)
            start = np.stack([low.min(axis=1), high.max(axis=1)])
            self.start.append(start)
            own = particles.id[inside]
            for a, side in of_box:
                self._faces.append((number, a, side))
                lies_there = high[a] >= start[1, a] - near[a] if side else low[a] <= start[0, a] + near[a]
                ids.append(own[lies_there])
        counts = [len(each) for each in ids]
        self._ids = np.concatenate(ids) if ids else np.zeros(0, dtype=np.int64)
        self._begins = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
        self._axis = np.repeat([a for _, a, _ in self._faces], counts)
        self._sign = np.repeat([1.0 if side else -1.0 for _, _, side in self._faces], counts)
        self._rows = np.array([stretch_row(len(self.cell), a) for a in range(len(self.cell))])

    def faces(self, p: Any, slowest: float = math.inf) -> list[Faces]:
        """Of each box those that are flat and no faster than ``slowest`` along their normals."""
        found: list[Faces] = [{} for _ in range(self.count)]
        if not self._faces or not p.count:
            return found
        face, a = places_in_memory(p, self._most)[self._ids], self._axis
        is_there = face >= 0
        half = self._sign * p.size[a, face]
        if self._stretches:
            half *= p.F[self._rows[a], face]
        at = (p.X[a, face] + half - self.lower[a]) / self.cell[a]
        low = np.minimum.reduceat(np.where(is_there, at, math.inf), self._begins)
        high = np.maximum.reduceat(np.where(is_there, at, -math.inf), self._begins)
        speed = np.maximum.reduceat(np.where(is_there, np.abs(p.V[a, face]), 0.0), self._begins)
        is_flat = (low <= high) & (high <= low + 2.0 * REACH)
        for number in np.flatnonzero(is_flat & (speed <= slowest) & (speed < math.inf)):
            box, axis, side = self._faces[number]
            found[box][axis, side] = Face(float(low[number]), float(high[number]), float(speed[number]))
        return found

    def cells_moved(self, a: int, face: Face, wave_speed: float, courant: float) -> float:
        """By how many cells along axis ``a`` a face moves in a step."""
        return courant * float(self.cell.min() / self.cell[a]) * face.speed / wave_speed

    def start_places(self, number: int, a: int) -> list[Places]:
        """Places of both faces of a box along an axis at the start, and ``REACH`` to both sides."""
        within = (self.start[number][:, a] - self.lower[a]) / self.cell[a]
        return [places_between(float(place) - REACH, float(place) + REACH) for place in within]


def places_in_memory(p: Any, most: int) -> Array:
    """Where the particles of identities up to ``most`` are, (most + 1,); −1 for those that have left the grid."""
    places = np.full(most + 1, -1)
    places[p.id] = np.arange(p.count)
    return places


def is_box(p: Any, members: Array) -> bool:
    """Whether the members (N,) of the particles fill a box."""
    low, high = _sides(p, members)
    volume = np.prod(high.max(axis=1) - low.min(axis=1))
    filled = np.prod(2.0 * p.size[:, members], axis=0).sum()
    return bool(abs(filled - volume) <= ROUND_OFF * volume)


def _sides(p: Any, members: Array) -> tuple[Array, Array]:
    """Where the members of the particles begin and end along the axes, at the start."""
    X, size = p.X[:, members], p.size[:, members]
    return X - size, X + size


def stretch_row(d: int, a: int) -> int:
    """Row of F that stretches along an axis."""
    return F_COMPONENTS[d].index("xyz"[a] * 2)


def places_between(low: float, high: float) -> Places:
    """Where within a cell limits may be least between two places: ends, grid lines, middles."""
    inside = range(math.ceil(2.0 * low), math.floor(2.0 * high) + 1)
    found = set()
    for place in (low, high, *(0.5 * half for half in inside)):
        within = round(place * PLACES_PER_CELL) / PLACES_PER_CELL % 1.0
        found.add(max(min(within, 1.0 - within), NEAR))
    return tuple(sorted(found))


class LimitsOfPlaces:
    """Limits of blocks that rest with their faces at places along the axes, and of endless rows; found once each.

    Where they are ``enough`` or more they are some number that is so too.
    """

    def __init__(self, blocks: Sequence[Block], scheme: Scheme, enough: float = math.inf):
        self._blocks, self._scheme, self._enough = blocks, scheme, enough
        self._found: dict[tuple[tuple[Places, ...], ...], float] = {}

    def least(self, sides: Mapping[int, Sequence[Places]]) -> float:
        """The least of all blocks, with the places of the faces of each axis."""
        key = tuple(tuple(sides[a]) for a in sorted(sides))
        if key not in self._found:
            with one_thread():
                self._found[key] = min(self._limits(sides))
        return self._found[key]

    def _limits(self, sides: Mapping[int, Sequence[Places]]) -> Iterator[float]:
        for block in self._blocks:
            if block.lattice.is_endless:
                yield limit_of_row(block, self._scheme, self._enough)
                continue
            enough = self._enough / block.scale
            for axes in block.axes:
                of_axes = [sorted({place for side in sides[a] for place in side}) for a in axes]
                for places in itertools.product(*of_axes):
                    yield block.scale * limit_at_rest(block.lattice, self._scheme, places, enough)
