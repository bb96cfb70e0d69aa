"""A crack as a chain of points: the plane between its faces, and the faces."""

from __future__ import annotations

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
    length0 : (P − 1,) lengths of the segments when they came into being [length]
    numbers : what else the points carry, by name, (…, P); 0 of new points
    """

    def __init__(self, name: str, index: int, X: Array, tips: tuple[bool, bool]):
        self.name, self.index, self.tips = name, index, tips
        self.joined = (False, False)
        self.X = np.array(X, dtype=np.float64)
        self.faces = np.stack([self.X, self.X])
        self.velocity = np.zeros_like(self.faces)
        self.length0 = segment_lengths(self.X)
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

    def close_tip(self, end: int, joined: bool) -> None:
        """Let a tip be one no more: a mouth, or the place where the crack has ``joined`` another one."""
        at = range(2)[end]
        self.X = self.X.copy()  # so that those who hold the points of all chains gather them anew
        self.tips = tuple(tip and k != at for k, tip in enumerate(self.tips))  # type: ignore[assignment]
        self.joined = tuple(was or (joined and k == at) for k, was in enumerate(self.joined))  # type: ignore[assignment]

    def memory(self) -> dict[str, Any]:
        """What a checkpoint keeps of it."""
        kept = ("X", "faces", "velocity", "length0")
        own = {f"numbers.{name}": values for name, values in self.numbers.items()}
        return (
            {name: getattr(self, name) for name in kept} | {"tips": np.array([self.tips, self.joined])} | own
        )

    def recall(self, memory: Mapping[str, Array]) -> None:
        """Take it back."""
        for name in ("X", "faces", "velocity", "length0"):
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


def carries_tractions(model: Any) -> bool:
    """Whether points of a crack of the scene may carry tractions."""
    return bool(model.traction) or (model.growth is not None and model.growth.leaves_tractions)


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
