"""A running simulation: what a scene became, and the verbs that the time step calls."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from mpmcli.boundary.conditions import VelocityConditions
from mpmcli.boundary.loads import by_identity
from mpmcli.core.compiler import use_threads
from mpmcli.core.errors import SimulationError
from mpmcli.core.order import CellOrder
from mpmcli.core.runtime import available_threads
from mpmcli.core.state import State
from mpmcli.geometry.faces import surface_faces
from mpmcli.materials.strain import (
    ArtificialViscosity,
    block_count,
    stored_energy,
    update_strain_and_stress,
)
from mpmcli.solver import setup
from mpmcli.solver.averaging import NoAveraging, VolumeAveraging
from mpmcli.solver.clock import TaskClock
from mpmcli.solver.conditions import GridConditions, NoConditions
from mpmcli.solver.contact import NoContact, NodalContact
from mpmcli.solver.continuation import restore, state_arrays
from mpmcli.solver.courant import TimeStep
from mpmcli.solver.exits import held_sides, overrun_of, settle_exits
from mpmcli.solver.grid_view import show_on_grid, view_of_grid
from mpmcli.solver.loads import NodalLoads, NoLoads, place_of_identity
from mpmcli.solver.period import EveryStep, Period
from mpmcli.solver.plan import PARALLEL_FROM, allocate_step_arrays, make_plan
from mpmcli.solver.rigid import NoRigidBodies, RigidBodies
from mpmcli.solver.step import advance
from mpmcli.solver.transfer import Transfer
from mpmcli.stability.choice import ChosenCourant, GivenCourant

Array = np.ndarray
LOGGER = logging.getLogger("mpmcli")

GOOD_EVERY = 200
"""Steps between copies of the state, of which the last one is shown after a failure.

A step that fails before it has changed anything shows the state that it began with.
"""
SHOWN = ("X", "V", "F", "tau", "mass", "id", "body", "material")
"""Arrays of particles that are shown after a failure."""


class Simulation:
    """A scene set up to run.

    Parameters
    ----------
    loaded
        The scene as ``scene.load_scene`` read it.
    threads
        Number of threads; all that the process may use if None. It never changes a result.

    Attributes
    ----------
    state : what output sees
    plan, arrays, grid, particles, order, transfer : the parts of the step
    clock : the time that tasks take
    setup_report : text about the bodies
    """

    def __init__(self, loaded: Any, threads: int | None = None):
        scene = loaded.scene
        self.threads = use_threads(threads or available_threads())
        self.plan = make_plan(scene)
        self.period = Period(self.plan) if self.plan.is_periodic else EveryStep(self.plan)
        self.reached_order = self.plan.order
        self.grid = setup.make_grid(scene, self.plan)
        of_bodies = [scene.materials[body.material] for body in scene.bodies]
        section = setup.section_of(scene)
        turns = self._fill(scene)
        self.materials = list(scene.materials.values())
        name = self.plan.analysis_name
        self._parameters = [m.parameters(name, self.plan.adiabatic) for m in self.materials]
        self.parallel = self._is_large()
        self.order = CellOrder(self.particles, self.grid)
        self.on_exit = scene.domain.on_exit
        self.held_sides = held_sides(scene, self.grid)
        self._may_wait = {condition.name for condition in scene.boundary if condition.may_wait(self.grid)}
        self.transfer = Transfer(
            self.plan.analysis,
            self.plan.shape,
            self.particles,
            self.grid,
            self.order,
            self.parallel,
            self.describe,
            keeps_domain=self.plan.update.first > 0.0,
            affine=self.plan.velocity_gradient,
            stores_weights=self.plan.stores_weights,
            turns=turns,
            overrun=overrun_of(self.held_sides, self.grid, self.on_exit),
        )
        self.arrays = allocate_step_arrays(self.plan, self.grid, self.particles.count)
        self._J_limits = tuple(float(J) for J in scene.domain.volume_ratio)
        self.clock = TaskClock()
        self.surface_identities: dict[Any, Array] = {}
        self._speed2 = np.zeros(block_count(self.particles.count))
        self._bad = np.full(block_count(self.particles.count), -1, dtype=np.int64)
        self.wave_speed = max(
            m.initial_wave_speed(name)
            for i, m in enumerate(self.materials)
            if np.any(self.particles.material == i)
        )
        self.particle_speed = float(np.sqrt(np.square(self.particles.V).sum(axis=0).max()))
        self.courant_choice = self._choose_courant(scene)
        self.time_step = TimeStep(scene.time.step, self.courant_choice.courant, float(self.grid.cell.min()))
        self._dt = 0.0
        self._last_good: State | None = None
        self._is_untouched = True
        self._rigid_version = -1
        self.max_steps = scene.time.max_steps
        self.state = State(
            analysis=self.plan.analysis,
            particles=self.particles,
            bodies=[body.name for body in scene.bodies],
            materials=list(scene.materials),
            material_models=self.materials,
            strain_energy_density=self._strain_energy_density,
            full_ring=setup.full_ring(self.plan),
            grid=view_of_grid(self),
            X0=by_identity(self.particles) if self.plan.shows_displacement else None,
            rigid=tuple(i for i, model in enumerate(of_bodies) if model.kind == "rigid"),
        )
        self._used_materials = [i for i in range(len(self.materials)) if np.any(self.particles.material == i)]
        self.conditions = self._make_conditions(scene)
        self.loads = NodalLoads(self, scene.loads, section) if self.plan.has_loads else NoLoads()
        self._start_accounts(scene)
        self.averaging = VolumeAveraging(self) if self.plan.averages_volume else NoAveraging(self)
        self.rigid = RigidBodies(self, scene.bodies) if self.state.rigid else NoRigidBodies()
        self.contact = NodalContact(self, scene) if self.plan.has_contact else NoContact()
        self.state.contact = getattr(self.contact, "view", None)
        show_on_grid(self, self.contact.nodal_fields())
        if any("stress_free_at_rest" not in self.materials[i].properties for i in self._used_materials):
            self.update_stress(0.0)

    # ------------------------------------------------------------------ the step

    @property
    def timings(self) -> dict[str, float]:
        """Seconds per task so far."""
        return self.clock.timings

    @property
    def time(self) -> float:
        """Time of the state."""
        return self.state.time

    def step(self) -> None:
        """Advance by one time step; raises SimulationError where the simulation cannot go on."""
        if self.state.step % GOOD_EVERY == 0:
            self.keep_good_state()
        self._is_untouched = True
        try:
            self.time_step.courant = self.courant_choice.at(
                self.state.step, self.particles, self.wave_speed, self.particle_speed
            )
            self._dt = self.time_step.choose(self.wave_speed, self.particle_speed, self.describe_extreme)
            self.plan = self.period.plan_of_step(self)
            self.reached_order = self.plan.order
            with np.errstate(all="ignore"):  # the watchdogs say it better
                advance(self, self._dt)
            if self.state.step == 1:
                self._warn_of_idle_conditions()
        except SimulationError as error:
            if self._is_untouched and self.particles.are_possible():
                self.keep_good_state()
            error.state = self._last_good
            raise

    def keep_good_state(self) -> None:
        """Copy the state, to be shown if a later step fails."""
        last = None if self._last_good is None else self._last_good.particles
        if last is not None and last.count != self.particles.count:
            last = self._last_good = None  # give its memory back before the next copy takes as much
        self._last_good = replace(
            self.state,
            particles=self.particles.copy(into=last, names=SHOWN),
            work=dict(self.state.work),
            reactions=dict(self.state.reactions),
            extra=dict(self.state.extra),
            grid=None,
        )

    def state_arrays(self) -> dict[str, Any]:
        """What the next step depends on, by name (see ``solver.continuation``); not copied."""
        return state_arrays(self)

    def restore(self, arrays: Mapping[str, Array]) -> None:
        """Go back to a state that ``state_arrays`` gave; raises ArchiveError if it is not of this scene."""
        restore(self, arrays)

    def update_stress(self, dt: float) -> None:
        """Tasks 1.d and 5: deformation gradient, stress and energies of every particle."""
        self._is_untouched = False
        p = self.particles
        several = len(self._used_materials) > 1
        fastest = 0.0
        for i in self._used_materials:
            update_strain_and_stress[self.parallel](
                self.plan.analysis, self._parameters[i], i if several else -1, p.F, self.averaging.L, p.tau, p.H,
                p.mass, p.vol0, p.material, p.stress_work, self._viscous_now(), dt, self._J_limits,
                self._speed2, self._bad,
            )  # fmt: skip
            bad = int(self._bad.max())
            if bad >= 0:
                self._report_bad(bad)
            fastest = max(fastest, float(self._speed2.max()))
        self.wave_speed = float(np.sqrt(fastest))

    def account_for_work(self, dt: float) -> None:
        """Add the work that conditions and loads do in this step, the first change of the state."""
        self._is_untouched = False
        work = self.state.work
        if "boundary_work" in work:
            work["boundary_work"] += self.conditions.work(self.arrays.v)
        if "external_work" in work:
            work["external_work"] += self.loads.work(dt)
        self.contact.account(self.arrays.v, dt)

    def refuse_leaps(self) -> None:
        """Raise SimulationError if a particle has just moved by more than a cell along an axis."""
        if 1.0 < self.transfer.farthest < np.inf:
            raise SimulationError(
                f"a particle moved by {self.transfer.farthest:.3g} cells in one step; "
                f"{self.describe_extreme('fastest')}. {self._advice()}"
            )

    def finish_step(self, dt: float) -> None:
        """Task 6: what happened to time, speeds, damping and particles that left the domain."""
        state, a = self.state, self.arrays
        if a.node_work is not None:
            state.work["damping_work"] += float(a.node_work.sum())
        if a.damped is not None:
            state.work["damping_work"] += float(a.damped[: len(self.order.chunks) - 1].sum())
        self.particle_speed = self.transfer.largest_speed
        if not np.isfinite(self.particle_speed):
            self._report_runaway()
        if self.plan.has_conditions:
            state.reactions = self.conditions.reactions(dt)
        if self.transfer.particle_outside() >= 0:
            settle_exits(self)
        state.step += 1
        if "mean_order" in state.extra:
            state.extra["mean_order"] += (self.reached_order - state.extra["mean_order"]) / state.step
        state.time += dt
        state.dt = dt

    # ------------------------------------------------------------------ parts

    def _fill(self, scene: Any) -> Array | None:
        """Make the particles, and the report about the bodies; returns the turns of the particle domains."""
        self.particles, filled = setup.make_particles(scene, self.plan, self.grid)
        self.setup_report = setup.report_of_bodies(scene, self.plan, filled)
        return setup.turns_of_bodies(filled)

    def _is_large(self) -> bool:
        """Whether parallel kernels pay."""
        return self.particles.count >= PARALLEL_FROM

    def _choose_courant(self, scene: Any) -> Any:
        if scene.time.courant != "auto":
            return GivenCourant(scene.time.courant)
        choice = ChosenCourant(scene, self.particles)
        LOGGER.info("Courant number %.4g, chosen by the stability limit%s", choice.courant, choice.in_words())
        return choice

    @property
    def courant_of_step(self) -> float:
        """Courant number of the current step."""
        return self.time_step.courant_of(self._dt, self.wave_speed, self.particle_speed)

    @property
    def rigid_dofs(self) -> Array:
        """Active degrees of freedom of rigid bodies."""
        grid = self.grid
        if grid.active_version != self._rigid_version:
            self._rigid_version = grid.active_version
            self._rigid_dofs = grid.active[np.array(self.plan.rigid_fields)[grid.active // grid.node_count]]
        return self._rigid_dofs

    @property
    def has_mirror(self) -> bool:
        """Whether the scene has symmetry planes."""
        return self.conditions.mirror is not None

    def _make_conditions(self, scene: Any) -> NoConditions:
        if not self.plan.has_conditions:
            return NoConditions()
        conditions = VelocityConditions(scene.boundary, self.grid, self.plan.analysis, self._surface_nodes)
        return GridConditions(
            conditions,
            self.grid,
            rigid_fields=self.plan.rigid_fields,
        )

    def _surface_nodes(self, body: str, face: Any) -> Array:
        """Nodes that the particles on a face of a body see now; the face is that of the undeformed body."""
        p = self.particles
        key = (body, face.index, face.side)
        if key not in self.surface_identities:
            members = np.flatnonzero(p.body == self.state.bodies.index(body))
            self.surface_identities[key] = p.id[surface_faces(p.X, p.size, face.index, face.side, members)]
        place = place_of_identity(p.id)[self.surface_identities[key]]
        return self.transfer.seen_nodes(place[place >= 0])

    def _start_accounts(self, scene: Any) -> None:
        work = self.state.work
        if scene.boundary or self.on_exit != "error":
            work["boundary_work"] = 0.0
        if self.plan.has_loads:
            work["external_work"] = 0.0
        if self.plan.grid_damping or self.plan.particle_damping:
            work["damping_work"] = 0.0
        if self.on_exit == "delete":
            self.state.extra.update(deleted_particles=0.0, deleted_mass=0.0)
        if self.plan.is_periodic or self.plan.dynamic is not None:
            self.state.extra["mean_order"] = 0.0

    def remove_particles(self, kept: Array) -> None:
        """Keep only the particles of the mask ``kept`` (N,) in memory."""
        self.particles.keep(kept)
        blocks = block_count(self.particles.count)
        self._speed2, self._bad = self._speed2[:blocks], self._bad[:blocks]
        if self.arrays.X_new is not None:
            self.arrays.X_new = np.zeros_like(self.particles.X)
        self.order.drift = np.inf  # sort at the start of the next step; until then the grid shows this one

    def _viscous_now(self) -> ArtificialViscosity | None:
        if self.plan.viscosity is None:
            return None
        p, (linear, quadratic) = self.particles, self.plan.viscosity
        return ArtificialViscosity(
            linear, quadratic, float(self.grid.cell.min()), p.viscous_pressure, p.viscous_work
        )

    def _strain_energy_density(self) -> Array:
        p = self.particles
        out = np.zeros(p.count)
        for i in self._used_materials:
            stored_energy[self.parallel](
                self.plan.analysis, self._parameters[i], i, p.F, p.H, p.material, out
            )
        return out

    # ------------------------------------------------------------------ what can go wrong

    def _warn_of_idle_conditions(self) -> None:
        for name in self.conditions.idle(self.grid.mp):
            if name in self._may_wait:
                continue
            LOGGER.warning("boundary condition '%s' holds no node of a body at the start", name)

    def describe(self, particle: int) -> str:
        """Particle, body, position, cell and time in words, for messages; ``particle`` is its place in memory."""
        p, state, grid = self.particles, self.state, self.grid
        X = p.X[:, particle]
        at = ", ".join(f"{x:.6g}" for x in X)
        place = np.floor((X - grid.lower) / grid.cell)
        cell = f", cell ({', '.join(f'{i:.10g}' for i in place)})," if np.isfinite(place).all() else ""
        return (
            f"particle {p.id[particle]} of body '{state.bodies[p.body[particle]]}' at ({at}){cell} "
            f"in step {state.step + 1}, time {state.time:.6g}"
        )

    def describe_extreme(self, which: str) -> str:
        """The ``fastest`` or the most ``compressed`` particle in words, for messages."""
        p = self.particles
        if which == "fastest":
            speed = np.sqrt(np.square(p.V).sum(axis=0))
            particle = int(np.argmax(speed))
            return f"the fastest is {self.describe(particle)}, with speed {speed[particle]:.3g}"
        J = p.determinant()
        particle = int(np.argmin(J))
        return f"the most compressed is {self.describe(particle)}, with J = {J[particle]:.3g}"

    def _report_bad(self, particle: int) -> None:
        J = float(self.particles.determinant()[particle])
        if np.isfinite(J) and J <= 0.0:
            what = f"J = {J:.3g}: the particle turned inside out"
        elif np.isfinite(J) and not self._J_limits[0] <= J <= self._J_limits[1]:
            low, high = self._J_limits
            what = f"J = {J:.3g} is out of domain.volume_ratio, {low:g} to {high:g}"
        else:
            what = "the stress is not finite"
        raise SimulationError(f"{what}; {self.describe(particle)}. {self._advice()}")

    def _report_runaway(self) -> None:
        bad = ~np.isfinite(self.particles.V).all(axis=0)
        raise SimulationError(
            f"the velocity is not finite; {self.describe(int(np.argmax(bad)))}. {self._advice()}"
        )

    def _advice(self) -> str:
        courant = self.courant_of_step
        key, half = (
            ("step", 0.5 * self._dt)
            if self.time_step.courant is None
            else ("courant", 0.5 * self.time_step.courant)
        )
        return (
            f"The last step was {self._dt:.3g} (Courant number {courant:.2g}): most likely it is too long; "
            f"try time.{key}: {half:.2g}"
        )
