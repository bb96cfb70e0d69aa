"""Shapes of bodies, holes and conditions as regions."""

import math
from typing import Any

from mpmcli.importers.nairnmpm.commands import Command
from mpmcli.importers.nairnmpm.grammar import SHAPES
from mpmcli.importers.nairnmpm.job import Job
from mpmcli.importers.nairnmpm.values import Value, scaled
from mpmcli.scene.context import Context
from mpmcli.scene.units import Units

NAMES = tuple(SHAPES.split())
_AXES = {"x": 0, "X": 0, "1": 0, "y": 1, "Y": 1, "2": 1, "z": 2, "Z": 2, "3": 2}
Box = tuple[list[float], list[float]]


def region(job: Job, shape: Command) -> dict[str, Any] | None:
    """The region of a shape without the shapes in it, or None after an error or a note."""
    made = ring(job, shape) if shape.name == "Arc" else _whole(job, shape)
    holes = [region(job, inside) for inside in shape.all(*NAMES)]
    holes = [hole for hole in holes if hole is not None]
    if made is None or not holes:
        return made
    return {"kind": "difference", "region": made, "subtract": holes}


def limits(made: dict[str, Any], d: int) -> Box | None:
    """The box around a region, or None if it is not known: of files, and of what is no valid region."""
    if made["kind"] in {"bitmap", "points"}:
        return None
    try:
        lower, upper = Context(Units(), {}).region(scaled(made)).bounds(d)
    except ValueError:
        return None
    return lower.tolist(), upper.tolist()


def corners(job: Job, shape: Command) -> tuple[list[Value], list[Value]] | None:
    """Lowest and highest coordinates of a shape, or None after an error."""
    ends: list[tuple[Value, Value]] = []
    for axis, letter in enumerate(job.axes):
        names = (f"{letter}min", f"{letter}max")
        if names[0] not in shape.attributes:
            names = (f"{letter}1", f"{letter}2")
        low, high = (job.coordinate(shape, name, axis) for name in names)
        if low is None or high is None:
            if not set(names) <= set(shape.attributes):
                words = f"the attribute {letter}min or {letter}max is missing"
                job.error(shape, words)
            return None
        ends.append((low, high) if low.scaled <= high.scaled else (high, low))
    if len(job.axes) == 2:
        shape.get("zmin")
        shape.get("zmax")
    shape.get("tolerance")
    return [low for low, _ in ends], [high for _, high in ends]


def ring(job: Job, arc: Command) -> dict[str, Any] | None:
    """The points that lie at an arc within its tolerance, or None after an error or a note."""
    if job.analysis == "3d":
        job.error(arc, "belongs to analyses in 2D")
        return None
    found = corners(job, arc)
    if found is None:
        return None
    width = half_width(job, arc)
    half = [0.5 * (high.scaled - low.scaled) for low, high in zip(*found, strict=True)]
    center = [0.5 * (high.scaled + low.scaled) for low, high in zip(*found, strict=True)]
    if abs(half[0] - half[1]) > 1e-9 * max(half) or half[0] <= width:
        job.note("not_supported", arc, "arcs other than those of circles wider than their tolerance")
        return None
    made = {"kind": "disk", "center": center, "radius": half[0] + width, "inner_radius": half[0] - width}
    return _sector(job, arc, made, center)


def half_width(job: Job, shape: Command) -> float:
    """Half the width of a line: in cells with a star; a hundredth of a cell by default."""
    text = job.source.plain(shape.get("tolerance") or "").strip()
    if not text:
        return 0.01 * min(job.cell)
    try:
        cells = float(text[1:]) if text.startswith("*") else None
    except ValueError:
        return 0.01 * min(job.cell)
    width = job.number(shape, "tolerance") if cells is None else Value(cells * min(job.cell))
    return 0.01 * min(job.cell) if width is None else width.scaled


def _sector(job: Job, angles: Command, made: dict[str, Any], center: list[float]) -> dict[str, Any] | None:
    """The part of a region between two angles about its centre, counter-clockwise from x in degrees."""
    start, end = job.plain(angles, "start"), job.plain(angles, "end", 360.0)
    if end < start:
        job.error(angles, f"the end angle {end:g} is below the start angle {start:g}")
        return None
    if end - start >= 360:
        return made
    sides = []
    for angle, sign in ((start, 1), (end, -1)):
        turn = math.radians(angle)
        normal = [Value(round(sign * part, 15) + 0.0) for part in (math.sin(turn), -math.cos(turn))]
        sides.append({"kind": "half_space", "point": center, "normal": normal})
    wedge = [{"kind": "union", "regions": sides}] if end - start > 180 else sides
    return {"kind": "intersection", "regions": [made, *wedge]}


def _whole(job: Job, shape: Command) -> dict[str, Any] | None:
    if shape.name == "Polygon":
        return _polygon(job, shape)
    if shape.name not in {"Rect", "Box", "Oval", "Sphere", "Cylinder"}:
        job.unsupported(shape, "this shape has no counterpart")
        return None
    flat = shape.name in {"Rect", "Oval"}
    if flat == (job.analysis == "3d"):
        there = "2D" if flat else "3D"
        job.error(shape, f"belongs to analyses in {there}")
        return None
    found = corners(job, shape)
    if found is None:
        return None
    lower, upper = found
    axis = shape.get("axis")
    turned = shape.name in {"Box", "Cylinder"} and axis in _AXES
    shape.get("radius")
    half = [0.5 * (high.scaled - low.scaled) for low, high in zip(lower, upper, strict=True)]
    center = [0.5 * (high.scaled + low.scaled) for low, high in zip(lower, upper, strict=True)]
    if turned or shape.name == "Cylinder":
        return _cylinder(job, shape, _AXES.get(axis or "z", 2), lower, upper)
    made: dict[str, Any]
    if shape.name in {"Rect", "Box"}:
        made = {"kind": "box", "lower": lower, "upper": upper}
    elif max(half) - min(half) <= 1e-9 * max(half):
        made = {"kind": "disk" if flat else "sphere", "center": center, "radius": half[0]}
    else:
        made = {"kind": "ellipse" if flat else "ellipsoid", "center": center, "semi_axes": half}
    sector = shape.last("arc")
    return made if sector is None else _sector(job, sector, made, center)


def _polygon(job: Job, shape: Command) -> dict[str, Any] | None:
    if job.analysis == "3d":
        job.error(shape, "belongs to analyses in 2D")
        return None
    points = []
    for point in shape.all("pt"):
        pair = [job.coordinate(point, letter, axis) for axis, letter in enumerate("xy")]
        if None in pair:
            return None
        points.append(pair)
    if len(points) > 1:
        ends = zip(points[0], points[-1], strict=True)
        if all(abs(scaled(a) - scaled(b)) <= 1e-12 for a, b in ends):
            points.pop()
    if len(points) < 3:
        job.error(shape, f"three points are needed, not {len(points)}")
        return None
    return {"kind": "polygon", "points": points}


def _cylinder(
    job: Job, shape: Command, axis: int, lower: list[Value], upper: list[Value]
) -> dict[str, Any] | None:
    cone = job.plain(shape, "radius", 1.0)
    across = [a for a in range(3) if a != axis]
    half = [0.5 * (upper[a].scaled - lower[a].scaled) for a in across]
    if abs(half[0] - half[1]) > 1e-9 * max(half) or cone != 1.0:
        job.unsupported(shape, "a cone, or a cylinder that is not round")
        return None
    center: list[Any] = [0.5 * (low.scaled + high.scaled) for low, high in zip(lower, upper, strict=True)]
    start, end = list(center), list(center)
    start[axis], end[axis] = lower[axis], upper[axis]
    return {"kind": "cylinder", "from": start, "to": end, "radius": half[0]}
