"""The spring of a cohesive mode: it follows its shape, and unloads and reloads on a line through the origin."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.interfaces.shapes.base import (
    elastic_end,
    envelope,
    envelope_slope,
    failure,
    secant,
    snap,
    spent,
)
from mpmcli.interfaces.springs import (
    Elastic,
    is_linear,
    is_perfect,
    no,
    oscillate,
    oscillate_nonlinear,
    pull,
    rate,
    resist,
    settle,
    stored,
)

ROUNDS = 200
"""Steps of root finding at most; six are usual."""


class Softening(NamedTuple):
    """The numbers of a shape; T(−δ) = −T(δ)."""

    shape: Any


@generic
def lost(spring: Any, most: Any) -> Any:
    """Energy per area that it has spent [energy/area]."""


@generic
def lost_share(spring: Any, most: Any) -> Any:
    """The same as a share of the toughness."""


@generic
def has_failed(spring: Any, most: Any) -> Any:
    """Whether it transmits nothing any more."""


@generic
def worn(spring: Any, most: Any) -> Any:
    """Share of its stiffness that it has lost, 0 to 1."""


@lost.register(Elastic)
@lost_share.register(Elastic)
@worn.register(Elastic)
def _(spring, most):
    return 0.0


@has_failed.register(Elastic)
def _(spring, most):
    return False


is_perfect.register(Softening)(no)
is_linear.register(Softening)(no)


@lost.register(Softening)
def _(spring, most):
    return spent(spring.shape, most)


@lost_share.register(Softening)
def _(spring, most):
    return spent(spring.shape, most) / spent(spring.shape, failure(spring.shape))


@has_failed.register(Softening)
def _(spring, most):
    return most >= failure(spring.shape)


@worn.register(Softening)
def _(spring, most):
    base = elastic_end(spring.shape)
    if most <= base:
        return 0.0
    return min(max(1.0 - secant(spring.shape, most) / secant(spring.shape, base), 0.0), 1.0)


@pull.register(Softening)
def _(spring, opening, most):
    size, base = abs(opening), max(most, elastic_end(spring.shape))
    if size <= base:
        return secant(spring.shape, base) * opening
    return math.copysign(envelope(spring.shape, size), opening)


@rate.register(Softening)
def _(spring, opening, most):
    size, base = abs(opening), max(most, elastic_end(spring.shape))
    return secant(spring.shape, base) if size <= base else envelope_slope(spring.shape, size)


@stored.register(Softening)
def _(spring, opening, most):
    base = max(most, abs(opening), elastic_end(spring.shape))
    return 0.5 * secant(spring.shape, base) * opening * opening


@settle.register(Softening)
def _(spring, opening, target, compliance, most):
    size, base = abs(target), max(most, elastic_end(spring.shape))
    stiffening = 1.0 + compliance * secant(spring.shape, base)
    if size <= base * stiffening:
        return target / stiffening
    return math.copysign(opening_beyond(spring.shape, base, size, compliance), target)


@resist.register(Softening)
def _(spring, opening, target, compliance, most):
    # damage is that of the start of the step: at light nodes the opening of its end is no measure of it
    stiffness = secant(spring.shape, max(most, abs(opening), elastic_end(spring.shape)))
    return stiffness * target / (1.0 + compliance * stiffness)


oscillate.register(Softening)(oscillate_nonlinear)


@inline
def opening_beyond(shape, base, target, compliance):
    """Return the smallest δ > ``base`` with δ + c S(δ) = ``target``, which is above the left side at ``base``.

    The left side rises up to δ₁, falls to δ₂ and rises again (``snap``).
    """
    if target >= failure(shape) and base >= failure(shape):
        return target
    first, second = snap(shape, compliance)
    if base < first and target <= first + compliance * envelope(shape, first):
        return rising_root(shape, base, first, target, compliance)
    if target >= failure(shape):
        return target
    return rising_root(shape, max(base, second), target, target, compliance)


@inline
def rising_root(shape, low, high, target, compliance):
    """Root of δ + c S(δ) = ``target`` between ``low`` and ``high``, where the left side rises.

    Newton steps; halving where they leave the bracket or do not converge.
    """
    if low + compliance * envelope(shape, low) >= target:
        return low
    x = (
        low if low >= 0.0 else high
    )  # the end that is nearer to the origin: Newton finds small targets at once
    last = high - low
    for _ in range(ROUNDS):
        residual = x + compliance * envelope(shape, x) - target
        slope = 1.0 + compliance * envelope_slope(shape, x)
        if residual > 0.0:
            high = x
        elif residual < 0.0:
            low = x
        else:
            break
        step = -residual / slope if abs(residual) < 0.5 * last * slope else high - low
        moved = x + step
        if not low < moved < high:
            moved = 0.5 * (low + high)
            step = moved - x
        last = abs(step)
        if moved == x:
            break
        x = moved
        if last <= 1e-16 * abs(x):
            break
    return x
