"""Where a crack runs at the start: the kinds of ``path``, each a model that gives the corners of a polyline."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from mpmcli.core.model import Model, PositiveLength
from mpmcli.core.registry import Registry
from mpmcli.geometry.rotation import Angle
from mpmcli.geometry.vectors import Count, Point2

Array = np.ndarray

PATHS = Registry("path", "mpmcli.cracks", {"arc": "paths", "points": "paths"})


class Path(Model):
    """Base of all paths."""

    noun: ClassVar[str] = "path"

    def corners(self) -> Array:
        """Return the corners (n, 2) of the polyline [length]."""
        raise NotImplementedError


@PATHS.register
class PointsPath(Path):
    """Straight from point to point."""

    kind: Literal["points"]
    points: Annotated[tuple[Point2, ...], Count(2, 5000, "points")]
    """Points [x, y] in order."""

    def corners(self) -> Array:
        """Return the points."""
        return np.array(self.points)


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

    def corners(self) -> Array:
        """Return points a degree apart at most."""
        count = max(2, 1 + math.ceil(abs(self.end_angle - self.start_angle)))
        angle = np.radians(np.linspace(self.start_angle, self.end_angle, count))
        return np.array(self.center) + self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
