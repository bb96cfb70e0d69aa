"""The spring of a cohesive mode: it follows its shape, and unloads and reloads on a line through the origin."""

import math
from typing import Any, NamedTuple

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.interfaces.shapes.base import elastic_end, envelope, envelope_slope, failure, secant, spent
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


@inline
def left(spring, opening, most):
    """Stiffness that is left at the start of the step: at light nodes the opening of its end is no measure of it."""
    return secant(spring.shape, max(most, abs(opening), elastic_end(spring.shape)))


@settle.register(Softening)
def _(spring, opening, target, compliance, most):
    return target / (1.0 + compliance * left(spring, opening, most))


@resist.register(Softening)
def _(spring, opening, target, compliance, most):
    return left(spring, opening, most) * settle(spring, opening, target, compliance, most)


oscillate.register(Softening)(oscillate_nonlinear)
