"""Linear to the strength, linear to failure."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

from mpmcli.core.model import Quantity
from mpmcli.interfaces.shapes.base import PEAK, ShapeModel, envelope, envelope_slope, spent, with_peak


class TriangularShape(ShapeModel):
    """S rises linearly to σ at δ_e and falls linearly to 0 at δ_c: G = ½ σ δ_c."""

    shape: Literal["triangular"]
    """Its name."""
    peak: Annotated[float, Quantity("1", gt=0, lt=1)] = PEAK
    """δ_e/δ_c: where the traction is largest, as a share of the opening at failure."""

    @property
    def area(self) -> float:
        """½."""
        return 0.5

    @property
    def slope(self) -> float:
        """σ/δ_e."""
        strength, _, opening = self.resistance
        return strength / (self.peak * opening)

    def scaled(self, strength: float, opening: float) -> Triangular:
        """Strength and both openings."""
        return Triangular(strength, self.peak * opening, opening)


@with_peak
class Triangular(NamedTuple):
    """σ [pressure], δ_e and δ_c [length]."""

    strength: float
    elastic: float
    opening: float


@envelope.register(Triangular)
def _(shape, opening):
    if opening <= shape.elastic:
        return shape.strength * (opening / shape.elastic)
    return shape.strength * max(shape.opening - opening, 0.0) / (shape.opening - shape.elastic)


@envelope_slope.register(Triangular)
def _(shape, opening):
    if opening <= shape.elastic:
        return shape.strength / shape.elastic
    return -shape.strength / (shape.opening - shape.elastic) if opening < shape.opening else 0.0


@spent.register(Triangular)
def _(shape, opening):
    share = (opening - shape.elastic) / (shape.opening - shape.elastic)
    return 0.5 * shape.strength * shape.opening * min(max(share, 0.0), 1.0)
