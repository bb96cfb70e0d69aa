"""Heat conduction of a scene: the choices that it makes, and the parts that it needs."""

from __future__ import annotations

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
from mpmcli.scene.archive import shows
from mpmcli.scene.filling import section_of
from mpmcli.solver.parts import Parts
from mpmcli.transport.conduction import Choices, Conduction

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
    n = particles.count
    if choose_conduction(scene).carries:
        particles.T_carried = None if particles.T is None else particles.T.copy()
    particles.heat_inflow, particles.entropy = np.zeros(n), np.zeros(n)
    if shows(scene.archive, scene.probes, "heat_flux"):
        particles.heat_flux = np.zeros_like(particles.X)


def make_heat_field(grid: Grid, particles: Particles, capacity: Callable[[], Array]) -> NodalField:
    """Make the nodal field of heat, of which a node has one temperature for all velocity fields."""
    nodes = SharedNodes(grid)
    n = nodes.count
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


def make_conduction(
    scene: Any, s: Parts, mirror: Mirror | None, shown: Callable[[str, Any], Array]
) -> Conduction:
    """Make the part that conducts heat, with what holds temperatures and what heats.

    ``shown`` gives the identities (n,) of the particles that show a face of a body.
    """
    assert s.heat_interval is not None
    nodal = make_heat_field(s.grid, s.particles, lambda: conduction.capacity())
    conduction = Conduction(
        choose_conduction(scene), s.heat_interval, nodal, s.particles, s.order, s.transfer, s.state, s.parallel,
        s.failures.refuse_temperature,
    )  # fmt: skip
    own = None if mirror is None else mirror.for_scalars()
    if own is not None:
        nodal.corrections.append(ImagesOfScalars(own, nodal.nodes))
    conditions, loads = scene.conditions_on("temperature"), scene.loads_on("temperature")
    on_nodes = [condition for condition in conditions if condition.held_face() is None]
    on_faces = [condition for condition in conditions if condition.held_face() is not None]
    if on_nodes:
        conduction.held = held = HeldTemperatures(on_nodes, s.grid, nodal, own)
        nodal.corrections.append(held)
    if on_faces or loads:
        conduction.sources = HeatLoads(
            on_faces, loads, particles=s.particles, grid=s.grid, order=s.order, transfer=s.transfer, field=nodal,
            analysis=s.transfer.analysis, shape=s.transfer.shape, section=section_of(scene), bodies=s.state.bodies,
            shown=shown, conductivity=conduction.conductivity_along,
        )  # fmt: skip
    s.transfer.fields.append(nodal)
    conduction.begin()
    return conduction
