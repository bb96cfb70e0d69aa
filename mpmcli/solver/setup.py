"""From a checked scene to particles and grid at time zero."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from mpmcli.boundary.clocks import Clock, ClockedLoad, ClockedVelocity, Clocks
from mpmcli.boundary.grid_conditions import GridConditions
from mpmcli.boundary.symmetry import symmetry_line
from mpmcli.contact.choice import ContactChoice
from mpmcli.core.errors import SceneError
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.state import State
from mpmcli.geometry.bodies import BodyParticles
from mpmcli.geometry.fill import fill_bodies
from mpmcli.geometry.report import body_report, report_table
from mpmcli.materials.base import history_at_start, needs_increment
from mpmcli.materials.own_numbers import OwnMaterial
from mpmcli.scene.axes import turn_history
from mpmcli.scene.event_checks import clocked
from mpmcli.scene.fields import covering, exchanges_by_area, law_table
from mpmcli.scene.filling import (
    check_memory,
    find_masses,
    ghost_layers,
    section_of,
    start_temperature,
    start_velocity,
)
from mpmcli.scene.own_numbers import materials_of, set_own_numbers, values_of_particles
from mpmcli.solver.plan import Plan
from mpmcli.solver.transfer import Transfer

Array = np.ndarray

AMBIENT = 300.0
"""Temperature of rigid bodies that are given none."""


def make_grid(scene: Any, plan: Plan) -> Grid:
    """The scene's grid, with the ghost layers that its shape function needs."""
    grid = scene.grid
    check_memory(scene)
    found = Grid(
        np.array(grid.lower),
        np.array(grid.upper),
        np.array(grid.cell),
        ghost_layers(scene),
        plan.shape.width,
        fields=len(plan.fields),
        sides=plan.sides,
        periodic=tuple("xyz".index(axis) for axis in grid.periodic or ()),
    )
    found.mirrors = tuple(
        (
            condition.plane.index,
            symmetry_line(condition.plane, found),
            condition.plane.side_on(found) == "lower",
        )
        for condition in scene.conditions_on("velocity")
        if condition.kind == "symmetry"
    )
    return found


@np.errstate(all="ignore")
def make_particles(scene: Any, plan: Plan, grid: Grid) -> tuple[Particles, list[BodyParticles]]:
    """Fill all bodies; particles with mass, velocity and the materials' initial history."""
    filled = fill_bodies(scene.bodies, grid, plan.analysis, covering(scene.boundary))
    names = list(scene.materials)
    X = np.concatenate([body.X for body in filled], axis=1)
    index, vol0, mass = find_masses(scene, filled)
    material = np.array([names.index(body.material) for body in scene.bodies])[index]
    models = materials_of(scene)
    particles = Particles.at_rest(
        plan.analysis,
        X,
        np.concatenate([b.size for b in filled], axis=1),
        vol0,
        mass,
        body=index,
        material=material,
        velocity_field=np.array(plan.field_of_body)[index],
        history_rows=max(len(model.history) for model in models),
        artificial_viscosity=plan.viscosity is not None,
    )
    for m, model in enumerate(models):
        if model.history:
            particles.H[: len(model.history), material == m] = history_at_start(model, 1)
    _set_own_numbers(scene, particles, models)
    if any(model.bands for model in models):
        from mpmcli.scene.bands import set_bands

        set_bands(scene, particles, models)
    if plan.has_temperature:
        _allocate_temperatures(particles, models, plan)
    _set_initial_fields(scene, plan, particles, models)
    if choose_contact(scene, plan).uses_rigid_surfaces:
        _set_outward_normals(scene, plan, particles, grid)
    if plan.velocity_gradient:
        _set_initial_gradients(scene, particles)
    if any(body.stress is not None for body in scene.bodies):
        from mpmcli.solver.initial_stress import set_initial_stress

        set_initial_stress(scene, plan, particles, models)
    if plan.heat is not None:
        from mpmcli.solver.heat import allocate_particles

        allocate_particles(scene, particles)
    return particles, filled


def report_of_bodies(scene: Any, plan: Plan, filled: list[BodyParticles]) -> str:
    """Return the table of the bodies' particles, mass, volume and bounds."""
    models = [scene.materials[body.material] for body in scene.bodies]
    densities = [None if model.kind == "rigid" else model.density for model in models]
    return report_table(
        body_report(scene.bodies, filled, densities, scene.grid, plan.analysis, section_of(scene))
    )


def turns_of_bodies(filled: list[BodyParticles]) -> Array | None:
    """Turns (bodies, d, d) from the sides of each body's particle domains to the grid's axes; None without any."""
    if all(body.turn is None for body in filled):
        return None
    return np.stack([np.eye(len(body.X)) if body.turn is None else body.turn for body in filled])


def choose_contact(scene: Any, plan: Plan) -> ContactChoice:
    """Return what the scene chooses about contact."""
    laws, table = law_table(scene, plan.fields)
    return ContactChoice(
        scene.contact,
        plan.fields,
        plan.rigid_fields,
        laws,
        table,
        has_loop=plan.has_full_mass_loop,
        particles_per_axis=min(min(np.ravel(body.particles_per_axis)) for body in scene.bodies),
        thickness=section_of(scene),
        needs_area=exchanges_by_area(scene, plan.fields),
        whole_fields=_fields_without_cracks(scene, plan) if scene.cracks else None,
    )


def add_friction(
    conditions: GridConditions, models: Sequence[Any], grid: Grid, state: State, transfer: Transfer
) -> None:
    """Make the friction of conditions that rub."""
    rough = [(i, model) for i, model in enumerate(models) if getattr(model, "rubs", False)]
    if not rough:
        return
    from mpmcli.boundary.plane_friction import PlaneFriction
    from mpmcli.solver.nodal_areas import NodalAreas

    areas = None
    if any(model.cohesion for _, model in rough):
        areas = NodalAreas(transfer, state.particles, grid, conditions.images)
    for i, model in rough:
        conditions.friction[i] = PlaneFriction(
            i,
            model.friction or 0.0,
            model.cohesion or 0.0,
            model.inward(grid),
            areas if model.cohesion else None,
        )
    state.extra["boundary_friction_work"] = 0.0


def make_clocks(scene: Any) -> Clocks:
    """Make the clocks of what events act on."""
    turning = [event for event in scene.events or () if event.do != "stop"]
    if not turning:
        return Clocks()
    boundary, loads, bodies = (enumerate(each) for each in (scene.boundary, scene.loads, scene.bodies))
    names = [name for name, _ in clocked(boundary, loads, bodies, scene.materials)]
    if all(event.to is not None for event in turning):
        names = [name for name in names if any(name in event.to for event in turning)]
    return Clocks((name, Clock()) for name in names)


def loads_by_clocks(scene: Any, clocks: Clocks) -> list[Any]:
    """Return the loads of a scene, which may go by clocks."""
    loads = scene.loads_on("velocity")
    return [ClockedLoad(load, clocks[load.name]) if load.name in clocks else load for load in loads]


def impedance_of(scene: Any, load: Any, particles: Particles) -> Array:
    """Return the impedance (N, d) of a load that absorbs waves, by identity, with the numbers of each particle.

    It comes before the first step. Rigid materials have none, nor have bodies that the load is not on.
    """
    kind, d, face = scene.analysis.kind, scene.dimensions, load.loaded_face()
    order = np.argsort(particles.id)
    place, index = particles.X[:, order], particles.body[order]
    found = np.zeros((len(order), d))
    for i, body in enumerate(scene.bodies):
        material, mine = scene.materials[body.material], index == i
        if material.kind != "rigid" and (face is None or face[0] == body.name):
            values = values_of_particles(
                body, material, lambda model: tuple(load.impedance_of(model, kind, d)), place[:, mine]
            )
            found[mine] = values.T
    return found


def bodies_by_clocks(scene: Any, clocks: Clocks) -> Sequence[Any]:
    """Return the bodies of a scene; rigid ones may go by clocks."""
    if not any(body.name in clocks for body in scene.bodies):
        return tuple(scene.bodies)
    return [
        SimpleNamespace(
            name=body.name, velocity=[ClockedVelocity(each, clocks[body.name]) for each in body.velocity]
        )
        if body.name in clocks
        else body
        for body in scene.bodies
    ]


def _fields_without_cracks(scene: Any, plan: Plan) -> list[bool]:
    """Whether each velocity field has no body that a crack may cut."""
    whole = [True] * len(plan.fields)
    for body, field in zip(scene.bodies, plan.field_of_body, strict=True):
        if scene.materials[body.material].kind != "rigid":
            whole[field] &= all(
                crack.cuts is not None and body.name not in crack.cuts for crack in scene.cracks
            )
    return whole


def rigid_bodies_of(scene: Any) -> tuple[int, ...]:
    """Return the indices of the rigid bodies."""
    return tuple(i for i, b in enumerate(scene.bodies) if scene.materials[b.material].kind == "rigid")


def _allocate_temperatures(particles: Particles, models: list[Any], plan: Plan) -> None:
    """Temperatures of the start, without those that bodies give."""
    T0 = np.array([getattr(model, "T0", AMBIENT) for model in models])
    particles.T = T0[particles.material]
    used = [models[m] for m in np.unique(particles.material)]
    if any(
        getattr(model, "expansion", 0.0) > 0.0
        and needs_increment(model.parameters(plan.analysis_name, plan.adiabatic))
        for model in used
    ):
        particles.T_stress = particles.T.copy()


def _set_own_numbers(scene: Any, particles: Particles, models: list[Any]) -> None:
    """Numbers that particles have from their files."""
    for i, body in enumerate(scene.bodies):
        model = models[list(scene.materials).index(body.material)]
        if isinstance(model, OwnMaterial):
            mine = np.flatnonzero(particles.body == i)
            H = particles.H[:, mine]
            set_own_numbers(scene, model, body, particles.X[:, mine], H)
            particles.H[:, mine] = H


def _set_initial_gradients(scene: Any, particles: Particles) -> None:
    """Velocity gradients of the initial velocity fields, by differences over each particle's own width."""
    d = particles.X.shape[0]
    for i, body in enumerate(scene.bodies):
        mine = np.flatnonzero(particles.body == i)
        for row, component in enumerate(body.velocity):
            for axis in range(d):
                half = particles.size[axis, mine]
                ahead, behind = particles.X[:, mine], particles.X[:, mine]
                ahead[axis] += half
                behind[axis] -= half
                difference = component(*_point(ahead)) - component(*_point(behind))
                particles.L[d * row + axis, mine] = difference / (2.0 * half)


def _set_outward_normals(scene: Any, plan: Plan, particles: Particles, grid: Grid) -> None:
    """Normals of the surfaces of rigid bodies; those that share a velocity field or move alike have one surface."""
    from mpmcli.geometry.outward import FARTHEST, outward_normals

    particles.outward = np.zeros((scene.dimensions + 1, particles.count))
    fields, rigid = plan.field_of_body, rigid_bodies_of(scene)
    bounds = [body.region.bounds(scene.dimensions) for body in scene.bodies]
    for i in rigid:
        mine = np.flatnonzero(particles.body == i)
        X = particles.X[:, mine]
        reach = FARTHEST * grid.cell.max()
        low, high = X.min(axis=1) - reach, X.max(axis=1) + reach
        near = [bool(((lower <= high) & (upper >= low)).all()) for lower, upper in bounds]
        motion = scene.bodies[i].motion
        alike = [j for j in rigid if fields[j] == fields[i] or scene.bodies[j].motion == motion]
        one_surface = [
            (scene.bodies[j].region, [scene.bodies[k].region for k in _cutters_of(scene, j) if near[k]])
            for j in alike
            if near[j]
        ]

        def contains(points: Array, parts: list[Any] = one_surface) -> Array:
            inside = np.zeros(points.shape[1], dtype=bool)
            for region, cuts in parts:
                matter = region.contains(points)
                for cut in cuts:
                    matter[matter] = ~cut.contains(points[:, matter])
                inside |= matter
            return inside

        step = max(region.step() for part, cuts in one_surface for region in (part, *cuts))
        particles.outward[:, mine] = outward_normals(contains, X, grid, step)


def _cutters_of(scene: Any, i: int) -> list[int]:
    """Bodies whose regions take places from body ``i``, as ``settle_overlaps`` does."""
    bodies, apart = scene.bodies, covering(scene.boundary)
    earlier = range(i) if bodies[i].overlap == "keep" else ()
    later = [j for j in range(i + 1, len(bodies)) if bodies[j].overlap == "replace"]
    others = [j for j in (*earlier, *later) if bodies[j].name not in apart and bodies[i].name not in apart]
    return [j for j in others if not bodies[j].region.gives_particles]


def _point(X: Array) -> tuple[Any, ...]:
    return (*X, 0.0, 0.0)[:3]


def _set_initial_fields(scene: Any, plan: Plan, particles: Particles, models: list[Any]) -> None:
    problems = []
    for i, body in enumerate(scene.bodies):
        mine = np.flatnonzero(particles.body == i)
        values, found = start_velocity(body, particles.X[:, mine])
        problems += found
        for axis, value in enumerate(values):
            particles.V[axis, mine] = value
        model = models[particles.material[mine[0]]]
        history = model.history
        if body.axes is not None:
            H = particles.H[:, mine]
            problems += turn_history(body, model, particles.X[:, mine], H)
            particles.H[:, mine] = H
        if body.temperature is None or (particles.T is None and "temperature" not in history):
            continue
        temperature, wrong = start_temperature(body, particles.X[:, mine], plan.has_temperature)
        problems += wrong
        if particles.T is not None:  # histories learn of it with the first stress
            particles.T[mine] = temperature
        else:
            particles.H[history.index("temperature"), mine] = temperature
    if problems:
        raise SceneError(problems)
