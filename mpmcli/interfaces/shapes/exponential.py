"""Linear to the strength, exponential to failure."""

from __future__ import annotations

import math
from typing import Annotated, Literal, NamedTuple

from mpmcli.core.model import Quantity
from mpmcli.interfaces.shapes.base import PEAK, ShapeModel, envelope, envelope_slope, spent, with_peak


class ExponentialShape(ShapeModel):
    """S rises linearly to σ at δ_e and falls as σ (e^{−αξ} − e^{−α})/(1 − e^{−α}), ξ = (δ − δ_e)/(δ_c − δ_e).

    G = ½ σ (δ_e + f (δ_c − δ_e)) with f = 2/α − 2 e^{−α}/(1 − e^{−α}).
    """

    shape: Literal["exponential"]
    """Its name."""
    alpha: Annotated[float, Quantity("1", ge=0.01, le=100)]
    """α: how fast the traction falls; a small one is almost a triangle."""
    peak: Annotated[float, Quantity("1", gt=0, lt=1)] = PEAK
    """δ_e/δ_c: where the traction is largest, as a share of the opening at failure."""

    @property
    def area(self) -> float:
        """½ (δ_e/δ_c + f (1 − δ_e/δ_c))."""
        f = 2.0 / self.alpha - 2.0 / math.expm1(self.alpha)
        return 0.5 * (self.peak + f * (1.0 - self.peak))

    @property
    def slope(self) -> float:
        """σ/δ_e."""
        strength, _, opening = self.resistance
        return strength / (self.peak * opening)

    def scaled(self, strength: float, opening: float) -> Exponential:
        """Strength, both openings and α."""
        return Exponential(strength, self.peak * opening, opening, self.alpha, -math.expm1(-self.alpha))


@with_peak
class Exponential(NamedTuple):
    """σ [pressure], δ_e and δ_c [length], α and 1 − e^{−α} [-]."""

    strength: float
    elastic: float
    opening: float
    alpha: float
    fall: float


@envelope.register(Exponential)
def _(shape, opening):
    if opening <= shape.elastic:
        return shape.strength * (opening / shape.elastic)
    rest = max(shape.opening - opening, 0.0) / (shape.opening - shape.elastic)
    left = -math.expm1(-shape.alpha * rest) / shape.fall
    return shape.strength * math.exp(-shape.alpha * (1.0 - rest)) * left


@envelope_slope.register(Exponential)
def _(shape, opening):
    if opening <= shape.elastic:
        return shape.strength / shape.elastic
    if opening >= shape.opening:
        return 0.0
    width = shape.opening - shape.elastic
    way = (opening - shape.elastic) / width
    return -shape.strength * shape.alpha / (width * shape.fall) * math.exp(-shape.alpha * way)


@spent.register(Exponential)
def _(shape, opening):
    if opening <= shape.elastic:
        return 0.0
    width = shape.opening - shape.elastic
    way = min((opening - shape.elastic) / width, 1.0)
    a = shape.alpha
    fallen = (-math.expm1(-a * way) / a - way * (1.0 - shape.fall)) / shape.fall
    work = shape.strength * (0.5 * shape.elastic + width * fallen)
    return work - 0.5 * envelope(shape, opening) * opening
