"""Linear to the strength, linear to a kink, linear to failure."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.core.model import Quantity
from mpmcli.interfaces.shapes.base import PEAK, ShapeModel, envelope, envelope_slope, spent, with_peak


class TrilinearShape(ShapeModel):
    """S rises linearly to σ at δ_e, goes linearly to σ₂ at δ₂ and falls linearly to 0 at δ_c.

    G = ½ δ_c (σ δ₂/δ_c + σ₂ (1 − δ_e/δ_c)).
    """

    shape: Literal["trilinear"]
    """Its name."""
    peak: Annotated[float, Quantity("1", gt=0, lt=1)] = PEAK
    """δ_e/δ_c: where the traction is largest, as a share of the opening at failure."""
    kink_opening: Annotated[float, Quantity("1", gt=0, lt=1)]
    """δ₂/δ_c: opening of the kink as a share of that at failure."""
    kink_strength: Annotated[float, Quantity("1", ge=0, le=1)]
    """σ₂/σ: traction at the kink as a share of the strength."""

    @model_validator(mode="after")
    def _kink_after_peak(self) -> Self:
        if self.kink_opening <= self.peak:
            raise ValueError(
                f"kink_opening ({self.kink_opening:g}) must be above peak ({self.peak:g}): the kink comes after it"
            )
        return self

    @property
    def area(self) -> float:
        """½ (δ₂/δ_c + σ₂/σ (1 − δ_e/δ_c))."""
        return 0.5 * (self.kink_opening + self.kink_strength * (1.0 - self.peak))

    @property
    def slope(self) -> float:
        """σ/δ_e."""
        strength, _, opening = self.resistance
        return strength / (self.peak * opening)

    def scaled(self, strength: float, opening: float) -> Trilinear:
        """Both tractions and all three openings."""
        return Trilinear(
            strength, self.kink_strength * strength, self.peak * opening, self.kink_opening * opening, opening
        )


@with_peak
class Trilinear(NamedTuple):
    """σ and σ₂ [pressure], δ_e, δ₂ and δ_c [length]."""

    strength: float
    kink_strength: float
    elastic: float
    kink: float
    opening: float


@envelope.register(Trilinear)
def _(shape, opening):
    if opening <= shape.elastic:
        return shape.strength * (opening / shape.elastic)
    if opening <= shape.kink:
        way = (opening - shape.elastic) / (shape.kink - shape.elastic)
        return shape.strength * (1.0 - way) + shape.kink_strength * way
    return shape.kink_strength * max(shape.opening - opening, 0.0) / (shape.opening - shape.kink)


@envelope_slope.register(Trilinear)
def _(shape, opening):
    if opening <= shape.elastic:
        return shape.strength / shape.elastic
    if opening <= shape.kink:
        return (shape.kink_strength - shape.strength) / (shape.kink - shape.elastic)
    return -shape.kink_strength / (shape.opening - shape.kink) if opening < shape.opening else 0.0


@spent.register(Trilinear)
def _(shape, opening):
    traction = envelope(shape, opening)
    if opening <= shape.elastic:
        return 0.0
    if opening <= shape.kink:
        return 0.5 * (shape.strength * opening - traction * shape.elastic)
    most = shape.strength * shape.kink + shape.kink_strength * (shape.opening - shape.elastic)
    return 0.5 * (most - traction * shape.opening)
