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

import math
from dataclasses import dataclass, replace
from typing import Any

from threadpoolctl import threadpool_limits

from mpmcli.core.errors import Problem, SceneError
from mpmcli.shapes import SHAPES
from mpmcli.stability.blocks import (
    ELSEWHERE,
    LARGEST_COURANT,
    Block,
    NoKnownLimit,
    blocks_of,
    scheme_of,
)
from mpmcli.stability.growth import (
    LOWEST,
    NEAR,
    flying_limit,
    limit_at_rest,
    moving_limit,
    slow_limit,
    swinging_limit,
    worst_limit,
)
from mpmcli.stability.linear_step import Scheme
from mpmcli.stability.speeds import deformable, is_fast_at_first, largest_speed

SAFETY = 0.99
"""``courant: auto`` is this share of the limit."""
PERIODIC = 0.95
"""Limits with a periodic transfer over those predicted: FMPM(8) with C_X = 2 in the bar, 0.63/0.67."""


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
    """A warning if the scene's Courant number, or its time step, is above the known limit.

    A Courant number above ``LARGEST_COURANT`` is an error unless the limit is known and as large.
    """
    span = scene.time
    if span.courant == "auto":
        return None
    asked = courant_of_step(scene, span.step) if span.courant is None else float(span.courant)
    is_large = span.courant is not None and asked > LARGEST_COURANT
    try:
        limit = known_limit(scene, enough=asked)
    except NoKnownLimit as reason:
        return _too_large(asked, f"no stability limit is known: {reason}") if is_large else None
    faster = particles_over_waves(scene)
    if asked <= limit.courant * (1.0 + 1e-9):
        words = f"particles, {faster:.3g} times as fast as waves, would cross more than a cell in a step"
        return _too_large(asked, words) if is_large and faster > 1.0 else None
    above = f"above the stability limit {limit.courant:.3g} ({limit.because})"
    if is_large:
        return _too_large(asked, f"the scene is stable only to {limit.courant:.3g} ({limit.because})")
    if span.courant is None:
        path, words = "time.step", f"is the Courant number {asked:.3g}, which is {above}"
    else:
        path, words = "time.courant", f"{asked:.4g} is {above}"
    return Problem(path=path, message=f"{words}: the run may fail", code="unstable", severity="warning")


def _too_large(asked: float, because: str) -> Problem:
    words = f"{asked:.4g} is not possible: above {LARGEST_COURANT:g} a Courant number must be known to be stable, and "
    return Problem(path="time.courant", message=words + because, code="unstable")


def refuse_large_courant(scene: Any) -> None:
    """Raise SceneError for a Courant number above ``LARGEST_COURANT`` that is not known to be stable."""
    given = scene.time.courant
    if isinstance(given, float) and given > LARGEST_COURANT and (problem := warning_of(scene)) is not None:
        raise SceneError([problem])


def courant_of_step(scene: Any, step: float) -> float:
    """Courant number at the start of a fixed time step."""
    kind = scene.analysis.kind
    speed = max((model.initial_wave_speed(kind) for _, model in deformable(scene)), default=0.0)
    return step * max(speed, largest_speed(scene)) / min(scene.grid.cell)


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
