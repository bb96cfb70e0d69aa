"""Springs across interfaces and cracks: how stiff they are where each side has half a cell, and the steps they need.

φ² = D A Δt²/m_red at a node on an interface, by direction: m_red/A = ½ Δx ρ_α ρ_β/(ρ_α + ρ_β), ρΔx/4 for equal sides.
With ``step: implicit`` no φ is too large; ``step: oscillator`` needs φ < 1 (Nairn 2023, Eq. 5.35). Tractions on the
points of cracks are those of the start of a step, and need Δt < 0.75 √(ρ Δx/k), with k their initial slope. FMPM(k)
moves fast motion with less mass: 1/k of that was found to be stable for orders 2, 4 and 6 at two positions within a
cell, twice as much never was.

The jump of ``jump: extrapolated`` contains the strain of 0.375 cells of each side (two particles per cell): its
interface has the compliance 1/D − Σ 0.375 Δx/M. Where that is negative, runs may be unstable at any time step.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from mpmcli.core.errors import Problem
from mpmcli.scene.fields import field_name, owners_of_fields, velocity_fields
from mpmcli.scene.interface_checks import joints_of
from mpmcli.scene.own_numbers import lightest_density
from mpmcli.stability.bodies import deformable

DIRECTIONS = ("normal", "tangential")
SHARE = 0.75
"""Longest time step of tractions on points over √(ρ Δx/k); with FMPM of some order over that by the order."""
WITHIN = 0.375
"""Cells by which the matter at an edge, extrapolated to nodes, is inside it: two particles per cell."""


@dataclass(frozen=True)
class Spring:
    """One direction of an interface, or a traction on the points of a crack.

    Attributes
    ----------
    path : of the law in the scene
    because : what it is when it limits the time step, in words
    stiffness : largest slope D of the traction [pressure/length]
    mass : reduced mass per area m_red/A that it moves [mass/area]
    density : the lower one of both sides [density]
    direction : ``normal`` or ``tangential``; empty for cracks
    joint : fields and law of an interface
    sides : its deformable bodies and their materials, on either side
    """

    path: str
    because: str
    stiffness: float
    mass: float
    density: float
    direction: str = ""
    joint: Any = None
    sides: Sequence[list[tuple[Any, Any]]] = ()

    @property
    def longest_step(self) -> float:
        """Time step at which φ is 1 (Nairn 2023, Eq. 5.35) [time]."""
        return math.sqrt(self.mass / self.stiffness)


def springs_of(scene: Any) -> Iterator[Spring]:
    """Yield every direction of every interface of a checked scene that is a spring."""
    if scene.contact is None:
        return
    members: dict[str, list[tuple[Any, Any]]] = {name: [] for name in velocity_fields(scene)[0]}
    for body, model in deformable(scene):
        members[field_name(scene, body)].append((body, model))
    for joint in joints_of(scene.contact, list(members), owners_of_fields(scene)):
        sides = [side for name in (joint.first, joint.second) if (side := members[name])]
        densities = [min(lightest_density(*each) for each in side) for side in sides]
        for direction, slope in zip(DIRECTIONS, joint.law.slopes, strict=True):
            if sides and slope > 0.0:
                mass = 0.5 * float(min(scene.grid.cell)) / sum(1.0 / rho for rho in densities)
                because = (
                    f"the interface of '{joint.first}' and '{joint.second}' is stiff for step 'oscillator'"
                )
                yield Spring(
                    f"{joint.path}.law", because, slope, mass, min(densities), direction, joint, sides
                )


def tractions_of(scene: Any) -> Iterator[Spring]:
    """Yield the tractions on the points of all cracks of a checked scene."""
    transfer = scene.method.transfer
    share = SHARE / (transfer.order if transfer.kind == "fmpm" else 1)
    for crack in scene.cracks:
        densities = [
            lightest_density(body, material)
            for body, material in deformable(scene)
            if crack.cuts is None or body.name in crack.cuts
        ]
        for key, law in crack.laws_of_points():
            if densities and (slope := max(law.slopes)) > 0.0:
                density, because = min(densities), f"the tractions of crack '{crack.name}' are stiff"
                mass = share**2 * density * float(min(scene.grid.cell))
                yield Spring(f"cracks.{crack.name}.{key}", because, slope, mass, density)


def warnings_of_interfaces(scene: Any) -> list[Problem]:
    """Warn of springs that are stiffer than the matter that their extrapolated jump contains; once per law."""
    found: dict[str, Problem] = {}
    if scene.contact is None or scene.contact.interface.jump != "extrapolated":
        return []
    for spring in springs_of(scene):
        moduli = [[_modulus(model, spring.direction) for _, model in side] for side in spring.sides]
        compliance = sum(WITHIN * min(scene.grid.cell) / min(each) for each in moduli)
        if spring.stiffness * compliance > 1.0:
            has_key = spring.direction in type(spring.joint.law).model_fields
            key = f"{spring.path}.{spring.direction}" if has_key else spring.path
            words = (
                f"is too stiff along the {spring.direction} for jump 'extrapolated', which contains the strain of "
                f"{WITHIN:g} cells of each side: runs may be unstable at any time step. Use jump 'gradient' (the "
                f"default), or at most {1.0 / compliance:.3g} of stiffness"
            )
            problem = Problem(key, words, code="unstable", severity="warning")
            found.setdefault(spring.path + spring.direction, problem)
    return list(found.values())


def _modulus(material: Any, direction: str) -> float:
    """Return the modulus of a strain in a direction; infinite where the material is not elastic at rest."""
    shear, lame = (float(getattr(material, name, None) or 0.0) for name in ("shear_modulus", "lame_modulus"))
    return (lame + 2.0 * shear if direction == "normal" else shear) or math.inf
