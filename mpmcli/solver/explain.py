"""What a scene switches on and what it leaves out: particles, arrays, kernels, memory, time step."""

from __future__ import annotations

import math
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from mpmcli.contact.clouds import find_candidates
from mpmcli.core.grid import Grid
from mpmcli.core.order import CellOrder
from mpmcli.core.particles import Particles
from mpmcli.core.runtime import available_threads
from mpmcli.core.stencil import kept_as
from mpmcli.scene.fields import law_table
from mpmcli.solver.explain_text import as_text
from mpmcli.solver.plan import PARALLEL_FROM, Plan, StepArrays, allocate_step_arrays, make_plan
from mpmcli.solver.setup import make_grid, make_particles
from mpmcli.solver.spare import find_questions, find_spare
from mpmcli.stability.blocks import NoKnownLimit
from mpmcli.stability.choice import ChosenCourant
from mpmcli.stability.scene_limit import SAFETY, known_limit

Array = np.ndarray

STEP_NANOSECONDS = {1: 250.0, 2: 130.0, 3: 280.0}
"""Rough time per particle, step and thread for each number of axes (ugimp, FLIP); see benchmarks/."""
CALL_SECONDS = 1e-4
"""Rough time of a step however few the particles are."""
PASS_SHARE = 0.15
"""Rough share of a step that one more order of FMPM or XPIC costs."""


@np.errstate(all="ignore")
def explain(
    loaded: Any, threads: int | None = None, measured: dict[str, Any] | None = None
) -> dict[str, Any]:
    """Tell what a scene will do, without doing it.

    Parameters
    ----------
    loaded
        The scene as ``scene.load_scene`` read it.
    threads
        Threads that the estimate of the run time counts on; all that the process may use if None.
    measured
        What ``shares.measure`` found, to be told too.

    Returns
    -------
    dict
        Facts by name, all of them fit for JSON, and under ``text`` the same for people.
    """
    scene = loaded.scene
    threads = threads or available_threads()
    plan = make_plan(scene)
    grid = make_grid(scene, plan)
    particles, _ = make_particles(scene, plan, grid)
    arrays = allocate_step_arrays(plan, grid, particles.count)
    name = plan.analysis_name
    present = sorted({int(i) for i in particles.material})
    models = list(scene.materials.values())
    wave_speed = max(models[i].initial_wave_speed(name) for i in present)
    particle_speed = float(np.sqrt(np.square(particles.V).sum(axis=0).max()))
    fastest, cell = max(wave_speed, particle_speed), float(grid.cell.min())
    auto = ChosenCourant(scene, particles) if scene.time.courant == "auto" else None
    courant = scene.time.courant if auto is None else auto.at(0, particles, wave_speed, particle_speed)
    dt = scene.time.step if courant is None else courant * cell / fastest
    courant = dt * fastest / cell
    limit, known = None, ""
    try:
        found = known_limit(scene)
        limit, known = found.courant, found.because
    except NoKnownLimit as reason:
        known = str(reason)
    if auto is not None and not math.isclose(auto.courant, auto.otherwise):
        limit, known = courant / SAFETY, "of what the bodies do at first"
    steps = int(np.ceil(scene.time.end / dt))
    kept = {f.name: getattr(arrays, f.name) for f in fields(StepArrays)}
    dense = {f"grid.{key}": array for key, array in (("mp", grid.mp), ("f", grid.f))}
    dense |= {key: array for key, array in kept.items() if array is not None}
    if plan.has_loads:
        dense["loads.force"] = np.zeros((grid.dof_count, grid.dimensions))
    contact = ContactChoice(scene, plan)
    dense |= contact.nodal_arrays(grid)
    particle_bytes = sum(array.nbytes for array in particles.arrays().values())
    particle_bytes += contact.particle_bytes(particles) + plan.shows_displacement * particles.X.nbytes
    if plan.stores_weights:
        kept = kept_as(plan.shape.parameters).columns(grid.width, grid.dimensions)
        particle_bytes += particles.count * 8 * (1 + kept)
    grid_bytes = sum(array.nbytes for array in dense.values())
    share = 1.0 + PASS_SHARE * (plan.order - 1)
    parallel = particles.count >= PARALLEL_FROM
    seconds = STEP_NANOSECONDS[grid.dimensions] * share * particles.count * steps * 1e-9
    seconds = seconds / (threads if parallel else 1) + CALL_SECONDS * steps
    if measured is not None and measured["seconds_per_step"] is not None:
        seconds = measured["seconds_per_step"] * steps
    facts: dict[str, Any] = {
        "title": scene.title,
        "analysis": name,
        "velocity_fields": len(plan.fields),
        "particles": particles.count,
        "grid_nodes": grid.node_count,
        "shape": scene.method.shape,
        "contact": contact.facts(particles, grid),
        "tasks": tasks_of(plan, contact),
        "not_modelled": left_out(plan, contact),
        "kernels": kernels_of(plan, contact),
        "arrays": sorted(dense),
        "particle_bytes": particle_bytes,
        "grid_bytes": grid_bytes,
        "wave_speed": wave_speed,
        "time_step": dt,
        "courant": courant,
        "courant_is_chosen": auto is not None,
        "auto_in_words": "" if auto is None else auto.in_words(),
        "known_stability_limit": limit,
        "stability_margin": None if limit is None else 1.0 - courant / limit,
        "stability_limit_of": known,
        "steps": steps,
        "parallel": parallel,
        "threads": threads,
        "estimated_seconds": seconds,
        "measured": measured,
        "could_be_dropped": [asdict(spare) for spare in find_spare(scene, plan, grid, particles, dt)],
        "to_find_out": find_questions(scene, plan),
    }
    facts["text"] = as_text(facts)
    return facts


class ContactChoice:
    """What a scene chooses about contact.

    Attributes
    ----------
    exists : several velocity fields can meet
    laws : the laws that act on those that do
    knows_normals : some law needs normals, separations and areas, and with them clouds of particles
    lumped, increments, later : contact acts on updated momenta, on every FMPM increment, on final velocities
    drives_apart : sides that overlap are driven apart
    """

    def __init__(self, scene: Any, plan: Plan):
        self._model = scene.contact
        self._plan = plan
        self._scene = scene
        self.exists = plan.has_contact
        laws = law_table(scene, plan.fields)[0] if self.exists else []
        self.laws = [law for law in laws if not law.skipped]
        self.knows_normals = any(law.needs_normal for law in self.laws)
        way = self._model.increments if self.laws and plan.has_full_mass_loop else "lumped"
        self.lumped = bool(self.laws) and way != "after"
        self.increments = way if way in ("net", "evolving") else ""
        self.later = way in ("after", "combined")
        self.starts = bool(self.laws) and not self._model.once
        drives = self.lumped and any(law.drives_apart for law in self.laws)
        self.removal = float(self._model.overlap_removal) if drives else 0.0
        self.drives_apart = self.removal > 0.0

    def facts(self, particles: Particles, grid: Grid) -> dict[str, Any]:
        """The choices in words, and how many nodes and particles contact looks at in the first step."""
        if not self.exists:
            return {}
        order = CellOrder(particles, grid)
        order.sort(False)
        near = find_candidates(order, grid)
        rigid = [
            name
            for name, is_rigid in zip(self._plan.fields, self._plan.rigid_fields, strict=True)
            if is_rigid
        ]
        is_screened = len(rigid) + 1 < len(self._plan.fields) and any(law.screened for law in self.laws)
        return {
            "fields": list(self._plan.fields),
            "rigid_fields": rigid,
            "laws": [law.kind for law in law_table(self._scene, self._plan.fields)[0]],
            "normal": self._model.normal.kind if self.knows_normals else None,
            "separation": self._model.separation.kind if self.knows_normals else None,
            "increments": self.increments or None,
            "mass_ratio": self._model.mass_ratio if is_screened else 0.0,
            "candidate_nodes": len(near.node),
            "candidate_particles": len(near.particle) if self.knows_normals else 0,
        }

    def nodal_arrays(self, grid: Grid) -> dict[str, Array]:
        """Arrays over all nodes that contact asks for."""
        arrays: dict[str, Array] = {}
        if self.exists:
            arrays["contact.slot_of_node"] = np.zeros(grid.node_count, dtype=np.int32)
            if self.knows_normals and getattr(self._model.normal, "reuse", False):
                arrays["contact.guesses"] = np.zeros((grid.dof_count, grid.dimensions))
        return arrays

    def particle_bytes(self, particles: Particles) -> int:
        """Memory that contact adds to particles."""
        if not self.knows_normals:
            return 0
        displacement = particles.X.nbytes if self._model.separation.needs_displacement else 0
        return displacement + (particles.mass.nbytes if any(law.adhesive for law in self.laws) else 0)

    def kernels(self) -> list[str]:
        """Names of the kernels that contact runs where fields meet."""
        if not self.laws:
            return []
        clouds = ["collect_sights", "sum_volumes", "find_geometry"] * self.knows_normals
        clouds += ["find_drive"] * self.drives_apart
        settling = [f"settle_stage({type(law.parameters()).__name__})" for law in self.laws]
        on_velocities = ["add_to_velocities"] * bool(self.increments or self.later)
        on_momenta = ["add_to_momenta", "start_increments"] * (self.lumped or self.starts)
        return [f"contact.{name}" for name in (*clouds, "find_slip", *settling, *on_momenta, *on_velocities)]


def tasks_of(plan: Plan, contact: ContactChoice) -> list[str]:
    """The tasks of a step that this scene has, in order."""
    again, first, last = plan.update.again, plan.update.first, plan.update.last
    loop = f"FMPM loop, {plan.order - 1} further passes" if plan.has_full_mass_loop else ""
    loop += f", contact ({contact.increments}) on every increment" if contact.increments else ""
    geometry = "normals, separations and areas" if contact.knows_normals else "no normals"
    filtered = ", aware of what contact corrected" if plan.corrects_filter else ""
    tasks = [
        "1 extrapolate mass and momentum" + (" of every velocity field" if contact.exists else ""),
        f"1.a find contacts, {geometry}" if contact.laws else "",
        "1.a contact on extrapolated momenta" if contact.starts else "",
        ("1.b–1.d strain and stress before the forces" + ", rates of volume averaged" * plan.averages_volume)
        if first
        else "",
        "2 averages of the mean stresses" if plan.averages_volume else "",
        "2 internal forces",
        "2 forces of loads" if plan.has_loads else "",
        "2.a velocity conditions" if plan.imposes_lumped else "",
        "3 update momenta",
        "3.a contact on updated momenta"
        + (f", {contact.removal:.3g} of overlaps taken back" if contact.drives_apart else "")
        if contact.lumped
        else "",
        f"3.b velocities by the {loop}" if loop else "3.b lumped velocities",
        "3.b contact on the velocities" if contact.later else "",
        f"3.b XPIC filter, {plan.order - 1} passes{filtered}" if plan.method.projects else "",
        "4 move particles",
        "4 move rigid bodies" if any(plan.rigid_fields) else "",
        "4.a–4.c extrapolate momenta again" + (", with contact" if contact.laws else "") if again else "",
        "5 averages of the rates of volume" if last and plan.averages_volume else "",
        "5 strain and stress" if last else "",
    ]
    return [task for task in tasks if task]


def left_out(plan: Plan, contact: ContactChoice) -> list[str]:
    """What the scene does not ask for; nothing of it is stored, computed or compiled."""
    absent = {
        "contact (one velocity field): nodal volumes, positions, gradients, normals": not contact.exists,
        "contact normals, separations, areas and clouds of particles": contact.exists
        and not contact.knows_normals,
        "rigid bodies": not any(plan.rigid_fields),
        "FMPM loop": not plan.has_full_mass_loop,
        "XPIC filter": not plan.method.projects,
        "second extrapolation of momenta": not plan.update.again,
        "averages of volume changes and pressures": not plan.averages_volume,
        "velocity conditions": not plan.has_conditions,
        "loads": not plan.has_loads,
        "damping": not (plan.particle_damping or plan.grid_damping),
        "artificial viscosity": plan.viscosity is None,
    }
    return [name for name, is_absent in absent.items() if is_absent]


def kernels_of(plan: Plan, contact: ContactChoice) -> list[str]:
    """Names of the kernels that a step of this scene runs, with the tasks that the scatter is compiled for."""
    loop = plan.has_full_mass_loop
    projects = plan.method.projects
    first, again, averages = plan.update.first > 0.0, plan.update.again, plan.averages_volume
    used = {
        "clear_nodes": True,
        "scatter(StateAndForces)": plan.has_final_stress,
        "scatter(MassAndMomentum)": not plan.has_final_stress,
        "scatter(InternalForces)": not plan.has_final_stress,
        "scatter(WeightedSums)": averages,
        "mean_of_rows": averages,
        "divide_sums": averages,
        "shift_rows": averages,
        "scatter(VectorSum)": again,
        "scatter(Projection)": loop or (projects and plan.order > 1),
        "update_momenta": True,
        "find_velocities": True,
        "start_increments": loop,
        "next_increment": loop,
        "add_increment": loop,
        "start_projection": projects,
        "next_projection": projects and plan.order > 1,
        "add_projected": projects,
        "move_particles": True,
        "find_velocity_gradients": again or first,
        "add_nodal": plan.has_loads,
        "external_power": plan.has_loads,
        "update_strain_and_stress": True,
    }
    return [name for name, is_used in used.items() if is_used] + contact.kernels()
