"""A crack as a chain of points: the plane between its faces, and the faces."""

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

Array = np.ndarray

ABOVE, BELOW = 0, 1
"""Places of the faces."""
START, END = 0, -1
"""Places of the ends in a chain."""
FOLDED = -math.sqrt(0.75)
"""Cosine of the turn between two segments, 150 degrees, from which on a plane is folded."""
VISIBLE = 0.25
"""Length of the shorter segment at a fold [cells] below which the grid does not resolve the fold."""
STRETCHED, SHRUNK = 1.5, 0.25
"""Lengths of segments over their first ones from which on a point is put in, or one is taken out."""


class Chain:
    """The points of one crack, from its start to its end; *above* lies on the left on this way.

    Attributes
    ----------
    name, index : of the crack
    tips : whether its start and its end are tips, else they are mouths
    joined : whether they are neither, since they have met another crack
    X : (2, P) points of the plane between the faces [length]
    faces : (2, 2, P) points of the face above and of that below [length]
    velocity : (2, 2, P) their velocities [velocity]
    length0 : (P − 1,) lengths of the segments when they came into being; parts and unions of segments keep the longest
        [length]
    usual : mean length of the segments at the start of the run [length]
    dry : how many segments at the start and at the end lie outside of the matter at the start of the run, (2,)
    numbers : what else the points carry, by name, (…, P); 0 of new points
    """

    def __init__(self, name: str, index: int, X: Array, tips: tuple[bool, bool]):
        self.name, self.index, self.tips = name, index, tips
        self.joined = (False, False)
        self.X = np.array(X, dtype=np.float64)
        self.faces = np.stack([self.X, self.X])
        self.velocity = np.zeros_like(self.faces)
        self.length0 = segment_lengths(self.X)
        self.usual = float(self.length0.mean())
        self.dry = np.zeros(2)
        self.numbers: dict[str, Array] = {}

    @property
    def count(self) -> int:
        """Number of points."""
        return self.X.shape[1]

    @property
    def length(self) -> float:
        """Length along the plane [length]."""
        return float(segment_lengths(self.X).sum())

    @property
    def openings(self) -> tuple[Array, Array]:
        """Opening of the faces along the normal of the plane, and along its tangent, (P,) each [length]."""
        jump, tangent = self.faces[0] - self.faces[1], self.tangents()
        return tangent[0] * jump[1] - tangent[1] * jump[0], (tangent * jump).sum(axis=0)

    def tangents(self) -> Array:
        """Return unit tangents (2, P), from each point's neighbours."""
        way = np.empty_like(self.X)
        way[:, 1:-1] = self.X[:, 2:] - self.X[:, :-2]
        way[:, 0] = self.X[:, 1] - self.X[:, 0]
        way[:, -1] = self.X[:, -1] - self.X[:, -2]
        return way / np.linalg.norm(way, axis=0)

    def normals(self) -> Array:
        """Return unit normals (2, P), which point to the face above."""
        x, y = self.tangents()
        return np.stack([-y, x])

    def direction(self, end: int) -> Array:
        """Return the unit vector (2,) in which the last segment at ``START`` or ``END`` points out of the chain."""
        inner = 1 if end == START else -2
        way = self.X[:, end] - self.X[:, inner]
        return np.asarray(way / math.hypot(*way))

    def extend(self, end: int, points: Array) -> None:
        """Add points (2, n) beyond ``START`` or ``END``, which go away from it; they are closed and move as the tip."""
        n, last = points.shape[1], self.X[:, end]
        lengths = segment_lengths(np.column_stack([last, points]))
        velocity = np.repeat(self.velocity[:, :, [end]], n, axis=2)
        faces = np.stack([points, points])
        if end == START:
            points, faces, lengths = points[:, ::-1], faces[:, :, ::-1], lengths[::-1]
        self.X = _joined(end, self.X, points)
        self.faces = _joined(end, self.faces, faces)
        self.velocity = _joined(end, self.velocity, velocity)
        self.length0 = _joined(end, self.length0, lengths)
        for name, old in self.numbers.items():
            self.numbers[name] = _joined(end, old, np.zeros((*old.shape[:-1], n), dtype=old.dtype))

    def limits(self) -> Array:
        """Return the longest and the shortest that segments may be, (2, P) by their first points.

        Segments much shorter than usual, as growth leaves them where it joins a crack, may shrink.
        """
        least = SHRUNK * self.usual
        longest = np.append(STRETCHED * np.maximum(self.length0, least), np.inf)
        return np.stack(
            [longest, np.append(np.where(self.length0 >= least, SHRUNK * self.length0, 0.0), 0.0)]
        )

    def put_points(self, places: Array) -> None:
        """Replace the points by those at ``places`` (n,), ascending indices of points or between two of them.

        What points carry is interpolated linearly; whole numbers are those of the point before.
        """
        before = np.floor(places).astype(np.int64)
        share, after = places - before, np.minimum(before + 1, self.count - 1)

        def at_places(values: Array) -> Array:
            if values.dtype.kind != "f":
                return values[..., before].copy()
            mixed = (1.0 - share) * values[..., before] + share * values[..., after]
            return np.where(share > 0.0, mixed, values[..., before])

        ends = zip(before[:-1], np.ceil(places[1:]).astype(np.int64), strict=True)
        self.length0 = np.array([self.length0[first:last].max() for first, last in ends])
        last = self.count - 1.0
        start, end = np.interp([self.dry[0], last - self.dry[1]], places, np.arange(len(places)))
        self.dry = np.array([start, len(places) - 1.0 - end])
        self.X, self.faces, self.velocity = map(at_places, (self.X, self.faces, self.velocity))
        self.numbers = {name: at_places(values) for name, values in self.numbers.items()}

    def close_tip(self, end: int, joined: bool) -> None:
        """Let a tip be one no more: a mouth, or the place where the crack has ``joined`` another one."""
        at = range(2)[end]
        self.X = self.X.copy()  # so that those who hold the points of all chains gather them anew
        self.tips = tuple(tip and k != at for k, tip in enumerate(self.tips))  # type: ignore[assignment]
        self.joined = tuple(was or (joined and k == at) for k, was in enumerate(self.joined))  # type: ignore[assignment]

    def memory(self) -> dict[str, Any]:
        """What a checkpoint keeps of it."""
        kept = ("X", "faces", "velocity", "length0", "dry")
        own = {f"numbers.{name}": values for name, values in self.numbers.items()}
        return (
            {name: getattr(self, name) for name in kept} | {"tips": np.array([self.tips, self.joined])} | own
        )

    def recall(self, memory: Mapping[str, Array]) -> None:
        """Take it back."""
        for name in ("X", "faces", "velocity", "length0", "dry"):
            setattr(self, name, memory[name])
        for name in self.numbers:
            self.numbers[name] = memory[f"numbers.{name}"]
        (start, end), (joined, ended) = memory["tips"].tolist()
        self.tips, self.joined = (start, end), (joined, ended)


def _joined(end: int, old: Array, new: Array) -> Array:
    """Arrays one after the other along their last axis, in the order of the chain."""
    return np.concatenate([new, old] if end == START else [old, new], axis=-1)


def segment_lengths(X: Array) -> Array:
    """Lengths (P − 1,) between consecutive points (2, P)."""
    return np.hypot(*np.diff(X, axis=1))


def turns(X: Array, least: float) -> Array:
    """Cosines (P − 2,) of the turns between consecutive segments of points (2, P); 1 beside those below ``least``."""
    way = np.diff(X, axis=1)
    length = np.hypot(*way)
    product = length[1:] * length[:-1]
    seen = (product > 0.0) & (np.minimum(length[1:], length[:-1]) >= least)
    return np.where(seen, (way[:, 1:] * way[:, :-1]).sum(axis=0) / np.where(seen, product, 1.0), 1.0)


def respaced(chain: Chain) -> Array:
    """Return the places of the points of a chain (see ``put_points``) after segments are divided or joined.

    Of a segment that is too short the inner point that has the shorter segment beyond it goes, but no end of the chain.
    """
    length, (longest, shortest) = segment_lengths(chain.X), chain.limits()
    gone: set[int] = set()
    for k in np.flatnonzero(length < shortest[:-1]).tolist():
        beyond = [
            (float(length[k - 1 if point == k else k + 1]), point)
            for point in (k, k + 1)
            if 0 < point < chain.count - 1 and not gone & {point - 1, point, point + 1}
        ]
        if beyond:
            gone.add(min(beyond)[1])
    kept = [float(k) for k in range(chain.count) if k not in gone]
    return np.sort([*kept, *(np.flatnonzero(length > longest[:-1]) + 0.5)])


def divide(corners: Array, longest: float) -> Array:
    """Points (2, P) along the polyline with corners (n, 2), none farther from the next than ``longest``.

    The same from either end, to the last digit.
    """
    points = [corners[0]]
    for a, b in itertools.pairwise(corners):
        count = max(1, math.ceil(float(np.hypot(*(b - a))) / longest * (1.0 - 1e-9)))
        steps = np.arange(1, count)[:, None]
        points += [*(((count - steps) * a + steps * b) / count), b]
    return np.array(points).T


def with_point(corners: Array, length: float) -> Array:
    """Polyline (n, 2) with a further corner at a length along it, if it is that long and has none there."""
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    if not 0.0 < length < way[-1] or np.abs(way - length).min() <= 1e-9 * way[-1]:
        return corners
    place = [np.interp(length, way, corners[:, a]) for a in range(2)]
    return np.insert(corners, int(np.searchsorted(way, length)), place, axis=0)


def make_chain(model: Any, index: int, cell: float) -> Chain:
    """Return the chain of a scene's crack on a grid whose smallest cell side is ``cell``."""
    corners = model.path.corners()
    for part in model.traction:
        for length in part.along or ():
            corners = with_point(corners, length)
    points = divide(corners, model.spacing * cell)
    return Chain(model.name, index, points, (model.ends.start == "tip", model.ends.end == "tip"))
