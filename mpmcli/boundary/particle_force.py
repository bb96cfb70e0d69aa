"""A force shared by particles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np
from pydantic import model_validator

from mpmcli.boundary.base import LOADS, Array, LoadModel, Values, check_length
from mpmcli.boundary.place import Box, Region, check_space, inside
from mpmcli.boundary.velocity import check_variables, evaluate
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Model, Varying

ForceField = Annotated[Expression, Varying("force")]


class Target(Model):
    """Particles of a body, in a box or in a region; with more than one, those that are in all of them."""

    body: str | None = None
    """Name of the body."""
    box: Box | None = None
    """Particles that are in this box at the start of the simulation."""
    region: Region = None
    """Particles that are in this region at the start of the simulation."""

    @model_validator(mode="after")
    def _some_place(self) -> Target:
        if self.body is None and self.box is None and self.region is None:
            raise ValueError("give body, box or region")
        return self


@LOADS.register
class ParticleForce(LoadModel):
    """Pushes particles with a force: one total shared in proportion to mass, or the same on each."""

    kind: Literal["particle_force"] = "particle_force"
    """Kind of load."""
    on: Target
    """Which particles."""
    force: tuple[ForceField, ...]
    """Force, one number or expression of t per axis (axisymmetric: on the full ring); per particle also of x, y, z.

    These are the current position of the particle.
    """
    per: Literal["total", "particle"] = "total"
    """Whether the force is the total, shared in proportion to mass, or that on each particle."""

    @property
    def varies(self) -> bool:
        """Whether it depends on time, or on the current position."""
        return not all(component.is_constant for component in self.force)

    @property
    def shares_force(self) -> bool:
        """Whether the force is the total."""
        return self.per == "total"

    def chosen(self, points: Array, is_of: Callable[[str], Array]) -> Array:
        """Return which particles are of the body, in the box and in the region."""
        on = self.on
        found = np.ones(points.shape[1], dtype=bool)
        if on.body is not None:
            found &= is_of(on.body)
        if on.box is not None:
            found &= inside(on.box, None, points)
        if on.region is not None:
            found &= inside(None, on.region, points)
        return found

    def force_at(self, points: Array, time: float) -> Values:
        """Return the force."""
        return [evaluate(component, points, time) for component in self.force]

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        found = check_length("force", self.force, dimensions)
        for a, component in enumerate(self.force):
            found += check_variables(f"force.{a}", component, dimensions)
            if self.shares_force and component.variables - {"t"}:
                words = "a total cannot depend on the place; give 'per: particle'"
                found.append((f"force.{a}", words))
        return found + check_space("on", self.on.box, self.on.region, dimensions)
