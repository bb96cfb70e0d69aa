"""Contact between velocity fields: where in the step it corrects momenta (Nairn 2026, section 3.2)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmcli.contact import momenta, overlap, pairs
from mpmcli.contact.account import ContactAccount
from mpmcli.contact.choice import ContactChoice
from mpmcli.contact.clouds import NEAREST, Clouds
from mpmcli.contact.contacts import Contacts
from mpmcli.contact.direction import DirectionWatch
from mpmcli.contact.members import Rules
from mpmcli.contact.settle import BROKEN
from mpmcli.core.analysis import Axisymmetric
from mpmcli.core.nodal_field import Correction
from mpmcli.core.order import CellOrder
from mpmcli.core.state import ContactView
from mpmcli.core.step import Step

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
            explicit=model.three_or_more != "lumped",
            coupled=model.three_or_more == "coupled",
            shares_normal=model.normal.shares_normal,
        )
        self._has_geometry = choice.knows_normals
        self._removes_overlap = model.overlap_removal > 0.0 and self._has_geometry
        self._drives = np.array([law.drives_apart for law in choice.laws])
        self._axes = (0.0,) * d
        self._ring = isinstance(transfer.analysis, Axisymmetric)
        self._nodal = choice.nodal_arrays(grid)
        self._guesses = self._nodal.get("guesses")
        self.clouds = Clouds(order, grid, self._planes(), self._nodal["slot_of_node"])
        self.contacts = Contacts(self.clouds, self._rules, grid.node_count, d)
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
        c.count = 0
        self._account.clear()
        if self._rigid is not None:
            self._rigid.hold(step, mp)
            self._rigid_dof = self._rigid.dofs
            self._rigid_momentum = mp[self._rigid_dof, 1:]
        if self.clouds.find_nodes() == 0:
            return
        if self._has_geometry:
            transfer, parallel = self._transfer, self._runs_parallel
            F = transfer.domain_F
            self.clouds.collect(
                transfer.shape.parameters, transfer.across, transfer.stencil, p.X, F, p.size, parallel
            )
            c.sum_volumes(p, F, parallel)
        c.find_members(mp)
        if c.count == 0:
            return
        if self._has_geometry:
            c.find_geometry(
                self._normal, self._separation, self._grid, p, F, self._ring, p.X0,
                self._model.separation.needs_radius, self._guesses, parallel,
            )  # fmt: skip
            if self._direction is not None:
                self._direction.look(p)
        c.start[: c.count] = 0.0
        keeps_start = _keeps_start(step.plan)
        if keeps_start:
            self._find_slip(None, c.slip)
        if not self._model.once:
            self._settle_momenta(step.dt, after_forces=False, advance=0.0)
            c.start[: c.count] = c.dp[: c.count]
            self._start_increments()
        if not keeps_start:
            self._find_slip(None, c.slip)

    def after_update(self, step: Step) -> None:
        """Task 3.a: p⁺ += Δp⁽²⁾, which is also a force."""
        c = self.contacts
        self._restore_rigid()
        if c.count == 0:
            return
        c.net[: c.count] = 0.0
        if step.plan.has_full_mass_loop and self._model.increments == "after":
            return
        if self._removes_overlap:
            self._find_drive(step.dt)
        self._settle_momenta(step.dt, after_forces=True, advance=step.dt)
        self._start_increments()
        if step.plan.imposes_lumped:
            self._conditions.impose_on_momenta(step)

    def take_out_start(self, step: Step, p: Array) -> None:
        """Take Δp⁽¹⁾ out of momenta ``p`` (dofs, d) of the start of the step, where the filter is to know it."""
        c = self.contacts
        if step.plan.corrects_filter:
            momenta.take_out(self._axes, c.count, c.members, c.start, p)

    def correct(self, step: Step, dv: Array, counts_reactions: bool) -> None:
        """Part (2) of an FMPM increment: contact on Δv(ℓ); conditions, whose impulses may count, have the last word."""
        if self._rigid is not None:
            dv[self._rigid.held] = 0.0
        if self.contacts.count == 0 or not self._incremental:
            return
        self._settle_velocities(step.dt, dv, is_increment=True)
        if step.plan.zeroes_increments:
            self._conditions.zero_increment(dv, counts_reactions)

    def after_velocities(self, step: Step, v: Array) -> None:
        """Lumped contact on v⁺(k) itself (``after`` and ``combined``, for comparison)."""
        c = self.contacts
        if c.count == 0 or not self._later:
            return
        self._settle_velocities(step.dt, v, is_increment=False)
        c.net[: c.count] += c.dp[: c.count]

    def after_new_extrapolation(self, step: Step) -> None:
        """Task 4.b: momenta extrapolated again satisfy contact; no force, no work."""
        self._restore_rigid()
        if self.contacts.count == 0:
            return
        self._settle_momenta(step.dt, after_forces=False, advance=0.0)
        self._start_increments()
        if step.plan.imposes_lumped:
            self._conditions.impose_again(step)

    def account(self, step: Step, v: Array) -> None:
        """Sum up forces, areas and friction work of the step from the final net Δp; mark broken adhesion.

        Δp⁽¹⁾ is part of it where particles take on grid velocities, whose momentum it is part of; with FLIP it only
        moves them, and XPIC(m > 1) filters it out again.
        """
        c = self.contacts
        after = c.prior  # its rows are free now
        if c.count > 0:
            self._find_slip(v, after)
            if _keeps_start(step.plan):
                c.net[: c.count] += c.start[: c.count]
        self._account.close(c.net, c.slip, after, step.dt)
        if c.count > 0 and self.choice.breaks:
            self._break_bonds()

    # ------------------------------------------------------------------ from one step to the next

    def memory(self) -> dict[str, Any]:
        """What it remembers from step to step: accounts, and normals to begin the next search with."""
        found = self._account.memory()
        if self._guesses is not None:
            found["guessed"] = np.flatnonzero(self._guesses.any(axis=1))
            found["guesses"] = self._guesses[found["guessed"]]
        return found

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._account.recall(memory)
        if self._guesses is not None:
            self._guesses[memory["guessed"]] = memory["guesses"]

    def nodal_arrays(self) -> dict[str, Array]:
        """Return its arrays over all nodes, by name."""
        return self._nodal

    def nodal_fields(self) -> dict[str, Callable[[], Array]]:
        """Normal, separation and traction of contacts on nodes."""
        return self._account.nodal_fields()

    # ------------------------------------------------------------------ parts

    @property
    def _parallel(self) -> bool:
        return self.contacts.count >= self.parallel_from

    def _settle_momenta(self, dt: float, after_forces: bool, advance: float) -> None:
        c, grid = self.contacts, self._grid
        for stage in range(c.stages):
            self._settle(stage, dt, advance, after_forces=after_forces)
            momenta.add_to_momenta[self._parallel](
                self._axes, c.count, stage, c.members, c.dp, dt, grid.mp, grid.f, after_forces
            )

    def _settle_velocities(self, dt: float, v: Array, is_increment: bool) -> None:
        c = self.contacts
        for stage in range(c.stages):
            self._settle(stage, dt, 0.0 if is_increment else dt, v=v, is_increment=is_increment)
            momenta.add_to_velocities[self._parallel](
                self._axes, c.count, stage, c.members, c.dp, self._grid.mp, v
            )

    def _settle(
        self, stage: int, dt: float, advance: float, after_forces: bool = False, v: Array | None = None,
        is_increment: bool = False,
    ) -> None:  # fmt: skip
        """Settle momenta, or the velocities ``v``, at the contacts of a stage; see ``momenta.settle_stage``."""
        c, g, grid = self.contacts, self.contacts.geometry, self._grid
        drives = self._removes_overlap and v is None and advance > 0.0
        of_velocity, v = v is not None, grid.f if v is None else v
        for which in self.choice.used:
            if self._rules.skipped[which]:
                continue
            momenta.settle_stage[self._parallel](
                self._laws[which], which, stage, self._axes, c.count, c.members, grid.node_count, self.clouds.dof,
                self._rules.rigid, grid.mp, grid.f, after_forces, v, of_velocity, c.prior, c.net, is_increment,
                self._evolving, g.normal, g.separation, g.area, g.bond, dt, advance, self._model.displacement_only,
                c.separation_now, c.push, c.drive, drives, c.dp0, c.total, c.settled, c.dp, c.state,
            )  # fmt: skip
        if self._rules.explicit and stage == 0:
            self._settle_pairs(v, of_velocity, is_increment, dt, advance, drives)

    def _settle_pairs(
        self, v: Array, of_velocity: bool, is_increment: bool, dt: float, advance: float, drives: bool
    ) -> None:
        """The contacts that ``three_or_more: pairs`` or ``coupled`` asks for."""
        c, g, mp = self.contacts, self.contacts.geometry, self._grid.mp
        slots, n = self.clouds.count, self._grid.node_count
        chosen, total, wanted = np.zeros(slots, dtype=bool), np.zeros_like(c.dp), np.zeros_like(c.dp)
        pairs.find_pair_impulses(
            self._axes, c.count, c.members, n, self.clouds.dof, self._rules.rigid, mp, v, of_velocity, c.prior,
            is_increment, g.normal, g.separation, c.separation_now, advance, c.drive, drives, c.dp0, total,
        )  # fmt: skip
        for sweep in range(pairs.SWEEPS + 1):
            change = size = 0.0
            for which in self.choice.used:
                if not self._rules.skipped[which]:
                    moved, whole = pairs.settle_pairs(
                        self._laws[which], which, self._axes, c.count, c.members, c.begin, chosen, sweep > 0, mp,
                        g.normal, c.separation_now, g.area, g.bond, dt, self._model.displacement_only, c.dp0, wanted,
                        c.settled, total, c.state,
                    )  # fmt: skip
                    change, size = change + moved, size + whole
            if sweep == 0:
                most = len(c.members.pair) if self._rules.coupled else 2
                pairs.choose_pairs(slots, c.members, c.begin, most, c.state, chosen)
                if not chosen.any():
                    break
            elif change <= pairs.SETTLED * size:
                break
        pairs.finish_pairs(
            self._axes,
            c.count,
            c.members,
            c.begin,
            chosen,
            c.prior,
            c.net,
            is_increment,
            self._evolving,
            c.dp0,
            total,
            c.dp,
            c.state,
        )

    def _find_drive(self, dt: float) -> None:
        c, clouds, grid = self.contacts, self.clouds, self._grid
        overlap.find_drive[self._parallel](
            self._axes, c.count, c.members, clouds.node, clouds.first, clouds.dof, grid.node_count, self._rules.rigid,
            self._drives, grid.shape, tuple(float(x) for x in grid.lower - grid.pad * grid.cell),
            tuple(float(x) for x in grid.cell), True if self._ring else None, self.choice.thickness,
            float(self._model.overlap_removal), c.volume, c.geometry.normal, grid.mp, dt, c.drive,
        )  # fmt: skip

    def _start_increments(self) -> None:
        c = self.contacts
        momenta.start_increments[self._parallel](
            self._axes, c.count, c.dp0, c.dp, self._evolving, c.prior, c.net
        )

    def _find_slip(self, v: Array | None, out: Array) -> None:
        c = self.contacts
        momenta.find_slip[self._parallel](
            self._axes, c.count, c.members, self._grid.node_count, self.clouds.dof, self._rules.rigid,
            self._grid.mp, self._grid.f if v is None else v, v is not None, out,
        )  # fmt: skip

    def _restore_rigid(self) -> None:
        if len(self._rigid_dof):
            self._grid.mp[self._rigid_dof, 1:] = self._rigid_momentum
            self._grid.f[self._rigid_dof] = 0.0

    def _break_bonds(self) -> None:
        """Particles lose their bond with the node that they are nearest to."""
        c, sights = self.contacts, self.clouds.sights
        bond: Any = self._particles.bond
        for k in np.flatnonzero(c.state[: c.count] == BROKEN):
            at = sights.head[c.members.slot[k]]
            while at >= 0:
                if sights.flag[at] & NEAREST:
                    bond[sights.particle[at]] = 0.0
                at = sights.next[at]


def _keeps_start(plan: Any) -> bool:
    """Whether Δp⁽¹⁾ changes the particles' momentum in a step of this plan (see ``NodalContact.account``)."""
    filters_out = plan.method.projects and plan.corrects_filter and plan.order > 1
    return not (plan.method.flip or filters_out)


PARALLEL_CONTACTS = 512
"""Contacts from which parallel kernels pay for their launch."""
PARTICLES_PER_CONTACT = 30
"""Simulations with fewer particles per ``PARALLEL_CONTACTS`` rarely have so many: they compile serial kernels only."""
