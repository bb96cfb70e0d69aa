"""Temperatures that conditions and loads of a scene ask for at one place, held against each other."""

from __future__ import annotations

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
    _check_faces(scene, report)
    _check_planes(scene, report)


def _check_faces(scene: HeatOfScene, report: Report) -> None:
    """Faces that two conditions hold at different temperatures, and loads on faces that are held."""
    held: dict[tuple[str, str, str], list[tuple[str, Any]]] = {}
    for index, model in scene.parts.boundary:
        place = model.held_face() if model.acts_on == "temperature" else None
        if place is None:
            continue
        path, key = scene.report.label("boundary", index), _key(place)
        others = held.setdefault(key, [])
        for first_path, first in others:
            if not _agree(scene, place, first, model):
                line = report.line(first_path)
                words = f"the face is held at another temperature by '{first.name}' in line {line}"
                report(f"{path}.value", words, "contradiction")
                break
        others.append((path, model))
    for path, model in scene.acting():
        place = None if hasattr(model, "held_face") else model.loaded_face()
        found = [] if place is None else held.get(_key(place), [])
        for _, holder in [each for each in found if model.acts_within(each[1])][:1]:
            words = f"has no effect on the body, because '{holder.name}' holds the temperature of this face"
            report(f"{path}.on", words, "no_effect", "warning")


@dataclass(frozen=True)
class _Side:
    """Where a condition holds temperatures: a plane, or a plane face of a body.

    Attributes
    ----------
    path, model : of the condition
    axis, side, at : number of the axis that it is normal to, where bodies are not, and its coordinate
    box : corners (d,) of the face's body, or of the grid
    is_face : whether it is a face
    """

    path: str
    model: Any
    axis: int
    side: str
    at: float
    box: tuple[np.ndarray, np.ndarray]
    is_face: bool


def _sides(scene: HeatOfScene) -> Iterator[_Side]:
    grid, boxes = scene.parts.grid, {body.name: body for _, body in scene.parts.bodies}
    for index, model in scene.parts.boundary:
        if model.acts_on != "temperature" or grid is None:
            continue
        path, place = scene.report.label("boundary", index), model.held_face()
        plane = getattr(getattr(model, "on", None), "plane", None)
        if place is not None:
            body = boxes.get(place[0])
            box = None if body is None or body.region.kind != "box" else scene.box_of(body)
            if box is not None and place[1].index < grid.dimensions:
                at = box[place[1].side == "upper"][place[1].index]
                yield _Side(path, model, place[1].index, place[1].side, float(at), box, True)
        elif plane is not None and plane.index < grid.dimensions:
            try:
                side = plane.side_on(grid)
            except ValueError:
                continue  # reported already
            box = np.array(grid.lower, dtype=float), np.array(grid.upper, dtype=float)
            yield _Side(path, model, plane.index, side, float(plane.at), box, False)


def _check_planes(scene: HeatOfScene, report: Report) -> None:
    """Planes that are held at another temperature than a plane or a face at the same place."""
    sides = list(_sides(scene))
    for k, second in enumerate(sides):
        for first in sides[:k]:
            if first.is_face and second.is_face:
                continue
            margin = ON_LINE * float(scene.parts.grid.cell[first.axis])
            is_same = (first.axis, first.side) == (second.axis, second.side)
            if not is_same or abs(first.at - second.at) > margin:
                continue
            face = first if first.is_face else second
            if not _alike(face.box, face.axis, face.at, first.model, second.model):
                line = report.line(first.path)
                words = f"this place is held at another temperature by '{first.model.name}' in line {line}"
                report(f"{second.path}.value", words, "contradiction")
                break


def _key(place: tuple[str, Any]) -> tuple[str, str, str]:
    body, face = place
    return body, face.axis, face.side


def _agree(scene: HeatOfScene, place: tuple[str, Any], first: Any, second: Any) -> bool:
    """Whether two conditions hold a face at the same temperature when first both act, at points spread over it."""
    body = next((body for _, body in scene.parts.bodies if body.name == place[0]), None)
    box = None if body is None else scene.box_of(body)
    if box is None or place[1].index >= len(box[0]):
        return True
    axis = place[1].index
    return _alike(box, axis, box[place[1].side == "upper"][axis], first, second)


def _alike(box: tuple[np.ndarray, np.ndarray], axis: int, at: float, first: Any, second: Any) -> bool:
    """Whether two conditions ask for the same when first both act, at points of a box (corners (d,)) on a plane."""
    time = first.first_with(second)
    if time is None:
        return True
    low, high = box
    points = low[:, None] + (high - low)[:, None] * np.array([[0.1, 0.35, 0.6, 0.85]])
    points[axis] = at
    with np.errstate(all="ignore"):
        one, other = (
            np.broadcast_to(model.face_temperature_at(points, time), points.shape[1:])
            for model in (first, second)
        )
    return not bool((np.abs(one - other) > ALIKE * np.abs(one)).any())
