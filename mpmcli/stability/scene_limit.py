"""The largest stable Courant number of a scene: what ``time.courant: auto``, warnings and ``explain`` go by.

Where a body starts at ``FAST`` of the wave speed or more, and with CPDI, bodies have the limit of a moving block, and
none above that of one that swings, where it is known how; else that of one that moves slowly (``growth``), or with
ugimp that at the worst place. In no case is the limit above that of a block that rests where the scene puts the faces
of the body within their cells, along the axes along which it does not start to move. Axes along which both faces are
held (``held``) are no axes of the block: along them the body is an endless row. So it is along axes along which it
swings or flies, in part or as a whole. ``choice`` follows what the bodies do then. These rules, and ``SAFETY``, were
chosen by limits measured with ``mpmcli stability``; docs/studies.md has them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from mpmcli.core.errors import Problem, SceneError
from mpmcli.geometry.lattice import is_by_right_angles
from mpmcli.shapes import SHAPES
from mpmcli.stability.growth import (
    FLIES,
    LOWEST,
    NEAR,
    Swing,
    flying_limit,
    limit_at_rest,
    moving_limit,
    slow_limit,
    swinging_limit,
    worst_limit,
)
from mpmcli.stability.held import held_axes, held_faces
from mpmcli.stability.lattice import DOMAINS, GRID_FUNCTIONS, Lattice
from mpmcli.stability.linear_step import Scheme
from mpmcli.stability.speeds import (
    FAST,
    deformable,
    is_fast_at_first,
    largest_speed,
    start_speeds,
    swinging_axes,
)

Array = np.ndarray

SAFETY = 0.99
"""``courant: auto`` is this share of the limit."""
LARGEST_COURANT = 1.0
"""``courant: auto`` is never above it: no particle may pass a whole cell in a step."""
PERIODIC = 0.95
"""Limits with a periodic transfer over those predicted: FMPM(8) with C_X = 2 in the bar, 0.63/0.67."""
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
class KnownLimit:
    """The largest stable Courant number of a scene.

    Attributes
    ----------
    courant : the limit
    body : the body that sets it
    because : in words, what kind of limit it is
    """

    courant: float
    body: str
    because: str


@dataclass(frozen=True)
class Prediction:
    """Largest stable Courant numbers of a moving block, and of one that rests at the worst place.

    The first is that of a swinging block where a body on one axis is held at one end, at rest there, and starts to move
    at the other.
    """

    moving: float
    worst: float


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


def chosen_courant(scene: Any) -> float | None:
    """The scene's Courant number, chosen where it says ``auto``; None where it gives a time step.

    Raises
    ------
    SceneError
        If it says ``auto`` and there is no known limit.
    """
    if scene.time.courant != "auto":
        return None if scene.time.courant is None else float(scene.time.courant)
    return min(particles_over_waves(scene) * courant_of_waves(scene), LARGEST_COURANT)


def courant_of_waves(scene: Any) -> float:
    """The Courant number of waves that ``courant: auto`` takes, whatever the speed of particles.

    Raises
    ------
    SceneError
        If there is no known limit.
    """
    try:
        limit = known_limit(scene)
        if limit.courant < LOWEST:
            raise NoKnownLimit(f"{limit.because}, is unstable at {LOWEST} already")
        return min(SAFETY * limit.courant / particles_over_waves(scene), LARGEST_COURANT)
    except NoKnownLimit as reason:
        words = f"no stability limit is known: {reason}; give a number (and find it with mpmcli stability)"
        raise SceneError([Problem(path="time.courant", message=words, code="no_known_limit")]) from None


def known_limit(scene: Any, enough: float = math.inf) -> KnownLimit:
    """The limit of a checked scene; if it is ``enough`` or more, some number that is so too, found much faster.

    Raises
    ------
    NoKnownLimit
        If the scene has something that the analysis knows nothing about.
    """
    scheme = scheme_of(scene)
    is_fast = SHAPES[scene.method.shape].follows_deformation and is_fast_at_first(scene)
    faster = particles_over_waves(scene)
    with one_thread():
        found = [_limit_of(block, scheme, is_fast, enough / faster) for block in blocks_of(scene)]
    if not found:
        raise NoKnownLimit("all bodies are rigid")
    least = min(found, key=lambda limit: limit.courant)
    return replace(least, courant=faster * least.courant)


def particles_over_waves(scene: Any) -> float:
    """Largest speed at the start over that of waves, 1 at least: Courant numbers are those of the faster of both."""
    kind = scene.analysis.kind
    wave = max((model.initial_wave_speed(kind) for _, model in deformable(scene)), default=0.0)
    share = largest_speed(scene) / wave if wave > 0.0 else 1.0
    return share if 1.0 < share < math.inf else 1.0


def one_thread() -> Any:
    """A context in which matrix products stay on one thread: they are small, and threads that wait burn time."""
    return threadpool_limits(1, user_api="blas")


def predict(scene: Any) -> Prediction | None:
    """The limits of moving and of resting blocks for the scene, or None where this analysis says nothing."""
    try:
        scheme, blocks = scheme_of(scene), list(blocks_of(scene))
    except NoKnownLimit:
        return None
    if not blocks:
        return None
    with one_thread():
        return Prediction(
            min(_moving(block, scheme) for block in blocks),
            min(block.scale * worst_limit(block.lattice, scheme) for block in blocks),
        )


def _moving(block: Block, scheme: Scheme) -> float:
    if block.flight is not None:
        return limit_of_row(block, scheme)
    if block.swing is not None:
        return block.scale * swinging_limit(block.lattice, scheme, block.swing)
    return block.scale * moving_limit(block.lattice, scheme)


def warning_of(scene: Any) -> Problem | None:
    """A warning if the scene's Courant number, or its time step, is above the known limit."""
    span = scene.time
    if span.courant == "auto":
        return None
    asked = courant_of_step(scene, span.step) if span.courant is None else float(span.courant)
    try:
        limit = known_limit(scene, enough=asked)
    except NoKnownLimit:
        return None
    if asked <= limit.courant * (1.0 + 1e-9):
        return None
    path, what = ("time.step", f"is the Courant number {asked:.3g}") if span.courant is None else (
        "time.courant", f"{asked:.4g} is"
    )  # fmt: skip
    joint = ", which is above" if span.courant is None else " above"
    words = f"{what}{joint} the stability limit {limit.courant:.3g} ({limit.because}): the run may fail"
    return Problem(path=path, message=words, code="unstable", severity="warning")


def courant_of_step(scene: Any, step: float) -> float:
    """Courant number at the start of a fixed time step."""
    kind = scene.analysis.kind
    speed = max((model.initial_wave_speed(kind) for _, model in deformable(scene)), default=0.0)
    return step * max(speed, largest_speed(scene)) / min(scene.grid.cell)


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


def _limit_of(block: Block, scheme: Scheme, is_fast: bool, enough: float) -> KnownLimit:
    if block.lattice.is_endless:
        because = "between held faces"
        if block.swing is not None:
            because = "swinging"
        elif block.flight is not None:
            because = f"flying at {block.flight.speed:.2g} of the wave speed"
        row = limit_of_row(block, scheme, enough)
        return KnownLimit(row, block.body, f"body '{block.body}', {because}")
    enough /= block.scale
    if is_fast:
        share = PERIODIC if scheme.every_courant or scheme.every_steps else 1.0
        limit, because = (
            share * moving_limit(block.lattice, scheme, enough / share),
            f"body '{block.body}', moving",
        )
        if block.rests_on_stairs and (slow := slow_limit(block.lattice, scheme, enough)) < limit:
            limit, because = slow, f"body '{block.body}', whose stairs rest in the grid"
        if block.swing is not None:
            swinging = swinging_limit(block.lattice, scheme, block.swing, enough)
            if swinging < limit:
                limit, because = swinging, f"body '{block.body}', whose end swings"
    elif block.lattice.domain == "box" and block.lattice.grid_functions == "linear":
        limit = worst_limit(block.lattice, scheme, enough)
        because = f"body '{block.body}', at the worst place in a cell"
    else:
        limit, because = slow_limit(block.lattice, scheme, enough), f"body '{block.body}', moving slowly"
    for faces in (places for places in block.faces if set(places) != {ELSEWHERE}):
        at_rest = limit_at_rest(block.lattice, scheme, faces, enough)
        if at_rest < limit:
            where = "on grid lines" if set(faces) <= {NEAR, ELSEWHERE} else "amid cells"
            limit, because = at_rest, f"body '{block.body}', whose faces lie {where}"
    return KnownLimit(block.scale * limit, block.body, because)


def limit_of_row(block: Block, scheme: Scheme, enough: float = math.inf) -> float:
    """Limit of an endless row that swings, flies, or passes all places of its cells slowly."""
    row, enough = block.lattice, enough / block.scale
    if block.swing is not None:
        return block.scale * swinging_limit(row, scheme, block.swing, enough)
    if block.flight is not None:
        flying = flying_limit(row, scheme, block.flight.speed, block.flight.duration, enough)
        return block.scale * flying
    return block.scale * worst_limit(row, scheme, enough)


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
    return min(duration, (scene.time.max_steps or math.inf) * LARGEST_COURANT)
