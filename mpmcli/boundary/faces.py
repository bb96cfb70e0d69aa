"""Tractions through the deformed faces of particles, put on the grid as the shape function sees it."""

from collections.abc import Mapping, Sequence

import numpy as np

from mpmcli.boundary.base import Array, LoadModel, Nodes
from mpmcli.boundary.corners import Cells, Faces, Matter
from mpmcli.boundary.face_kernels import add_tractions
from mpmcli.boundary.particle_loads import finite
from mpmcli.boundary.place import Face
from mpmcli.core.analysis import Analysis
from mpmcli.core.errors import SimulationError
from mpmcli.core.identity import place_of_identity
from mpmcli.core.particles import Particles


class TractionFaces:
    """The loaded faces of a scene.

    Parameters
    ----------
    loads
        Load, its face, and the identities (n,) of the particles that have it.
    particles
        All particles, at the start of the simulation.
    grid
        The grid (``base.Nodes``).
    analysis
        The kind of analysis; in axisymmetric ones areas are per radian.
    section
        Thickness in plane analyses, area of the section in 1D, else 1.
    grid_functions, domain
        The shape function's, as ``shapes.ShapeEntry`` names them.
    several_fields
        Forces go to the nodes of the velocity field of the face's particle.
    impedances
        By the load's id: traction per velocity against it, (N, d) by identity, of loads that resist velocities.

    Attributes
    ----------
    faces : the arrays of the kernels
    """

    def __init__(
        self,
        loads: Sequence[tuple[LoadModel, Face, Array]],
        particles: Particles,
        grid: Nodes,
        analysis: Analysis,
        section: float = 1.0,
        *,
        grid_functions: str = "linear",
        domain: str = "corners",
        several_fields: bool = False,
        impedances: Mapping[int, Array] | None = None,
    ):
        self._loads = [(load, face, np.asarray(ids, dtype=np.int64)) for load, face, ids in loads]
        self._cells = Cells.of(grid, analysis, section, grid_functions, domain)
        self._several_fields = several_fields
        self.faces, self._centres, self._rows = list_faces(
            [face for _, face, _ in loads], [ids for *_, ids in self._loads],
            [load.follows for load, *_ in loads], particles,
        )  # fmt: skip
        self._area, self._force = np.zeros(len(self.faces.id)), np.zeros_like(self.faces.traction)
        self._evaluated = False
        self._varies = any(load.changes for load, *_ in loads)
        self._impedances = impedances or {}

    def __bool__(self) -> bool:
        """Whether any face is loaded."""
        return self.faces.id.shape[0] > 0

    def add(self, time: float, particles: Particles, position_of_id: Array, mp: Array, f: Array) -> None:
        """Add the tractions at ``time`` to nodal forces: see ``face_kernels``.

        Parameters
        ----------
        time
            Time at the start of the step.
        particles
            Current state.
        position_of_id
            (N,) where the particle of each identity is in memory; -1 if it is gone.
        mp
            (n, 1+d) mass and momentum.
        f
            (n, d) nodal forces; the tractions are added.
        """
        if not self._evaluated or self._varies:
            self._evaluate(time, particles, position_of_id)
        if self._impedances:
            self._resist(time, particles, position_of_id)
        matter = Matter(particles.X, particles.F, particles.size, position_of_id)
        field = particles.velocity_field if self._several_fields else None
        lost = add_tractions(self.faces, self._cells, matter, field, self._area, self._force, mp, f)
        if lost >= 0:
            raise SimulationError(
                f"a loaded face of particle {self.faces.id[lost]} left the grid at time {time:g}"
            )

    def _resist(self, time: float, particles: Particles, position_of_id: Array) -> None:
        for (load, _, ids), rows in zip(self._loads, self._rows, strict=True):
            if (Z := self._impedances.get(id(load))) is not None:
                V = particles.V[:, position_of_id[ids]].T
                self.faces.traction[rows] = -Z[ids] * V if load.acts_at(time) else 0.0

    def _evaluate(self, time: float, particles: Particles, position_of_id: Array) -> None:
        for (load, face, ids), rows in zip(self._loads, self._rows, strict=True):
            if id(load) in self._impedances:
                continue
            if not load.acts_at(time):
                self.faces.traction[rows] = 0.0
                continue
            centres = self._centres[:, rows]
            if load.follows_positions:
                centres = present_centres(face, particles, position_of_id[ids])
            for a, value in enumerate(load.traction_at(centres, time)):
                self.faces.traction[rows, a] = finite(value, load, time)
        self._evaluated = True


def present_centres(face: Face, particles: Particles, memory: Array) -> Array:
    """Return the middles (d, n) of the deformed faces of particles at these places in memory [length]."""
    centres = particles.X[:, memory].copy()
    d, half = len(centres), face.sign * particles.size[face.index, memory]
    for a in range(d):
        centres[a] += particles.F[d * a + face.index, memory] * half
    return centres


def list_faces(
    places: Sequence[Face], identities: Sequence[Array], follows: Sequence[bool], particles: Particles
) -> tuple[Faces, Array, list[slice]]:
    """List the faces of particles that loads act on.

    Parameters
    ----------
    places, identities, follows
        Face of a body, identities (n,) of the particles that have it, and whether loads follow its deformation.
    particles
        All particles, at the start of the simulation.

    Returns
    -------
    faces
        One after the other, without traction.
    centres
        (d, nf) their centres at the start [length].
    rows
        Those of each member of ``places``.
    """
    counts = [ids.shape[0] for ids in identities]
    ends = np.cumsum([0, *counts])
    rows = [slice(int(ends[j]), int(ends[j + 1])) for j in range(len(counts))]
    ids = np.concatenate([np.empty(0, dtype=np.int64), *identities])
    memory = place_of_identity(particles.id, ids)
    initial = particles.X[:, memory[ids]]
    faces = Faces(
        id=ids,
        axis=np.repeat([face.index for face in places], counts).astype(np.int64),
        sign=np.repeat([face.sign for face in places], counts).astype(np.float64),
        follower=np.repeat(follows, counts).astype(bool),
        radius=initial[0].copy(),
        traction=np.zeros(initial.T.shape),
    )
    half = particles.size[:, memory[ids]]
    each = np.arange(ids.shape[0])
    initial[faces.axis, each] += faces.sign * half[faces.axis, each]
    return faces, initial, rows
