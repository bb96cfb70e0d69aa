"""Contact of the faces of cracks: where in the step it acts, and its account."""

from typing import Any

import numpy as np

from mpmcli.contact import impulses
from mpmcli.contact.contact_impulses import ContactImpulses, Ways, keeps_start_impulses
from mpmcli.contact.fields_in_contact import NodeTable
from mpmcli.contact.impulses import Place
from mpmcli.contact.laws.impulse import slip_work
from mpmcli.core.compiled.kernel import called_once
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.state import CracksView
from mpmcli.core.step import Step
from mpmcli.core.variants import StrainUpdate
from mpmcli.cracks.face_contacts import FaceContacts, tables_in
from mpmcli.cracks.face_geometry import Separations
from mpmcli.cracks.sides import CrackSides

Array = np.ndarray

find_impulses, add_to_momenta, start_increments, find_slip = (
    each.versions[False]
    for each in (
        impulses.find_impulses,
        impulses.add_to_momenta,
        impulses.start_increments,
        impulses.find_slip,
    )
)
EARLY, LATE, NEVER = 0, 1, 2
"""When ``correct_at_once`` finds how fast faces slip: before the correction, after it, or not."""


@called_once
def correct_at_once(law, axes, count, blocks, first, dof, rigid, node_count, mp, f, dt, after_forces, slips):
    """What ``ContactImpulses`` does at a place in the step, where all contacts have one law and a node has one of them.

    One call for all of it: there are few contacts, and handing them over takes longer than the work. Where ``slips`` is
    not ``NEVER``, momenta are those extrapolated first, whose impulses ``rows.start`` keeps.
    """
    fields, _, geometry, rows = tables_in(blocks)
    nodes = NodeTable(first, first, dof, blocks.numbers[0], rigid, node_count)
    advance = dt if after_forces else 0.0
    here = Place(0, after_forces, False, False, False, False, False, after_forces, dt, advance)
    if slips == EARLY:
        find_slip(axes, count, fields, nodes, mp, f, False, rows.slip)
    find_impulses(law, axes, 0, count, fields, nodes, geometry, rows, here, mp, f, f)
    add_to_momenta(axes, count, fields, rows.dp, here, mp, f)
    start_increments(axes, count, False, rows.dp0, rows.dp, rows.prior, rows.net)
    if slips != NEVER:
        for k in range(count):
            for a in range(len(axes)):
                rows.start[k, a] = rows.dp[k, a]
    if slips == LATE:
        find_slip(axes, count, fields, nodes, mp, f, False, rows.slip)


@called_once
def close_step(
    axes, count, blocks, first, dof, rigid, node_count, mp, v, dt, keeps_start, weight, smooth, force
):
    """Complete ``rows.net`` and sum up a step: writes the forces on the matter above into ``force`` (cracks, 2).

    Returns the friction work. ``rows.prior`` receives the relative velocities that the impulses leave, ``weight`` (k,)
    are shares of real particles, ``smooth`` (laws,) laws without friction. ``rows.start`` is part of the impulses if
    the step ``keeps_start``; see ``ContactImpulses``.
    """
    fields, faces, geometry, rows = tables_in(blocks)
    nodes = NodeTable(first, first, dof, blocks.numbers[0], rigid, node_count)
    work = 0.0
    for crack in range(force.shape[0]):
        for a in range(len(axes)):
            force[crack, a] = 0.0
    find_slip(axes, count, fields, nodes, mp, v, True, rows.prior)
    for k in range(count):
        if keeps_start:
            for a in range(len(axes)):
                rows.net[k, a] += rows.start[k, a]
        rows.friction[k] = 0.0
        if not smooth[fields.law[k]]:
            rows.friction[k] = slip_work(axes, geometry.normal[k], rows.net[k], rows.slip[k], rows.prior[k])
        work += weight[k] * rows.friction[k]
        for a in range(len(axes)):
            force[faces.crack[k], a] -= weight[k] * rows.net[k, a]
    for crack in range(force.shape[0]):
        for a in range(len(axes)):
            force[crack, a] /= dt
    return work


class FaceContact(ContactImpulses):
    """Contact of the faces of all cracks.

    Parameters
    ----------
    laws : of the cracks, one each
    separations : how the distance of the faces of each crack is found
    sides : of the step
    rigid : (fields,) whether a field belongs to a rigid body
    grid, particles, conditions, mirror, work : of the simulation
    update : strain update of the step
    ring : the analysis is axisymmetric
    view : what output sees
    """

    def __init__(
        self, laws: list[Any], separations: Separations, sides: CrackSides, rigid: Array, grid: Grid,
        particles: Particles, conditions: Any, mirror: Any, work: dict[str, float], update: StrainUpdate, ring: bool,
        view: CracksView,
    ):  # fmt: skip
        models: list[Any] = []
        for law in laws:
            if law not in models:
                models.append(law)
        of_crack = np.array([models.index(law) for law in laws])
        self.contacts = FaceContacts(sides, of_crack, models, separations, rigid, grid, particles, ring)
        super().__init__(self.contacts, models, range(len(models)), Ways(), grid, conditions)
        self._particles, self._mirror, self._work = particles, mirror, work
        self._view = view
        self._smooth = np.array([model.is_interface or model.bonds for model in models])
        self._alone = len(models) == 1 and not (models[0].is_interface or models[0].skipped)
        work.setdefault("contact_work", 0.0)
        if any(model.is_interface for model in models):
            from mpmcli.cracks.face_interfaces import FaceInterfaces

            self.interfaces = FaceInterfaces(models, self.contacts, grid, work, update, view)

    def find(self, step: Step) -> int:
        """Return how many pairs of sides are in contact, which ``after_extrapolation`` has found."""
        return self.contacts.count

    def after_extrapolation(self, step: Step) -> None:
        """Task 1.a: find the pairs of sides in contact, and let the extrapolated momenta satisfy them."""
        self._forces_known = self._springs_act = False
        to_node = self.interfaces is not None and self.interfaces.act_at_node(step.plan)
        count = self.contacts.find(self._particles.F, to_node)
        if count > 0 and self._acts_at_once:
            self._correct_at_once(step.dt, False, EARLY if keeps_start_impulses(step.plan) else LATE)
            return
        if self.interfaces is not None and count > 0:
            self.interfaces.find()
        super().after_extrapolation(step)

    def after_update(self, step: Step) -> None:
        """Task 3.a: let the updated momenta satisfy contact."""
        self._forces_known = self._springs_act = True
        if not self._acts_at_once:
            super().after_update(step)
        elif self.contacts.count > 0:
            self._correct_at_once(step.dt, True, NEVER)
            if step.plan.imposes_lumped:
                self._conditions.impose_on_momenta(step)

    @property
    def _acts_at_once(self) -> bool:
        return self._alone and not self.contacts.has_pairs

    def _correct_at_once(self, dt: float, after_forces: bool, slips: int) -> None:
        c, grid = self.contacts, self._grid
        self._call(
            correct_at_once, self._parameters[0], self._axes, c.count, c.blocks, c.first, c.dof, c.rigid,
            grid.node_count, grid.mp, grid.f, dt, after_forces, slips,
        )  # fmt: skip

    def rehearse(self) -> None:
        """Call what acts only where cracks meet, or several bodies on one side."""
        c = self.contacts
        if c.count > 0 and (self._grid.sides > 2 or self._grid.fields > 1):
            c.has_pairs = True
            with np.errstate(all="ignore"):
                self._correct_momenta(1.0, after_forces=False, advance=0.0)
                self._start_increments()
                self._find_slip(None, c.rows.slip)

    def account(self, step: Step, v: Array) -> None:
        """Sum up forces and friction work of the step."""
        c, view = self.contacts, self._view
        view.interface_energy.fill(0.0)  # to which tractions on points add theirs
        if c.count == 0:
            view.force.fill(0.0)
            return
        mirror = self._mirror
        weight = c.whole if mirror is None else mirror.share_of(c.fields.alpha[: c.count])
        self._work["contact_work"] += self._call(
            close_step, self._axes, c.count, c.blocks, c.first, c.dof, c.rigid, self._grid.node_count, self._grid.mp,
            v, step.dt, keeps_start_impulses(step.plan), weight, self._smooth, view.force,
        )  # fmt: skip
        if self.interfaces is not None:
            self.interfaces.close(c.rows.prior, weight[: c.count], step.dt)
