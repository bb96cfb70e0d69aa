"""What a scene becomes at its start, as far as it can be wrong: memory, particles, masses and velocities.

Runs and ``validate`` refuse the same scenes by these functions; ``validate`` leaves out large ones and says so.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.compiled.runtime import available_memory
from mpmcli.core.errors import Problem, SceneError
from mpmcli.geometry.bodies import BodyParticles, Domains
from mpmcli.geometry.faces import surface_faces
from mpmcli.geometry.fill import fill_bodies, places_to_test
from mpmcli.scene.axes import start_axes
from mpmcli.scene.fields import covering, velocity_fields
from mpmcli.scene.initial_stress import check_stress
from mpmcli.scene.interface_checks import check_touch
from mpmcli.scene.values import not_finite
from mpmcli.shapes import SHAPES

Array = np.ndarray

NUMBERS_PER_NODE = {d: 1 + 4 * d for d in (1, 2, 3)}
"""Numbers that are kept of every node: mass, momentum, force, velocity, and a vector more for all but FLIP."""
MOST_HEIGHTS = 3
"""Heights of the particles of a face that is made of flat ones."""
NUMBERS_OF_HEAT = 4
"""The same of conduction: capacity, content, power, temperature; the full-capacity loop has one more."""
MAX_DISTANCES = 20_000_000
"""Distances between particles and points of loads up to which points are checked."""
ON_NODE = 1e-6
"""How far from a node, in cells, a point still counts as on it."""
MAX_PLACES = 1_000_000
"""Places in cells up to which ``validate`` fills bodies: it is to take less than a second."""


def ghost_layers(scene: Any) -> int:
    """Return how many layers of nodes the grid has beyond each side."""
    pad = SHAPES[scene.method.shape].pad
    return min(pad, 4) if scene.dimensions == 3 else pad


def check_memory(scene: Any) -> None:
    """Refuse grids whose arrays are larger than the memory, before any of them is made."""
    grid, pad = scene.grid, ghost_layers(scene)
    fields = len(velocity_fields(scene)[0])
    nodes = math.prod(cells + 1.0 + 2 * pad for cells in grid.cells)
    needed = (nodes + _nodes_of_cracks(scene)) * fields * NUMBERS_PER_NODE[grid.dimensions] * 8
    if scene.heat is not None:
        numbers = NUMBERS_OF_HEAT + (scene.heat.transfer.order > 1)
        needed += nodes * (1 if scene.heat.contact == "shared" else fields) * numbers * 8
    there = available_memory()
    if needed > there:
        several = f" in {fields} velocity fields" if fields > 1 else ""
        words = (
            f"a grid of {nodes:.2g} nodes{several} needs {needed / 1e9:.3g} GB of memory, but only "
            f"{there / 1e9:.3g} GB are available; use larger cells or a smaller grid"
        )
        raise SceneError([Problem("grid.cell", words, code="memory")])


def _nodes_of_cracks(scene: Any) -> float:
    """Return how many further sides of nodes cracks make use of at most; only these take memory."""
    if not scene.cracks:
        return 0.0
    across = 2 * SHAPES[scene.method.shape].width + 1
    corners = (crack.path.corners() for crack in scene.cracks)
    cells = sum(float(np.hypot(*np.diff(each, axis=0).T).sum()) for each in corners) / min(scene.grid.cell)
    return (1 if len(scene.cracks) == 1 else 3) * across * (cells + len(scene.cracks) * across)


def section_of(scene: Any) -> float:
    """Return the thickness of a plane analysis, the area of a 1D one, else 1."""
    return float(getattr(scene.analysis, "thickness", getattr(scene.analysis, "area", 1.0)))


@np.errstate(all="ignore")
def find_masses(scene: Any, filled: Sequence[BodyParticles]) -> tuple[Array, Array, Array]:
    """Return body, initial volume and mass of all particles, (N,) each.

    Raises SceneError if a particle would have a mass that no computer number can hold.
    """
    index = np.repeat(np.arange(len(filled)), [b.count for b in filled])
    usual = [scene.materials[body.material].density for body in scene.bodies]
    own = [rho if b.density is None else b.density for rho, b in zip(usual, filled, strict=True)]
    density = np.concatenate([np.broadcast_to(rho, b.count) for rho, b in zip(own, filled, strict=True)])
    vol0 = np.concatenate([b.volume for b in filled]) * section_of(scene)
    if scene.analysis.kind == "axisymmetric":
        vol0 = vol0 * np.concatenate([b.X[0] for b in filled])
    mass = density * vol0
    wrong = ~(np.isfinite(mass) & (mass > 0.0))
    problems = [
        Problem(
            f"bodies.{body.name}.material",
            f"a particle would have mass {mass[index == i][0]:g}; check density, cell size and units",
            code="mass",
        )
        for i, body in enumerate(scene.bodies)
        if wrong[index == i].any()
    ]
    if any(material.bands for material in scene.materials.values()):
        from mpmcli.scene.bands import band_problems

        problems += band_problems(scene)
    if problems:
        raise SceneError(problems)
    return index, vol0, mass


def start_velocity(body: Any, X: Array) -> tuple[list[Any], list[Problem]]:
    """Return the components of a body's velocity at points X (d, n) at the start, and what is wrong with them."""
    values = [component(**dict(zip("xyz", X, strict=False))) for component in body.velocity]
    problems = []
    for axis, (component, value) in enumerate(zip(body.velocity, values, strict=True)):
        words = f"the velocity '{component.source}' is not finite at some particles"
        problems += not_finite(value, f"bodies.{body.name}.velocity.{axis}", words)
    return values, problems


def start_temperature(body: Any, X: Array, is_absolute: bool) -> tuple[Array, list[Problem]]:
    """Return a body's temperature at points X (d, n) at the start (n,), and what is wrong with it.

    ``is_absolute``: more than a flow stress depends on it, so that it has to be above zero.
    """
    values = np.broadcast_to(body.temperature(**dict(zip("xyz", X, strict=False))), X.shape[1:])
    path, source = f"bodies.{body.name}.temperature", body.temperature.source
    if found := not_finite(values, path, f"the temperature '{source}' is not finite at some particles"):
        return values, found
    if is_absolute and not np.all((values > 0.0) & (values < 1e30)):
        worst, bound = values.min(), "temperatures are absolute, above 0 K"
        if worst > 0.0:
            worst, bound = values.max(), "temperatures must be below 1e30"
        words = f"the temperature '{source}' is {worst:g} at a particle; {bound}"
        return values, [Problem(path, words, code="range")]
    return values, []


@np.errstate(all="ignore")
def check_filling(scene: Any) -> list[Problem]:
    """Refuse what a run would refuse when it sets up the scene; return what it is warned of.

    Raises SceneError if the grid is too large for the memory, a body has no particle, reaches out of the grid or
    overlaps another one, or a mass or velocity is out of range.
    """
    check_memory(scene)
    analysis = ANALYSES[scene.analysis.kind]()
    places = sum(places_to_test(body, scene.grid, analysis) for body in scene.bodies)
    if places > MAX_PLACES:
        words = (
            f"the bodies have up to {places:.2g} particles, more than are checked here; the run checks them"
        )
        return [Problem("bodies", words, code="not_checked", severity="warning")]
    filled = fill_bodies(scene.bodies, scene.grid, analysis, covering(scene.boundary))
    find_masses(scene, filled)
    problems: list[Problem] = []
    for body, particles in zip(scene.bodies, filled, strict=True):
        problems += start_velocity(body, particles.X)[1]
        if body.temperature is not None:
            problems += start_temperature(body, particles.X, scene.has_temperature)[1]
        if body.stress is not None:
            problems += check_stress(scene, body, particles.X)
        if body.axes is not None:
            problems += start_axes(body, particles.X)[1]
    if problems:
        raise SceneError(problems)
    return [*stair_stepped_faces(scene, filled), *check_start(scene, filled)]


def check_start(scene: Any, filled: Sequence[BodyParticles]) -> list[Problem]:
    """Refuse interfaces and cracks that are not where matter is at the start; return what is doubtful.

    Raises SceneError with the distances.
    """
    if scene.cracks:
        from mpmcli.scene.crack_places import check_places

        check_places(scene, filled)
    found = check_touch(scene, filled)
    if scene.fracture is not None:
        from mpmcli.scene.fracture_checks import check_tips

        found += check_tips(scene, filled)
    found += particles_on_lines(scene, filled)
    return [*found, *idle_nodal_forces(scene, filled), *bodies_behind_walls(scene, filled)]


def particles_on_lines(scene: Any, filled: Sequence[BodyParticles]) -> Iterator[Problem]:
    """Warn of point particles on grid lines: they have gradients at nodes to which they give no mass."""
    if SHAPES[scene.method.shape].domain != "point" or SHAPES[scene.method.shape].grid_functions != "linear":
        return
    lower, cell = (np.array(x)[:, None] for x in (scene.grid.lower, scene.grid.cell))
    for body, particles in zip(scene.bodies, filled, strict=True):
        place = (particles.X - lower) / cell
        if (
            scene.materials[body.material].kind != "rigid"
            and (np.abs(place - np.rint(place)) < ON_NODE).any()
        ):
            words = (
                f"particles of body '{body.name}' lie on grid lines, where '{scene.method.shape}' loses forces and "
                "heat at upper faces; move the body or the grid by a part of a cell, or use another shape function"
            )
            yield Problem(f"bodies.{body.name}.region", words, code="on_grid_line", severity="warning")


def bodies_behind_walls(scene: Any, filled: Sequence[BodyParticles]) -> Iterator[Problem]:
    """Warn of walls that hold all of a body, as with a normal that points out of the material."""
    soft = [
        (body.name, particles.X)
        for body, particles in zip(scene.bodies, filled, strict=True)
        if scene.materials[body.material].kind != "rigid"
    ]
    for wall in scene.boundary:
        if wall.kind != "wall" or not wall.acts_at(0.0):
            continue
        held = [name for name, X in soft if wall.is_behind(X).all()]
        if held:
            words = (
                f"all of body '{held[0]}' is behind this wall, which moves it as if it were rigid; "
                "the normal points from the wall into the material"
            )
            yield Problem(f"boundary.{wall.name}.normal", words, code="behind_wall", severity="warning")


def idle_nodal_forces(scene: Any, filled: Sequence[BodyParticles]) -> Iterator[Problem]:
    """Warn of forces on nodes that no particle sees at the start: they load nothing until a body comes."""
    loads = [load for load in scene.loads_on("velocity") if "nodal_force_at" in load.effects()]
    if not loads:
        return
    shape, grid = SHAPES[scene.method.shape], scene.grid
    lower, upper, cell = (np.array(x)[:, None] for x in (grid.lower, grid.upper, grid.cell))
    is_periodic = np.isin(list("xyz")[: grid.dimensions], grid.periodic or ())[:, None]
    X, half, *_ = Domains.of(filled)
    reach = (1.0 if shape.grid_functions == "linear" else 1.5) * cell + (shape.domain != "point") * half
    for load in loads[: MAX_DISTANCES // X.shape[1]]:
        at = np.array(load.nodal_force_at(0.0)[0])[:, None]
        place = (at - lower) / cell
        place = np.where(np.abs(place - np.round(place)) < ON_NODE, np.round(place), place)
        first, last = lower + np.floor(place) * cell, lower + np.ceil(place) * cell
        apart = np.maximum(first - X, X - last)
        apart = np.where(is_periodic, np.minimum(apart, upper - lower - np.abs(X - at)), apart)
        if not (apart < reach).all(axis=0).any():
            point = ", ".join(f"{x:g}" for x in at[:, 0])
            words = f"the nodal force at ({point}) is at no node of a body at the start"
            words += " and has no effect until a body comes there"
            yield Problem(f"loads.{load.name}.at", words, code="no_effect", severity="warning")


def stair_stepped_faces(scene: Any, filled: Sequence[BodyParticles]) -> Iterator[Problem]:
    """Warn of heat through faces of curved or oblique bodies: faces of particles have more area than such a surface."""
    particles = {body.name: particles for body, particles in zip(scene.bodies, filled, strict=True)}
    for load in scene.loads_on("temperature"):
        place = load.loaded_face()
        if place is None:
            continue
        name, face = place
        X, size = particles[name].X, particles[name].size
        shown = surface_faces(X, size, face.index, face.side)
        heights = np.unique(np.rint(X[face.index, shown] / size[face.index].min())).size
        if heights > MOST_HEIGHTS:
            words = (
                f"this face of body '{name}' is stair-stepped: its particles lie at {heights} heights. Its area, and "
                "with it the heat, is too large, by 4/pi for a circle; held temperatures do not depend on it"
            )
            yield Problem(f"loads.{load.name}.on", words, code="stair_stepped", severity="warning")
