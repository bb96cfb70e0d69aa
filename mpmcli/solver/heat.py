"""Heat conduction of a scene: the choices that it makes, and the parts that it needs."""

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcli.boundary.heat_loads import HeatLoads
from mpmcli.boundary.held_temperatures import HeldTemperatures
from mpmcli.boundary.images import ImagesOfScalars
from mpmcli.boundary.mirror import Mirror
from mpmcli.core.grid import Grid, SharedNodes
from mpmcli.core.particles import Particles
from mpmcli.core.transfer.nodal_field import NodalField
from mpmcli.scene.archive import grid_shows, shows
from mpmcli.scene.fields import conductance_table, velocity_fields
from mpmcli.scene.filling import section_of
from mpmcli.solver.grid_view import show_on_grid
from mpmcli.solver.parts import Parts
from mpmcli.transport.conduction import Choices, Conduction
from mpmcli.transport.contact import FrictionHeat, HeatContact

Array = np.ndarray


def choose_conduction(scene: Any) -> Choices:
    """Return what the scene chooses about conduction."""
    heat, models = scene.heat, list(scene.materials.values())
    conducting = [getattr(model, "conductivity", None) or (0.0, 0.0, 0.0) for model in models]
    conductivity = np.array(conducting, dtype=np.float64)
    if (conductivity == conductivity[:, :1]).all():
        conductivity = np.ascontiguousarray(conductivity[:, 0])
    return Choices(
        replaces=heat.transfer.kind == "fmpm",
        order=heat.transfer.order,
        every=getattr(heat.transfer, "every_steps", None),
        capacity=np.array([model.specific_heat or 0.0 for model in models]),
        conductivity=conductivity,
    )


def allocate_particles(scene: Any, particles: Particles) -> None:
    """Allocate what conduction needs on particles, whose temperatures ``T`` are known."""
    if choose_conduction(scene).carries:
        particles.T_carried = None if particles.T is None else particles.T.copy()
    if shows(scene.archive, scene.probes, "heat_flux"):
        particles.heat_flux = np.zeros_like(particles.X)


def allocate_accounts(particles: Particles, work_heats: bool) -> None:
    """Allocate what accounts of heat and entropy need; ``work_heats``: work changes temperatures, or a bath takes it.

    Without, they follow from the temperatures of the start and of now.
    """
    if work_heats:
        particles.heat_inflow, particles.entropy = np.zeros(particles.count), np.zeros(particles.count)
    else:
        particles.T_start = np.array(particles.T)


def make_heat_field(
    grid: Grid, particles: Particles, capacity: Callable[[], Array], is_shared: bool
) -> NodalField:
    """Make the nodal field of heat; ``is_shared``: a node has one temperature for all velocity fields."""
    nodes: Any = SharedNodes(grid) if is_shared else grid
    n = nodes.count if is_shared else grid.dof_count
    return NodalField(
        "temperature",
        (0.0,),
        nodes,
        capacity,
        lambda: _carried(particles),
        np.zeros((n, 2)),
        np.zeros((n, 1)),
        np.zeros((n, 1)),
    )


def _carried(particles: Particles) -> Array:
    carried = particles.T if particles.T_carried is None else particles.T_carried
    return np.asarray(carried)[None]


def _has_own_temperatures(scene: Any, s: Parts) -> bool:
    return s.contact is not None and scene.heat.contact != "shared"


def _baths(scene: Any) -> Array | None:
    """Which velocity fields are those of rigid bodies with a temperature, (fields,); None without any."""
    names, field_of_body = velocity_fields(scene)
    found = np.zeros(len(names), dtype=bool)
    for body, field in zip(scene.bodies, field_of_body, strict=True):
        found[field] |= scene.materials[body.material].kind == "rigid" and body.temperature is not None
    return found if found.any() else None


def _effusivities(scene: Any, s: Parts) -> Array:
    """√(κ ρ c) of each velocity field (fields,), mean by mass of its materials; 0 of rigid ones."""
    e = np.zeros(len(scene.materials))
    for m, model in enumerate(scene.materials.values()):
        if model.kind != "rigid":
            e[m] = np.sqrt(
                np.mean(model.conductivity or (0.0,)) * model.density * (model.specific_heat or 0.0)
            )
    p, fields = s.particles, len(s.contact.choice.fields) if s.contact is not None else 1
    mass = np.bincount(p.velocity_field, p.mass, minlength=fields)
    sums = np.bincount(p.velocity_field, p.mass * e[p.material], minlength=fields)
    return np.divide(sums, mass, out=np.zeros(fields), where=mass > 0.0)


def _add_contact(scene: Any, s: Parts, conduction: Conduction, is_shared: bool) -> None:
    """Let bodies exchange heat by contact, and friction heat them."""
    contact, nodal, n = s.contact, conduction.nodal, s.grid.node_count
    assert contact is not None
    names = contact.choice.fields
    rigid = np.array(contact.choice.rigid_fields)
    if not is_shared:
        table = conductance_table(scene, names)
        pairs = [(names.index(a), names.index(b)) for a, b in contact.view.pairs]
        is_bath = rigid if conduction.choices.is_bath is None else conduction.choices.is_bath
        conductance = np.array([table[pair] for pair in pairs])
        conduction.contact = HeatContact(
            contact, nodal, [f"{a}|{b}" for a, b in contact.view.pairs], conductance, is_bath, n
        )
        nodal.corrections.append(conduction.contact)
    if scene.heat.friction:
        s.state.work["friction_heat"] = 0.0
        conduction.friction = FrictionHeat(contact, nodal, _effusivities(scene, s), rigid, n)
        assert s.heat_interval is not None
        shared = SharedNodes(s.grid)  # contacts are not known yet where a step begins
        s.heat_interval.has_friction = lambda: len(shared.active) < len(s.grid.active)


def make_conduction(
    scene: Any, s: Parts, mirror: Mirror | None, shown: Callable[[str, Any], Array]
) -> Conduction:
    """Make the part that conducts heat, with what holds temperatures and what heats.

    ``shown`` gives the identities (n,) of the particles that show a face of a body.
    """
    assert s.heat_interval is not None
    is_shared = not _has_own_temperatures(scene, s)
    nodal = make_heat_field(s.grid, s.particles, lambda: conduction.capacity(), is_shared)
    choices = choose_conduction(scene)
    if not is_shared:
        choices.is_bath = _baths(scene)
    conduction = Conduction(
        choices, s.heat_interval, nodal, s.particles, s.order, s.transfer, s.state, s.parallel,
        s.failures.refuse_temperature,
    )  # fmt: skip
    if s.grid.periodic:
        from mpmcli.boundary.periodic import PeriodicSides

        nodal.corrections.append(PeriodicSides(s.grid, nodal.nodes))
    own = None if mirror is None else mirror.for_scalars()
    if own is not None:
        nodal.corrections.append(ImagesOfScalars(own, nodal.nodes))
    if s.contact is not None:
        _add_contact(scene, s, conduction, is_shared)
    conditions, loads = scene.conditions_on("temperature"), scene.loads_on("temperature")
    on_nodes = [condition for condition in conditions if condition.held_face() is None]
    on_faces = [condition for condition in conditions if condition.held_face() is not None]
    if on_nodes:
        conduction.held = held = HeldTemperatures(on_nodes, s.grid, nodal, own, choices.is_bath)
        nodal.corrections.append(held)
    if on_faces or loads:
        conduction.sources = HeatLoads(
            on_faces, loads, particles=s.particles, grid=s.grid, order=s.order, transfer=s.transfer, field=nodal,
            analysis=s.transfer.analysis, shape=s.transfer.shape, section=section_of(scene), bodies=s.state.bodies,
            shown=shown, conductivity=conduction.conductivity_along,
        )  # fmt: skip
    s.transfer.fields.append(nodal)
    allocate_accounts(s.particles, s.stress.knows_temperature)
    if scene.domain.on_exit == "delete":
        s.state.extra["deleted_heat"] = 0.0
    if grid_shows(scene.archive, scene.probes, ("temperature", "heat_capacity")):
        conduction.shown = np.zeros((len(nodal.mp), 2))
        assert s.state.grid is not None
        show_on_grid(s.state.grid, s.grid, _nodal_fields(conduction.shown, s, is_shared))
    conduction.begin()
    return conduction


def _nodal_fields(shown: Array, s: Parts, is_shared: bool) -> dict[str, Callable[[], Array]]:
    """Heat capacity and temperature of all velocity fields but rigid ones, per node of the grid."""
    deformable = None if s.contact is None else ~np.array(s.contact.choice.rigid_fields)

    def summed(values: Array) -> Array:
        return values if is_shared else s.grid.sum_of_fields(values, deformable)

    def temperature() -> Array:
        C = summed(shown[:, 0])
        heat = summed(shown[:, 0] * shown[:, 1])
        return np.divide(heat, C, out=np.zeros_like(heat), where=C > 0.0)

    return {"heat_capacity": lambda: summed(shown[:, 0]), "temperature": temperature}
