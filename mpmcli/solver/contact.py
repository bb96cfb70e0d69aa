"""Contact between velocity fields: where in the step it corrects momenta (Nairn 2026, section 3.2)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.contact import momenta, overlap, pairs
from mpmcli.contact.clouds import NEAREST, Clouds
from mpmcli.contact.contacts import Contacts, Rules
from mpmcli.contact.settle import BROKEN
from mpmcli.core.analysis import Axisymmetric
from mpmcli.scene.fields import law_table
from mpmcli.scene.filling import section_of
from mpmcli.solver.contact_account import ContactAccount
from mpmcli.solver.contact_direction import DirectionWatch

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

Array = np.ndarray


class NoContact:
    """One velocity field: bodies that touch move together. The places where contact corrects momenta stay empty."""

    def after_extrapolation(self, dt: float) -> None:
        """Task 1.a."""

    def after_update(self, dt: float) -> None:
        """Task 3.a."""

    def take_out_start(self, p: Array) -> None:
        """Nothing was corrected in task 1.a."""

    def correct_increment(self, dv: Array, dt: float, counts_reactions: bool) -> None:
        """Part (2) of an FMPM increment."""

    def after_velocities(self, v: Array, dt: float) -> None:
        """After task 3.b."""

    def after_new_extrapolation(self, dt: float) -> None:
        """Task 4.b."""

    def account(self, v: Array, dt: float) -> None:
        """Task 6: forces and friction work."""

    def nodal_fields(self) -> dict[str, Callable[[], Array]]:
        """Nothing to show on nodes."""
        return {}


class NodalContact(NoContact):
    """The contact of a scene.

    Geometry (nodes, normals, separations, areas) is found once per step, in task 1.a, and used by all corrections of
    the step.

    Attributes
    ----------
    parallel_from : number of contacts from which their kernels run in parallel
    """

    def __init__(self, s: Simulation, scene: Any):
        self._s = s
        model = scene.contact
        plan, grid = s.plan, s.grid
        self._model = model
        models, table = law_table(scene, plan.fields)
        self._laws = [law.parameters() for law in models]
        self._used = sorted({int(i) for i in table.ravel() if i >= 0})
        d = grid.dimensions
        cell = tuple(float(c) for c in grid.cell)
        self._normal = model.normal.parameters(d, cell)
        per_axis = min(min(np.ravel(body.particles_per_axis)) for body in scene.bodies)
        self._separation = model.separation.parameters(d, cell, per_axis)
        used = [models[i] for i in self._used]
        self._has_geometry = any(law.needs_normal for law in used)
        self._breaks = any(law.adhesive for law in used)
        rigid = np.array(plan.rigid_fields, dtype=bool)
        self._rules = Rules(
            law=table,
            skipped=np.array([law.skipped for law in models]),
            screened=np.array([law.screened for law in models]),
            rigid=rigid,
            mass_ratio=model.mass_ratio,
            explicit=model.three_or_more != "lumped",
            coupled=model.three_or_more == "coupled",
            shares_normal=model.normal.shares_normal,
        )
        self._removes_overlap = model.overlap_removal > 0.0 and self._has_geometry
        self._drives = np.array([law.drives_apart for law in models])
        self._thickness = section_of(scene)
        self._axes = (0.0,) * d
        self._ring = isinstance(plan.analysis, Axisymmetric)
        self.clouds = Clouds(s.order, grid, self._planes())
        self.contacts = Contacts(self.clouds, self._rules, grid.node_count, d)
        p = s.particles
        if model.separation.needs_displacement:
            p.X0 = p.X.copy()
        if self._breaks:
            p.bond = np.ones(p.count)
        self._direction = None
        if model.normal.is_given and self._has_geometry:
            self._direction = DirectionWatch(self.contacts, plan.fields, grid.node_count)
        self._guesses = np.zeros((grid.dof_count, d)) if getattr(model.normal, "reuse", False) else None
        many = s.parallel and p.count >= PARTICLES_PER_CONTACT * PARALLEL_CONTACTS
        self.parallel_from = PARALLEL_CONTACTS if many else math.inf
        self._incremental = model.increments in ("net", "evolving")
        self._evolving = model.increments == "evolving"
        self._later = model.increments in ("after", "combined")
        self._rigid_dof = np.zeros(0, dtype=np.int64)
        self._account = ContactAccount(s, self.contacts, rigid, self._has_geometry)
        self.view = self._account.view

    def _planes(self) -> list[tuple[int, int]]:
        s = self._s
        planes = s.conditions.mirror.lines() if s.conditions.mirror is not None else []
        if self._ring and s.grid.lower[0] == 0.0:
            planes.append((0, s.grid.pad))
        return planes

    # ------------------------------------------------------------------ the places in the step

    def after_extrapolation(self, dt: float) -> None:
        """Task 1.a: find who meets whom, and let the extrapolated momenta satisfy contact: p += Δp⁽¹⁾."""
        s, c = self._s, self.contacts
        mp = s.grid.mp
        c.count = 0
        self._account.clear()
        s.rigid.hold(mp, s.time)
        self._keep_rigid()
        if self.clouds.find_nodes() == 0:
            return
        if self._has_geometry:
            stencil = s.transfer.stencil
            F = s.transfer.domain_F
            self.clouds.collect(
                s.plan.shape.parameters,
                s.transfer.across,
                stencil,
                s.particles.X,
                F,
                s.particles.size,
                s.parallel,
            )
            c.sum_volumes(s.particles, F, s.parallel)
        c.find_members(mp)
        if c.count == 0:
            return
        if self._has_geometry:
            c.find_geometry(
                self._normal, self._separation, s.grid, s.particles, F, self._ring, s.particles.X0,
                self._model.separation.needs_radius, self._guesses, s.parallel,
            )  # fmt: skip
            if self._direction is not None:
                self._direction.look(s.particles)
        c.start[: c.count] = 0.0
        if self._keeps_start:
            self._find_slip(None, c.slip)
        if not self._model.once:
            self._settle_momenta(dt, None, advance=0.0)
            c.start[: c.count] = c.dp[: c.count]
            self._start_increments()
        if not self._keeps_start:
            self._find_slip(None, c.slip)

    def after_update(self, dt: float) -> None:
        """Task 3.a: p⁺ += Δp⁽²⁾, which is also a force."""
        s, c = self._s, self.contacts
        self._restore_rigid()
        if c.count == 0:
            return
        c.net[: c.count] = 0.0
        if s.plan.has_full_mass_loop and self._model.increments == "after":
            return
        if self._removes_overlap:
            self._find_drive(dt)
        self._settle_momenta(dt, s.grid.f, advance=dt)
        self._start_increments()
        if s.plan.imposes_lumped:
            s.conditions.impose_on_momentum(s.grid.mp, s.grid.f, dt)

    def take_out_start(self, p: Array) -> None:
        """Take Δp⁽¹⁾ out of momenta ``p`` (dofs, d) of the start of the step."""
        c = self.contacts
        momenta.take_out(self._axes, c.count, c.members, c.start, p)

    def correct_increment(self, dv: Array, dt: float, counts_reactions: bool) -> None:
        """Contact on an FMPM increment Δv(ℓ); conditions, whose impulses may count, have the last word."""
        s, c = self._s, self.contacts
        dv[s.rigid.held] = 0.0
        if c.count == 0 or not self._incremental:
            return
        for stage in range(c.stages):
            self._settle(stage, dt, 0.0, v=dv, is_increment=True)
            momenta.add_to_velocities[self._parallel](
                self._axes, c.count, stage, c.members, c.dp, s.grid.mp, dv
            )
        if s.plan.zeroes_increments:
            s.conditions.zero_increment(dv, s.grid.mp, counts_reactions)

    def after_velocities(self, v: Array, dt: float) -> None:
        """Lumped contact on v⁺(k) itself (``after`` and ``combined``, for comparison)."""
        s, c = self._s, self.contacts
        if c.count == 0 or not self._later:
            return
        for stage in range(c.stages):
            self._settle(stage, dt, dt, v=v)
            momenta.add_to_velocities[self._parallel](
                self._axes, c.count, stage, c.members, c.dp, s.grid.mp, v
            )
        c.net[: c.count] += c.dp[: c.count]

    def after_new_extrapolation(self, dt: float) -> None:
        """Task 4.b: momenta extrapolated again satisfy contact; no force, no work."""
        s, c = self._s, self.contacts
        self._restore_rigid()
        if c.count == 0:
            return
        self._settle_momenta(dt, None, advance=0.0)
        self._start_increments()
        if s.plan.imposes_lumped:
            s.conditions.impose_on_momentum(s.grid.mp, None, dt)

    def account(self, v: Array, dt: float) -> None:
        """Sum up forces, areas and friction work of the step from the final net Δp; mark broken adhesion.

        Δp⁽¹⁾ is part of it where particles take on grid velocities, whose momentum it is part of; with FLIP it only
        moves them, and XPIC(m > 1) filters it out again.
        """
        c = self.contacts
        after = c.prior  # its rows are free now
        if c.count > 0:
            self._find_slip(v, after)
            if self._keeps_start:
                c.net[: c.count] += c.start[: c.count]
        self._account.close(c.net, c.slip, after, dt)
        if c.count > 0 and self._breaks:
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

    def nodal_fields(self) -> dict[str, Callable[[], Array]]:
        """Normal, separation and traction of contacts on nodes."""
        return self._account.nodal_fields()

    # ------------------------------------------------------------------ parts

    @property
    def _keeps_start(self) -> bool:
        """Whether Δp⁽¹⁾ changes the particles' momentum (see ``account``)."""
        plan = self._s.plan
        filters_out = plan.method.projects and plan.corrects_filter and plan.order > 1
        return not (plan.method.flip or filters_out)

    @property
    def _parallel(self) -> bool:
        return self.contacts.count >= self.parallel_from

    def _settle_momenta(self, dt: float, f: Array | None, advance: float) -> None:
        s, c = self._s, self.contacts
        for stage in range(c.stages):
            self._settle(stage, dt, advance, after_forces=f is not None)
            momenta.add_to_momenta[self._parallel](
                self._axes, c.count, stage, c.members, c.dp, dt, s.grid.mp, s.grid.f, f is not None
            )

    def _settle(
        self, stage: int, dt: float, advance: float, after_forces: bool = False, v: Array | None = None,
        is_increment: bool = False,
    ) -> None:  # fmt: skip
        """Settle momenta, or the velocities ``v``, at the contacts of a stage; see ``momenta.settle_stage``."""
        s, c, g = self._s, self.contacts, self.contacts.geometry
        drives = self._removes_overlap and v is None and advance > 0.0
        of_velocity, v = v is not None, s.arrays.v if v is None else v
        for which in self._used:
            if self._rules.skipped[which]:
                continue
            momenta.settle_stage[self._parallel](
                self._laws[which], which, stage, self._axes, c.count, c.members, s.grid.node_count, self.clouds.dof,
                self._rules.rigid, s.grid.mp, s.grid.f, after_forces, v, of_velocity, c.prior, c.net, is_increment,
                self._evolving, g.normal, g.separation, g.area, g.bond, dt, advance, self._model.displacement_only,
                c.separation_now, c.push, c.drive, drives, c.dp0, c.total, c.settled, c.dp, c.state,
            )  # fmt: skip
        if self._rules.explicit and stage == 0:
            self._settle_pairs(v, of_velocity, is_increment, dt, advance, drives)

    def _settle_pairs(
        self, v: Array, of_velocity: bool, is_increment: bool, dt: float, advance: float, drives: bool
    ) -> None:
        """The contacts that ``three_or_more: pairs`` or ``coupled`` asks for."""
        s, c, g = self._s, self.contacts, self.contacts.geometry
        slots, n = self.clouds.count, s.grid.node_count
        chosen, total, wanted = np.zeros(slots, dtype=bool), np.zeros_like(c.dp), np.zeros_like(c.dp)
        pairs.find_pair_impulses(
            self._axes, c.count, c.members, n, self.clouds.dof, self._rules.rigid, s.grid.mp, v, of_velocity, c.prior,
            is_increment, g.normal, g.separation, c.separation_now, advance, c.drive, drives, c.dp0, total,
        )  # fmt: skip
        for sweep in range(pairs.SWEEPS + 1):
            change = size = 0.0
            for which in self._used:
                if not self._rules.skipped[which]:
                    moved, whole = pairs.settle_pairs(
                        self._laws[which], which, self._axes, c.count, c.members, c.begin, chosen, sweep > 0, s.grid.mp,
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
        s, c, clouds = self._s, self.contacts, self.clouds
        grid = s.grid
        overlap.find_drive[self._parallel](
            self._axes, c.count, c.members, clouds.node, clouds.first, clouds.dof, grid.node_count, self._rules.rigid,
            self._drives, grid.shape, tuple(float(x) for x in grid.lower - grid.pad * grid.cell),
            tuple(float(x) for x in grid.cell), True if self._ring else None, self._thickness,
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
            self._axes, c.count, c.members, self._s.grid.node_count, self.clouds.dof, self._rules.rigid,
            self._s.grid.mp, self._s.arrays.v if v is None else v, v is not None, out,
        )  # fmt: skip

    def _keep_rigid(self) -> None:
        self._rigid_dof = self._s.rigid_dofs
        self._rigid_momentum = self._s.grid.mp[self._rigid_dof, 1:]

    def _restore_rigid(self) -> None:
        if len(self._rigid_dof):
            self._s.grid.mp[self._rigid_dof, 1:] = self._rigid_momentum
            self._s.grid.f[self._rigid_dof] = 0.0

    def _break_bonds(self) -> None:
        """Particles lose their bond with the node that they are nearest to."""
        c, sights = self.contacts, self.clouds.sights
        bond: Any = self._s.particles.bond
        for k in np.flatnonzero(c.state[: c.count] == BROKEN):
            at = sights.head[c.members.slot[k]]
            while at >= 0:
                if sights.flag[at] & NEAREST:
                    bond[sights.particle[at]] = 0.0
                at = sights.next[at]


PARALLEL_CONTACTS = 512
"""Contacts from which parallel kernels pay for their launch."""
PARTICLES_PER_CONTACT = 30
"""Simulations with fewer particles per ``PARALLEL_CONTACTS`` rarely have so many: they compile serial kernels only."""
