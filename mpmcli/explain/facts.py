"""What a scene switches on and what it leaves out: particles, arrays, kernels, memory, time step."""

from typing import Any

import numpy as np

from mpmcli.contact.choice import ContactChoice
from mpmcli.core.compiled.runtime import available_threads
from mpmcli.core.transfer.stencil import kept_as
from mpmcli.explain.cracks import crack_facts
from mpmcli.explain.heat import cost_of_heat, heat_facts
from mpmcli.explain.interfaces import interface_facts
from mpmcli.explain.redundant import find_questions, find_redundant
from mpmcli.explain.text import as_text
from mpmcli.solver.plan import Plan
from mpmcli.solver.setup import choose_contact
from mpmcli.solver.simulation import Simulation
from mpmcli.solver.stand_in import StandIn
from mpmcli.stability.heat import forecast as foresee_heat
from mpmcli.stability.models import NoKnownLimit
from mpmcli.stability.scene_limit import stable_courant

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
    loaded : the scene as ``scene.load_scene`` read it
    threads : threads that the estimate of the run time counts on; all that the process may use if None
    measured : what ``shares.measure`` found, to be reported too

    Returns
    -------
    dict
        Facts by name, all of them fit for JSON, and under ``text`` the same for people.
    """
    scene = loaded.scene
    threads = threads or available_threads()
    simulation = Simulation(loaded, threads)
    plan, grid, particles = simulation.plan, simulation.grid, simulation.particles
    kernels = StandIn(loaded, simulation).kernels_of_tasks()
    wave_speed, particle_speed = simulation.wave_speed, simulation.particle_speed
    fastest, cell = max(wave_speed, particle_speed), float(grid.cell.min())
    courant = simulation.time_step.courant
    dt = scene.time.step if courant is None else courant * cell / fastest
    foreseen = None if scene.heat is None else foresee_heat(scene, wave_speed, particle_speed)
    if foreseen is not None:
        dt = foreseen.dt
    courant = dt * fastest / cell
    stable, because = None, ""
    try:
        found = stable_courant(scene)
        stable, because = found.courant, found.because
    except NoKnownLimit as reason:
        because = str(reason)
    steps = int(np.ceil(scene.time.end / dt))
    contact = choose_contact(scene, plan)
    dense = simulation.nodal_arrays()
    particle_bytes = sum(array.nbytes for array in particles.arrays().values())
    particle_bytes += plan.shows_displacement * particles.X.nbytes
    if plan.stores_weights:
        kept = kept_as(plan.shape.parameters).columns(grid.width, grid.dimensions)
        particle_bytes += particles.count * 8 * (1 + kept)
    # of further sides only what cracks touch is ever used
    used = grid.used_dofs / grid.dof_count
    grid_bytes = sum(
        int(array.nbytes * (used if len(array) == grid.dof_count else 1.0)) for array in dense.values()
    )
    share = 1.0 + PASS_SHARE * (plan.order - 1)
    if foreseen is not None:
        share += cost_of_heat(scene, foreseen, PASS_SHARE)
    parallel = simulation.parallel
    seconds = STEP_NANOSECONDS[grid.dimensions] * share * particles.count * steps * 1e-9
    seconds = seconds / (threads if parallel else 1) + CALL_SECONDS * steps
    if measured is not None and measured["seconds_per_step"] is not None:
        seconds = measured["seconds_per_step"] * steps
    all_kernels = list(dict.fromkeys(name for names in kernels.values() for name in names))
    facts: dict[str, Any] = {
        "title": scene.title,
        "analysis": plan.analysis_name,
        "velocity_fields": len(plan.fields),
        "particles": particles.count,
        "grid_nodes": grid.node_count,
        "shape": scene.method.shape,
        "contact": contact.facts(simulation.order),
        "interfaces": interface_facts(scene, simulation, contact, dt, all_kernels),
        "cracks": crack_facts(scene, simulation),
        "heat": {} if foreseen is None else heat_facts(scene, simulation, foreseen, kernels),
        "tasks": list(kernels),
        "not_modelled": left_out(plan, contact),
        "kernels_of_tasks": kernels,
        "kernels": all_kernels,
        "arrays": sorted(dense),
        "particle_bytes": particle_bytes,
        "grid_bytes": grid_bytes,
        "wave_speed": wave_speed,
        "time_step": dt,
        "time_unit": loaded.units.label("time") if loaded.units.are_declared else None,
        "courant": courant,
        "courant_is_chosen": scene.time.courant == "auto",
        "stable_courant": stable,
        "stability_margin": None if stable is None else 1.0 - courant / stable,
        "stable_because": because,
        "steps": steps,
        "parallel": parallel,
        "threads": threads,
        "estimated_seconds": seconds,
        "measured": measured,
        "warnings": [f"{problem.path}: {problem.message}" for problem in simulation.setup_warnings],
        "redundant": [found._asdict() for found in find_redundant(scene, plan, dt)],
        "questions": list(find_questions(scene, plan)),
    }
    facts["text"] = as_text(facts)
    return facts


def left_out(plan: Plan, contact: ContactChoice) -> list[str]:
    """What the scene does not ask for; nothing of it is stored, computed or compiled."""
    absent = {
        "contact (one velocity field): nodal volumes, positions, gradients, normals": not contact.exists,
        "contact normals, separations and areas": contact.exists and not contact.knows_normals,
        "interface laws: jumps of displacement": contact.exists and not contact.has_interfaces,
        "rigid bodies": not any(plan.rigid_fields),
        "FMPM loop": not plan.has_full_mass_loop,
        "XPIC filter": not plan.method.projects,
        "second extrapolation of momenta": not plan.update.again,
        "averages of volume changes and pressures": not plan.averages_volume,
        "linear increments of deformation": not plan.linear_increments,
        "velocity conditions": not plan.has_conditions,
        "loads": not plan.has_loads,
        "damping": not plan.damping.takes_energy,
        "artificial viscosity": plan.viscosity is None,
        "heat conduction": plan.heat is None,
        "cracks: sides of nodes, faces": plan.sides == 1,
    }
    return [name for name, is_absent in absent.items() if is_absent]
