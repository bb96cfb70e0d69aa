"""Tractions through the deformed faces of particles, put on the grid as the shape function sees it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mpmcli.boundary.base import Array, LoadModel, Nodes
from mpmcli.boundary.corners import Cells, Corners, Faces, add_tractions
from mpmcli.boundary.particle_loads import finite
from mpmcli.core.analysis import Analysis, Axisymmetric
from mpmcli.core.errors import SimulationError
from mpmcli.core.identity import place_of_identity
from mpmcli.core.particles import Particles


class TractionFaces:
    """The loaded faces of a scene.

    Parameters
    ----------
    loads
        Pairs of a load with a traction and the identities (n,) of the particles that have the loaded face.
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

    Attributes
    ----------
    faces, corners : the arrays of the kernels
    """

    def __init__(
        self,
        loads: Sequence[tuple[LoadModel, Array]],
        particles: Particles,
        grid: Nodes,
        analysis: Analysis,
        section: float = 1.0,
        *,
        grid_functions: str = "linear",
        domain: str = "corners",
        several_fields: bool = False,
    ):
        d = analysis.dimensions
        self._loads = [(load, np.asarray(ids, dtype=np.int64)) for load, ids in loads]
        faces = [load.loaded_face()[1] for load, _ in loads]
        self._cells = Cells.of(grid, grid_functions, domain)
        self._several_fields = several_fields
        self._axisymmetric = isinstance(analysis, Axisymmetric)
        self._section = section
        counts = [ids.shape[0] for _, ids in self._loads]
        ends = np.cumsum([0, *counts])
        self._rows = [slice(int(ends[j]), int(ends[j + 1])) for j in range(len(counts))]
        ids = np.concatenate([np.empty(0, dtype=np.int64), *(ids for _, ids in self._loads)])
        memory = place_of_identity(particles.id, least=int(ids.max(initial=-1)) + 1)
        initial = particles.X[:, memory[ids]]
        self.faces = Faces(
            id=ids,
            axis=np.repeat([face.index for face in faces], counts).astype(np.int64),
            sign=np.repeat([face.sign for face in faces], counts).astype(np.float64),
            follower=np.repeat([load.follows for load, _ in loads], counts).astype(bool),
            radius=initial[0].copy(),
            traction=np.zeros((ids.shape[0], d)),
        )
        self._centres = initial.copy()
        half = particles.size[:, memory[ids]]
        for k, (a, sign) in enumerate(zip(self.faces.axis, self.faces.sign, strict=True)):
            self._centres[a, k] += sign * half[a, k]
        nc = ids.shape[0] * self._cells.points ** (d - 1)
        weights = np.zeros((nc, self._cells.width**d))
        self.corners = Corners(np.zeros(nc, dtype=np.int64), weights, np.zeros((nc, d)))
        self._evaluated = False
        self._varies = any(load.varies for load, _ in loads)

    def __bool__(self) -> bool:
        """Whether any face is loaded."""
        return self.faces.id.shape[0] > 0

    def add(self, time: float, particles: Particles, position_of_id: Array, mp: Array, f: Array) -> None:
        """Add the tractions at ``time`` to nodal forces: see ``add_tractions``.

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
            self._evaluate(time)
        lost = add_tractions(
            self.faces, self.corners, self._cells, particles.X, particles.F, particles.size,
            particles.velocity_field if self._several_fields else None, position_of_id, self._section,
            self._axisymmetric, mp, f,
        )  # fmt: skip
        if lost >= 0:
            raise SimulationError(
                f"a loaded face of particle {self.faces.id[lost]} left the grid at time {time:g}"
            )

    def _evaluate(self, time: float) -> None:
        for (load, _), rows in zip(self._loads, self._rows, strict=True):
            for a, value in enumerate(load.traction_at(self._centres[:, rows], time)):
                self.faces.traction[rows, a] = finite(value, load, time)
        self._evaluated = True
