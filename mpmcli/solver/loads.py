"""The scene's loads as nodal forces, and the work that they do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.boundary.faces import TractionFaces
from mpmcli.boundary.loads import Loads
from mpmcli.core import nodes
from mpmcli.core.nodes import CHUNKS
from mpmcli.geometry.faces import surface_faces

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

Array = np.ndarray


class NodalLoads:
    """Gravity, particle accelerations and tractions of a scene, gathered as forces on nodes once per step."""

    def __init__(self, s: Simulation, models: Any, section: float):
        self.s = s
        bodies = s.state.bodies
        self.loads = Loads(models, s.plan.analysis, bodies)
        self.loads.start(s.particles)
        p = s.particles
        faces = []
        for traction in self.loads.tractions:
            face = traction.on.face
            members = np.flatnonzero(p.body == bodies.index(traction.on.body))
            shown = surface_faces(p.X, p.size, face.index, face.side, members)
            faces.append((traction, p.id[shown]))
        shape = s.plan.shape
        self.faces = TractionFaces(
            faces, p, s.grid, s.plan.analysis, section,
            grid_functions=shape.grid_functions, domain=shape.domain, several_fields=s.grid.fields > 1,
        )  # fmt: skip
        self._with_gravity = s.has_mirror
        self._place: Array | None = None
        self._version = -1
        self._work = np.zeros(CHUNKS)

    def collect(self, time: float) -> None:
        """Find the forces of all loads at ``time``; call when nodal masses are those of the particles alone."""
        s = self.s
        f, active = s.arrays.f_external, s.grid.active
        nodes.clear_nodes[s.parallel](active, f)
        version = s.order.version
        B = self.loads.particle_accelerations(time, s.particles, version, self._with_gravity)
        if B is not None:
            s.transfer.add_vector(B, f)
        gravity = None if self._with_gravity else self.loads.gravity(time)
        if gravity is not None:
            nodes.add_gravity[s.parallel](active, s.grid.mp, gravity, f)
        if self.faces:
            if self._place is None or self._version != version:
                self._place = place_of_identity(s.particles.id)
                self._version = version
            self.faces.add(time, s.particles, self._place, s.grid.mp, f)
        if s.state.rigid:
            f[s.rigid_dofs] = 0.0

    def add_to(self, f: Array) -> None:
        """Add them to the nodal forces."""
        nodes.add_nodal[self.s.parallel](self.s.grid.active, self.s.arrays.f_external, f)

    def work(self, dt: float) -> float:
        """Work of the loads in this step, with the mean of the velocities before and after it."""
        s = self.s
        a = s.arrays
        nodes.external_power[s.parallel](s.grid.active, a.f_external, s.grid.mp, a.p_start, a.v, self._work)
        return float(self._work.sum()) * dt


class NoLoads:
    """A scene without loads."""

    def collect(self, time: float) -> None:
        """Nothing to find."""

    def add_to(self, f: Array) -> None:
        """Nothing to add."""

    def work(self, dt: float) -> float:
        """No work."""
        return 0.0


def place_of_identity(identity: Array) -> Array:
    """Where the particle of each identity is in memory, −1 if it is gone; ``identity`` (N,)."""
    place = np.full(int(identity.max(initial=-1)) + 1, -1, dtype=np.int64)
    place[identity] = np.arange(len(identity))
    return place
