"""A running simulation: what a scene became, and its steps."""

import logging
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from time import perf_counter
from typing import Any

import numpy as np

from mpmcli.boundary.conditions import VelocityConditions
from mpmcli.boundary.exits import Exits, held_sides
from mpmcli.boundary.grid_conditions import GridConditions
from mpmcli.boundary.loads import Loads
from mpmcli.boundary.rigid import RigidBodies
from mpmcli.contact.nodal_contact import NodalContact
from mpmcli.core.analysis import full_ring
from mpmcli.core.compiled.compiler import use_threads
from mpmcli.core.compiled.runtime import available_threads
from mpmcli.core.errors import SimulationError
from mpmcli.core.identity import by_identity
from mpmcli.core.order import CellOrder
from mpmcli.core.state import State
from mpmcli.core.step import Step
from mpmcli.scene.filling import check_start
from mpmcli.scene.own_numbers import lightness, materials_of
from mpmcli.solver import continuation, setup
from mpmcli.solver.averaging import VolumeAveraging
from mpmcli.solver.courant import TimeStep
from mpmcli.solver.damping import Damping
from mpmcli.solver.failures import Failures
from mpmcli.solver.grid_view import show_on_grid, view_of_grid
from mpmcli.solver.heat_interval import make_interval
from mpmcli.solver.parts import Parts
from mpmcli.solver.period import Period
from mpmcli.solver.plan import PARALLEL_FROM, allocate_step_arrays, make_plan, make_velocity
from mpmcli.solver.step import Task, tasks_of
from mpmcli.solver.stress import StressUpdate
from mpmcli.solver.surfaces import Surfaces
from mpmcli.solver.transfer import Transfer
from mpmcli.stability.scene_limit import chosen_courant

Array = np.ndarray
LOGGER = logging.getLogger("mpmcli")

GOOD_EVERY = 200
"""Steps between copies of the state, of which the last one is shown after a failure.

A step that fails before it has changed anything shows the state that it began with.
"""
SHOWN = ("X", "V", "F", "tau", "T", "mass", "id", "body", "material")
"""Arrays of particles that are shown after a failure."""


class Simulation(Parts):
    """A scene set up to run.

    Parameters
    ----------
    loaded
        The scene as ``scene.load_scene`` read it.
    threads
        Number of threads; all that the process may use if None. It never changes a result.

    Attributes
    ----------
    plan : the choices of the scene; those in force in a step come with the step
    last_step : the step that was taken last
    timings : seconds per task so far, by number and name
    setup_report, setup_warnings : text about the bodies, and what to warn of them
    """

    def __init__(self, loaded: Any, threads: int | None = None):
        scene = loaded.scene
        threads = use_threads(threads or available_threads())
        self.plan = make_plan(scene)
        self.period = Period(self.plan) if self.plan.is_periodic else None
        self.grid = setup.make_grid(scene, self.plan)
        turns = self._fill(scene)
        self.parallel = self._is_large()
        self.threads = threads if self.parallel else 1
        self.order = CellOrder(self.particles, self.grid)
        self.velocity = make_velocity(self.plan, self.grid, self.particles)
        self.arrays = allocate_step_arrays(self.plan, self.velocity, self.particles.count)
        self.state = self._make_state(scene)
        self.max_steps = scene.time.max_steps
        self.heat_interval = None
        if self.plan.heat is not None:
            self.heat_interval = make_interval(scene, self.particles, lambda: self.particle_speed)
        self.time_step = TimeStep(
            scene.time.step, self._choose_courant(scene), float(self.grid.cell.min()), self.heat_interval
        )
        self.reached_order = self.plan.order
        self.last_step = Step(self.plan, 0.0, 0.0)
        self._last_good: State | None = None
        self._make_parts(scene, turns)
        self.particle_speed = float(np.sqrt(np.square(self.particles.V).sum(axis=0).max()))
        self.make_tasks()
        if self.stress.starts_with_stress or any(body.stress is not None for body in scene.bodies):
            self.stress.update(self.particles.L, 0.0)

    def _make_parts(self, scene: Any, turns: Array | None) -> None:
        """Make what the scene needs of the parts."""
        plan, grid, particles, state = self.plan, self.grid, self.particles, self.state
        materials, J = materials_of(scene), scene.domain.volume_ratio
        self.failures = Failures(particles, state, grid, self.time_step, J)
        self.stress = StressUpdate(
            plan, particles, materials, J, float(grid.cell.min()), self.parallel, self.failures.refuse_state,
            state.work, lightness(scene),
        )  # fmt: skip
        state.strain_energy_density = self.stress.energy_density
        held = held_sides(scene.conditions_on("velocity"), grid)
        self.exits = Exits(
            scene.domain.on_exit, held, grid, particles, state, self.failures.describe, self.remove_particles,
            self.order.jumped,
        )  # fmt: skip
        self.transfer = Transfer(
            plan.analysis,
            plan.shape,
            particles,
            grid,
            self.order,
            self.parallel,
            self.failures.describe,
            [self.velocity],
            bounds=self.exits.bounds,
            keeps_domain=plan.update.first > 0.0,
            stores_weights=plan.stores_weights,
            turns=turns,
        )
        self.surfaces = Surfaces(particles, state.bodies, self.transfer)
        self.clocks = setup.make_clocks(scene)
        self.conditions = self._make_conditions(scene)
        images = None if self.conditions is None else self.conditions.images
        mirror = None if images is None else images.mirror
        sides: Any = None
        if grid.periodic:
            from mpmcli.boundary.periodic import PeriodicSides

            sides = PeriodicSides(grid)
        others = images or sides  # a scene has no more than one of them
        self.damping = Damping(plan.damping, state, others)
        self.averaging = self.increments = None
        if plan.averages_volume:
            self.averaging = VolumeAveraging(plan.analysis, grid, particles, self.transfer, others)
        if plan.linear_increments:
            from mpmcli.solver.linear_increments import LinearIncrements

            self.increments = LinearIncrements(particles, self.parallel)
        self.rigid = self.loads = self.contact = self.heat = None
        if state.rigid:
            self.rigid = RigidBodies(
                setup.bodies_by_clocks(scene, self.clocks), state.rigid, plan.fields, plan.field_of_body, self.order,
                mirror,
            )  # fmt: skip
            self.damping.rigid = self.rigid
        if plan.has_loads:
            self.loads = self._make_loads(scene, None if others is None else others.complete_scalars)
        if plan.has_contact:
            self.contact = NodalContact(
                setup.choose_contact(scene, plan), self.order, self.transfer, self.conditions, mirror, self.rigid,
                state.work, self.parallel,
            )  # fmt: skip
            state.contact = self.contact.view
            if self.contact.choice.has_interfaces:
                from mpmcli.interfaces.interfaces import Interfaces

                self.contact.interfaces = Interfaces(
                    self.contact, self.order, state.work, plan.update, self.transfer.reach
                )
            if state.grid is not None:
                show_on_grid(state.grid, grid, self.contact.nodal_fields())
        self.cracks = None
        if scene.cracks:
            from mpmcli.cracks.cracks import Cracks

            self.cracks = Cracks(
                scene, plan, grid, state, self.order, self.transfer, self.conditions, lambda: self.wave_speed,
                None if self.loads is None else self.loads.per_mass,
            )  # fmt: skip
            state.cracks = self.cracks.view
        faces = None if self.cracks is None else self.cracks.faces
        corrections = (sides, images, self.conditions, self.contact, faces)
        self.velocity.corrections = [part for part in corrections if part is not None]
        if plan.heat is not None:
            from mpmcli.solver.heat import make_conduction

            self.heat = make_conduction(scene, self, mirror, self.surfaces.shown)

    def make_tasks(self) -> None:
        """List the tasks of a step, for every plan that steps may have."""
        plans = [self.plan, self.plan.of_flip()] if self.plan.is_periodic else [self.plan]
        self.tasks: dict[bool, list[Task]] = {plan.method.flip: tasks_of(plan, self) for plan in plans}
        self.timings = {task.title: 0.0 for tasks in self.tasks.values() for task in tasks}

    # ------------------------------------------------------------------ the step

    @property
    def time(self) -> float:
        """Time of the state."""
        return self.state.time

    @property
    def wave_speed(self) -> float:
        """Largest wave speed now."""
        return self.stress.wave_speed

    def step(self) -> None:
        """Advance by one time step; raises SimulationError where the simulation cannot go on."""
        if self.state.step % GOOD_EVERY == 0:
            self.keep_good_state()
        begun: list[Task] = []
        try:
            self.last_step = step = self._next_step()
            timings, begin = self.timings, perf_counter()
            for task in self.tasks[step.plan.method.flip]:
                begun.append(task)
                task.run(step)
                end = perf_counter()
                timings[task.title] += end - begin
                begin = end
            self.particle_speed = self.transfer.largest_speed
            if self.state.step == 1:
                self._warn_of_idle(self.conditions)
            if self.heat is not None and self.heat.acts and self.heat.acted == 1:
                self._warn_of_idle(self.heat.held)
        except SimulationError as error:
            if not any(task.changes_state for task in begun) and self.particles.are_possible():
                self.keep_good_state()
            error.state = self._last_good
            raise

    def _next_step(self) -> Step:
        """Choose the size of the next step, and what it does."""
        dt = self.time_step.choose(self.wave_speed, self.particle_speed, self.failures.describe_extreme)
        plan = self.plan
        if self.period is not None:
            plan = self.period.plan_of_step(self.time_step.courant_of_step)
        self.reached_order = plan.order
        return Step(plan, dt, self.state.time)

    # ------------------------------------------------------------------ what is kept

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
            cracks=self.state.cracks and self.state.cracks.copy(),
        )

    def state_arrays(self) -> dict[str, Any]:
        """Return what the next step depends on, by name (see ``solver.continuation``); not copied."""
        return continuation.state_arrays(self._memories())

    def restore(self, arrays: Mapping[str, Array]) -> None:
        """Go back to a state that ``state_arrays`` gave; raises ArchiveError if it is not of this scene."""
        continuation.restore(self._memories(), arrays)
        self._fit_to_particles()
        self.transfer.size_buffers()
        self.keep_good_state()

    def _memories(self) -> dict[str, Any]:
        """What remembers something from step to step, by the names of the checkpoint."""
        parts = ("time_step", "period", "contact", "cracks", "heat")
        return {
            "state": self.state,
            "speed": continuation.Speeds(self, self.stress),
            "order": self.order,
            "grid": self.grid,
            "surface": self.surfaces,
            **({"clocks": self.clocks} if self.clocks else {}),
            **self._start_positions(),
            **{name: part for name in parts if hasattr(part := getattr(self, name), "memory")},
            "particles": self.particles,
        }

    def _start_positions(self) -> dict[str, Any]:
        """Positions at time 0 where steps change them: those of particles that pass a periodic side."""
        if not self.grid.periodic or self.state.X0 is None:
            return {}
        from mpmcli.boundary.periodic import StartPositions

        return {"start": StartPositions(self.state.X0)}

    def remove_particles(self, kept: Array) -> None:
        """Keep only the particles of the mask ``kept`` (N,) in memory."""
        self.particles.keep(kept)
        self._fit_to_particles()
        self.order.drop(kept)  # sorted at the start of the next step; until then the grid shows this one

    def _fit_to_particles(self) -> None:
        self.stress.fit()
        if self.arrays.X_new is not None:
            self.arrays.X_new = np.zeros_like(self.particles.X)

    # ------------------------------------------------------------------ from the scene

    def _fill(self, scene: Any) -> Array | None:
        """Make the particles, and the report about the bodies; returns the turns of the particle domains."""
        self.particles, filled = setup.make_particles(scene, self.plan, self.grid)
        self.setup_warnings = check_start(scene, filled)
        self.setup_report = setup.report_of_bodies(scene, self.plan, filled)
        return setup.turns_of_bodies(filled)

    def _is_large(self) -> bool:
        """Whether parallel kernels pay."""
        return self.particles.count >= PARALLEL_FROM

    def _make_state(self, scene: Any) -> State:
        plan, work, extra = self.plan, {}, {}
        if scene.conditions_on("velocity"):
            work["boundary_work"] = 0.0
        if plan.heat is not None:
            work |= {"boundary_heat": 0.0, "source_heat": 0.0}
        if plan.has_loads:
            work["external_work"] = 0.0
        if plan.is_periodic or plan.dynamic is not None:
            extra["mean_order"] = 0.0
        return State(
            analysis=plan.analysis,
            particles=self.particles,
            bodies=[body.name for body in scene.bodies],
            materials=list(scene.materials),
            material_models=list(scene.materials.values()),
            full_ring=full_ring(plan.analysis),
            grid=view_of_grid(self.grid, self.arrays.v, plan.rigid_fields),
            X0=by_identity(self.particles.id, self.particles.X) if plan.shows_displacement else None,
            rigid=setup.rigid_bodies_of(scene),
            work=work,
            extra=extra,
            chunks=lambda: self.order.chunks,
        )

    def _choose_courant(self, scene: Any) -> float | None:
        courant = chosen_courant(scene)
        if scene.time.courant == "auto":
            LOGGER.info("Courant number %.4g, selected by auto", courant)
        return courant

    def _make_conditions(self, scene: Any) -> GridConditions | None:
        self._may_wait = {each.name for each in scene.boundary if not each.acts_at(0.0)}
        if not self.plan.has_conditions:
            return None
        models = scene.conditions_on("velocity")
        conditions = VelocityConditions(
            models, self.grid, self.plan.analysis, self.surfaces.nodes, self.clocks
        )
        is_moving = bool(self.plan.has_loads or self.particles.V.any())
        self._may_wait |= {
            condition.name
            for condition in models
            if condition.may_wait(self.grid) and (is_moving or condition.kind == "symmetry")
        }
        found = GridConditions(conditions, self.grid, self.plan.rigid_fields)
        setup.add_friction(found, models, self.grid, self.state, self.transfer)
        return found

    def _make_loads(self, scene: Any, complete: Any) -> Loads:
        rigid = self.rigid
        return Loads(
            setup.loads_by_clocks(scene, self.clocks),
            particles=self.particles,
            grid=self.grid,
            order=self.order,
            transfer=self.transfer,
            analysis=self.plan.analysis,
            shape=self.plan.shape,
            section=setup.section_of(scene),
            bodies=self.state.bodies,
            shown=self.surfaces.shown,
            rigid_dofs=None if rigid is None else lambda: rigid.dofs,
            complete=complete,
            parallel=self.parallel,
            impedance=lambda load: setup.impedance_of(scene, load, self.particles),
            areas=lambda weights: self._nodal_areas(weights),
        )

    @cached_property
    def _nodal_areas(self) -> Any:
        """Areas that matter has at nodes, of real particles only: loads on nodes are completed as all forces are."""
        from mpmcli.solver.nodal_areas import NodalAreas

        return NodalAreas(self.transfer, self.particles, self.grid, None)

    def _warn_of_idle(self, conditions: Any) -> None:
        for name in [] if conditions is None else conditions.idle():
            if name not in self._may_wait:
                LOGGER.warning("boundary condition '%s' holds no node of a body at the start", name)
