"""Uplift by water at rest in the pores of the ground."""

from typing import Annotated, Any, Literal

import numpy as np

from mpmcli.boundary.base import LOADS, Array
from mpmcli.boundary.body_force import LoadOnBodies
from mpmcli.boundary.velocity import check_variables, evaluate
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Density, Varying

LevelField = Annotated[Expression, Varying("length")]


@LOADS.register
class Buoyancy(LoadOnBodies):
    """Lifts what is below a water table: −ρ_w g per current volume, the gradient of the pressure of water at rest.

    The stress of the material is then the effective one, and ``geostatic`` stress that of the buoyant weight. Gravity
    along one axis of the grid is needed, a load of kind ``gravity``. A particle that the water table cuts is lifted in
    proportion to the part of its domain below.
    """

    kind: Literal["buoyancy"] = "buoyancy"
    """Kind of load."""
    level: LevelField
    """Coordinate of the water table along gravity, a number or an expression of the other coordinates and t."""
    density: Density
    """Mass density ρ_w of the water."""

    def water_at(self, points: Array, time: float) -> tuple[Any, float]:
        """Return the coordinate of the water table along gravity at points (d, n), and the density of the water."""
        return evaluate(self.level, points, time), self.density

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        return check_variables("level", self.level, dimensions)


def lift(level: Any, density: float, gravity: Array, particles: Any, rows: Any) -> tuple[int, Array]:
    """Return the axis of gravity, and the force per mass along it (n,) by which water lifts particles [acceleration].

    ``level`` is the coordinate of the water table, a number or (n,); ``gravity`` (d,) the acceleration; ``rows`` the
    places in memory of the particles.
    """
    axis = int(np.argmax(np.abs(gravity)))
    volume = (particles.vol0 * particles.determinant())[rows]
    below = (level - particles.X[axis, rows]) * -np.sign(gravity[axis])
    share = np.clip(0.5 + 0.5 * below / particles.size[axis, rows], 0.0, 1.0)
    return axis, -density * gravity[axis] * share * volume / particles.mass[rows]
