"""What a growth criterion is: a model that says how much of what growth needs is there.

A new criterion is one new file here and its row in ``KINDS``.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import TYPE_CHECKING, Annotated, ClassVar

from mpmcli.core.errors import SimulationError
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Model, Varying
from mpmcli.core.registry import Registry

if TYPE_CHECKING:
    from mpmcli.cracks.tip_state import TipState

KINDS = {
    "empirical": "empirical",
    "energy_release_rate": "energy_release_rate",
    "maximum_hoop_stress": "maximum_hoop_stress",
    "never": "never",
    "opening": "opening",
    "steady_speed": "steady_speed",
    "strain_energy_density": "strain_energy_density",
}
"""The module in this package of each kind."""

CRITERIA = Registry("growth criterion", "mpmcli.cracks.criteria", KINDS)

VARIABLES = ("t", "length", "speed")
Toughness = Annotated[Expression, Varying("energy/area", VARIABLES)]
"""Energy per area of new crack; may vary with time, with the length of the crack and with the speed of its tip."""
Factor = Annotated[Expression, Varying("pressure*length^0.5", VARIABLES)]
"""Stress intensity; may vary likewise."""


class Criterion(Model):
    """Base of all growth criteria."""

    needs: ClassVar[frozenset[str]] = frozenset()
    """What it is made of: ``J``, ``K`` (which only isotropic elastic materials have), ``opening``."""
    direction: ClassVar[str] = "self_similar"
    """Kind of the direction in which cracks grow by it, unless the scene names another."""

    @abstractmethod
    def demand(self, tip: TipState) -> float:
        """How much of what it takes is there; the tip grows from 1 on."""

    def goes_on(self, tip: TipState) -> bool:
        """Whether the tip runs though no growth is due, so that it is not arrested."""
        return False

    def moment(self, tip: TipState) -> float:
        """Return the time that counts as that of the growth now due [time]."""
        return tip.time


def value_of(expression: Expression, tip: TipState) -> float:
    """Return a value at the tip's time, length and speed.

    Raises
    ------
    SimulationError
        Where the expression is not defined.
    """
    value = float(expression(t=tip.time, length=tip.length, speed=tip.speed))
    if math.isnan(value):
        raise SimulationError(
            f"'{expression.source}' of the growth of tip '{tip.name}' is not defined at time {tip.time:.6g}, length "
            f"{tip.length:.6g} and speed {tip.speed:.6g}"
        )
    return value


def share(value: float, critical: float) -> float:
    """Return ``value`` over a critical one; a critical value of 0 or less is reached by every positive one."""
    if critical > 0.0:
        return value / critical
    return float("inf") if value > 0.0 else 0.0
