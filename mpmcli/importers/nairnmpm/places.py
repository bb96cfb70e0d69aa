"""Where conditions and loads act: lines, arcs, boxes and shapes as places of a scene."""

from __future__ import annotations

import math
from typing import Any

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.shapes import NAMES, corners, region
from mpmcli.importers.nairnmpm.values import Value

SIDES = {(0, False): "left", (0, True): "right", (1, False): "bottom", (1, True): "top", (2, False): "back"}
SIDES[2, True] = "front"


class Where:
    """A place: its box or region, and a plane for whole sides of the grid."""

    def __init__(self, name: str, lower: list[float], upper: list[float], made: dict[str, Any] | None = None):
        self.name = name
        self.lower = lower
        self.upper = upper
        self.region = made

    def particles(self) -> dict[str, Any]:
        """The place for particles."""
        if self.region is not None:
            return {"region": self.region}
        return _box(self.lower, self.upper)

    def nodes(self, job: Job) -> dict[str, Any] | None:
        """The place for nodes of the grid: a plane where they are a whole side, else a box; None if it has no nodes."""
        if self.region is not None:
            return {"region": self.region}
        tolerance = job.tolerance
        for axis in range(len(job.axes)):
            others = [a for a in range(len(job.axes)) if a != axis]
            if any(
                self.lower[a] > job.lower[a] + tolerance or self.upper[a] < job.upper[a] - tolerance
                for a in others
            ):
                continue
            cell = job.cell[axis]
            first = math.ceil((self.lower[axis] - job.lower[axis] - tolerance) / cell)
            last = math.floor((self.upper[axis] - job.lower[axis] + tolerance) / cell)
            count = round((job.upper[axis] - job.lower[axis]) / cell)
            if last < first or first > count or last < 0:
                continue
            if last >= count and first > 0:
                self.name = SIDES[axis, True]
                at = (
                    job.scene["grid"]["upper"][axis]
                    if first == count
                    else Value(job.lower[axis] + first * cell)
                )
                return {"plane": {"axis": job.axes[axis], "at": at} | _side(first, count, True)}
            if first <= 0 and last < count:
                self.name = SIDES[axis, False]
                at = job.scene["grid"]["lower"][axis] if last == 0 else Value(job.lower[axis] + last * cell)
                return {"plane": {"axis": job.axes[axis], "at": at} | _side(last, count, False)}
        for a in range(len(job.axes)):
            first = math.ceil((self.lower[a] - job.lower[a] - tolerance) / job.cell[a])
            last = math.floor((self.upper[a] - job.lower[a] + tolerance) / job.cell[a])
            if (
                last < first
                or self.lower[a] > job.upper[a] + tolerance
                or self.upper[a] < job.lower[a] - tolerance
            ):
                return None
            if first == last:  # one line of nodes: its own coordinate instead of a tolerance around it
                self.lower[a] = self.upper[a] = job.lower[a] + first * job.cell[a]
        return _box(self.lower, self.upper)


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
        if (shape.get("axis") or "0") not in {"0"}:
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
            job.made.error(shape.line, "<BCShape>", "a shape is missing")
        if not made or made[0] is None:
            return None
        if made[0]["kind"] == "box":
            ends = [[v.scaled for v in made[0][end]] for end in ("lower", "upper")]
            return Where(f"box_{number}", ends[0], ends[1])
        return Where(f"shape_{number}", [], [], made[0])
    return _arc(job, shape, f"arc_{number}")


def _tolerance(job: Job, shape: Command) -> float:
    """Half the width of a line: in cells with a star; a hundredth of a cell by default."""
    text = job.source.plain(shape.get("tolerance") or "").strip()
    if not text:
        return 0.01 * min(job.cell)
    try:
        return float(text[1:]) * min(job.cell) if text.startswith("*") else job.plain(shape, "tolerance")
    except ValueError:
        return 0.01 * min(job.cell)


def _line(job: Job, shape: Command, name: str) -> Where | None:
    if job.analysis == "3d":
        job.made.error(shape.line, "<BCLine>", "belongs to analyses in 2D")
        return None
    ends = []
    for end in ("min", "max") if "xmin" in shape.attributes else "12":
        pair = [job.coordinate(shape, f"{letter}{end}", axis) for axis, letter in enumerate("xy")]
        if None in pair:
            return None
        ends.append([v.scaled for v in pair if v is not None])
    shape.get("z1")
    shape.get("z2")
    width = _tolerance(job, shape)
    (x1, y1), (x2, y2) = ends
    length = math.hypot(x2 - x1, y2 - y1)
    if length == 0:
        job.made.error(shape.line, f"<{shape.name}>", "the line has no length")
        return None
    if abs(x2 - x1) <= 1e-9 * length:
        return Where(name, [x1 - width, min(y1, y2)], [x1 + width, max(y1, y2)])
    if abs(y2 - y1) <= 1e-9 * length:
        return Where(name, [min(x1, x2), y1 - width], [max(x1, x2), y1 + width])
    nx, ny = -(y2 - y1) / length * width, (x2 - x1) / length * width
    points = [[x1 + nx, y1 + ny], [x2 + nx, y2 + ny], [x2 - nx, y2 - ny], [x1 - nx, y1 - ny]]
    return Where(name, [], [], {"kind": "polygon", "points": points})


def _arc(job: Job, shape: Command, name: str) -> Where | None:
    """A ring as wide as the tolerance on both sides; arcs that are no full circle are not translated."""
    ends: list[list[float]] = []
    for end in "12":
        pair = [job.coordinate(shape, f"{letter}{end}", axis) for axis, letter in enumerate("xy")]
        if None in pair:
            job.made.error(shape.line, f"<{shape.name}>", "x1, x2, y1 and y2 are needed")
            return None
        ends.append([v.scaled for v in pair if v is not None])
    width = _tolerance(job, shape)
    turn = job.plain(shape, "end", 360.0) - job.plain(shape, "start", 0.0)
    half = [abs(b - a) / 2 for a, b in zip(*ends, strict=True)]
    if turn < 360 or abs(half[0] - half[1]) > 1e-9 * max(half) or half[0] <= width:
        job.note("not_supported", shape, "arcs other than full circles")
        return None
    center = [(a + b) / 2 for a, b in zip(*ends, strict=True)]
    made = {"kind": "disk", "center": center, "radius": half[0] + width, "inner_radius": half[0] - width}
    return Where(name, [], [], made)
