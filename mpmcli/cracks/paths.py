"""Where a crack runs at the start: the kinds of ``path``, each a model that gives the corners of a polyline."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from mpmcli.core.angles import Angle
from mpmcli.core.model import Model, PositiveLength
from mpmcli.core.registry import Registry
from mpmcli.geometry.polygon import first_crossing
from mpmcli.geometry.vectors import Count, Point2

Array = np.ndarray

PATHS = Registry("path", "mpmcli.cracks", {"arc": "paths", "file": "path_files", "points": "paths"})
MAX_POINTS = 5000
"""Most points of a path."""


class Path(Model):
    """Base of all paths."""

    noun: ClassVar[str] = "path"

    @abstractmethod
    def corners(self) -> Array:
        """Return the corners (n, 2) of the polyline [length]."""

    def where(self, point: int) -> tuple[str, str]:
        """Return the key below ``path`` where a scene gives a point, and words that say which one it is."""
        return "", ""

    def files(self) -> list[str]:
        """Return the names of the files that the path needs."""
        return []


def fault_of(corners: Array) -> tuple[int, str] | None:
    """Return the place of the first point of a polyline (n, 2) that no crack can have, and why, or None."""
    step = np.diff(corners, axis=0)
    equal = np.flatnonzero(~step.any(axis=1))
    if len(equal):
        point = int(equal[0]) + 1
        return point, f"the point {_words(corners[point])} repeats the one before"
    back = (step[1:] * step[:-1]).sum(axis=1) < 0.0
    back &= step[1:, 0] * step[:-1, 1] == step[1:, 1] * step[:-1, 0]
    if back.any():
        point = int(np.flatnonzero(back)[0]) + 1
        return point, f"the path turns back onto itself at {_words(corners[point])}"
    crossing = first_crossing(corners[:-1], corners[1:], is_closed=False)
    if crossing is not None:
        first, second = (f"{_words(corners[k])} to {_words(corners[k + 1])}" for k in crossing)
        return (
            crossing[1],
            f"the path crosses or touches itself: the piece from {second} meets that from {first}",
        )
    return None


def _words(point: Array) -> str:
    return f"[{point[0]:g}, {point[1]:g}]"


@PATHS.register
class PointsPath(Path):
    """Straight from point to point."""

    kind: Literal["points"]
    points: Annotated[tuple[Point2, ...], Count(2, MAX_POINTS, "points")]
    """Points [x, y] in order."""

    @field_validator("points")
    @classmethod
    def _simple(cls, points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        fault = fault_of(np.array(points))
        if fault is not None:
            raise ValueError(f"point {fault[0] + 1}: {fault[1]}")
        return points

    def corners(self) -> Array:
        """Return the points."""
        return np.array(self.points)

    def where(self, point: int) -> tuple[str, str]:
        """Return the key of a point."""
        return f"points.{point}", ""


@PATHS.register
class ArcPath(Path):
    """Part of a circle."""

    kind: Literal["arc"]
    center: Point2
    """Centre [x, y]."""
    radius: PositiveLength
    """Radius."""
    start_angle: Angle = Field(alias="from")
    """Angle from the x axis at which it starts, anticlockwise."""
    end_angle: Angle = Field(alias="to")
    """Angle at which it ends."""

    @model_validator(mode="after")
    def _open(self) -> ArcPath:
        span = abs(self.end_angle - self.start_angle)
        if not 0.0 < span < 360.0:
            words = "has no length" if span == 0.0 else f"spans {span:g} degrees and closes"
            raise ValueError(f"the arc from {self.start_angle:g} to {self.end_angle:g} degrees {words}")
        return self

    def corners(self) -> Array:
        """Return points a degree apart at most."""
        count = max(2, 1 + math.ceil(abs(self.end_angle - self.start_angle)))
        angle = np.radians(np.linspace(self.start_angle, self.end_angle, count))
        return np.array(self.center) + self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
