"""Springs of interfaces: how stiff they are at a node on the interface, where each side has half a cell."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from mpmcli.scene.fields import owners_of_fields, velocity_fields
from mpmcli.scene.interface_checks import Joint, joints_of
from mpmcli.scene.own_density import lightest_density

DIRECTIONS = ("normal", "tangential")
LARGEST_PHI = 1.0
"""φ up to which springs that oscillate within the step are stable."""


@dataclass(frozen=True)
class Spring:
    """One direction of an interface.

    Attributes
    ----------
    joint : its fields and law
    direction : ``normal`` or ``tangential``
    stiffness : largest slope D of its traction [pressure/length]
    mass : reduced mass per area m_red/A [mass/area]
    density : the lower one of both sides [density]
    """

    joint: Joint
    direction: str
    stiffness: float
    mass: float
    density: float

    def phi(self, dt: float) -> float:
        """φ = Δt √(D A/m_red) [-]."""
        return dt * math.sqrt(self.stiffness / self.mass)

    def longest_step(self) -> float:
        """Time step at which φ is 1 (Nairn 2023, Eq. 5.35) [time]."""
        return math.sqrt(self.mass / self.stiffness)

    def speed(self, cell: float) -> float:
        """v_int = √(D Δx/ρ) (Nairn 2023, Eq. 5.37) [velocity]."""
        return math.sqrt(self.stiffness * cell / self.density)

    def largest_stiffness(self, dt: float) -> float:
        """Stiffness at which φ is 1 (as Nairn 2023, Eq. 5.38) [pressure/length]."""
        return self.mass / dt**2


def springs_of(scene: Any) -> Iterator[Spring]:
    """Every direction of every interface of a checked scene that is a spring."""
    if scene.contact is None:
        return
    names, field_of_body = velocity_fields(scene)
    densities: dict[str, list[float]] = {name: [] for name in names}
    for body, field in zip(scene.bodies, field_of_body, strict=True):
        model = scene.materials[body.material]
        if model.kind != "rigid":
            densities[names[field]].append(lightest_density(body, model))
    cell = float(min(scene.grid.cell))
    for joint in joints_of(scene.contact, names, owners_of_fields(scene)):
        sides = [min(each) for each in (densities[joint.first], densities[joint.second]) if each]
        if not sides:
            continue
        mass = 0.5 * cell / sum(1.0 / rho for rho in sides)
        for direction, slope in zip(DIRECTIONS, joint.law.slopes, strict=True):
            if slope > 0.0:
                yield Spring(joint, direction, slope, mass, min(sides))
