"""The Courant number that ``courant: auto`` takes from step to step: the limit of what the bodies do just then.

by their faces
    If all deformable particles fill a box at the start, move in one velocity field and start slowly along axes with a
    free face, the faces of that box are followed: the step is that of a block that rests with its faces where they lie
    now. It is so as long as the particles of each face lie within ``2 REACH`` along its normal. Rigid bodies must hold
    a face along an axis without free faces: no face that is followed is one that they touch. Where a face passes on
    through its cells they are looked at more often, and the limit of the scene counts where it is higher: a place
    that is passed may be as bad as that.
else
    The limit of the scene (``scene_limit``), as for bodies that pass all places slowly. So it is at all times where a
    body starts fast, is no box, or touches another deformable one.

Limits are those of waves. Where particles are faster than waves, the Courant number, which is that of the faster of
both, is greater by the ratio of the speeds, 1 at most.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.analysis import F_COMPONENTS
from mpmcli.shapes import SHAPES
from mpmcli.stability.growth import NEAR, limit_at_rest, worst_limit
from mpmcli.stability.held import held_axes, rigid_bodies_hold_no_free_axis
from mpmcli.stability.scene_limit import (
    LARGEST_COURANT,
    SAFETY,
    blocks_of,
    chosen_courant,
    deformable,
    is_fast_at_first,
    one_thread,
    particles_over_waves,
    scheme_of,
)

Array = np.ndarray

REACH = 0.2
"""Half of the cells over which the particles of a face may be spread along its normal."""
MARGIN = 0.02
"""Cells to both sides of the places of a face that count too, besides what it moves until it is looked at again."""
EVERY = 20
"""Steps between looks at the particles."""
PASSES = 0.1
"""Cells that a face may move between looks, if it would leave ``REACH`` in ``EVERY`` steps."""
LEAST = 2
"""Faces that would move so far in fewer steps are not followed."""
PLACES_PER_CELL = 48
"""Places of faces are rounded to so many."""
ROUND_OFF = 1e-6


class Face(NamedTuple):
    """Between which places its particles end [cells of the grid], and the cells that it moves in a step."""

    low: float
    high: float
    speed: float


class GivenCourant:
    """The Courant number that a scene gives, None for a fixed step."""

    def __init__(self, courant: float | None):
        self.courant = courant

    def at(
        self, step: int, particles: Any, wave_speed: float = 0.0, particle_speed: float = 0.0
    ) -> float | None:
        """That of the step that begins, with the largest speeds [velocity] of waves and particles."""
        return self.courant


class ChosenCourant(GivenCourant):
    """The Courant number of ``courant: auto``.

    Parameters
    ----------
    scene : the checked scene
    particles : as they start

    Attributes
    ----------
    otherwise : where faces are not followed
    follows_faces : whether they are followed
    courant : the current one, of waves
    next_look : the step at which the particles are looked at again

    Raises
    ------
    SceneError
        If there is no known limit.
    """

    courant: float

    def __init__(self, scene: Any, particles: Any):
        chosen = chosen_courant(scene) or LARGEST_COURANT
        self.otherwise = min(chosen / particles_over_waves(scene), LARGEST_COURANT)
        super().__init__(self.otherwise)
        self.next_look = 0
        self._free = np.any([~held_axes(scene, body) for body, _ in deformable(scene)], axis=0)
        self._blocks, self._scheme = list(blocks_of(scene)), scheme_of(scene)
        self.follows_faces = (
            not is_fast_at_first(scene)
            and _is_one_box(scene, particles)
            and all(rigid_bodies_hold_no_free_axis(scene, body) for body, _ in deformable(scene))
        )
        if not self.follows_faces:
            return
        self._lower = np.asarray(scene.grid.lower, dtype=float)
        self._cell = np.asarray(scene.grid.cell, dtype=float)
        self._stretches = SHAPES[scene.method.shape].follows_deformation
        self._layers = np.zeros((2, len(self._cell), int(particles.id.max()) + 1), dtype=bool)
        low, high = particles.X - particles.size, particles.X + particles.size
        soft = _is_soft(scene, particles)
        near = ROUND_OFF * self._cell
        self._held: list[list[tuple[float, ...]]] = []
        for a, cell in enumerate(self._cell):
            ends = low[a, soft].min(), high[a, soft].max()
            self._layers[0, a, particles.id] = soft & (low[a] <= ends[0] + near[a])
            self._layers[1, a, particles.id] = soft & (high[a] >= ends[1] - near[a])
            within = [float(end - self._lower[a]) / cell for end in ends]
            self._held.append([_places(place - REACH, place + REACH) for place in within])
        self._look(0, particles, math.inf)
        self.next_look = 0

    def at(self, step: int, particles: Any, wave_speed: float = 0.0, particle_speed: float = 0.0) -> float:
        """That of the step that begins, by what the particles do; they are looked at every ``EVERY`` steps at least."""
        if step >= self.next_look and self.follows_faces:
            self._look(step, particles, wave_speed)
        faster = particle_speed / wave_speed if wave_speed > 0.0 else 1.0
        return min(self.courant * max(1.0, faster), LARGEST_COURANT)

    def memory(self) -> dict[str, float]:
        """What it remembers from step to step."""
        return {"courant": self.courant, "next_look": self.next_look}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self.courant = float(memory["courant"])
        self.next_look = int(memory.get("next_look", 0))

    def in_words(self) -> str:
        """What it goes by later, after a semicolon; empty if it is always the same."""
        if not self.follows_faces:
            return ""
        return f"; as the faces lie within their cells, {self.otherwise:.3g} when they are no longer flat"

    def _look(self, step: int, p: Any, wave_speed: float) -> None:
        """Choose the Courant number by where the faces are, and when to look again."""
        faces = self._faces(p, wave_speed)
        self.courant, self.next_look = self.otherwise, step + EVERY
        if faces is None:
            return
        steps, least = EVERY, 0.0
        if any(face.high - face.low + 2.0 * EVERY * face.speed > 2.0 * REACH for face in faces.values()):
            steps = min(int(PASSES / max(face.speed for face in faces.values())), EVERY)
            least = self.otherwise
        if steps < LEAST:
            return
        sides = self._sides(faces, steps)
        with one_thread():
            limit = min(self._limits(sides))
        self.courant = min(max(SAFETY * limit, least), LARGEST_COURANT)
        self.next_look = step + steps

    def _limits(self, sides: list[list[tuple[float, ...]]]) -> Iterator[float]:
        """Limits of all blocks with faces at these places of both sides along each axis."""
        for block in self._blocks:
            if block.lattice.is_endless:
                yield block.scale * worst_limit(block.lattice, self._scheme)
                continue
            for axes in block.axes:
                of_axes = [sorted({*sides[a][0], *sides[a][1]}) for a in axes]
                for places in itertools.product(*of_axes):
                    yield block.scale * limit_at_rest(block.lattice, self._scheme, places)

    def _faces(self, p: Any, wave_speed: float) -> dict[tuple[int, int], Face] | None:
        """The faces by axis and side; None if one is not flat."""
        found = {}
        for a, side in itertools.product(np.flatnonzero(self._free), (0, 1)):
            cell, face = self._cell[a], self._layers[side, a, p.id]
            if not face.any():
                return None  # it has left the grid
            half = p.size[a, face]
            if self._stretches:
                half = half * p.F[F_COMPONENTS[len(self._cell)].index("xyz"[a] * 2), face]
            at = (p.X[a, face] + (half if side else -half) - self._lower[a]) / cell
            speed = self.courant * self._cell.min() * float(np.abs(p.V[a, face]).max()) / cell / wave_speed
            low, high = float(at.min()), float(at.max())
            if not (high - low <= 2.0 * REACH and speed < math.inf):
                return None
            found[int(a), side] = Face(low, high, speed)
        return found

    def _sides(self, faces: Mapping[tuple[int, int], Face], steps: int) -> list[list[tuple[float, ...]]]:
        """Places within their cells of the lower and the upper face, along each axis, in so many steps."""
        found: list[list[tuple[float, ...]]] = []
        for a in range(len(self._cell)):
            if not self._free[a]:  # of a body that is held along all axes: where its faces lie at the start
                found.append(self._held[a])
                continue
            of_axis = []
            for face in (faces[a, 0], faces[a, 1]):
                margin = MARGIN + steps * face.speed
                of_axis.append(_places(face.low - margin, face.high + margin))
            found.append(of_axis)
        return found


def _places(low: float, high: float) -> tuple[float, ...]:
    """Where within a cell, 0 to ½ and mirrored, limits may be least between two places: ends, grid lines, middles."""
    inside = range(math.ceil(2.0 * low), math.floor(2.0 * high) + 1)
    found = set()
    for place in (low, high, *(0.5 * half for half in inside)):
        within = round(place * PLACES_PER_CELL) / PLACES_PER_CELL % 1.0
        found.add(max(min(within, 1.0 - within), NEAR))
    return tuple(sorted(found))


def _is_soft(scene: Any, p: Any) -> Array:
    """Which particles are of deformable materials."""
    rigid = np.array([model.kind == "rigid" for model in scene.materials.values()])
    found: Array = ~rigid[p.material]
    return found


def _is_one_box(scene: Any, p: Any) -> bool:
    """Whether the deformable particles move in one velocity field and fill a box."""
    soft = _is_soft(scene, p)
    fields = p.velocity_field[soft]
    if not soft.any() or (fields != fields[0]).any():
        return False
    X, size = p.X[:, soft], p.size[:, soft]
    low, high = (X - size).min(axis=1), (X + size).max(axis=1)
    volume = np.prod(high - low)
    return bool(abs(np.prod(2.0 * size, axis=0).sum() - volume) <= ROUND_OFF * volume)
