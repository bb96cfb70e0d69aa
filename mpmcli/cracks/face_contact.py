"""Contact of the faces of cracks: where in the step it acts, and its account."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcli.contact.contact_impulses import ContactImpulses, Ways, keeps_start_impulses
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.state import CracksView
from mpmcli.core.step import Step
from mpmcli.core.variants import StrainUpdate
from mpmcli.cracks.face_contacts import FaceContacts
from mpmcli.cracks.face_geometry import Separations
from mpmcli.cracks.face_impulses import Pairs, close, meet, pairs_of
from mpmcli.cracks.sides import CrackSides
from mpmcli.interfaces.jump import HIGHEST_AT_INTERFACE

Array = np.ndarray


NOTHING = np.zeros(0)


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
        self._springs = np.array([model.is_interface for model in models])
        self._alike = len(models) == 1 and not (models[0].is_interface or models[0].skipped)
        self._gathered = pairs_of(self.contacts.fields, self.contacts.geometry, self.contacts.rows)
        work.setdefault("contact_work", 0.0)
        if self._springs.any():
            from mpmcli.cracks.face_interfaces import FaceInterfaces

            self.interfaces = FaceInterfaces(models, self.contacts, grid, work, update, view)

    def find(self, step: Step) -> int:
        """Find the pairs of sides in contact."""
        order = step.plan.order if step.plan.has_full_mass_loop else 1
        count = self.contacts.find(self._particles.F, order > HIGHEST_AT_INTERFACE)
        if self.interfaces is not None and count > 0:
            self.interfaces.find()
        return count

    @property
    def _pairs(self) -> Pairs:
        c = self.contacts
        if self._gathered.alpha is not c.fields.alpha:
            self._gathered = pairs_of(c.fields, c.geometry, c.rows)
        return self._gathered

    def _satisfy_start(self, step: Step) -> None:
        if not self._alike or self.contacts.has_pairs:
            super()._satisfy_start(step)
            return
        self._meet(step, first=True)

    def after_update(self, step: Step) -> None:
        """Task 3.a: p⁺ += Δp⁽²⁾, which is also a force."""
        if self.contacts.count == 0:
            return
        if not self._alike or self.contacts.has_pairs:
            super().after_update(step)
            return
        self._meet(step, first=False)
        if step.plan.imposes_lumped:
            self._conditions.impose_on_momenta(step)

    def _meet(self, step: Step, first: bool) -> None:
        keeps_start = keeps_start_impulses(step.plan)
        mp, f = self._grid.mp, self._grid.f
        meet(self._parameters[0], self.contacts.count, first, keeps_start, step.dt, self._pairs, mp, f)

    def rehearse(self) -> None:
        """Call what acts only where cracks meet, or only where they do not."""
        c, grid = self.contacts, self._grid
        if not self._alike or c.count == 0:
            return
        meet(self._parameters[0], 0, True, True, 1.0, self._pairs, grid.mp, grid.f)
        if grid.sides > 2:
            c.has_pairs = True
            with np.errstate(all="ignore"):
                self._correct_momenta(1.0, after_forces=False, advance=0.0)
            self._start_increments()
            self._find_slip(None, c.rows.slip)

    def account(self, step: Step, v: Array) -> None:
        """Sum up forces and friction work of the step."""
        c, view = self.contacts, self._view
        view.interface_energy[:] = 0.0  # to which tractions on points add theirs
        if c.count == 0:
            view.force[:] = 0.0
            return
        weight = NOTHING if self._mirror is None else self._mirror.share_of(c.fields.alpha[: c.count])
        self._work["contact_work"] += close(
            c.count, self._pairs, c.faces.crack, c.fields.law, self._springs, keeps_start_impulses(step.plan), weight,
            step.dt, self._grid.mp, v, c.rows.friction, view.force,
        )  # fmt: skip
        if self.interfaces is not None:
            shares = weight if len(weight) else np.ones(c.count)
            self.interfaces.close(c.rows.prior, shares, step.dt)
