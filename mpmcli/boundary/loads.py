"""The loads of a scene: nodal forces once per step, and the work that they do."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from mpmcli.boundary.base import Array, LoadModel
from mpmcli.boundary.faces import TractionFaces
from mpmcli.boundary.particle_loads import ParticleLoads
from mpmcli.boundary.place import Face
from mpmcli.core.analysis import Analysis, full_ring
from mpmcli.core.chunks import CHUNKS
from mpmcli.core.grid import Grid
from mpmcli.core.identity import place_of_identity
from mpmcli.core.order import CellOrder
from mpmcli.core.particles import Particles
from mpmcli.core.step import Step
from mpmcli.core.transfer import nodes

if TYPE_CHECKING:  # imported by scenes with concentrated forces
    from mpmcli.boundary.nodal_forces import NodalForces
    from mpmcli.boundary.plane_dashpots import PlaneDashpots


class Scatter(Protocol):
    """What loads need of the transfer."""

    def add_vector(self, B: Array, f: Array) -> None:
        """Add Σ_p S_ip m_p B_p, of a vector (d, N) per mass, to nodes (n, d)."""


class GridFunctions(Protocol):
    """What loads need of the shape function (``shapes.ShapeEntry`` has it)."""

    @property
    def grid_functions(self) -> str:
        """Functions of the grid: linear, quadratic or other."""

    @property
    def domain(self) -> str:
        """How a particle's domain deforms."""


class Loads:
    """Loads as nodal forces.

    Parameters
    ----------
    models
        Models of the scene's ``loads`` list.
    particles, grid, order, transfer
        The parts of the step that it works on; the particles are at the start of the simulation.
    analysis, shape, section
        Kind of analysis, shape function, and thickness or area of the section.
    bodies
        Names of the bodies, in the order of ``Particles.body``.
    shown
        Gives the identities (n,) of the particles that show a face of a body now.
    rigid_dofs
        Gives the active degrees of freedom of rigid bodies; None without any.
    complete
        Completes nodal sums (n, 1) beside symmetry planes or periodic sides, as it does masses: then gravity comes from
        the particles. None without any.
    parallel
        Whether parallel kernels are used.
    impedance
        Gives the impedance of a load that resists velocities (N, d), by the identities of particles.
    areas
        See ``plane_dashpots.PlaneDashpots``.

    Attributes
    ----------
    force : (n, d) nodal force of all loads in this step [force]
    """

    def __init__(
        self,
        models: Sequence[LoadModel],
        *,
        particles: Particles,
        grid: Grid,
        order: CellOrder,
        transfer: Scatter,
        analysis: Analysis,
        shape: GridFunctions,
        section: float,
        bodies: Sequence[str],
        shown: Callable[[str, Face], Array],
        rigid_dofs: Callable[[], Array] | None,
        complete: Callable[[Array], None] | None,
        parallel: bool,
        impedance: Callable[[LoadModel], Array],
        areas: Callable[[Array], Array],
    ):
        self._particles, self._grid, self._order, self._transfer = particles, grid, order, transfer
        self._rigid_dofs, self._completes_mass, self._parallel = rigid_dofs, complete is not None, parallel
        self.on_particles = ParticleLoads(models, analysis, bodies, particles)
        on_faces = [(load, face) for load in models if (face := load.loaded_face()) is not None]
        self.faces = TractionFaces(
            [(load, face[1], shown(*face)) for load, face in on_faces], particles, grid, analysis, section,
            grid_functions=shape.grid_functions, domain=shape.domain, several_fields=grid.fields > 1,
            impedances={id(load): impedance(load) for load, _ in on_faces if "impedance_of" in load.effects()},
        )  # fmt: skip
        self._on_nodes: NodalForces | None = None
        if on_nodes := [load for load in models if "nodal_force_at" in load.effects()]:
            from mpmcli.boundary.nodal_forces import NodalForces

            self._on_nodes = NodalForces(on_nodes, grid, full_ring(analysis))
        self._on_planes: PlaneDashpots | None = None
        if on_planes := [load for load in models if load.loaded_plane() is not None]:
            from mpmcli.boundary.plane_dashpots import PlaneDashpots

            self._on_planes = PlaneDashpots(
                [(load, impedance(load)) for load in on_planes], grid, areas, complete
            )
        self.force = np.zeros((grid.dof_count, grid.dimensions))
        self._place: Array | None = None
        self._version: Any = None
        self._work = np.zeros(CHUNKS)
        self._least_mass = particles.negligible_mass()

    def collect(self, step: Step) -> None:
        """Task 1: find the forces of all loads at the start of the step."""
        time, grid, f, version = step.time, self._grid, self.force, self._order.version
        nodes.clear_nodes[self._parallel](grid.active, f)
        B = self.on_particles.accelerations(time, self._particles, version, self._completes_mass)
        if B is not None:
            self._transfer.add_vector(B, f)
        gravity = None if self._completes_mass else self.on_particles.gravity(time)
        if gravity is not None:
            nodes.add_gravity[self._parallel](grid.active, grid.mp, gravity, f)
        if self.faces:
            if self._place is None or self._version != version:
                self._place = place_of_identity(self._particles.id, self.faces.faces.id)
                self._version = version
            self.faces.add(time, self._particles, self._place, grid.mp, f)
        if self._on_nodes is not None:
            self._on_nodes.add(time, grid.mp, f)
        if self._on_planes is not None:
            self._on_planes.add(time, grid.mp, f, step.dt)
        if self._rigid_dofs is not None:
            f[self._rigid_dofs()] = 0.0

    def per_mass(self, state: Any) -> Array | None:
        """Return the force per mass (d, N) of loads on particles now [length/time²], None without any.

        The next call overwrites it.
        """
        return self.on_particles.accelerations(state.time, state.particles, with_gravity=True)

    def nodal_arrays(self) -> dict[str, Array]:
        """Return its arrays over all nodes, by name."""
        return {"force": self.force}

    def add_to(self, f: Array) -> None:
        """Add them to nodal forces (n, d)."""
        nodes.add_nodal[self._parallel](self._grid.active, (0.0,) * f.shape[1], self.force, f)

    def work(self, v: Array, dt: float) -> float:
        """Return the work of the loads in this step, with the mean velocity: ``v`` (n, d) are v⁺.

        The stress does its work with v⁺(k), too: loads in balance with it give what it takes.
        """
        grid = self._grid
        nodes.external_power[self._parallel](
            grid.active, grid.active_chunks, self.force, grid.mp, grid.f, v, dt, self._least_mass, self._work
        )
        return float(self._work.sum()) * dt
