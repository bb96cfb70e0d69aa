"""The small blocks and endless rows that stand for the deformable bodies of a scene, and how they move.

``growth`` knows their limits, ``scene_limit`` which of them count.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.geometry.lattice import is_by_right_angles
from mpmcli.shapes import SHAPES
from mpmcli.stability.growth import FLIES, NEAR, Swing
from mpmcli.stability.held import held_axes, held_faces
from mpmcli.stability.lattice import DOMAINS, GRID_FUNCTIONS, Lattice
from mpmcli.stability.linear_step import Scheme
from mpmcli.stability.speeds import FAST, deformable, start_speeds, swinging_axes

Array = np.ndarray

LARGEST_COURANT = 1.0
"""``courant: auto`` is never above it, and a number above it must lie within the stability limit."""
SPACE = 0.95
"""Limits in space over those in the plane: 0.742/0.783 (FLIP) and 0.463/0.487 (FMPM(4)) for lcpdi and ν = 1/3, found
once with cubes of 2³ cells, whose eigenvalues take a minute."""
FASTEST = 10.0
"""Speed over wave speed above which flights count as the same."""
LONGEST_SWING = 1000.0
"""Longest period of a swing that is followed, in times in which a wave crosses a cell: bodies of some 250 cells."""
ELSEWHERE = 0.2
"""Offset along axes along which a body moves: a place where few shape functions lose their stability early."""


IN_COMPRESSION = 0.5
"""Share of the time in which artificial viscosity acts, as behind a shock, where bodies swing about their compression.
The quadratic part is left out: it is large in the front only, which passes a particle within some steps."""


class NoKnownLimit(ValueError):
    """A scene whose limit nobody knows; the message says why."""


@dataclass(frozen=True)
class Flight:
    """How fast a body flies along an axis, over the wave speed, and for how long: in times a wave takes for a cell."""

    speed: float
    duration: float


@dataclass(frozen=True)
class Block:
    """The block that stands for a body.

    Attributes
    ----------
    lattice : the block
    body : the body's name
    scale : Courant number of the scene over that of the block: wave speed of the fastest body over this one's, and
        ``SPACE`` for three axes
    axes : one axis of the scene, or pairs of them, that the axes of the block stand for
    faces : places of the lower and of the upper faces of the body within their cells, along ``axes``; none if endless
    rests_on_stairs : its surface has stairs in the grid, as round bodies have, and along some of ``axes`` it does not
        start to move
    swing : how its free end swings, if that is known
    flight : of an endless row that flies, or None
    """

    lattice: Lattice
    body: str
    scale: float
    axes: tuple[tuple[int, ...], ...]
    faces: tuple[tuple[float, ...], ...]
    rests_on_stairs: bool = False
    swing: Swing | None = None
    flight: Flight | None = None


def scheme_of(scene: Any) -> Scheme:
    """What a scene's steps do; a dynamic order counts as the largest one."""
    transfer = scene.method.transfer
    blend = getattr(transfer, "blend", None)
    viscosity = scene.method.artificial_viscosity
    return Scheme(
        transfer.kind,
        getattr(transfer, "order", 1),
        scene.method.update,
        None if blend is None else (blend.order, float(blend.fraction)),
        getattr(transfer, "every_courant", None),
        getattr(transfer, "every_steps", None),
        bool(getattr(transfer, "velocity_gradient", False)),
        0.0 if viscosity is None else IN_COMPRESSION * float(viscosity.linear),
    )


MOST_PARTICLES = 6
"""Per cell and axis: with more of them the matrices of a block take seconds and gigabytes."""


def blocks_of(scene: Any) -> Iterator[Block]:
    """The blocks that stand for the scene's deformable bodies.

    Materials that are not elastic at rest count as fluids of their wave speed, axisymmetric analyses as plane. A block
    has the axes along which its body is not held (the first one if it is held along all), in space the two of them with
    the smallest edges of a cell. There is an endless row for each axis along which it is held, for
    each along which parts of it start at ``FLIES`` of the wave speed or more, and for that along which it swings.

    Raises
    ------
    NoKnownLimit
        If the shape function is of a kind that the analysis does not know.
    """
    shape, kind = SHAPES[scene.method.shape], scene.analysis.kind
    if shape.grid_functions not in GRID_FUNCTIONS or shape.domain not in DOMAINS:
        raise NoKnownLimit(f"the shape function {scene.method.shape} is of no kind that was analysed")
    bodies = list(deformable(scene))
    fastest = max((model.initial_wave_speed(kind) for _, model in bodies), default=0.0)
    cell = np.asarray(scene.grid.cell, dtype=float)
    for body, model in bodies:
        free = np.flatnonzero(~held_axes(scene, body))
        free = free if len(free) else np.array([0])
        axes = np.sort(free[np.argsort(cell[free], kind="stable")[:2]])
        relative = tuple(float(h) for h in cell[axes] / cell.min())
        space = SPACE if len(free) == 3 else 1.0
        speed = model.initial_wave_speed(kind)
        if not 0.0 < speed < math.inf or not 0.0 < (modulus := model.density * speed * speed) < math.inf:
            raise NoKnownLimit(f"body '{body.name}' has the wave speed {speed:.3g}")
        shear = float(getattr(model, "shear_modulus", 0.0)) / modulus if len(relative) > 1 else 0.0
        parts = np.broadcast_to(np.asarray(body.particles_per_axis), cell.shape)
        if parts[free].max() > MOST_PARTICLES:
            raise NoKnownLimit(
                f"body '{body.name}' has more than {MOST_PARTICLES} particles per cell and axis"
            )
        pairs = tuple(tuple(map(int, pair)) for pair in itertools.combinations(free, len(relative)))
        places = _face_places(scene, body, parts)
        rests = start_speeds(scene, body) < FAST * speed
        sides = np.where(rests, places, ELSEWHERE)
        has_stairs = len(axes) > 1 and not _is_flat(body.region, len(cell))
        faces = tuple(sorted({tuple(float(side[a]) for a in pair) for side in sides for pair in pairs}))
        swing = swing_of(scene, body)
        for particles in sorted({int(n) for n in parts[free]}):
            lattice = Lattice(
                shape.grid_functions, shape.domain, particles, relative, 1.0 - 2.0 * shear, shear
            )
            scale = space * fastest / speed
            yield Block(lattice, body.name, scale, pairs, faces, has_stairs and rests[free].any(), swing)
        held = np.setdiff1d(np.arange(len(cell)), free)
        yield from _rows(
            scene, body, speed, held, swing if _rows_tell(scheme_of(scene)) else None, fastest / speed
        )


def _rows_tell(scheme: Scheme) -> bool:
    """Whether noise grows in a bar that swings slowly as it does in a row.

    With velocity gradients and periodic transfers it is taken up: FMPM(8) is stable to 0.93 in the bar, 0.36 in a row.
    """
    return not scheme.velocity_gradient and scheme.every_courant is None and scheme.every_steps is None


def _rows(
    scene: Any, body: Any, wave_speed: float, held: Array, swing: Swing | None, scale: float
) -> Iterator[Block]:
    """Endless rows along the axes that are held, and along those along which the body swings or flies."""
    shape, cell = SHAPES[scene.method.shape], np.asarray(scene.grid.cell, dtype=float)
    parts = np.broadcast_to(np.asarray(body.particles_per_axis), cell.shape)
    flights = start_speeds(scene, body) / wave_speed
    for a in range(len(cell)):
        edge = (float(cell[a] / cell.min()),)
        row = Lattice(shape.grid_functions, shape.domain, int(parts[a]), edge, is_endless=True)
        if a in held:
            yield Block(row, body.name, scale, ((a,),), ())
        if swing is not None and a not in held:
            yield Block(row, body.name, scale, ((a,),), (), swing=swing)
        if flights[a] >= FLIES:
            # two digits, so that bodies that fly nearly alike need one search
            speed = float(f"{min(flights[a], FASTEST):.2g}")
            flight = Flight(speed, _duration(scene, wave_speed))
            yield Block(row, body.name, scale, ((a,),), (), flight=flight)


def _is_flat(region: Any, d: int) -> bool:
    """Whether a region is a box along the axes, or is made with one."""
    parts = [*getattr(region, "regions", ()), *filter(None, [getattr(region, "region", None)])]
    if not is_by_right_angles(region.turn(d)):
        return False
    return region.kind == "box" or any(_is_flat(part, d) for part in parts)


def _face_places(scene: Any, body: Any, parts: Array) -> Array:
    """Places within a cell (0 to ½, mirrored) of a body's lower and upper faces, as its particles have them, (2, d).

    It is ``NEAR`` instead of 0, where the body has no end, and where none of its faces is plane.
    """
    lower, cell = np.asarray(scene.grid.lower), np.asarray(scene.grid.cell, dtype=float)
    sides = []
    is_flat = _is_flat(body.region, len(cell))
    for bound, ceiling in zip(body.region.bounds(len(cell)), (0.5, -0.5), strict=True):
        with np.errstate(invalid="ignore"):
            sub_cells = (np.asarray(bound) - lower) / cell * parts
            # sub-cells are filled whose middle is inside
            face = (
                np.ceil(sub_cells - ceiling - 1e-6) if ceiling > 0 else np.floor(sub_cells - ceiling + 1e-6)
            )
            if body.particles_along == "region":
                face = sub_cells
            place = np.where(np.isfinite(face) & is_flat, np.mod(face, parts) / parts, 0.0)
        sides.append(np.maximum(np.minimum(place, 1.0 - place), NEAR))
    return np.array(sides)


def swing_of(scene: Any, body: Any) -> Swing | None:
    """How the end of a body swings that is held at the other and has one axis with a free face; None of any other body.

    It does so with the speed with which it starts and at the frequency πc/(2L).
    """
    free = np.flatnonzero(~held_axes(scene, body))
    if len(free) != 1 or not swinging_axes(scene, body)[free[0]]:
        return None
    axis, cell = int(free[0]), np.asarray(scene.grid.cell, dtype=float)
    speed = float(start_speeds(scene, body)[axis])
    low, high = body.region.bounds(len(cell))
    length = float(high[axis]) - float(low[axis])
    wave = scene.materials[body.material].initial_wave_speed(scene.analysis.kind)
    period = 4.0 * length / float(cell.min())
    if not speed < wave or not 0.0 < period <= LONGEST_SWING:
        return None
    parts = np.broadcast_to(np.asarray(body.particles_per_axis), cell.shape)
    free_side = int(held_faces(scene, body)[0, axis])
    place = float(_face_places(scene, body, parts)[free_side, axis])
    return Swing(
        amplitude=2.0 * length * speed / (math.pi * wave * float(cell[axis])),
        period=period,
        duration=_duration(scene, wave),
        place=0.0 if place == NEAR else place,
    )


def _duration(scene: Any, wave_speed: float) -> float:
    """How long the run is at most, in times in which a wave crosses a cell."""
    duration = float(scene.time.end) * wave_speed / float(min(scene.grid.cell))
    given = scene.time.courant
    largest = max(LARGEST_COURANT, given) if isinstance(given, float) else LARGEST_COURANT
    return min(duration, (scene.time.max_steps or math.inf) * largest)
