"""What a scene needs, decided once: which parts of the step exist, which arrays they work on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from mpmcli.core.analysis import ANALYSES, Analysis
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.transfer.full_mass import OrderRule
from mpmcli.core.transfer.nodal_field import NodalField
from mpmcli.core.variants import (
    STRAIN_UPDATES,
    TRANSFER_METHODS,
    StrainUpdate,
    TransferMethod,
    increment_factor,
)
from mpmcli.scene.archive import shows, tables_show
from mpmcli.scene.fields import law_table, velocity_fields
from mpmcli.scene.heat import Heat
from mpmcli.shapes import SHAPES, ShapeEntry

Array = np.ndarray

PARALLEL_FROM = 4000
"""Particles from which parallel kernels pay for their launch."""


@dataclass(frozen=True)
class Plan:
    """The choices that a scene makes, as the step reads them.

    Attributes
    ----------
    analysis_name, analysis : kind of analysis, as a word and as the tuple that selects compiled code
    shape : shape function
    update, method : rows of data, see ``core.variants``
    order : k of FMPM(k), m of XPIC(m), 1 in FLIP
    alpha : of the position update
    velocity_conditions : how conditions enter the FMPM loop
    damping : the scene's words about damping
    viscosity : (linear, quadratic) coefficients of artificial viscosity, or None
    adiabatic : work heats the materials
    has_temperature : particles have a temperature beside the one that histories have
    has_conditions, has_loads : the scene has some
    heat : what the scene chooses about conduction, or None
    fields : names of the velocity fields
    field_of_body : field of each body
    rigid_fields : for each field, whether it belongs to a rigid body
    has_contact : fields meet by a contact law
    slides : some fields that meet, or faces of cracks, are not bonded for good
    sides : sides that a node may have: 1 without cracks, 2 with one, 4 with more
    every_courant, every_steps : period of the steps that take the transfer as asked, FLIP between; None: all
    blend : (order m, fraction α) of blended FMPM, or None
    dynamic : (metric, tolerance) that ends the FMPM loop early, or None
    velocity_gradient : extrapolated velocities carry their gradient
    shows_displacement : displacements of particles are written
    corrects_filter : the filter of XPIC knows what contact corrects
    averages_volume : rates of volume and pressures are averaged over nodes
    linear_increments : dF = I + L Δt, not its exponential
    """

    analysis_name: str
    analysis: Analysis
    shape: ShapeEntry
    update: StrainUpdate
    method: TransferMethod
    order: int
    alpha: float
    velocity_conditions: str
    damping: Any
    viscosity: tuple[float, float] | None
    adiabatic: bool
    has_temperature: bool
    has_conditions: bool
    has_loads: bool
    heat: Heat | None
    fields: list[str]
    field_of_body: list[int]
    rigid_fields: tuple[bool, ...]
    has_contact: bool
    slides: bool
    sides: int
    corrects_filter: bool
    every_courant: float | None
    every_steps: int | None
    blend: tuple[int, float] | None
    dynamic: tuple[str, float] | None
    velocity_gradient: bool
    shows_displacement: bool
    averages_volume: bool
    linear_increments: bool

    @property
    def has_final_stress(self) -> bool:
        """The particles' stresses at the start of the step are those that its forces come from."""
        return self.update.first == 0.0 and not self.averages_volume

    @property
    def keeps_positions(self) -> bool:
        """Stencils need the positions of the start of the step after the particles have moved."""
        return self.update.again or self.averages_volume

    @property
    def is_periodic(self) -> bool:
        """Some steps are FLIP's."""
        return self.every_courant is not None or self.every_steps is not None

    def of_flip(self) -> Plan:
        """The plan of the steps between those of a periodic transfer."""
        return replace(self, method=TRANSFER_METHODS["flip"], order=1)

    @property
    def stores_weights(self) -> bool:
        """Weights of nodes are found once and kept where several passes of full-mass loops read them."""
        of_velocity = 0 if self.velocity_gradient else self.order - 1
        of_heat = 0 if self.heat is None else self.heat.transfer.order - 1
        return of_velocity + of_heat > 1

    @property
    def order_rule(self) -> OrderRule:
        """How many increments the full-mass loop adds."""
        return OrderRule(self.order, partial(increment_factor, self.blend), self.dynamic)

    @property
    def imposes_lumped(self) -> bool:
        """Conditions act on the lumped momenta (task 2.a)."""
        return self.has_conditions and (not self.has_full_mass_loop or self.velocity_conditions != "velocity")

    @property
    def zeroes_increments(self) -> bool:
        """Conditions act on every FMPM increment."""
        return self.has_conditions and self.has_full_mass_loop and self.velocity_conditions == "incremental"

    @property
    def imposes_velocity(self) -> bool:
        """Conditions act on the final velocity v⁺(k) (older methods, for comparison)."""
        return (
            self.has_conditions
            and self.has_full_mass_loop
            and self.velocity_conditions in ("velocity", "combined")
        )

    @property
    def has_full_mass_loop(self) -> bool:
        """Grid velocities take the FMPM loop (order 1 is the lumped velocity itself)."""
        return self.method.full_mass and self.order > 1

    @property
    def keeps_start_momenta(self) -> bool:
        """The momenta of the start of the step are needed later in it."""
        return self.method.projects


def make_plan(scene: Any) -> Plan:
    """Read the choices of a checked scene."""
    method, transfer = scene.method, scene.method.transfer
    viscosity = method.artificial_viscosity
    blend, dynamic = getattr(transfer, "blend", None), getattr(transfer, "dynamic", None)
    fields, field_of_body = velocity_fields(scene)
    rigid_fields = [False] * len(fields)
    for body, field in zip(scene.bodies, field_of_body, strict=True):
        rigid_fields[field] |= scene.materials[body.material].kind == "rigid"
    has_contact = scene.contact is not None and len(fields) > 1
    axis_condition = scene.analysis.kind == "axisymmetric" and scene.grid.lower[0] == 0.0
    return Plan(
        analysis_name=scene.analysis.kind,
        analysis=ANALYSES[scene.analysis.kind](),
        shape=SHAPES[method.shape],
        update=STRAIN_UPDATES[method.update],
        method=TRANSFER_METHODS[transfer.kind],
        order=getattr(transfer, "order", 1),
        alpha=float(transfer.alpha),
        velocity_conditions=method.velocity_conditions,
        damping=method.damping,
        viscosity=None if viscosity is None else (float(viscosity.linear), float(viscosity.quadratic)),
        adiabatic=scene.is_adiabatic,
        has_temperature=scene.has_temperature,
        has_conditions=bool(scene.conditions_on("velocity")) or axis_condition,
        has_loads=bool(scene.loads_on("velocity")),
        heat=scene.heat,
        fields=fields,
        field_of_body=field_of_body,
        rigid_fields=tuple(rigid_fields),
        has_contact=has_contact,
        slides=_slides(scene, fields),
        sides=(1, 2)[len(scene.cracks)] if len(scene.cracks) < 2 else 4,
        corrects_filter=(has_contact or bool(scene.cracks))
        and getattr(transfer, "contact_correction", False),
        every_courant=getattr(transfer, "every_courant", None),
        every_steps=getattr(transfer, "every_steps", None),
        blend=None if blend is None else (blend.order, float(blend.fraction)),
        dynamic=None if dynamic is None else (dynamic.metric, float(dynamic.tolerance)),
        velocity_gradient=transfer.velocity_gradient,
        shows_displacement=shows(scene.archive, scene.probes, "displacement")
        or tables_show(scene, "displacement"),
        averages_volume=method.volumetric == "averaged",
        linear_increments=method.deformation_increment == "linear",
    )


def _slides(scene: Any, fields: list[str]) -> bool:
    """Whether some fields that meet, or faces of cracks, are not bonded for good."""
    laws, table = law_table(scene, fields) if len(fields) > 1 else ([], np.zeros(0))
    acting = [laws[i] for i in {int(i) for i in table.ravel() if i >= 0}] + [
        crack.faces.law for crack in scene.cracks
    ]
    return any(not law.bonds for law in acting)


@dataclass
class StepArrays:
    """Work arrays of the step; what the plan does not need is None.

    Attributes
    ----------
    v : (n, d) grid velocities, those of the nodal field
    start : (n, d) velocities v⁺ − a Δt, contact included, that move positions of XPIC where bodies touch
    w : (n, d) accelerations (FLIP) or projected velocities (XPIC)
    p_start, p_again : (n, d) momenta at the start of the step; momenta extrapolated again
    X_new : (d, N) positions after the step, while stencils still need the old ones
    """

    v: Array
    w: Any
    start: Any
    p_start: Any
    p_again: Any
    X_new: Any

    def nodal(self) -> dict[str, Array]:
        """Return the arrays over all nodes by name."""
        names = ("v", "start", "w", "p_start", "p_again")
        return {name: array for name in names if (array := getattr(self, name)) is not None}


def make_velocity(plan: Plan, grid: Grid, particles: Particles) -> NodalField:
    """Make the nodal field of momentum, with the arrays that the plan needs."""
    p = particles
    v, gradient = np.zeros(grid.f.shape), (lambda: p.L) if plan.velocity_gradient else None
    velocity = NodalField(
        "velocity", (0.0,) * grid.dimensions, grid, lambda: p.mass, lambda: p.V, grid.mp, grid.f, v, gradient
    )
    if plan.has_full_mass_loop or plan.method.projects:
        velocity.allocate_loop(is_dynamic=plan.dynamic is not None)
    return velocity


def allocate_step_arrays(plan: Plan, velocity: NodalField, particles: int) -> StepArrays:
    """Allocate what the plan needs and nothing else."""
    n, d = velocity.v.shape

    def nodal(wanted: bool) -> Array | None:
        return np.zeros((n, d)) if wanted else None

    return StepArrays(
        v=velocity.v,
        w=nodal(not plan.method.full_mass or plan.is_periodic),
        start=nodal(plan.method.projects and plan.slides),
        p_start=nodal(plan.keeps_start_momenta),
        p_again=nodal(plan.update.again),
        X_new=np.zeros((d, particles)) if plan.keeps_positions else None,
    )
