"""Contact between velocity fields: where in the step it corrects momenta (Nairn 2026, section 3.2)."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmcli.contact import overlap
from mpmcli.contact.account import ContactAccount
from mpmcli.contact.choice import ContactChoice
from mpmcli.contact.contact_impulses import ContactImpulses, Ways
from mpmcli.contact.contact_nodes import ContactNodes
from mpmcli.contact.contacts import Contacts
from mpmcli.contact.direction import DirectionWatch
from mpmcli.contact.fields_in_contact import Rules
from mpmcli.contact.geometry import Matter, Surroundings
from mpmcli.contact.near_particles import Parted
from mpmcli.core.analysis import Axisymmetric
from mpmcli.core.contacts import ContactRows
from mpmcli.core.order import CellOrder
from mpmcli.core.state import ContactView
from mpmcli.core.step import Step

Array = np.ndarray


class NodalContact(ContactImpulses):
    """The contact of a scene.

    Geometry (nodes, normals, separations, areas) is found once per step, in task 1.a, and used by all corrections of
    the step.

    Parameters
    ----------
    choice : what the scene chooses
    order : of the particles in the cells of the grid; contact gives its particles ``X0`` and ``bond`` if it needs them
    transfer : gives ``analysis``, ``shape``, and in every step ``stencil``, ``across``, ``domain_F``
    conditions : velocity conditions, or None
    mirror : the symmetry planes, or None
    rigid : the rigid bodies, or None
    work : accumulated energies by name, to which contact adds its own
    parallel : run the parallel version of kernels where it pays

    Attributes
    ----------
    parallel_from : number of contacts from which their kernels run in parallel
    view : what output sees
    """

    def __init__(
        self, choice: ContactChoice, order: CellOrder, transfer: Any, conditions: Any, mirror: Any, rigid: Any,
        work: dict[str, float], parallel: bool,
    ):  # fmt: skip
        self.choice = choice
        self._grid, self._particles, self._transfer = order.grid, order.particles, transfer
        self._mirror, self._rigid = mirror, rigid
        self._runs_parallel = parallel
        self._model = model = choice.model
        grid, particles = self._grid, self._particles
        d = grid.dimensions
        cell = tuple(float(c) for c in grid.cell)
        self._normal = model.normal.parameters(d, cell)
        self._separation = model.separation.parameters(d, cell, choice.particles_per_axis)
        is_rigid = np.array(choice.rigid_fields, dtype=bool)
        self._rules = Rules(
            law=choice.table,
            skipped=np.array([law.skipped for law in choice.laws]),
            screened=np.array([law.screened for law in choice.laws]),
            rigid=is_rigid,
            mass_ratio=model.mass_ratio,
            explicit=model.three_or_more != "lumped" or choice.has_interfaces,
            coupled=model.three_or_more == "coupled" or choice.has_interfaces,
            shares_normal=model.normal.shares_normal,
        )
        self._has_geometry = choice.knows_normals
        self._drives = np.array([law.drives_apart for law in choice.laws])
        self._ring = isinstance(transfer.analysis, Axisymmetric)
        self._nodal = choice.nodal_arrays(grid)
        self._guesses = self._nodal.get("guesses")
        self.nodes = ContactNodes(
            order, grid, self._planes(), self._nodal["slot_of_node"], choice.whole_fields
        )
        self.contacts = Contacts(self.nodes, self._rules, grid.node_count, d)
        ways = Ways(model.increments, model.once, model.displacement_only, self._rules.coupled)
        super().__init__(self.contacts, choice.laws, choice.used, ways, grid, conditions)
        self._removes_overlap = model.overlap_removal > 0.0 and self._has_geometry
        self._around = Surroundings(
            shape=np.array(grid.shape, dtype=np.int64),
            origin=grid.lower - grid.pad * grid.cell,
            cell=grid.cell,
            planes=self.nodes.images.line,
            shift=self.nodes.images.shift,
            pad=grid.pad,
            period=np.array([grid.cells[a] if a in grid.periodic else 0 for a in range(d)], dtype=np.int64),
            thickness=choice.thickness,
            ring=self._ring,
        )
        for name, array in choice.particle_arrays(particles).items():
            setattr(particles, name, array)
        self._direction = None
        if model.normal.is_given and self._has_geometry:
            self._direction = DirectionWatch(self.contacts, choice.fields, grid.node_count)
        many = parallel and particles.count >= PARTICLES_PER_CONTACT * PARALLEL_CONTACTS
        self.parallel_from = PARALLEL_CONTACTS if many else math.inf
        self._rigid_dof = np.zeros(0, dtype=np.int64)
        self._account = ContactAccount(choice, self.contacts, particles, grid, mirror, work)
        self.view: ContactView = self._account.view

    def pairs(self) -> tuple[Array, list[tuple[str, str]]]:
        """Return the number (fields, fields) of each pair of fields, and their names."""
        return self._account.pair, self.view.pairs

    def _planes(self) -> list[tuple[int, int]]:
        mirror, grid = self._mirror, self._grid
        planes: list[tuple[int, int]] = [] if mirror is None else mirror.lines()
        is_hollow = any(axis == 0 and is_lower for axis, _, is_lower in grid.mirrors)
        if self._ring and grid.lower[0] == 0.0 and not is_hollow:  # no matter reaches the axis behind a plane
            planes.append((0, grid.pad))
        return planes

    # ------------------------------------------------------------------ the places in the step

    def find(self, step: Step) -> int:
        """Find the fields in contact, and where and how they meet; returns the number of contacts."""
        c, p, mp = self.contacts, self._particles, self._grid.mp
        self._account.clear()
        if self._rigid is not None:
            self._rigid.hold(step, mp)
            self._rigid_dof = self._rigid.dofs
            self._rigid_momentum = mp[self._rigid_dof, 1:]
        if c.find_nodes() == 0:
            return 0
        if self._has_geometry:
            transfer, parallel = self._transfer, self._runs_parallel
            matter = Matter(
                p.velocity_field, p.X, transfer.domain_F, p.size, p.vol0, p.mass, p.X0, p.bond, p.outward
            )
            self.nodes.find_near(
                transfer.shape.parameters, transfer.across, transfer.stencil, p.X, matter.F, p.size, parallel,
                self._parted(),
            )  # fmt: skip
            c.sum_volumes(matter, parallel)
        c.find_fields(mp)
        if c.count == 0:
            return 0
        if self._has_geometry:
            c.find_geometry(
                self._normal, self._separation, self._around, matter, self._model.separation.needs_radius,
                self._guesses, parallel,
            )  # fmt: skip
            if self._direction is not None:
                self._direction.look(p)
        if self.interfaces is not None:
            self.interfaces.find(matter, self._around, parallel, step.plan)
        return c.count

    def _parted(self) -> Parted | None:
        """Which particles cracks part from nodes in this step."""
        cut, whole, grid = self._transfer.cut, self.choice.whole_fields, self._grid
        if cut is None or whole is None:
            return None
        side = grid.side_of(cut.dof.astype(np.int64))
        return Parted(cut.particle, side, whole[self._particles.velocity_field], grid.sides, grid.node_count)

    def after_update(self, step: Step) -> None:
        """Task 3.a: p⁺ += Δp⁽²⁾, which is also a force."""
        self._restore_rigid()
        super().after_update(step)

    def correct(self, step: Step, dv: Array, counts_reactions: bool) -> None:
        """Part (2) of an FMPM increment: contact on Δv(ℓ); conditions, whose impulses may count, have the last word."""
        if self._rigid is not None:
            dv[self._rigid.held] = 0.0
        super().correct(step, dv, counts_reactions)

    def after_new_extrapolation(self, step: Step) -> None:
        """Task 4.b: momenta extrapolated again satisfy contact; no force, no work."""
        self._restore_rigid()
        super().after_new_extrapolation(step)

    def account(self, step: Step, v: Array) -> None:
        """Sum up forces, areas and friction work of the step from the final net Δp; mark broken adhesion."""
        c = self.contacts
        after = self._close_impulses(step, v)
        bonded = None if self.interfaces is None else self.interfaces.bonded()
        self._account.close(after, step.dt, bonded)
        if self.interfaces is not None:
            self.interfaces.close(after, self._account.shares, step.dt)
        if c.count > 0 and self.choice.breaks:
            self._account.break_bonds()

    def contact_rows(self) -> ContactRows:
        """Return the contacts of this step, after it was accounted for."""
        return self._account.rows()

    # ------------------------------------------------------------------ from one step to the next

    def memory(self) -> dict[str, Any]:
        """What it remembers from step to step: accounts, and normals to begin the next search with."""
        found = self._account.memory()
        if self.interfaces is not None:
            found |= {f"interface_{name}": value for name, value in self.interfaces.memory().items()}
        if self._guesses is not None:
            found["guessed"] = np.flatnonzero(self._guesses.any(axis=1))
            found["guesses"] = self._guesses[found["guessed"]]
        return found

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._account.recall(memory)
        if self.interfaces is not None:
            mine = {n.removeprefix("interface_"): v for n, v in memory.items() if n.startswith("interface_")}
            self.interfaces.recall(mine)
        if self._guesses is not None:
            self._guesses[memory["guessed"]] = memory["guesses"]

    def nodal_arrays(self) -> dict[str, Array]:
        """Return its arrays over all nodes, by name."""
        return self._nodal

    def nodal_fields(self) -> dict[str, Callable[[], Array]]:
        """Normal, separation and traction of contacts on nodes."""
        found = self._account.nodal_fields()
        return (
            found if self.interfaces is None else found | self.interfaces.nodal_fields(self._account.on_nodes)
        )

    # ------------------------------------------------------------------ parts

    @property
    def _parallel(self) -> bool:
        return self.contacts.count >= self.parallel_from

    def _find_drive(self, dt: float) -> None:
        """Find the impulses that take overlap back, where there are any."""
        c = self.contacts
        if self._removes_overlap:
            overlap.find_drive[self._parallel](
                self._axes, c.count, c.fields, c.table, self._around, self._drives,
                float(self._model.overlap_removal), c.geometry.normal, self._grid.mp, dt, c.rows.drive,
            )  # fmt: skip

    def _restore_rigid(self) -> None:
        if len(self._rigid_dof):
            self._grid.mp[self._rigid_dof, 1:] = self._rigid_momentum
            self._grid.f[self._rigid_dof] = 0.0


PARALLEL_CONTACTS = 512
"""Contacts from which parallel kernels pay for their launch."""
PARTICLES_PER_CONTACT = 30
"""Simulations with fewer particles per ``PARALLEL_CONTACTS`` rarely have so many: they compile serial kernels only."""
