"""Contact of the faces of cracks: where in the step it acts, and its account."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcli.contact.contact_impulses import ContactImpulses, Ways
from mpmcli.contact.laws.impulse import slip_work
from mpmcli.core.compiled.kernel import called_once
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.state import CracksView
from mpmcli.core.step import Step
from mpmcli.core.variants import StrainUpdate
from mpmcli.cracks.face_contacts import FaceContacts
from mpmcli.cracks.face_geometry import Separations
from mpmcli.cracks.sides import CrackSides

Array = np.ndarray


@called_once
def tally(axes, count, fields, faces, geometry, rows, after, weight, springs, force):
    """Sum up a step: adds the impulses on the matter above to ``force`` (cracks, 2), and returns the friction work.

    ``after`` (k, 2) are the relative velocities that the impulses leave, ``weight`` (k,) shares of real particles,
    ``springs`` (laws,) laws without friction.
    """
    work = 0.0
    for k in range(count):
        rows.friction[k] = 0.0
        if not springs[fields.law[k]]:
            rows.friction[k] = slip_work(axes, geometry.normal[k], rows.net[k], rows.slip[k], after[k])
        work += weight[k] * rows.friction[k]
        for a in range(len(axes)):
            force[faces.crack[k], a] -= weight[k] * rows.net[k, a]
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
        self._springs = np.array([model.is_interface for model in models])
        work.setdefault("contact_work", 0.0)
        if self._springs.any():
            from mpmcli.cracks.face_interfaces import FaceInterfaces

            self.interfaces = FaceInterfaces(models, self.contacts, grid, work, update, view)

    def find(self, step: Step) -> int:
        """Find the pairs of sides in contact."""
        to_node = self.interfaces is not None and self.interfaces.act_at_node(step.plan)
        count = self.contacts.find(self._particles.F, to_node)
        if self.interfaces is not None and count > 0:
            self.interfaces.find()
        return count

    def rehearse(self) -> None:
        """Call what acts only where cracks meet."""
        c = self.contacts
        if c.count > 0 and self._grid.sides > 2:
            c.has_pairs = True
            with np.errstate(all="ignore"):
                self._correct_momenta(1.0, after_forces=False, advance=0.0)

    def account(self, step: Step, v: Array) -> None:
        """Sum up forces and friction work of the step."""
        c, view = self.contacts, self._view
        view.force[:] = 0.0
        view.interface_energy[:] = 0.0  # to which tractions on points add theirs
        if c.count == 0:
            return
        after = self._close_impulses(step, v)
        alpha = c.fields.alpha[: c.count]
        weight = np.ones(c.count) if self._mirror is None else self._mirror.share_of(alpha)
        self._work["contact_work"] += tally(
            self._axes,
            c.count,
            c.fields,
            c.faces,
            c.geometry,
            c.rows,
            after,
            weight,
            self._springs,
            view.force,
        )
        if self.interfaces is not None:
            self.interfaces.close(after, weight, step.dt)
        view.force /= step.dt
