"""Contact between velocity fields: where in the step it corrects momenta (Nairn 2026, section 3.2)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmcli.contact import coupled_pairs, impulses, overlap
from mpmcli.contact.account import ContactAccount
from mpmcli.contact.choice import ContactChoice
from mpmcli.contact.contact_nodes import ContactNodes
from mpmcli.contact.contacts import Contacts
from mpmcli.contact.direction import DirectionWatch
from mpmcli.contact.fields_in_contact import Rules
from mpmcli.contact.geometry import Matter, Surroundings
from mpmcli.contact.impulses import Place
from mpmcli.core.analysis import Axisymmetric
from mpmcli.core.contacts import ContactRows
from mpmcli.core.order import CellOrder
from mpmcli.core.state import ContactView
from mpmcli.core.step import Step
from mpmcli.core.transfer.nodal_field import Correction

Array = np.ndarray


class NodalContact(Correction):
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
        self._conditions, self._mirror, self._rigid = conditions, mirror, rigid
        self._runs_parallel = parallel
        self._model = model = choice.model
        self._laws = [law.parameters() for law in choice.laws]
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
        self._removes_overlap = model.overlap_removal > 0.0 and self._has_geometry
        self._drives = np.array([law.drives_apart for law in choice.laws])
        self._axes = (0.0,) * d
        self._ring = isinstance(transfer.analysis, Axisymmetric)
        self._nodal = choice.nodal_arrays(grid)
        self._guesses = self._nodal.get("guesses")
        self.nodes = ContactNodes(order, grid, self._planes(), self._nodal["slot_of_node"])
        self.contacts = Contacts(self.nodes, self._rules, grid.node_count, d)
        self._around = Surroundings(
            shape=np.array(grid.shape, dtype=np.int64),
            origin=grid.lower - grid.pad * grid.cell,
            cell=grid.cell,
            planes=self.nodes.images.line,
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
        self._incremental = model.increments in ("net", "evolving")
        self._evolving = model.increments == "evolving"
        self._later = model.increments in ("after", "combined")
        self._rigid_dof = np.zeros(0, dtype=np.int64)
        self._account = ContactAccount(choice, self.contacts, particles, grid, mirror, work)
        self.view: ContactView = self._account.view
        self.interfaces: Any = None
        """Interface laws of the scene, ``interfaces.interfaces.Interfaces``, or None."""

    def pairs(self) -> tuple[Array, list[tuple[str, str]]]:
        """Return the number (fields, fields) of each pair of fields, and their names."""
        return self._account.pair, self.view.pairs

    def _planes(self) -> list[tuple[int, int]]:
        mirror, grid = self._mirror, self._grid
        planes: list[tuple[int, int]] = [] if mirror is None else mirror.lines()
        if self._ring and grid.lower[0] == 0.0:
            planes.append((0, grid.pad))
        return planes

    # ------------------------------------------------------------------ the places in the step

    def after_extrapolation(self, step: Step) -> None:
        """Task 1.a: find the fields in contact, and let the extrapolated momenta satisfy contact: p += Δp⁽¹⁾."""
        c, p, mp = self.contacts, self._particles, self._grid.mp
        self._account.clear()
        if self._rigid is not None:
            self._rigid.hold(step, mp)
            self._rigid_dof = self._rigid.dofs
            self._rigid_momentum = mp[self._rigid_dof, 1:]
        if c.find_nodes() == 0:
            return
        if self._has_geometry:
            transfer, parallel = self._transfer, self._runs_parallel
            matter = Matter(p.velocity_field, p.X, transfer.domain_F, p.size, p.vol0, p.mass, p.X0, p.bond)
            self.nodes.find_near(
                transfer.shape.parameters, transfer.across, transfer.stencil, p.X, matter.F, p.size, parallel
            )
            c.sum_volumes(matter, parallel)
        c.find_fields(mp)
        if c.count == 0:
            return
        if self._has_geometry:
            c.find_geometry(
                self._normal, self._separation, self._around, matter, self._model.separation.needs_radius,
                self._guesses, parallel,
            )  # fmt: skip
            if self._direction is not None:
                self._direction.look(p)
        if self.interfaces is not None:
            self.interfaces.find(matter, self._around, parallel)
        rows = c.rows
        rows.start[: c.count] = 0.0
        keeps_start = _keeps_start(step.plan)
        if keeps_start:
            self._find_slip(None, rows.slip)
        if not self._model.once:
            self._correct_momenta(step.dt, after_forces=False, advance=0.0)
            rows.start[: c.count] = rows.dp[: c.count]
            self._start_increments()
        if not keeps_start:
            self._find_slip(None, rows.slip)

    def after_update(self, step: Step) -> None:
        """Task 3.a: p⁺ += Δp⁽²⁾, which is also a force."""
        c = self.contacts
        self._restore_rigid()
        if c.count == 0:
            return
        c.rows.net[: c.count] = 0.0
        if self.interfaces is not None:
            self.interfaces.forces_known(True)
        if step.plan.has_full_mass_loop and self._model.increments == "after":
            return
        if self._removes_overlap:
            self._find_drive(step.dt)
        self._correct_momenta(step.dt, after_forces=True, advance=step.dt)
        self._start_increments()
        if step.plan.imposes_lumped:
            self._conditions.impose_on_momenta(step)

    def take_out_start(self, step: Step, p: Array) -> None:
        """Take Δp⁽¹⁾ out of momenta ``p`` (dofs, d) of the start of the step, where the filter is to know it."""
        c = self.contacts
        if step.plan.corrects_filter:
            impulses.take_out(self._axes, c.count, c.fields, c.rows.start, p)

    def correct(self, step: Step, dv: Array, counts_reactions: bool) -> None:
        """Part (2) of an FMPM increment: contact on Δv(ℓ); conditions, whose impulses may count, have the last word."""
        if self._rigid is not None:
            dv[self._rigid.held] = 0.0
        if self.contacts.count == 0 or not self._incremental:
            return
        self._correct_velocities(step.dt, dv, is_increment=True)
        if step.plan.zeroes_increments:
            self._conditions.zero_increment(dv, counts_reactions)

    def after_velocities(self, step: Step, v: Array) -> None:
        """Lumped contact on v⁺(k) itself (``after`` and ``combined``, for comparison)."""
        c = self.contacts
        if c.count == 0 or not self._later:
            return
        self._correct_velocities(step.dt, v, is_increment=False)
        c.rows.net[: c.count] += c.rows.dp[: c.count]

    def after_new_extrapolation(self, step: Step) -> None:
        """Task 4.b: momenta extrapolated again satisfy contact; no force, no work."""
        self._restore_rigid()
        if self.contacts.count == 0:
            return
        if self.interfaces is not None:
            self.interfaces.forces_known(False)
        self._correct_momenta(step.dt, after_forces=False, advance=0.0)
        self._start_increments()
        if step.plan.imposes_lumped:
            self._conditions.impose_again(step)

    def account(self, step: Step, v: Array) -> None:
        """Sum up forces, areas and friction work of the step from the final net Δp; mark broken adhesion.

        Δp⁽¹⁾ is part of it where particles take on grid velocities, whose momentum it is part of; with FLIP it only
        moves them, and XPIC(m > 1) filters it out again.
        """
        c = self.contacts
        after = c.rows.prior  # its rows are free now
        if c.count > 0:
            self._find_slip(v, after)
            if _keeps_start(step.plan):
                c.rows.net[: c.count] += c.rows.start[: c.count]
        bonded = None if self.interfaces is None else self.interfaces.bonded()
        self._account.close(after, step.dt, bonded)
        if self.interfaces is not None:
            self.interfaces.close(after, *self._account.pair_of_contacts(), step.dt, self._parallel)
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

    def _correct_momenta(self, dt: float, after_forces: bool, advance: float) -> None:
        c, grid = self.contacts, self._grid
        here = self._place(dt, advance)._replace(
            after_forces=after_forces, drives=self._removes_overlap and advance > 0.0
        )
        for stage in range(c.stages):
            here = here._replace(stage=stage)
            self._find_impulses(here, grid.f)
            impulses.add_to_momenta[self._parallel](
                self._axes, c.count, c.fields, c.rows.dp, here, grid.mp, grid.f
            )

    def _correct_velocities(self, dt: float, v: Array, is_increment: bool) -> None:
        c = self.contacts
        here = self._place(dt, 0.0 if is_increment else dt)._replace(
            of_velocity=True, of_increment=is_increment
        )
        for stage in range(c.stages):
            here = here._replace(stage=stage)
            self._find_impulses(here, v)
            impulses.add_to_velocities[self._parallel](
                self._axes, c.count, c.fields, c.rows.dp, here, self._grid.mp, v
            )

    def _place(self, dt: float, advance: float) -> Place:
        return Place(
            stage=0,
            after_forces=False,
            of_velocity=False,
            of_increment=False,
            evolving=self._evolving,
            displacement_only=self._model.displacement_only,
            drives=False,
            dt=dt,
            advance=advance,
        )

    def _find_impulses(self, here: Place, v: Array) -> None:
        """Find the impulses on momenta, or on velocities ``v``, at the contacts of a stage."""
        c, grid = self.contacts, self._grid
        for which in self.choice.used:
            if self.choice.laws[which].is_interface:
                self.interfaces.find_impulses(which, here, v)
            elif not self._rules.skipped[which]:
                impulses.find_impulses[self._parallel](
                    self._laws[which], self._axes, which, c.count, c.fields, c.table, c.geometry, c.rows, here,
                    grid.mp, grid.f, v,
                )  # fmt: skip
        if c.has_pairs and here.stage == 0:
            self._find_pair_impulses(here, v)

    def _find_pair_impulses(self, here: Place, v: Array) -> None:
        """The contacts that ``three_or_more: pairs`` or ``coupled`` asks for."""
        c, mp = self.contacts, self._grid.mp
        slots = self.nodes.count
        chosen = np.zeros(slots, dtype=bool)
        coupled_pairs.start_pairs(self._axes, c.count, c.fields, c.table, c.geometry, c.rows, here, mp, v)
        for sweep in range(coupled_pairs.SWEEPS + 1):
            change = size = 0.0
            for which in self.choice.used:
                moved = whole = 0.0
                if self.choice.laws[which].is_interface:
                    moved, whole = self.interfaces.find_pair_impulses(which, here, chosen, sweep > 0)
                elif not self._rules.skipped[which]:
                    moved, whole = coupled_pairs.find_pair_impulses(
                        self._laws[which], self._axes, which, c.count, c.fields, c.begin, chosen, sweep > 0,
                        c.geometry, c.rows, here, mp,
                    )  # fmt: skip
                change, size = change + moved, size + whole
            if sweep == 0:
                most = len(c.fields.pair) if self._rules.coupled else 2
                coupled_pairs.choose_pairs(slots, c.fields, c.begin, most, c.rows.state, chosen)
                if not chosen.any():
                    break
            elif change <= coupled_pairs.CONVERGED * size:
                break
        coupled_pairs.finish_pairs(self._axes, c.count, c.fields, chosen, c.rows, here)

    def _find_drive(self, dt: float) -> None:
        c = self.contacts
        overlap.find_drive[self._parallel](
            self._axes, c.count, c.fields, c.table, self._around, self._drives, float(self._model.overlap_removal),
            c.geometry.normal, self._grid.mp, dt, c.rows.drive,
        )  # fmt: skip

    def _start_increments(self) -> None:
        c, rows = self.contacts, self.contacts.rows
        impulses.start_increments[self._parallel](
            self._axes, c.count, self._evolving, rows.dp0, rows.dp, rows.prior, rows.net
        )

    def _find_slip(self, v: Array | None, out: Array) -> None:
        c, grid = self.contacts, self._grid
        impulses.find_slip[self._parallel](
            self._axes, c.count, c.fields, c.table, grid.mp, grid.f if v is None else v, v is not None, out
        )

    def _restore_rigid(self) -> None:
        if len(self._rigid_dof):
            self._grid.mp[self._rigid_dof, 1:] = self._rigid_momentum
            self._grid.f[self._rigid_dof] = 0.0


def _keeps_start(plan: Any) -> bool:
    """Whether Δp⁽¹⁾ changes the particles' momentum in a step of this plan (see ``NodalContact.account``)."""
    filters_out = plan.method.projects and plan.corrects_filter and plan.order > 1
    return not (plan.method.flip or filters_out)


PARALLEL_CONTACTS = 512
"""Contacts from which parallel kernels pay for their launch."""
PARTICLES_PER_CONTACT = 30
"""Simulations with fewer particles per ``PARALLEL_CONTACTS`` rarely have so many: they compile serial kernels only."""
