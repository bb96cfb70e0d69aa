"""Where cracks lie among the particles at the start: tips in matter, mouths outside, matter on both sides."""

import itertools
from collections.abc import Container, Sequence
from typing import Any

import numpy as np

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.suggest import listing
from mpmcli.geometry.bodies import BodyParticles, Domains
from mpmcli.geometry.vectors import in_words
from mpmcli.scene.crack_checks import ENDS

Array = np.ndarray

ROUND_OFF = 1e-6
"""Distances below so many cells are none."""
DEEPEST = 0.5
"""How deep in a body a mouth may lie, in cells: surfaces are as rough as particles are large."""


def check_places(scene: Any, filled: Sequence[BodyParticles]) -> None:
    """Refuse cracks whose ends are not where they should be, and those that cut nothing.

    Raises SceneError with the distances.
    """
    errors = [problem for crack in scene.cracks for problem in _faults_of(crack, scene, filled)]
    if errors:
        raise SceneError(errors)


def matter_of(scene: Any, filled: Sequence[BodyParticles], cuts: Container[str] | None = None) -> Domains:
    """Return the domains of the particles of deformable bodies, of those with these names or of all."""
    rigid = {body.name for body in scene.bodies if scene.materials[body.material].kind == "rigid"}
    return Domains.of([b for b in filled if b.name not in rigid and (cuts is None or b.name in cuts)])


def _faults_of(crack: Any, scene: Any, filled: Sequence[BodyParticles]) -> list[Problem]:
    matter, cell = matter_of(scene, filled, crack.cuts), min(scene.grid.cell)
    corners = crack.path.corners()
    bodies = f"'{matter.names[0]}'" if len(matter.names) == 1 else listing(matter.names, 4)
    if not is_cut(matter, corners, cell):
        lower, upper = (matter.X - matter.half).min(axis=1), (matter.X + matter.half).max(axis=1)
        words = (
            f"cuts nothing: the path from {in_words(corners[0])} to {in_words(corners[-1])} does not run through "
            f"{bodies}, within {in_words(lower)} to {in_words(upper)}; correct the path, or leave the crack out"
        )
        return [Problem(f"cracks.{crack.name}.path", words, code="cuts_nothing")]
    found = []
    for key, point, inner in zip(ENDS, (corners[0], corners[-1]), (corners[1], corners[-2]), strict=True):
        path = f"cracks.{crack.name}.ends.{key}"
        if getattr(crack.ends, key) == "tip":
            distances = matter.distances(point)
            distance, name = distances.min(), matter.names[matter.body[distances.argmin()]]
            if distance > ROUND_OFF * cell:
                words = (
                    f"the tip at {in_words(point)} lies outside every body that the crack cuts, {distance:.3g} "
                    f"({distance / cell:.2g} cells) from '{name}'; move it into the body, or use 'mouth'"
                )
                found.append(Problem(path, words, code="tip_outside"))
        else:
            depth, name = depth_along(matter, point, point - inner, ROUND_OFF * cell)
            if depth > DEEPEST * cell:
                words = (
                    f"the mouth at {in_words(point)} lies inside '{name}', whose surface is {depth:.3g} "
                    f"({depth / cell:.2g} cells) further along the crack; extend the path, or use 'tip'"
                )
                found.append(Problem(path, words, code="mouth_inside"))
    return found


def depth_along(matter: Domains, point: Array, way: Array, margin: float) -> tuple[float, str]:
    """Return how far a ray from ``point`` (2,) along ``way`` stays in matter, and the body that it leaves there."""
    way = way / np.hypot(*way)
    first, last = _through(matter, point, way, margin)
    met = np.flatnonzero((last >= 0.0) & (last > first))
    met = met[np.argsort(first[met], kind="stable")]
    depth, name = 0.0, ""
    for particle in met:
        if first[particle] > depth:
            break
        if last[particle] > depth:
            depth, name = float(last[particle]), matter.names[matter.body[particle]]
    return depth, name


def is_cut(matter: Domains, corners: Array, cell: float) -> bool:
    """Whether a polyline (n, 2) runs through the domain of a particle, or has particles on both sides."""
    order = np.argsort(matter.X[0], kind="stable")
    sorted_x, widest = matter.X[0, order], float(matter.half[0].max())
    sides = set()
    for a, b in itertools.pairwise(corners):
        window = np.searchsorted(sorted_x, [min(a[0], b[0]) - 1.01 * widest, max(a[0], b[0]) + 1.01 * widest])
        here = matter.where(order[slice(*window)])
        length = float(np.hypot(*(b - a)))
        way = (b - a) / length
        first, last = _through(here, a, way, -ROUND_OFF * cell)
        if ((last > first) & (first < length) & (last > 0.0)).any():
            return True
        first, last = _through(here, a, way, ROUND_OFF * cell)
        met = (last > first) & (first < length) & (last > 0.0)
        side = way[0] * (here.X[1, met] - a[1]) - way[1] * (here.X[0, met] - a[0])
        sides |= set(np.sign(side).tolist())
    return {-1.0, 1.0} <= sides


def _through(matter: Domains, point: Array, way: Array, margin: float) -> tuple[Array, Array]:
    """Where a line from ``point`` along the unit vector ``way`` enters and leaves domains wider by ``margin``.

    Distances (n,) from the point; it misses the domains that it leaves before it enters.
    """
    first, last = np.full(matter.X.shape[1], -np.inf), np.full(matter.X.shape[1], np.inf)
    for axis in range(2):
        half = matter.half[axis] + margin
        gap = matter.X[axis] - point[axis]
        if abs(way[axis]) < 1e-12:
            last = np.where(np.abs(gap) <= half, last, -np.inf)
            continue
        ends = np.sort(np.stack([gap - half, gap + half]) / way[axis], axis=0)
        first, last = np.maximum(first, ends[0]), np.minimum(last, ends[1])
    return first, last
