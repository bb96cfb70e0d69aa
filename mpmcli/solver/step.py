"""One time step as a list of tasks, in the order and with the numbers of Nairn (2026), section 2.1 and Fig. 1."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mpmcli.core.step import Step
from mpmcli.core.suggest import listing
from mpmcli.core.transfer import nodes
from mpmcli.core.transfer.full_mass import add_filtered_values, add_full_mass_increments
from mpmcli.solver.parts import Parts
from mpmcli.solver.plan import Plan

if TYPE_CHECKING:  # imported by scenes that conduct heat
    from mpmcli.transport.conduction import Conduction


@dataclass
class Task:
    """A task of the step.

    Attributes
    ----------
    number : of Fig. 1
    name : what it does
    run : does it in a step
    changes_state : it changes particles or accounts, so that the step cannot be taken back
    title : number and name
    """

    number: str
    name: str
    run: Callable[[Step], None]
    changes_state: bool = False
    title: str = ""

    def __post_init__(self) -> None:
        self.title = f"{self.number} {self.name}"


def tasks_of(plan: Plan, s: Parts) -> list[Task]:
    """Return the tasks of a step with this plan, in order; nothing else says what a step does."""
    do = _Tasks(s)
    conditions, loads, contact, heat = s.conditions, s.loads, s.contact, s.heat
    faces, growth = (None, None) if s.cracks is None else (s.cracks.faces, s.cracks.growth)
    first, last, again = plan.update.first > 0.0, plan.update.last > 0.0, plan.update.again
    tasks = [
        Task("1", "extrapolate mass and momentum", do.extrapolate),
        loads and Task("1", "loads on nodes", loads.collect),
        conditions and Task("1", "held nodes", conditions.select),
        contact and Task("1.a", do.first_contact, contact.after_extrapolation),
        faces and Task("1.a", "contact of crack faces", faces.after_extrapolation),
        first and Task("1.b", f"velocities before the forces{do.loop_in_words(plan)}", do.find_strain_velocities),
        first and Task("1.d", "strain and stress before the forces", do.update_first_stress, True),
        heat and Task("1.h", "nodal temperatures", heat.extrapolate if first else heat.find_values),
        heat and Task("2.h", "loads of heat and held temperatures", heat.prepare_powers),
        Task("2", do.second, do.find_forces),
        Task("3", "update momenta", do.update_momenta),
        conditions and plan.imposes_lumped and Task("2.a", "reactions of conditions", conditions.impose_on_momenta),
        contact and Task("3.a", do.second_contact, contact.after_update),
        faces and Task("3.a", "contact of crack faces on updated momenta", faces.after_update),
        Task("3.b", f"velocities{do.loop_in_words(plan)}", do.find_velocities),
        do.accounts and Task("3", f"work of {listing(do.accounts)}", do.account, True),
        heat and Task("3.h", f"temperatures{do.loop_of_heat(heat)}", heat.update),
        Task("4", f"{do.motion} particles" + " and rigid bodies" * (s.rigid is not None), do.move_particles, True),
        faces and Task("4", "move crack faces", do.move_cracks, True),
        again and Task("4.a", "extrapolate momenta again", do.extrapolate_again),
        again and contact and Task("4.b", "contact on momenta extrapolated again", contact.after_new_extrapolation),
        again and faces and Task("4.b", "contact of crack faces again", faces.after_new_extrapolation),
        again and Task("4.c", f"velocities again{do.loop_in_words(plan)}", do.find_strain_velocities),
        last and Task("5", "strain and stress", do.update_last_stress),
        Task("6", "time, speeds and exits", do.finish),
        growth and Task("6", "growth of cracks", growth.grow, True),
    ]  # fmt: skip
    return [task for task in tasks if task]


def in_words(passes: int) -> str:
    """Return a number of passes over all particles."""
    return f"{passes} pass" + "es" * (passes != 1)


class _Tasks:
    """What the tasks do that no part does by itself."""

    def __init__(self, s: Parts):
        self._s = s

    @property
    def accounts(self) -> list[str]:
        """What does work that is accounted for."""
        s = self._s
        parts = {"conditions": s.conditions, "loads": s.loads, "contact": s.contact, "cracks": s.cracks}
        return [name for name, part in parts.items() if part is not None]

    @property
    def first_contact(self) -> str:
        """What contact does with extrapolated momenta."""
        contact = self._s.contact
        return "contact on extrapolated momenta" if contact and contact.choice.starts else "find contacts"

    @property
    def second_contact(self) -> str:
        """What contact does with updated momenta."""
        contact = self._s.contact
        return (
            "contact on updated momenta"
            if contact and contact.choice.lumped
            else "contact waits for velocities"
        )

    def loop_in_words(self, plan: Plan) -> str:
        """What makes grid velocities of momenta, besides division by mass."""
        contact = self._s.contact
        if plan.has_full_mass_loop:
            words = f", FMPM loop with {in_words(plan.order - 1)}"
            if contact and contact.choice.increments:
                words += ", contact on every increment"
            return words + ", then contact" if contact and contact.choice.later else words
        if plan.method.projects:
            aware = ", with contact corrections" * plan.corrects_filter
            return f", XPIC filter with {in_words(plan.order - 1)}{aware}"
        return ""

    @property
    def second(self) -> str:
        """What task 2 does."""
        s = self._s
        loads = " of stresses and loads" * (s.loads is not None)
        return f"forces{loads}" + ", heat conduction" * (s.heat is not None)

    @property
    def motion(self) -> str:
        """What task 4 does."""
        return "move" if self._s.heat is None else "move and warm"

    def loop_of_heat(self, heat: Conduction) -> str:
        """What makes nodal temperatures of heat, besides division by capacity."""
        passes = heat.choices.order - 1
        if not passes:
            return ""
        return f", {'FMPM' if heat.choices.replaces else 'full-capacity'} loop with {in_words(passes)}"

    def extrapolate(self, step: Step) -> None:
        """Task 1, and task 2's internal forces if the stress is final already."""
        s, plan = self._s, step.plan
        s.transfer.begin_step()
        scalar = None if s.heat is None else s.heat.begin_step(step)
        s.transfer.extrapolate(
            s.velocity, replaces_values=not plan.method.flip, with_forces=self._finds_forces_early(plan),
            scalar=None if plan.update.first > 0.0 else scalar,
        )  # fmt: skip
        if s.rigid is not None:  # after the last sort of the step
            s.rigid.prepare(step)

    def _finds_forces_early(self, plan: Plan) -> bool:
        """Whether task 1 finds the forces too; conduction waits for nodal temperatures, and shares their pass."""
        return plan.has_final_stress and (self._s.heat is None or not self._s.heat.acts)

    def find_strain_velocities(self, step: Step) -> None:
        """Tasks 1.b and 1.c, or 4.c: velocities of the momenta, and their gradients; nothing of it is a reaction."""
        s, v = self._s, self._s.arrays.v
        nodes.find_velocities[s.parallel](s.grid.active, s.velocity.zero, s.grid.mp, s.grid.f, v, None)
        if step.plan.imposes_lumped and s.conditions is not None:
            s.conditions.impose_on_velocity(v, counts_reactions=False)
        self._refine(step, counts_reactions=False)
        s.transfer.velocity_gradients(v)

    def update_first_stress(self, step: Step) -> None:
        """Task 1.d."""
        self._update_stress(step.plan.update.first * step.dt)

    def find_forces(self, step: Step) -> None:
        """Task 2: forces from Kirchhoff stress on initial volume, and from loads."""
        s = self._s
        if not self._finds_forces_early(step.plan):
            tau = s.particles.tau
            if s.averaging is not None:
                s.averaging.average_stresses()
                tau = s.averaging.tau
            s.transfer.internal_forces(tau, s.grid.f, None if s.heat is None else s.heat.to_conduct())
        if s.loads is not None:
            s.loads.add_to(s.grid.f)
        if s.cracks is not None:
            s.cracks.add_forces(step, s.grid.f)
        s.velocity.complete(s.grid.f, step.dt)

    def update_momenta(self, step: Step) -> None:
        """Task 3."""
        s, damping = self._s, self._s.damping
        mp, f = s.grid.mp, s.grid.f
        damping.prepare(step)
        damping.add_local(step, s.grid, s.conditions, s.parallel)
        nodes.update_momenta[s.parallel](
            s.grid.active,
            s.grid.active_chunks,
            mp,
            f,
            damping.grid,
            step.dt,
            s.arrays.p_start,
            damping.of_nodes,
        )
        damping.leave_out_others(mp, f, step.dt)

    def find_velocities(self, step: Step) -> None:
        """Task 3.b: grid velocities v⁺(k), and accelerations or filtered velocities where the transfer asks."""
        s, plan, v = self._s, step.plan, self._s.arrays.v
        w: Any = None if plan.method.full_mass else s.arrays.w
        nodes.find_velocities[s.parallel](s.grid.active, s.velocity.zero, s.grid.mp, s.grid.f, v, w)
        self._refine(step, counts_reactions=True)
        if plan.method.projects:
            add_filtered_values(s.velocity, s.transfer, step, plan.order, s.arrays.p_start, w, s.arrays.start)

    def account(self, step: Step) -> None:
        """The work that conditions, loads and contact do in this step."""
        s = self._s
        v, work = s.arrays.v, s.state.work
        if s.conditions is not None and "boundary_work" in work:
            work["boundary_work"] += s.conditions.work(v)
            if s.conditions.friction:
                s.state.extra["boundary_friction_work"] -= s.conditions.friction_work * s.state.full_ring
        if s.loads is not None:
            work["external_work"] += s.loads.work(v, step.dt)
        if s.contact is not None:
            s.contact.account(step, v)
        if s.cracks is not None:
            s.cracks.account(step, v)

    def move_particles(self, step: Step) -> None:
        """Task 4; with USL, task 5's velocity gradients come from the same stencils."""
        s, plan, a = self._s, step.plan, self._s.arrays
        X_new = a.X_new if plan.keeps_positions else s.particles.X
        s.transfer.move(
            a.v, None if plan.method.full_mass else a.w, a.start if plan.method.projects else None, plan.method.flip,
            plan.alpha, s.damping.particle, step.dt, X_new,
            plan.velocity_gradient or (plan.update.last > 0.0 and not plan.update.again), s.damping.of_particles,
            s.damping.damped_masses(s.particles), None if s.heat is None else s.heat.to_give(),
        )  # fmt: skip
        if s.heat is not None:
            s.heat.close()
        s.failures.refuse_leap(s.transfer.farthest)
        if s.rigid is not None:
            s.rigid.move(X_new)

    def move_cracks(self, step: Step) -> None:
        """Task 4 for cracks: their faces move with the matter."""
        s = self._s
        assert s.cracks is not None
        s.cracks.move(step, s.arrays.X_new if step.plan.keeps_positions else s.particles.X)

    def extrapolate_again(self, step: Step) -> None:
        """Task 4.a: momenta of the new particle velocities."""
        s, p = self._s, self._s.arrays.p_again
        nodes.clear_nodes[s.parallel](s.grid.active, p)
        s.transfer.add_values(s.velocity, p)
        s.grid.mp[s.grid.active, 1:] = p[s.grid.active]

    def update_last_stress(self, step: Step) -> None:
        """Task 5."""
        self._update_stress(step.plan.update.last * step.dt)

    def finish(self, step: Step) -> None:
        """Task 6: new positions, what damping took, reactions, particles that left the domain, the time."""
        s, state = self._s, self._s.state
        if step.plan.keeps_positions:
            s.arrays.X_new = s.particles.exchange_positions(s.arrays.X_new)
        if s.increments is not None and step.plan.velocity_gradient and not step.plan.update.again:
            s.increments.follow(step.dt)
        s.damping.account()
        s.failures.refuse_speed(s.transfer.largest_speed)
        if s.conditions is not None:
            state.reactions = s.conditions.reactions(step.dt)
        if s.transfer.lost >= 0:
            s.exits.apply()
        state.step += 1
        if "mean_order" in state.extra:
            state.extra["mean_order"] += (s.reached_order - state.extra["mean_order"]) / state.step
        state.time += step.dt
        state.dt = step.dt

    def _refine(self, step: Step, counts_reactions: bool) -> None:
        """Lumped velocities become v⁺(k)."""
        s, plan, v = self._s, step.plan, self._s.arrays.v
        if plan.has_full_mass_loop:
            s.reached_order = add_full_mass_increments(
                s.velocity, s.transfer, step, plan.order_rule, counts_reactions
            )
            if s.contact is not None:
                s.contact.after_velocities(step, v)
        if plan.imposes_velocity and s.conditions is not None:
            s.conditions.impose_on_velocity(v, counts_reactions)

    def _update_stress(self, dt: float) -> None:
        s = self._s
        L = s.particles.L
        if s.averaging is not None:
            s.averaging.average_rates()
            L = s.averaging.L
        if s.increments is not None:
            L = s.increments.rates(L, dt)
        s.stress.update(L, dt)
