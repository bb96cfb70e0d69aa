"""Temperatures that conditions and loads of a scene ask for at one place, held against each other."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.scene.heat_of_scene import HeatOfScene
from mpmcli.scene.problems import Report

ON_LINE = 1e-6
"""Cells between two planes at the same place."""
ALIKE = 1e-9
"""Relative difference between two temperatures of a face that is no round-off."""


def check_places(scene: HeatOfScene, report: Report) -> None:
    """Report places that are held at two temperatures, and loads on faces that are held."""
    sides = list(_sides(scene))
    for k, second in enumerate(sides):
        for first in sides[:k]:
            face = second if first.face is None else first
            if _is_same(scene, first, second) and not _alike(face, first.model, second.model):
                noun = "this place" if first.face is None or second.face is None else "the face"
                line = report.line(first.path)
                words = f"{noun} is held at another temperature by '{first.model.name}' in line {line}"
                report(f"{second.path}.value", words, "contradiction")
                break
    for path, model in scene.acting():
        place = None if hasattr(model, "held_face") else model.loaded_face()
        loaded = None if place is None else (place[0], place[1].axis, place[1].side)
        for side in sides:
            if loaded is not None and side.face == loaded and model.acts_within(side.model):
                words = f"has no effect on the body, because '{side.model.name}' holds the temperature of this face"
                report(f"{path}.on", words, "no_effect", "warning")
                break


@dataclass(frozen=True)
class _Side:
    """Where a condition holds temperatures: a plane, or a face of a body.

    Attributes
    ----------
    path, model : of the condition
    face : body, axis and side of a face, None for a plane
    axis, side, at : number of the axis that it is normal to, where bodies are not, and its coordinate
    box : corners (d,) of the face's body, or of the grid; None where they are not known
    is_flat : whether all of it lies at this coordinate
    """

    path: str
    model: Any
    face: tuple[str, str, str] | None
    axis: int
    side: str
    at: float = 0.0
    box: tuple[np.ndarray, np.ndarray] | None = None
    is_flat: bool = False


def _sides(scene: HeatOfScene) -> Iterator[_Side]:
    grid, bodies = scene.parts.grid, {body.name: body for _, body in scene.parts.bodies}
    for path, model in scene.parts.boundary:
        if model.acts_on != "temperature":
            continue
        place = model.held_face()
        plane = getattr(getattr(model, "on", None), "plane", None)
        if place is not None:
            name, face = place
            body = bodies.get(name)
            box = None if body is None else scene.box_of(body)
            key, axis = (name, face.axis, face.side), face.index
            if body is None or box is None or axis >= len(box[0]):
                yield _Side(path, model, key, axis, face.side)
            else:
                at = float(box[face.side == "upper"][axis])
                yield _Side(path, model, key, axis, face.side, at, box, body.region.kind == "box")
        elif plane is not None and grid is not None and plane.index < grid.dimensions:
            try:
                side = plane.side_on(grid)
            except ValueError:
                continue  # reported already
            box = np.array(grid.lower, dtype=float), np.array(grid.upper, dtype=float)
            yield _Side(path, model, None, plane.index, side, float(plane.at), box, True)


def _is_same(scene: HeatOfScene, first: _Side, second: _Side) -> bool:
    """Whether two conditions hold the same face, or lie at the same coordinate."""
    if first.face is not None and second.face is not None:
        return first.face == second.face
    if not (first.is_flat and second.is_flat) or (first.axis, first.side) != (second.axis, second.side):
        return False
    return abs(first.at - second.at) <= ON_LINE * float(scene.parts.grid.cell[first.axis])


def _alike(face: _Side, first: Any, second: Any) -> bool:
    """Whether two conditions ask for the same when first both act, at points spread over a face; so it is without."""
    time = first.first_with(second)
    if time is None or face.box is None:
        return True
    low, high = face.box
    points = low[:, None] + (high - low)[:, None] * np.array([[0.1, 0.35, 0.6, 0.85]])
    points[face.axis] = face.at
    with np.errstate(all="ignore"):
        one, other = (
            np.broadcast_to(model.face_temperature_at(points, time), points.shape[1:])
            for model in (first, second)
        )
    return not bool((np.abs(one - other) > ALIKE * np.abs(one)).any())
