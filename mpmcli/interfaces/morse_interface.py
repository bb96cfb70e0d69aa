"""A bond that softens and comes back: the potential of Morse."""

import math
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import BeforeValidator, ValidationInfo

from mpmcli.contact.laws.base import LAWS
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.interfaces.base import InterfaceModel
from mpmcli.interfaces.independent import Independent
from mpmcli.interfaces.springs import (
    is_linear,
    is_perfect,
    no,
    oscillate,
    oscillate_nonlinear,
    pull,
    rate,
    resist,
    resist_by_pull,
    settle,
    stored,
)
from mpmcli.interfaces.stiffness import NUMBER_OR_WORD, read_stiffness, slope_of, spring_of

ROUNDS = 200
"""Steps of root finding at most; eight are usual."""
STEEPEST = 100.0
"""Largest |aδ| in compression at which the exponential is still evaluated: no traction is as large."""


def read_tangential(value: Any, info: ValidationInfo) -> Any:
    """A stiffness, ``perfect``, or ``same``."""
    return "same" if value == "same" else read_stiffness(value, info)


Tangential = Annotated[Any, BeforeValidator(read_tangential), NUMBER_OR_WORD]


@LAWS.register
class MorseInterface(InterfaceModel):
    """An elastic bond that softens: T = 2 D_e a e^{−aδ}(1 − e^{−aδ}), D_e = 8 N²/D, a = D/(4 N).

    D is the initial stiffness, N the largest traction, reached at δ = 4 N ln 2/D. Nothing is lost: sides that come
    back are bonded again. Its energy is D_e (1 − e^{−aδ})² per area.
    """

    kind: Literal["morse_interface"]
    stiffness: Annotated[float, Quantity("pressure/length", gt=0)]
    """Initial stiffness D."""
    peak: PositivePressure
    """Largest traction N."""
    tangential: Tangential = "same"
    """Shear traction per slip; ``same``: the law of the normal, for the size of the slip; ``perfect``: no slip."""

    @property
    def slopes(self) -> tuple[float, float]:
        """D, and that of the tangential direction; 0 if perfect."""
        same = self.tangential == "same"
        return self.stiffness, self.stiffness if same else slope_of(self.tangential)

    @property
    def has_perfect_direction(self) -> bool:
        """Whether there is no slip."""
        return bool(self.tangential == "perfect")

    @property
    def last_opening(self) -> float:
        """Opening beyond which the traction is below 1 % of its peak [length]."""
        return 4.0 * self.peak / self.stiffness * math.log(400.0)

    def parameters(self) -> Independent:
        """Two springs."""
        normal = Morse(8.0 * self.peak**2 / self.stiffness, self.stiffness / (4.0 * self.peak))
        tangential = Mirrored(normal) if self.tangential == "same" else spring_of(self.tangential)
        return Independent(normal, tangential)


class Morse(NamedTuple):
    """D_e [energy/area] and a [1/length]."""

    energy: float
    steepness: float


class Mirrored(NamedTuple):
    """A spring of slips: what it does in tension, in both directions."""

    spring: Any


for kind in (Morse, Mirrored):
    is_perfect.register(kind)(no)
    is_linear.register(kind)(no)
    oscillate.register(kind)(oscillate_nonlinear)
    resist.register(kind)(resist_by_pull)


@pull.register(Morse)
def _(spring, opening, most):
    way = max(spring.steepness * opening, -STEEPEST)
    return -2.0 * spring.energy * spring.steepness * math.exp(-way) * math.expm1(-way)


@rate.register(Morse)
def _(spring, opening, most):
    y = math.exp(-max(spring.steepness * opening, -STEEPEST))
    return 2.0 * spring.energy * spring.steepness * spring.steepness * y * (2.0 * y - 1.0)


@stored.register(Morse)
def _(spring, opening, most):
    return spring.energy * math.expm1(-max(spring.steepness * opening, -STEEPEST)) ** 2


@inline
def rising_root(spring, low, high, target, compliance):
    """Root of δ + c T(δ) = ``target`` between ``low`` and ``high``, where the left side rises.

    Newton steps; halving where they leave the bracket or do not converge.
    """
    if low + compliance * pull(spring, low, 0.0) >= target:
        return low
    x = low if low >= 0.0 else high  # nearer to the origin, where Newton finds small targets at once
    last = high - low
    for _ in range(ROUNDS):
        residual = x + compliance * pull(spring, x, 0.0) - target
        slope = 1.0 + compliance * rate(spring, x, 0.0)
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


@settle.register(Morse)
def _(spring, opening, target, compliance, most):
    # where δ + c T(δ) falls: 1 + c D y (2 y − 1) = 0 with y = e^{−aδ}
    d = 2.0 * spring.energy * spring.steepness * spring.steepness * compliance
    if d <= 8.0:
        return rising_root(spring, min(target, 0.0), max(target, 0.0), target, compliance)
    root = math.sqrt(1.0 - 8.0 / d)
    first = -math.log(0.25 * (1.0 + root)) / spring.steepness
    # 1 − root without its difference
    second = -math.log(2.0 / (d * (1.0 + root))) / spring.steepness
    top = first + compliance * pull(spring, first, most)
    bottom = second + compliance * pull(spring, second, most)
    from_below = opening <= first or (
        opening < second and target < opening + compliance * pull(spring, opening, most)
    )
    if (from_below and target <= top) or target < bottom:
        return rising_root(spring, min(target, 0.0), first, target, compliance)
    return rising_root(spring, second, max(target, second), target, compliance)


@pull.register(Mirrored)
def _(spring, opening, most):
    return math.copysign(pull(spring.spring, abs(opening), most), opening)


@rate.register(Mirrored)
def _(spring, opening, most):
    return rate(spring.spring, abs(opening), most)


@stored.register(Mirrored)
def _(spring, opening, most):
    return stored(spring.spring, abs(opening), most)


@settle.register(Mirrored)
def _(spring, opening, target, compliance, most):
    return math.copysign(settle(spring.spring, abs(opening), abs(target), compliance, most), target)
