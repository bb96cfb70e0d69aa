"""Needleman's cubic law: smooth, damaged from the start."""

from __future__ import annotations

from typing import Literal, NamedTuple

from mpmcli.interfaces.shapes.base import (
    ShapeModel,
    elastic_end,
    envelope,
    envelope_slope,
    failure,
    secant,
    spent,
)


class CubicShape(ShapeModel):
    """S = (27 σ/4) x (1 − x)² with x = δ/δ_c [needleman1987]; largest at x = 1/3: G = 9 σ δ_c/16."""

    shape: Literal["cubic"]
    """Its name."""

    @property
    def area(self) -> float:
        """9/16."""
        return 9.0 / 16.0

    @property
    def slope(self) -> float:
        """27 σ/(4 δ_c)."""
        strength, _, opening = self.resistance
        return 6.75 * strength / opening

    def scaled(self, strength: float, opening: float) -> Cubic:
        """Strength and opening."""
        return Cubic(strength, opening)


class Cubic(NamedTuple):
    """σ [pressure], δ_c [length]."""

    strength: float
    opening: float


@envelope.register(Cubic)
def _(shape, opening):
    x = min(opening / shape.opening, 1.0)
    return 6.75 * shape.strength * x * (1.0 - x) ** 2


@envelope_slope.register(Cubic)
def _(shape, opening):
    x = min(opening / shape.opening, 1.0)
    return 6.75 * shape.strength / shape.opening * (1.0 - x) * (1.0 - 3.0 * x)


@elastic_end.register(Cubic)
def _(shape):
    return 0.0


@failure.register(Cubic)
def _(shape):
    return shape.opening


@secant.register(Cubic)
def _(shape, opening):
    x = min(opening / shape.opening, 1.0)
    return 6.75 * shape.strength / shape.opening * (1.0 - x) ** 2


@spent.register(Cubic)
def _(shape, opening):
    x = min(opening / shape.opening, 1.0)
    return 0.5625 * shape.strength * shape.opening * x**3 * (4.0 - 3.0 * x)
