"""What the shape of a cohesive law is: traction against opening in one mode, by strength, toughness and opening.

A shape is a pydantic model derived from ``ShapeModel`` (the scene's words) and a named tuple of numbers with the
generic functions below. S(δ) is the envelope that a monotone opening follows: it rises to the strength σ, falls to
zero at the opening at failure δ_c, and is zero from there on; G = ∫S dδ is the toughness.
"""

from typing import Annotated, Any, ClassVar, NamedTuple, Self, TypeVar

from pydantic import model_validator

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.model import Model, PositiveLength, PositivePressure, Quantity

PEAK = 0.2259
"""δ_e/δ_c with which a triangle fits Needleman's cubic law best."""


class Resistance(NamedTuple):
    """Strength σ [pressure], toughness G [energy/area] and opening at failure δ_c [length] of one mode."""

    strength: float
    toughness: float
    opening: float


class ShapeModel(Model):
    """Base of shapes that fail: two of three numbers, from which the third follows."""

    fails: ClassVar[bool] = True
    """Tractions end at some opening."""

    strength: PositivePressure | None = None
    """Largest traction σ."""
    toughness: Annotated[float, Quantity("energy/area", gt=0)] | None = None
    """Energy per area G that failure takes."""
    opening: PositiveLength | None = None
    """Opening at failure δ_c, where the traction has fallen to zero."""

    @property
    def area(self) -> float:
        """G/(σ δ_c): area under the shape of unit strength and opening."""
        raise TypeError(f"{type(self).__name__} gives no area")

    @property
    def resistance(self) -> Resistance:
        """All three numbers."""
        # a missing one is replaced by 1 only until the validator below has refused the shape
        strength, toughness, opening = (1.0 if x is None else x for x in self._given.values())
        if self.strength is None:
            strength = toughness / (self.area * opening)
        elif self.opening is None:
            opening = toughness / (self.area * strength)
        return Resistance(strength, self.area * strength * opening, opening)

    @property
    def _given(self) -> dict[str, float | None]:
        return {"strength": self.strength, "toughness": self.toughness, "opening": self.opening}

    @property
    def slope(self) -> float:
        """Largest slope of the traction, that of the start [pressure/length]."""
        raise TypeError(f"{type(self).__name__} gives no slope")

    @property
    def unit(self) -> NamedTuple:
        """The numbers of the shape for unit strength and opening: two modes of equal ones have the same shape."""
        return self.scaled(1.0, 1.0)

    def scaled(self, strength: float, opening: float) -> NamedTuple:
        """The numbers of the shape that compiled code needs, for this strength and opening at failure."""
        raise TypeError(f"{type(self).__name__} gives no numbers")

    def parameters(self) -> NamedTuple:
        """The numbers that compiled code needs."""
        return self.scaled(self.resistance.strength, self.resistance.opening)

    @model_validator(mode="after")
    def _two_of_three(self) -> Self:
        missing = [name for name, value in self._given.items() if value is None]
        if not missing:
            shown = ", ".join(f"{name} {value:g}" for name, value in self._given.items())
            raise ValueError(
                f"give two of strength, toughness and opening, not all three ({shown}): the third follows "
                f"(with this strength and opening the toughness is {self.resistance.toughness:.4g})"
            )
        if len(missing) > 1:
            others = "strength, toughness and opening" if len(missing) == 3 else " and ".join(missing)
            words = "two of strength, toughness and opening are needed, from which the third follows"
            raise ValueError(f"{words}; missing: {others}")
        return self


Numbers = TypeVar("Numbers")


@generic
def envelope(shape: Any, opening: Any) -> Any:
    """S(δ) for δ ≥ 0 [pressure]."""


@generic
def envelope_slope(shape: Any, opening: Any) -> Any:
    """dS/dδ for δ ≥ 0 [pressure/length]."""


@generic
def elastic_end(shape: Any) -> Any:
    """δ_e: up to this opening nothing is damaged [length]."""


@generic
def secant(shape: Any, opening: Any) -> Any:
    """S(δ)/δ for δ ≥ δ_e: stiffness after the largest opening δ [pressure/length]."""


@generic
def spent(shape: Any, opening: Any) -> Any:
    """Energy per area ∫S dδ − ½ S δ that is lost for good after the largest opening δ ≥ 0 [energy/area]."""


@generic
def failure(shape: Any) -> Any:
    """δ_c [length]."""


def with_peak(numbers: type[Numbers]) -> type[Numbers]:
    """Class decorator of a shape's numbers ``elastic`` = δ_e and ``opening`` = δ_c: register what follows from them."""
    elastic_end.register(numbers)(_elastic)
    failure.register(numbers)(_opening)
    secant.register(numbers)(_secant)
    return numbers


def _elastic(shape):
    return shape.elastic


def _opening(shape):
    return shape.opening


def _secant(shape, opening):
    return envelope(shape, opening) / opening
