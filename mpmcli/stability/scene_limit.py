"""The stable Courant number of a scene: ``courant: auto``, and what ``validate``, ``explain`` and ``stability`` tell.

It is ``SAFETY`` times the least limit that is known: of a block at rest at its worst position within a cell, of a block
that moves slowly, of endless rows for axes along which both faces are held or the body is fast (``models``), all with
the viscosity of a fluid, and 1, at which no material point crosses more than one cell per step. Courant numbers are
those of the faster of waves and particles, so that waves have a smaller one where particles are faster.
"""

import math
from dataclasses import replace
from typing import Any, NamedTuple

from threadpoolctl import threadpool_limits

from mpmcli.core.bisection import bisect_limit
from mpmcli.core.errors import Problem, SceneError
from mpmcli.scene.method import MAX_COURANT
from mpmcli.stability.bodies import largest_speed, largest_wave_speed
from mpmcli.stability.growth import is_stable
from mpmcli.stability.linear_step import Scheme
from mpmcli.stability.models import Model, NoKnownLimit, models_of, scheme_of
from mpmcli.stability.springs import springs_of, tractions_of

SAFETY = 0.95
"""The stable Courant number of a scene over the least known limit."""
RESOLUTION = 0.0025
"""Limits are whole multiples of it, so that they do not depend on round-off."""
DIGITS = 3
"""Of the stable Courant number, rounded down: what is shown is what counts."""
LOWEST = 0.02
"""Smallest limit that is searched for; a body much slower than the fastest one is stable below it."""
NOTABLE = 0.01
"""Viscosity, as of ``Model``, from which it is named with a limit."""
START = round(0.5 / RESOLUTION)
"""Where searches begin."""


class NeverStable(NoKnownLimit):
    """A scene that is unstable at the smallest Courant number that is tried."""


class StableCourant(NamedTuple):
    """The stable Courant number of a scene, and whose limit it is, in words."""

    courant: float
    because: str


def stable_courant(scene: Any) -> StableCourant:
    """Return the stable Courant number of a checked scene.

    Raises
    ------
    NoKnownLimit
        If the analysis does not cover the scene.
    """
    limit, model = _least_limit(scene, models_of(scene), 1.0)
    because = "no particle crosses more than one cell per step"
    if model is not None:
        because = f"body '{model.body}', {model.because}"
        if model.viscosity > NOTABLE:
            because += ", with its viscosity"
        if limit == 0.0:
            raise NeverStable(f"{because}, is unstable at {_lowest(model) * RESOLUTION:g} already")
    has_oscillators = scene.contact is not None and scene.contact.interface.step == "oscillator"
    for spring in [*tractions_of(scene), *(springs_of(scene) if has_oscillators else ())]:
        allowed = courant_of_step(scene, spring.longest_step) / SAFETY
        if allowed < limit:
            limit, because = allowed, spring.because
    return StableCourant(math.floor(SAFETY * limit * 10**DIGITS + 1e-6) / 10**DIGITS, because)


def limit_in_motion(scene: Any) -> float | None:
    """Return the limit for bodies that pass all positions within a cell, or None where the analysis knows none.

    It is compared with measured limits; bodies that stay at a bad position have a lower one.
    """
    try:
        models = models_of(scene)
    except NoKnownLimit:
        return None
    return _least_limit(scene, [model for model in models if model.speed > 0.0], MAX_COURANT)[0]


def _least_limit(scene: Any, models: list[Model], most: float) -> tuple[float, Model | None]:
    """Return the least limit of the models, ``most`` at most, and whose it is."""
    scheme, found = scheme_of(scene), None
    least = round(most / RESOLUTION)
    with threadpool_limits(1, user_api="blas"):  # the matrices are small, and threads that wait burn time
        for model in models:
            lowest = _lowest(model)
            viscous = replace(scheme, viscosity=scheme.viscosity + model.viscosity)

            def holds(number: int, model: Model = model, scheme: Scheme = viscous) -> bool:
                courant = number * RESOLUTION / model.scale
                slow = courant < LOWEST and model.viscosity == 0.0
                return slow or is_stable(model.lattice, scheme, courant, model.speed)

            if least >= lowest and not holds(least):
                found = model
                least = bisect_limit(holds, min(START, least), lowest, least)[0] or 0
    return least * RESOLUTION, found


def _lowest(model: Model) -> int:
    """Return the smallest multiple of ``RESOLUTION`` that is tried: steps of viscous fluids may be much shorter."""
    return 1 if model.viscosity > 0.0 else round(LOWEST / RESOLUTION)


def chosen_courant(scene: Any) -> float | None:
    """Return the Courant number of a scene, selected where it says ``auto``; None where it gives a time step.

    Raises
    ------
    SceneError
        If it says ``auto`` and no limit is known.
    """
    if scene.time.courant != "auto":
        return None if scene.time.courant is None else float(scene.time.courant)
    try:
        return stable_courant(scene).courant
    except NoKnownLimit as reason:
        words = f"the stability limit is unknown: {reason}. Give a number; mpmcli stability can find one"
        raise SceneError([Problem(path="time.courant", message=words, code="no_known_limit")]) from None


def warning_of(scene: Any) -> Problem | None:
    """Return a warning if the Courant number of a scene, or its time step, is above the stable Courant number."""
    span = scene.time
    if span.courant == "auto":
        return None
    asked = courant_of_step(scene, span.step) if span.courant is None else float(span.courant)
    try:
        stable = stable_courant(scene)
    except NeverStable as reason:
        above = f"above the stable Courant number: {reason}; the run may fail"
    except NoKnownLimit:
        return None
    else:
        if asked <= stable.courant * (1.0 + 1e-9):
            return None
        above = f"above the stable Courant number {stable.courant:.3g} ({stable.because}); the run may fail"
    if span.courant is None:
        path, words = "time.step", f"this is the Courant number {asked:.3g}, which is {above}"
    else:
        path, words = "time.courant", f"{asked:.4g} is {above}"
    return Problem(path=path, message=words, code="unstable", severity="warning")


def courant_of_step(scene: Any, step: float) -> float:
    """Return the Courant number of a fixed time step at the start."""
    courant = step * max(largest_wave_speed(scene), largest_speed(scene)) / min(scene.grid.cell)
    return courant if math.isfinite(courant) else math.inf


def first_step(scene: Any, wave_speed: float | None = None, particle_speed: float | None = None) -> float:
    """Return the first time step without conduction [time].

    Speeds are those of the start, found from the scene where they are not given.
    """
    courant = chosen_courant(scene)
    if courant is None:
        return float(scene.time.step)
    wave_speed = largest_wave_speed(scene) if wave_speed is None else wave_speed
    particle_speed = largest_speed(scene) if particle_speed is None else particle_speed
    return step_of_courant(courant, float(min(scene.grid.cell)), wave_speed, particle_speed)


def step_of_courant(courant: float, cell: float, wave_speed: float, particle_speed: float) -> float:
    """Return Δt = C Δx_min/max(c, |V|), in which no particle passes a whole cell; infinite if nothing moves [time]."""
    fastest = max(wave_speed, particle_speed)
    dt = courant * cell / fastest if fastest > 0.0 else math.inf
    return min(dt, cell / particle_speed) if courant > 1.0 and particle_speed > 0.0 else dt


def check_tractions(scene: Any) -> None:
    """Refuse time steps that are too long for tractions on the points of cracks.

    Raises
    ------
    SceneError
        With the step that works.
    """
    dt, problems = first_step(scene) if scene.cracks else 0.0, []
    for traction in tractions_of(scene):
        longest = traction.longest_step
        if dt > longest:
            shorter = f"time.step: {rounded_down(longest):g}"
            if (courant := chosen_courant(scene)) is not None:
                shorter = f"time.courant: {rounded_down(courant * longest / dt):g}, or {shorter}"
            words = (
                f"the time step, {dt:.3g}, is too long for this traction, whose slope is {traction.stiffness:.3g} at "
                f"most: tractions on points need steps of at most {longest:.3g}. Use {shorter}, a lower strength or a "
                "larger peak"
            )
            problems.append(Problem(traction.path, words, code="unstable"))
    if problems:
        raise SceneError(problems)


def rounded_down(number: float) -> float:
    """Return two digits of a number, not more than it."""
    size = 10.0 ** (math.floor(math.log10(number)) - 1)
    return math.floor(number / size * (1.0 + 1e-12)) * size
