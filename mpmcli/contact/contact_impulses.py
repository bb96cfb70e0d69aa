"""Where in the step contacts correct momenta, whatever found them (Nairn 2026, section 3.2)."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from mpmcli.contact import coupled_pairs, impulses
from mpmcli.contact.fields_in_contact import FieldsInContact, NodeTable
from mpmcli.contact.geometry import Geometry
from mpmcli.contact.impulses import ImpulseRows, Place
from mpmcli.contact.laws.impulse import APART, SLIDING, STICKING
from mpmcli.core.compiled.bound import TypedCalls
from mpmcli.core.grid import Grid
from mpmcli.core.step import Step
from mpmcli.core.transfer.nodal_field import Correction

Array = np.ndarray


class FoundContacts(Protocol):
    """The contacts of a step, of which the first ``count`` rows are valid; see ``Contacts``."""

    count: int
    stages: int
    has_pairs: bool
    begin: Array
    fields: FieldsInContact
    geometry: Geometry
    rows: ImpulseRows
    table: NodeTable


class Ways(NamedTuple):
    """How contacts act: keys of a scene's ``contact``, and whether several pairs at a node are always coupled."""

    increments: str = "net"
    once: bool = False
    displacement_only: bool = False
    coupled: bool = True


class ContactImpulses(Correction, ABC):
    """Corrects momenta at the contacts that ``find`` finds at the start of every step.

    Parameters
    ----------
    contacts : of the step
    laws, used : models of the laws, and the indices of those in use
    ways : how contacts act
    grid : of the simulation
    conditions : velocity conditions, or None

    Attributes
    ----------
    interfaces : interface laws of the contacts (``interfaces.interfaces.Interfaces`` or alike), or None
    """

    def __init__(
        self, contacts: FoundContacts, laws: Sequence[Any], used: Sequence[int], ways: Ways, grid: Grid,
        conditions: Any,
    ):  # fmt: skip
        self._found, self._ways, self._grid, self._conditions = contacts, ways, grid, conditions
        self._used = used
        self._of_interface = [law.is_interface for law in laws]
        self._skipped = [law.skipped for law in laws]
        self._bonded = [i for i in used if laws[i].bonds]
        self._parameters = [law.parameters() for law in laws]
        self._axes = (0.0,) * grid.dimensions
        self._incremental = ways.increments in ("net", "evolving")
        self._evolving = ways.increments == "evolving"
        self._later = ways.increments in ("after", "combined")
        self._removes_overlap = self._forces_known = self._springs_act = False
        self._call = TypedCalls()
        self.interfaces: Any = None

    @abstractmethod
    def find(self, step: Step) -> int:
        """Find the contacts of the step; returns how many."""

    @property
    def _parallel(self) -> bool:
        """Whether there are so many contacts that parallel kernels pay."""
        return False

    @property
    def _adds_parallel(self) -> bool:
        """Whether threads may add impulses to nodes: pairs that share a field would race, or add in another order."""
        return self._parallel and not self._found.has_pairs

    # ------------------------------------------------------------------ the places in the step

    def after_extrapolation(self, step: Step) -> None:
        """Task 1.a: find the contacts, and let the extrapolated momenta satisfy them: p += Δp⁽¹⁾."""
        self._forces_known = self._springs_act = False
        if self.find(step) == 0:
            return
        c, rows = self._found, self._found.rows
        rows.start[: c.count] = 0.0
        keeps = self._keeps_start(step.plan)
        if keeps.any():
            self._find_slip(None, rows.slip)
            before = rows.slip[: c.count][keeps]
        if self._ways.once or self._waits():
            # rows hold the step before: sides that wait hold together, of others nothing is known
            rows.state[: c.count] = STICKING if self._waits() else APART
        else:
            self._correct_momenta(step.dt, after_forces=False, advance=0.0)
            rows.start[: c.count] = rows.dp[: c.count]
            self._start_increments()
        if not keeps.all():
            self._find_slip(None, rows.slip)
            if keeps.any():
                rows.slip[: c.count][keeps] = before

    def after_update(self, step: Step) -> None:
        """Task 3.a: p⁺ += Δp⁽²⁾, which is also a force."""
        c = self._found
        self._forces_known = self._springs_act = True
        if c.count == 0:
            return
        c.rows.net[: c.count] = 0.0
        if self.interfaces is not None:
            self.interfaces.forces_known(True)
        if step.plan.has_full_mass_loop and self._ways.increments == "after":
            return
        self._find_drive(step.dt)
        self._correct_momenta(step.dt, after_forces=True, advance=step.dt)
        self._start_increments()
        if step.plan.imposes_lumped:
            self._conditions.impose_on_momenta(step)

    def take_out_start(self, step: Step, p: Array) -> None:
        """Take Δp⁽¹⁾ out of momenta ``p`` (dofs, d) of the start of the step, where the filter is to know it."""
        c = self._found
        if step.plan.corrects_filter:
            start = c.rows.start
            if self._bonded and step.plan.order > 1:
                start = start.copy()
                start[: c.count][self._keeps_start(step.plan)] = 0.0
            impulses.take_out(self._axes, c.count, c.fields, start, p)

    def unite(self, step: Step, v: Array, is_last: bool) -> None:
        """Let velocities ``v`` (dofs, d) of sides that are bonded for good be one, after a pass of XPIC's filter.

        Passes conserve momentum: of these impulses those of the last one reach the particles.
        """
        if self._bonded and self._found.count > 0 and step.plan.corrects_filter:
            self._correct_velocities(step.dt, v, is_increment=False, laws=self._bonded, counts=is_last)

    def correct(self, step: Step, dv: Array, counts_reactions: bool) -> None:
        """Part (2) of an FMPM increment: contact on Δv(ℓ); conditions, whose impulses may count, have the last word."""
        if self._found.count == 0 or not self._incremental:
            return
        if not self._waits() and (self._forces_known or not self._ways.once):
            self._correct_velocities(step.dt, dv, is_increment=True)
        if step.plan.zeroes_increments:
            self._conditions.zero_increment(dv, counts_reactions)

    def after_velocities(self, step: Step, v: Array) -> None:
        """Lumped contact on v⁺(k) itself (``after`` and ``combined``, for comparison)."""
        c = self._found
        if c.count == 0 or not self._later:
            return
        self._correct_velocities(step.dt, v, is_increment=False)
        c.rows.net[: c.count] += c.rows.dp[: c.count]

    def after_new_extrapolation(self, step: Step) -> None:
        """Task 4.b: momenta extrapolated again satisfy contact; no force, no work."""
        self._springs_act = False  # what they did is in these momenta
        if self._found.count == 0:
            return
        if self.interfaces is not None:
            self.interfaces.forces_known(False)
        if not self._waits():
            self._correct_momenta(step.dt, after_forces=False, advance=0.0)
            self._start_increments()
        if step.plan.imposes_lumped:
            self._conditions.impose_again(step)

    # ------------------------------------------------------------------ parts

    def _close_impulses(self, step: Step, v: Array) -> Array:
        """Let the rows' ``net`` be the impulses of the whole step; returns relative velocities (k, d) after them.

        Δp⁽¹⁾ is part of it where particles take on grid velocities, whose momentum it is part of; with FLIP it only
        moves them, and XPIC(m > 1) filters it out again but at sides that are bonded for good. Sides that it keeps
        apart alone touch, too.
        """
        c = self._found
        after = c.rows.prior  # its rows are free now
        if c.count > 0:
            self._find_slip(v, after)
            keeps = self._keeps_start(step.plan)
            if keeps.any():
                start, state = c.rows.start[: c.count], c.rows.state[: c.count]
                c.rows.net[: c.count][keeps] += start[keeps]
                state[keeps & (state == APART) & start.any(axis=1)] = SLIDING
        return after

    def _keeps_start(self, plan: Any) -> Array:
        """Return of which contacts (k,) Δp⁽¹⁾ changes the particles' momentum in a step of this plan."""
        law = self._found.fields.law[: self._found.count]
        return np.isin(law, self._bonded) if filters_out(plan) else np.full(len(law), not plan.method.flip)

    def _waits(self) -> bool:
        """Whether all contacts are interfaces that do nothing before the forces of the step are known."""
        return self.interfaces is not None and bool(self.interfaces.waits)

    def _find_drive(self, dt: float) -> None:
        """Find the impulses that take overlap back, where there are any."""

    def _correct_momenta(self, dt: float, after_forces: bool, advance: float) -> None:
        c, grid = self._found, self._grid
        here = self._place(dt, advance)._replace(
            after_forces=after_forces, drives=self._removes_overlap and advance > 0.0
        )
        for stage in range(c.stages):
            here = here._replace(stage=stage)
            self._find_impulses(here, grid.f, self._used)
            self._call(
                impulses.add_to_momenta, self._axes, c.count, c.fields, c.rows.dp, here, grid.mp, grid.f,
                parallel=self._adds_parallel,
            )  # fmt: skip

    def _correct_velocities(
        self, dt: float, v: Array, is_increment: bool, laws: Sequence[int] | None = None, counts: bool = False
    ) -> None:
        """Let velocities satisfy contact, by all laws or by some, whose impulses count in ``net`` if ``counts``."""
        c = self._found
        here = self._place(dt, 0.0 if is_increment else dt)._replace(
            of_velocity=True, of_increment=is_increment
        )
        for stage in range(c.stages):
            here = here._replace(stage=stage)
            if laws is not None:
                c.rows.dp[: c.count] = 0.0
            self._find_impulses(here, v, self._used if laws is None else laws)
            self._call(
                impulses.add_to_velocities, self._axes, c.count, c.fields, c.rows.dp, here, self._grid.mp, v,
                parallel=self._adds_parallel,
            )  # fmt: skip
            if counts:
                c.rows.net[: c.count] += c.rows.dp[: c.count]

    def _place(self, dt: float, advance: float) -> Place:
        return Place(
            stage=0,
            after_forces=False,
            of_velocity=False,
            of_increment=False,
            evolving=self._evolving,
            displacement_only=self._ways.displacement_only,
            drives=False,
            springs_act=self._springs_act,
            dt=dt,
            advance=advance,
        )

    def _find_impulses(self, here: Place, v: Array, laws: Sequence[int]) -> None:
        """Find the impulses of some laws on momenta, or on velocities ``v``, at the contacts of a stage."""
        c, grid = self._found, self._grid
        for which in laws:
            if self._of_interface[which]:
                self.interfaces.find_impulses(which, here, v)
            elif not self._skipped[which]:
                self._call(
                    impulses.find_impulses, self._parameters[which], self._axes, which, c.count, c.fields, c.table,
                    c.geometry, c.rows, here, grid.mp, grid.f, v, parallel=self._parallel, key=which,
                )  # fmt: skip
        if c.has_pairs and here.stage == 0:
            self._find_pair_impulses(here, v, laws)

    def _find_pair_impulses(self, here: Place, v: Array, laws: Sequence[int]) -> None:
        """The contacts that ``three_or_more: pairs`` or ``coupled`` asks for."""
        c, mp = self._found, self._grid.mp
        changed = np.zeros(len(c.table.node), dtype=np.int64)
        coupled_pairs.start_pairs(self._axes, c.count, c.fields, c.table, c.geometry, c.rows, here, mp, v)
        laws = [which for which in laws if not self._skipped[which]]
        takes_turns = len(laws) > 1 or any(self._of_interface[which] for which in laws)
        rounds = 1 if takes_turns else coupled_pairs.ROUNDS
        for turn in (0, *range(1, coupled_pairs.ROUNDS + 1, rounds)):
            for which in laws:
                if self._of_interface[which]:
                    self.interfaces.find_pair_impulses(which, here, changed, turn)
                else:
                    coupled_pairs.find_pair_impulses(
                        self._parameters[which], self._axes, which, c.fields, c.begin, changed, turn,
                        rounds if turn > 0 else 1, not takes_turns, c.table, c.geometry, c.rows, here, mp,
                        self._grid.f,
                    )  # fmt: skip
            if turn == 0:
                most = len(c.fields.pair) if self._ways.coupled else 2
                if not coupled_pairs.choose_pairs(c.fields, c.begin, most, c.rows.state, changed):
                    break
            elif takes_turns and coupled_pairs.end_round(
                self._axes, c.fields, c.begin, changed, turn, c.rows
            ):
                break
        coupled_pairs.finish_pairs(self._axes, c.count, c.fields, c.begin, changed, c.rows, here, mp)

    def _start_increments(self) -> None:
        c, rows = self._found, self._found.rows
        self._call(
            impulses.start_increments, self._axes, c.count, self._evolving, rows.dp0, rows.dp, rows.prior, rows.net,
            parallel=self._parallel,
        )  # fmt: skip

    def _find_slip(self, v: Array | None, out: Array) -> None:
        c, grid = self._found, self._grid
        self._call(
            impulses.find_slip, self._axes, c.count, c.fields, c.table, grid.mp, grid.f if v is None else v,
            v is not None, out, parallel=self._parallel,
        )  # fmt: skip


def keeps_start_impulses(plan: Any) -> bool:
    """Whether Δp⁽¹⁾ changes the particles' momentum in a step of this plan, whatever the laws are."""
    return not (plan.method.flip or filters_out(plan))


def filters_out(plan: Any) -> bool:
    """Whether XPIC filters Δp⁽¹⁾ out again, except at sides that are bonded for good."""
    return bool(plan.method.projects and plan.corrects_filter and plan.order > 1)
