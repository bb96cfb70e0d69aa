"""The Courant number that ``courant: auto`` takes from step to step: the limit of what the bodies do just then.

by their faces
    If all deformable particles fill a box at the start, move in one velocity field and start slowly along axes with a
    free face, the faces of that box are followed: the step is that of a block that rests with its faces where they lie
    now. It is so as long as the particles of each face lie within ``2 REACH`` along its normal, and stretches are
    within ``STRETCHES``. Rigid bodies must hold a face along an axis without free faces: no face that is followed is
    one that they touch. Where a face passes on through its cells they are looked at more often, and the limit of the
    scene counts where it is higher: a place that is passed may be as bad as that.
by faces that come to rest
    Where a body starts fast the limit of the scene is that of a moving block. A face of a box that has come to rest, as
    where two of them strike each other, has the lower one of a block that rests there.
else
    The limit of the scene (``scene_limit``), as for bodies that pass all places slowly. So it is at all times where a
    slow body is no box, or touches another deformable one.

Limits are those of waves. Where particles are faster than waves, the Courant number, which is that of the faster of
both, is greater by the ratio of the speeds, 1 at most.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np

from mpmcli.shapes import SHAPES
from mpmcli.stability.blocks import ELSEWHERE, LARGEST_COURANT, blocks_of, scheme_of, swing_of
from mpmcli.stability.faces import (
    REACH,
    Boxes,
    Face,
    Faces,
    LimitsOfPlaces,
    Places,
    is_box,
    places_between,
    stretch_row,
)
from mpmcli.stability.held import held_axes, held_faces, rigid_bodies_hold_no_free_axis
from mpmcli.stability.scene_limit import SAFETY, courant_of_waves
from mpmcli.stability.speeds import deformable, is_fast_at_first

Array = np.ndarray

MARGIN = 0.02
"""Cells to both sides of the places of a face that count too, besides what it moves until it is looked at again."""
EVERY = 20
"""Steps between looks at faces that are followed."""
SOONER = 10
"""Steps between looks at faces that may come to rest."""
RESTS = 0.02
"""Speed over wave speed below which a face rests: it moves so slowly through its cells that noise grows there."""
PASSES = 0.1
"""Cells that a face may move between looks, if it would leave ``REACH`` in ``EVERY`` steps."""
LEAST = 2
"""Faces that would move so far in fewer steps are not followed."""
STRETCHES = (0.6, 1.25)
"""Particles per cell count as at the start, and faces are not followed where they are many more or fewer."""


class GivenCourant:
    """The Courant number that a scene gives, None for a fixed step."""

    def __init__(self, courant: float | None):
        self.courant = courant

    def at(
        self, step: int, particles: Any, wave_speed: float = 0.0, particle_speed: float = 0.0
    ) -> float | None:
        """That of the step that begins, with the largest speeds [velocity] of waves and particles."""
        return self.courant


class Looks(Protocol):
    """Looks at the faces of bodies from time to time."""

    in_words: str
    """What it goes by, after a semicolon."""

    def look(self, p: Any, wave_speed: float, courant: float) -> tuple[float, int]:
        """Courant number of the next steps, after those with ``courant``, and how many steps until the next look."""


class ChosenCourant(GivenCourant):
    """The Courant number of ``courant: auto``.

    Parameters
    ----------
    scene : the checked scene
    particles : as they start

    Attributes
    ----------
    otherwise : where nothing is known of faces
    faces : what looks at them, or None
    courant : the current one, of waves
    next_look : the step at which the particles are looked at again

    Raises
    ------
    SceneError
        If there is no known limit.
    """

    courant: float

    def __init__(self, scene: Any, particles: Any):
        self.otherwise = courant_of_waves(scene)
        super().__init__(self.otherwise)
        self.next_look = 0
        self.faces = looks_at(scene, particles, self.otherwise)
        if self.faces is not None:
            kind = scene.analysis.kind
            wave_speed = max(model.initial_wave_speed(kind) for _, model in deformable(scene))
            self.courant, _ = self.faces.look(particles, wave_speed, self.otherwise)

    def at(self, step: int, particles: Any, wave_speed: float = 0.0, particle_speed: float = 0.0) -> float:
        """That of the step that begins, by what the particles do."""
        if self.faces is not None and step >= self.next_look:
            self.courant, steps = self.faces.look(particles, wave_speed, self.courant)
            self.next_look = step + steps
        faster = particle_speed / wave_speed if wave_speed > 0.0 else 1.0
        return min(self.courant * max(1.0, faster), LARGEST_COURANT)

    def memory(self) -> dict[str, float]:
        """What it remembers from step to step."""
        return {"courant": self.courant, "next_look": self.next_look}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        if self.faces is not None:  # else the end of the run decides, which may have changed
            self.courant = float(memory["courant"])
        self.next_look = int(memory.get("next_look", 0))

    def in_words(self) -> str:
        """What it goes by later, after a semicolon; empty if it is always the same."""
        return "" if self.faces is None else self.faces.in_words


def looks_at(scene: Any, particles: Any, otherwise: float) -> Looks | None:
    """What looks at the faces of a scene's bodies; None where they are not known."""
    if is_fast_at_first(scene):
        return _resting(scene, particles, otherwise)
    soft = _is_soft(scene, particles)
    fields = particles.velocity_field[soft]
    if (
        not soft.any()
        or (fields != fields[0]).any()
        or not is_box(particles, soft)
        or not all(rigid_bodies_hold_no_free_axis(scene, body) for body, _ in deformable(scene))
    ):
        return None
    return FollowedFaces(scene, particles, soft, otherwise)


class FollowedFaces:
    """Faces of a box that moves slowly."""

    def __init__(self, scene: Any, particles: Any, soft: Array, otherwise: float):
        self.otherwise = otherwise
        self.in_words = f"; as the faces lie within their cells, {otherwise:.3g} when they are no longer flat"
        self._soft = np.zeros(int(particles.id.max()) + 1, dtype=bool)
        self._soft[particles.id] = soft
        self._limits = LimitsOfPlaces(list(blocks_of(scene)), scheme_of(scene))
        held = np.all([held_axes(scene, body) for body, _ in deformable(scene)], axis=0)
        self._free = np.flatnonzero(~held).tolist()
        self._boxes = Boxes(scene, particles, [soft], [[(a, side) for a in self._free for side in (0, 1)]])

    def look(self, p: Any, wave_speed: float, courant: float) -> tuple[float, int]:
        """By where the faces are now."""
        (faces,) = self._boxes.faces(p)
        if len(faces) < 2 * len(self._free) or not self._is_little_strained(p):
            return self.otherwise, EVERY
        moves = {
            (a, side): self._boxes.cells_moved(a, face, wave_speed, courant)
            for (a, side), face in faces.items()
        }
        steps, least = EVERY, 0.0
        if any(face.high - face.low + 2.0 * EVERY * moves[of] > 2.0 * REACH for of, face in faces.items()):
            steps = min(int(PASSES / max(moves.values())), EVERY)
            least = self.otherwise
        if steps < LEAST:
            return self.otherwise, EVERY
        # of a body that is held along all axes: where its faces lie at the start
        sides = {
            a: self._boxes.start_places(0, a) for a in range(len(self._boxes.cell)) if a not in self._free
        }
        sides |= {a: [_places(faces[a, side], steps * moves[a, side]) for side in (0, 1)] for a in self._free}
        return min(max(SAFETY * self._limits.least(sides), least), LARGEST_COURANT), steps

    def _is_little_strained(self, p: Any) -> bool:
        soft, d = self._soft[p.id], len(self._boxes.cell)
        rows = [p.F[stretch_row(d, a), soft] for a in range(d)]
        return bool(soft.any()) and all(
            STRETCHES[0] <= row.min() and row.max() <= STRETCHES[1] for row in rows
        )


def _resting(scene: Any, particles: Any, otherwise: float) -> RestingFaces | None:
    if not SHAPES[scene.method.shape].follows_deformation:
        return None  # such bodies have the limit of the worst place at all times
    numbers = {body.name: number for number, body in enumerate(scene.bodies)}
    sides = {
        body.name: free_sides(scene, body)
        for body, _ in deformable(scene)
        if is_box(particles, particles.body == numbers[body.name])
    }
    sides = {name: free for name, free in sides.items() if free}
    return RestingFaces(scene, particles, sides, otherwise) if sides else None


def free_sides(scene: Any, body: Any) -> list[tuple[int, int]]:
    """Axis and side (0 or 1) of the faces of a body that may come to rest: nothing holds them.

    None of a body whose swing is known: its end is slow where it turns, and the limit of the scene knows of that.
    """
    if swing_of(scene, body) is not None:
        return []
    return [(int(a), int(side)) for a, side in np.argwhere(~held_faces(scene, body).T)]


class RestingFaces:
    """Faces of boxes, axis and side by the names of their bodies, that move and may come to rest."""

    def __init__(
        self, scene: Any, particles: Any, sides: Mapping[str, list[tuple[int, int]]], otherwise: float
    ):
        self.otherwise = otherwise
        self.in_words = "; less where a face comes to rest"
        scheme, blocks = scheme_of(scene), list(blocks_of(scene))
        members, self._free, self._limits = [], [], []
        alike: dict[Any, LimitsOfPlaces] = {}
        for number, body in enumerate(scene.bodies):
            if body.name in sides:
                members.append(particles.body == number)
                self._free.append(np.flatnonzero(~held_axes(scene, body)).tolist())
                own = [block for block in blocks if block.body == body.name and not block.lattice.is_endless]
                limits = LimitsOfPlaces(own, scheme, otherwise / SAFETY)
                kind = tuple((block.lattice, block.scale, block.axes) for block in own)
                self._limits.append(alike.setdefault(kind, limits))
        self._boxes = Boxes(scene, particles, members, list(sides.values()))

    def look(self, p: Any, wave_speed: float, courant: float) -> tuple[float, int]:
        """By which faces are at rest now, and where."""
        least, found = self.otherwise, self._boxes.faces(p, RESTS * wave_speed)
        for resting, free, limits in zip(found, self._free, self._limits, strict=True):
            if resting:
                sides = {a: self._places(resting, a, wave_speed, courant) for a in free}
                least = min(least, SAFETY * limits.least(sides))
        return least, SOONER

    def _places(self, resting: Faces, a: int, wave_speed: float, courant: float) -> list[Places]:
        """Of the faces that rest along an axis, until they are looked at again."""
        found = [
            _places(face, SOONER * self._boxes.cells_moved(a, face, wave_speed, courant))
            for (axis, _), face in resting.items()
            if axis == a
        ]
        return found or [(ELSEWHERE,)]


def _places(face: Face, moves: float) -> Places:
    """Places of a face that moves by so many cells until it is looked at again."""
    return places_between(face.low - MARGIN - moves, face.high + MARGIN + moves)


def _is_soft(scene: Any, p: Any) -> Array:
    """Which particles are of deformable materials."""
    rigid = np.array([model.kind == "rigid" for model in scene.materials.values()])
    found: Array = ~rigid[p.material]
    return found
