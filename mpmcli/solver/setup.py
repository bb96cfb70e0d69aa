"""From a checked scene to particles and grid at time zero."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mpmcli.core.analysis import Axisymmetric
from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles
from mpmcli.core.runtime import available_memory
from mpmcli.geometry.fill import BodyParticles, fill_bodies
from mpmcli.geometry.report import body_report, report_table
from mpmcli.solver.plan import Plan

Array = np.ndarray

NUMBERS_PER_NODE = {d: 1 + 4 * d for d in (1, 2, 3)}
"""Numbers that are kept of every node: mass, momentum, force, velocity, and a vector more for all but FLIP."""


def make_grid(scene: Any, plan: Plan) -> Grid:
    """The scene's grid, with the ghost layers that its shape function needs."""
    grid = scene.grid
    shape = plan.shape
    pad = min(shape.pad, 4) if plan.analysis.dimensions == 3 else shape.pad
    _check_memory(grid, pad, len(plan.fields))
    return Grid(
        np.array(grid.lower),
        np.array(grid.upper),
        np.array(grid.cell),
        pad,
        shape.width,
        fields=len(plan.fields),
    )


def _check_memory(grid: Any, pad: int, fields: int) -> None:
    """Refuse grids whose arrays are larger than the memory, before any of them is made."""
    nodes = math.prod(cells + 1.0 + 2 * pad for cells in grid.cells)
    needed = nodes * fields * NUMBERS_PER_NODE[grid.dimensions] * 8
    there = available_memory()
    if needed > there:
        several = f" in {fields} velocity fields" if fields > 1 else ""
        words = (
            f"a grid of {nodes:.2g} nodes{several} needs {needed / 1e9:.3g} GB of memory, and there are "
            f"{there / 1e9:.3g} GB: larger cells or a smaller grid are needed"
        )
        raise SceneError([Problem("grid.cell", words, code="memory")])


def section_of(scene: Any) -> float:
    """Thickness of a plane analysis, area of a 1D one, else 1."""
    return float(getattr(scene.analysis, "thickness", getattr(scene.analysis, "area", 1.0)))


def full_ring(plan: Plan) -> float:
    """2π in axisymmetric analyses (inside per radian), else 1."""
    return 2 * math.pi if isinstance(plan.analysis, Axisymmetric) else 1.0


@np.errstate(all="ignore")
def make_particles(scene: Any, plan: Plan, grid: Grid) -> tuple[Particles, list[BodyParticles]]:
    """Fill all bodies; particles with mass, velocity and the materials' initial history."""
    filled = fill_bodies(scene.bodies, grid, plan.analysis)
    names = list(scene.materials)
    bodies = {body.name: (i, body) for i, body in enumerate(scene.bodies)}
    X = np.concatenate([body.X for body in filled], axis=1)
    index = np.concatenate([np.full(b.count, bodies[b.name][0]) for b in filled])
    material_of_body = np.array([names.index(body.material) for body in scene.bodies])
    density = np.array([model.density for model in scene.materials.values()])
    vol0 = np.concatenate([b.volume for b in filled]) * section_of(scene)
    if isinstance(plan.analysis, Axisymmetric):
        vol0 = vol0 * X[0]
    material = material_of_body[index]
    mass = density[material] * vol0
    _check_mass(scene, index, mass)
    models = list(scene.materials.values())
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
        for row, name in enumerate(model.history):
            particles.H[row, material == m] = model.initial_history().get(name, 0.0)
    _set_initial_fields(scene, particles, models)
    if plan.velocity_gradient:
        _set_initial_gradients(scene, particles)
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


def _check_mass(scene: Any, index: Array, mass: Array) -> None:
    """Refuse bodies whose particles have masses that no computer number can hold."""
    wrong = ~(np.isfinite(mass) & (mass > 0.0))
    problems = [
        Problem(
            f"bodies.{body.name}.material",
            f"a particle of it would have the mass {mass[index == i][0]:g}: density times volume is out of range",
            code="mass",
        )
        for i, body in enumerate(scene.bodies)
        if wrong[index == i].any()
    ]
    if problems:
        raise SceneError(problems)


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


def _point(X: Array) -> tuple[Any, ...]:
    return (*X, 0.0, 0.0)[:3]


def _set_initial_fields(scene: Any, particles: Particles, models: list[Any]) -> None:
    problems = []
    for i, body in enumerate(scene.bodies):
        mine = np.flatnonzero(particles.body == i)
        points = dict(zip("xyz", particles.X[:, mine], strict=False))
        for axis, component in enumerate(body.velocity):
            value = component(**points)
            if not np.all(np.isfinite(value)):
                words = f"the velocity '{component.source}' is not finite at some particle"
                problems.append(Problem(f"bodies.{body.name}.velocity.{axis}", words, code="not_finite"))
            particles.V[axis, mine] = value
        if body.temperature is not None:
            history = models[particles.material[mine[0]]].history
            if "temperature" in history:
                particles.H[history.index("temperature"), mine] = body.temperature(**points)
            else:
                words = f"material '{body.material}' does not track its temperature"
                problems.append(Problem(f"bodies.{body.name}.temperature", words, code="unused"))
    if problems:
        raise SceneError(problems)
