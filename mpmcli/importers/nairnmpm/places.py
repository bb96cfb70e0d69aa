"""Where conditions and loads act: lines, arcs, boxes and shapes as places of a scene."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.shapes import NAMES, corners, half_width, region, ring
from mpmcli.importers.nairnmpm.values import Value

SIDES = {(0, False): "left", (0, True): "right", (1, False): "bottom", (1, True): "top", (2, False): "back"}
SIDES[2, True] = "front"


@dataclass
class Where:
    """A place: its box or region, and a plane for whole sides of the grid."""

    name: str
    lower: list[float]
    upper: list[float]
    region: dict[str, Any] | None = None

    def particles(self) -> dict[str, Any]:
        """The place for particles."""
        if self.region is not None:
            return {"region": self.region}
        return _box(self.lower, self.upper)

    def nodes(self, job: Job) -> dict[str, Any] | None:
        """The place for nodes of the grid: a plane where they are a whole side, else a box; None if it has no nodes."""
        if self.region is not None:
            return {"region": self.region}
        tolerance, axes = job.tolerance, range(len(job.axes))
        spans = [
            self.lower[a] <= job.lower[a] + tolerance and self.upper[a] >= job.upper[a] - tolerance
            for a in axes
        ]
        for axis in axes:
            if not all(spans[a] for a in axes if a != axis):
                continue
            first, last = self._lines(job, axis)
            count = round((job.upper[axis] - job.lower[axis]) / job.cell[axis])
            if last < first or first > count or last < 0:
                continue
            upper = last >= count
            if (first > 0) == upper:  # one of the two sides is in it, the other is not
                line = first if upper else last
                self.name = SIDES[axis, upper]
                at: Value = job.scene["grid"]["upper" if upper else "lower"][axis]
                if line != (count if upper else 0):
                    at = Value(job.lower[axis] + line * job.cell[axis])
                return {"plane": {"axis": job.axes[axis], "at": at} | _side(line, count, upper)}
        for a in axes:
            first, last = self._lines(job, a)
            outside = self.lower[a] > job.upper[a] + tolerance or self.upper[a] < job.lower[a] - tolerance
            if last < first or outside:
                return None
            if first == last:  # one line of nodes: its own coordinate instead of a tolerance around it
                self.lower[a] = self.upper[a] = job.lower[a] + first * job.cell[a]
        return _box(self.lower, self.upper)

    def _lines(self, job: Job, axis: int) -> tuple[int, int]:
        """First and last line of nodes of the grid in the place, across an axis."""
        first = math.ceil((self.lower[axis] - job.lower[axis] - job.tolerance) / job.cell[axis])
        return first, math.floor((self.upper[axis] - job.lower[axis] + job.tolerance) / job.cell[axis])


def _box(lower: list[float], upper: list[float]) -> dict[str, Any]:
    return {"box": {"lower": [Value(v) for v in lower], "upper": [Value(v) for v in upper]}}


def _side(line: int, count: int, upper: bool) -> dict[str, Any]:
    """The side of a plane, where it does not follow from the plane's place."""
    if (2 * line > count) == upper and 2 * line != count:
        return {}
    return {"side": "upper" if upper else "lower"}


def where(job: Job, shape: Command, number: int) -> Where | None:
    """The place of a BCLine, BCArc, BCBox, LdRect or BCShape, or None after an error or a note."""
    if shape.name == "BCLine":
        return _line(job, shape, f"line_{number}")
    if shape.name in {"BCBox", "LdRect"}:
        found = corners(job, shape)
        if (shape.get("axis") or "0") != "0":
            job.note("not_supported", shape, "a cylinder of nodes; use BCShape")
            return None
        if found is None:
            return None
        return Where(f"box_{number}", [v.scaled for v in found[0]], [v.scaled for v in found[1]])
    if shape.name == "BCShape":
        shapes = list(shape.all(*NAMES))
        if shapes and shapes[0].name == "Line":
            return _line(job, shapes[0], f"line_{number}")
        made = [region(job, inside) for inside in shapes]
        if not made:
            job.error(shape, "a shape is missing")
        if not made or made[0] is None:
            return None
        if made[0]["kind"] == "box":
            ends = [[v.scaled for v in made[0][end]] for end in ("lower", "upper")]
            return Where(f"box_{number}", ends[0], ends[1])
        return Where(f"shape_{number}", [], [], made[0])
    arc = ring(job, shape)
    return None if arc is None else Where(f"arc_{number}", [], [], arc)


def _ends(job: Job, shape: Command, names: Iterable[str]) -> list[list[float]] | None:
    """Both ends of a line or of the box around an arc, or None if one is missing."""
    ends = [
        [job.coordinate(shape, f"{letter}{name}", axis) for axis, letter in enumerate("xy")] for name in names
    ]
    known = [[value.scaled for value in pair if value is not None] for pair in ends]
    return known if all(len(pair) == 2 for pair in known) else None


def _line(job: Job, shape: Command, name: str) -> Where | None:
    if job.analysis == "3d":
        job.made.error(shape.line, "<BCLine>", "belongs to analyses in 2D")
        return None
    ends = _ends(job, shape, ("min", "max") if "xmin" in shape.attributes else "12")
    if ends is None:
        return None
    width = half_width(job, shape)
    (x1, y1), (x2, y2) = ends
    length = math.hypot(x2 - x1, y2 - y1)
    if length == 0:
        job.error(shape, "the line has no length")
        return None
    if abs(x2 - x1) <= 1e-9 * length:
        return Where(name, [x1 - width, min(y1, y2)], [x1 + width, max(y1, y2)])
    if abs(y2 - y1) <= 1e-9 * length:
        return Where(name, [min(x1, x2), y1 - width], [max(x1, x2), y1 + width])
    nx, ny = -(y2 - y1) / length * width, (x2 - x1) / length * width
    points = [[x1 + nx, y1 + ny], [x2 + nx, y2 + ny], [x2 - nx, y2 - ny], [x1 - nx, y1 - ny]]
    return Where(name, [], [], {"kind": "polygon", "points": points})
