"""Courant numbers at which the amplitude of a small block begins to grow.

One step of the block's linearised update is a matrix 𝐁(δ, C) that depends on the offset δ of the block within a cell.
The surface is part of it because it rules: between free nodes of little mass and particles that hardly reach them,
FMPM(k) loses its stability long before it does so in an endless bar. Six limits come of it:

moving
    The block travels through a cell, at a fortieth of the wave speed. Unstable if the largest eigenvalue of the
    product of all 𝐁 on the way, per step, is above ``exp(GROWTH)``. This is what bodies that move show; between 1/150
    and 1/10 of the wave speed it depends little on the speed (most with ugimp and bspline2: slower is less stable).
swinging
    The block moves as the free end of a body that swings. Unstable if a disturbance grows by more than
    ``exp(TOTAL_GROWTH)`` in all the steps of a run: just above a limit the growth is slow, and a short run hardly shows
    it. A transfer that damps (FMPM(1)) makes the swing smaller from step to step, so that it turns at other places of
    its cells each time. An endless row that swings so may grow a hundredfold: fast swings are no better than flight.
flying
    An endless row of particles travels through cells at a large share of the wave speed, or slower down to ``FLIES``.
    Unstable if the product grows by more than ``exp(FLIGHT_GROWTH)`` per step, and more than a hundredfold in a run.
slow
    The block is unstable at rest at no more than one of ``SLOW_PLACES`` places within a cell. What bodies show that
    move slowly, or bend: they pass the worst place, but their particles do not stay there.
worst
    The block stays where the largest eigenvalue of one 𝐁 is largest. The limit of a body that rests at the worst
    place: the lowest, and safe.
at rest
    The block stays at a given offset.

All are whole multiples of ``RESOLUTION``, so that they do not depend on round-off. Who only asks whether a Courant
number is stable gives it as ``enough``: a limit at or above it is then not looked for, and the answer is some number
at or above it.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from mpmcli.core.bisection import bisect_limit
from mpmcli.scene.method import MAX_COURANT
from mpmcli.stability.lattice import Lattice, stencils
from mpmcli.stability.linear_step import LinearStep, Scheme, wave_damping

Array = np.ndarray

STEPS_PER_CELL = 40.0
"""Steps at C = 1 in which the moving block crosses a cell."""
GROWTH = 1e-3
"""Growth per step (of the logarithm of the amplitude) above which an update counts as unstable."""
TOTAL_GROWTH = 8.0
"""Growth in a whole run above which a swinging block counts as unstable: from a ten-thousandth of the velocities, which
a smooth start may have in modes of the grid, to tenths, which the energy shows."""
SWING_PLACES = 200
"""Places per cell at which a swinging block is looked at."""
DIES = 0.01
"""A swing counts as the same all the time if the logarithm of its amplitude changes less in the whole run."""
AT_REST = 5.0
"""A swing that dies is followed until the logarithm of its amplitude has fallen by so much."""
MOST_FOLLOWED = 4000
"""Steps for which a swing that dies is followed; one that dies in more counts as the same all the time."""
RESCALED = 4
"""Steps of a long run after which its states are made small again."""
ISLANDS = 0.85
"""With a periodic transfer stable and unstable Courant numbers take turns, as a whole number of steps must pass between
those of full order: the least unstable one is looked for down to this share of the first limit that is found."""
PLACES = {1: 20, 2: 10}
"""Places within half a cell (the other half mirrors it) that the worst one is looked for among, by number of axes."""
NEAR = 0.01
"""A place just off the grid lines (cells): some shape functions lose their stability by leaving them."""
SLOW_PLACES = 12
"""Places within half a cell, of which a body that moves slowly may be unstable at one."""
FLIGHT_GROWTH = 5e-3
"""Growth per step above which a flying row counts as unstable; round-off stays small for some thousand steps."""
GROWTH_IN_RUN = math.log(100.0)
"""Growth in a whole run that a row may have that swings, and one that flies in any case."""
FLIGHT_STEPS = 40.0
"""A flying row is followed for so many steps at least, which take it across a whole number of cells."""
FLIES = 0.1
"""Bodies fly that are faster than this share of the wave speed; slower ones have the limits of a moving block."""
SLOWER = 0.7
"""A body that flies is slowed down: each speed by this factor below its own counts too, down to ``FLIES``."""
RESOLUTION = 0.0025
LOWEST, HIGHEST = 0.02, MAX_COURANT
"""Courant numbers between which limits are looked for."""
START = 0.5
OVERFLOW = 1e120
SQUARINGS = 15
"""A power of two, large enough that neither the norm nor growth with a power of time matters."""


@functools.lru_cache(maxsize=256)
def moving_limit(lattice: Lattice, scheme: Scheme, enough: float = math.inf) -> float:
    """Largest stable Courant number of a block that travels along all axes."""

    def is_stable(courant: float) -> bool:
        return _growth_moving(lattice, scheme, courant) <= GROWTH

    def start() -> float:
        return worst_limit(lattice, scheme) * 1.2 or START

    return _largest_stable(is_stable, start, enough)


@dataclass(frozen=True)
class Swing:
    """How the free end of a body swings for a while; in cells, and times in which a wave crosses a cell.

    Attributes
    ----------
    amplitude : to both sides of where it starts [cells]
    period, duration : of one swing, and of the run
    place : within its cell, where it starts
    """

    amplitude: float
    period: float
    duration: float
    place: float = 0.0


@functools.lru_cache(maxsize=256)
def swinging_limit(lattice: Lattice, scheme: Scheme, swing: Swing, enough: float = math.inf) -> float:
    """Largest stable Courant number of a block, or of an endless row, that swings along all axes."""
    most = GROWTH_IN_RUN if lattice.is_endless else TOTAL_GROWTH

    def is_stable(courant: float) -> bool:
        return _growth_in_run(lattice, scheme, courant, swing) <= most

    limit = _largest_stable(is_stable, lambda: moving_limit(lattice, scheme), enough)
    if scheme.every_courant is None or limit >= enough:
        return limit
    last = round(limit / RESOLUTION)
    for place in range(math.ceil(ISLANDS * last), last):
        if not is_stable(place * RESOLUTION):
            return (place - 1) * RESOLUTION
    return limit


@functools.lru_cache(maxsize=256)
def flying_limit(
    row: Lattice, scheme: Scheme, speed: float, duration: float = math.inf, enough: float = math.inf
) -> float:
    """Largest stable Courant number of an endless row that flies at ``speed`` times the wave speed, or slower.

    ``duration`` of the run counts in times in which a wave crosses a cell.
    """
    slower = itertools.takewhile(lambda v: v >= FLIES, (speed * SLOWER**n for n in itertools.count()))
    speeds = list(slower)

    def is_stable(courant: float) -> bool:
        most = max(FLIGHT_GROWTH, GROWTH_IN_RUN * courant / duration)
        return all(_growth_flying(row, scheme, courant, v) <= most for v in speeds)

    return _largest_stable(is_stable, lambda: worst_limit(row, scheme), enough)


@functools.lru_cache(maxsize=256)
def slow_limit(lattice: Lattice, scheme: Scheme, enough: float = math.inf) -> float:
    """Largest Courant number at which the block is unstable at rest at one of ``SLOW_PLACES`` at most."""
    places = [(place + 0.5) / (2 * SLOW_PLACES) for place in range(SLOW_PLACES)]
    return _stable_but_at(1, places, lattice, scheme, enough)


@functools.lru_cache(maxsize=256)
def worst_limit(lattice: Lattice, scheme: Scheme, enough: float = math.inf) -> float:
    """Largest stable Courant number of a block that rests at the worst place."""
    count = PLACES[lattice.dimensions]
    places = [NEAR, *(0.5 * place / count for place in range(count + 1))]
    return _stable_but_at(0, places, lattice, scheme, enough)


@functools.lru_cache(maxsize=1024)
def limit_at_rest(
    lattice: Lattice, scheme: Scheme, offsets: tuple[float, ...], enough: float = math.inf
) -> float:
    """Largest stable Courant number of a block that rests at ``offsets`` (cells) along the axes."""

    def is_stable(courant: float) -> bool:
        return _growth_at_rest(lattice, scheme, courant, offsets) <= GROWTH

    return _largest_stable(is_stable, lambda: START, enough)


def _stable_but_at(
    allowed: int, places: list[float], lattice: Lattice, scheme: Scheme, enough: float
) -> float:
    """Largest Courant number at which the block is unstable at ``allowed`` places along the diagonal at most."""
    first = list(reversed(places))  # where it is unstable first, mostly

    def is_stable(courant: float) -> bool:
        unstable = 0
        for place in list(first):
            if _growth_at_rest(lattice, scheme, courant, (place,) * lattice.dimensions) > GROWTH:
                first.remove(place)
                first.insert(0, place)
                unstable += 1
                if unstable > allowed:
                    return False
        return True

    return _largest_stable(is_stable, lambda: START, enough)


def _growth_moving(lattice: Lattice, scheme: Scheme, courant: float) -> float:
    """Logarithm of the amplification per step of a block that travels along all axes by one cell."""
    return _growth_along(lattice, scheme, courant, STEPS_PER_CELL / courant, lambda share: share)


def _growth_flying(row: Lattice, scheme: Scheme, courant: float, speed: float) -> float:
    """Logarithm of the amplification per step of a row that flies, as fast as takes it across whole cells."""
    cells_per_step = speed * courant / row.cell[0]
    cells = math.ceil(FLIGHT_STEPS * cells_per_step)
    return _growth_along(row, scheme, courant, cells / cells_per_step, lambda share: share * cells % 1.0)


def _growth_in_run(lattice: Lattice, scheme: Scheme, courant: float, swing: Swing) -> float:
    """Logarithm of the largest amplification in the run of a block that swings."""
    steps = swing.duration / courant
    wave = 2.0 * math.pi / swing.period
    dying = 0.5 * wave_damping(lattice, scheme, wave) / steps_apart(scheme, courant)
    followed = min(steps, AT_REST / dying) if dying > 0.0 else steps
    if dying * steps <= DIES or followed > MOST_FOLLOWED:
        return steps * _growth_swinging(lattice, scheme, courant, swing)
    number = np.arange(round(followed))
    at = swing.place + swing.amplitude * np.exp(-dying * number) * np.sin(wave * (number + 0.5) * courant)
    state, most, so_far = np.eye(1), 0.0, 0.0
    for step, matrix in enumerate(_steps(lattice, scheme, courant, _rounded(at))):
        state = matrix @ state if step else matrix
        if step % RESCALED == 0:
            largest = float(np.abs(state).max())
            state = state / largest
            so_far += math.log(largest)
            most = max(most, so_far)
    return most


def _steps(lattice: Lattice, scheme: Scheme, courant: float, places: Array) -> Iterator[Array]:
    """The matrices of the steps of a block that is at ``places`` (steps,) along all axes."""
    number = np.arange(len(places))
    is_flip = (number + 1) % steps_apart(scheme, courant) != 0
    along_all = np.repeat(places[:, None], lattice.dimensions, axis=1)
    return LinearStep(lattice, scheme, courant).matrices(along_all, is_flip)


def _growth_swinging(lattice: Lattice, scheme: Scheme, courant: float, swing: Swing) -> float:
    """Logarithm of the amplification per step of a block that swings.

    Where it swings about a grid line or the middle of a cell, one half of its period mirrors the other.
    """
    share_of_period = 0.5 if swing.place in (0.0, 0.5) else 1.0

    def place(share: Array) -> Array:
        return _rounded(swing.place + swing.amplitude * np.sin(2.0 * np.pi * share_of_period * share))

    return _growth_along(lattice, scheme, courant, share_of_period * swing.period / courant, place)


def _rounded(at: Array) -> Array:
    """The places within their cells, of ``SWING_PLACES`` there."""
    return np.round(at * SWING_PLACES) % SWING_PLACES / SWING_PLACES


def _growth_along(
    lattice: Lattice, scheme: Scheme, courant: float, about: float, place: Callable[[Array], Array]
) -> float:
    """Logarithm of the amplification per step on a way of ``about`` so many steps.

    ``place`` gives the offsets within a cell, along all axes, after shares of the way.
    """
    steps = max(6, round(about))
    period = steps_apart(scheme, courant)
    if period > 1:
        steps = period * max(1, round(steps / period))
    passed = np.eye(1)
    with np.errstate(over="ignore", invalid="ignore"):
        places = place((np.arange(steps) + 0.5) / steps)
        for step, matrix in enumerate(_steps(lattice, scheme, courant, places)):
            passed = matrix @ passed if step else matrix
            if not np.abs(passed).max() < OVERFLOW:
                return np.inf
    return _log_of_radius(passed) / steps


def _growth_at_rest(lattice: Lattice, scheme: Scheme, courant: float, offsets: tuple[float, ...]) -> float:
    """Logarithm of the amplification per step of a block at rest."""
    period = steps_apart(scheme, courant)
    step, at = LinearStep(lattice, scheme, courant), stencils(lattice, np.array([offsets]))
    with np.errstate(over="ignore", invalid="ignore"):
        passed = step.advance(step.identity(), at).matrices()[0]
        if period > 1:
            flip = step.advance(step.identity(), at, is_flip=True).matrices()[0]
            passed = passed @ np.linalg.matrix_power(flip, period - 1)
    return _log_of_radius(passed) / period if np.abs(passed).max() < OVERFLOW else np.inf


def steps_apart(scheme: Scheme, courant: float) -> int:
    """Steps from one that takes the transfer as asked to the next."""
    if scheme.every_steps is not None:
        return scheme.every_steps
    if scheme.every_courant is not None:
        return max(1, int(np.ceil(scheme.every_courant / courant - 1e-9)))
    return 1


def _log_of_radius(matrix: Array) -> float:
    """Logarithm of the spectral radius, from a norm of the power ``2**SQUARINGS``: faster than eigenvalues."""
    power, logarithm = matrix, 0.0
    for _ in range(SQUARINGS):
        scale = np.abs(power).max()
        if scale == 0.0:
            return -np.inf
        power = power / scale
        logarithm = 2.0 * (logarithm + np.log(scale))
        power = power @ power
    scale = np.abs(power).max()
    return float(logarithm + np.log(scale)) / 2**SQUARINGS if scale > 0.0 else -np.inf


def _largest_stable(is_stable: Callable[[float], bool], start: Callable[[], float], enough: float) -> float:
    if enough <= HIGHEST:
        place = math.ceil(max(enough, LOWEST) / RESOLUTION - 1e-9)
        if is_stable(place * RESOLUTION):
            return place * RESOLUTION
    low, _ = bisect_limit(
        lambda place: is_stable(place * RESOLUTION),
        round(start() / RESOLUTION),
        round(LOWEST / RESOLUTION),
        round(HIGHEST / RESOLUTION),
    )
    return 0.0 if low is None else low * RESOLUTION
