"""Tractions through the deformed faces of particles, put on the grid at the faces' corners."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mpmcli.boundary.base import Array, Nodes
from mpmcli.boundary.traction import Traction
from mpmcli.boundary.velocity import evaluate
from mpmcli.core.analysis import Analysis, Axisymmetric
from mpmcli.core.errors import SimulationError
from mpmcli.core.kernel import inline
from mpmcli.core.particles import Particles


class Faces(NamedTuple):
    """Loaded particle faces."""

    id: Array
    """(nf,) identity of the particle."""
    axis: Array
    """(nf,) axis that the undeformed face is normal to."""
    sign: Array
    """(nf,) component of the undeformed outward normal, -1 or 1."""
    follower: Array
    """(nf,) bool: whether area and direction follow the face."""
    radius: Array
    """(nf,) initial r of the particle, in axisymmetric analyses [length]."""
    traction: Array
    """(nf, d) traction along the undeformed axes [pressure]."""


class Corners(NamedTuple):
    """What the last ``add_tractions`` put on the grid, corner by corner (2^(d−1) per face)."""

    base: Array
    """(nc,) lowest node of the cell."""
    weight: Array
    """(nc, 2^d) weights of the cell's nodes, x fastest; their sum is 1."""
    force: Array
    """(nc, d) force [force]."""


class TractionFaces:
    """The loaded faces of a scene.

    Parameters
    ----------
    loads
        Pairs of a traction and the identities (n,) of the particles that have the loaded face.
    particles
        All particles; sizes are read, and initial positions unless given.
    grid
        The grid (``base.Nodes``).
    analysis
        The kind of analysis; in axisymmetric ones areas are per radian.
    section
        Thickness in plane analyses, area of the section in 1D, else 1.
    initial_positions
        (d, N) by identity, where the particles are not at the start any more.

    Attributes
    ----------
    faces, corners : the arrays of the kernels
    """

    def __init__(
        self,
        loads: Sequence[tuple[Traction, Array]],
        particles: Particles,
        grid: Nodes,
        analysis: Analysis,
        section: float = 1.0,
        initial_positions: Array | None = None,
    ):
        d = analysis.dimensions
        self._loads = [(traction, np.asarray(ids, dtype=np.int64)) for traction, ids in loads]
        self._grid = grid
        self._shape = np.array(grid.shape, dtype=np.int64)
        self._axisymmetric = isinstance(analysis, Axisymmetric)
        self._section = section
        counts = [ids.shape[0] for _, ids in self._loads]
        ends = np.cumsum([0, *counts])
        self._rows = [slice(int(ends[j]), int(ends[j + 1])) for j in range(len(counts))]
        ids = np.concatenate([np.empty(0, dtype=np.int64), *(ids for _, ids in self._loads)])
        memory = np.full(int(max(particles.id.max(initial=-1), ids.max(initial=-1))) + 1, -1)
        memory[particles.id] = np.arange(particles.count)
        initial = particles.X[:, memory[ids]] if initial_positions is None else initial_positions[:, ids]
        self.faces = Faces(
            id=ids,
            axis=np.repeat([traction.on.face.index for traction, _ in loads], counts).astype(np.int64),
            sign=np.repeat([traction.on.face.sign for traction, _ in loads], counts).astype(np.float64),
            follower=np.repeat([traction.follows for traction, _ in loads], counts).astype(bool),
            radius=initial[0].copy(),
            traction=np.zeros((ids.shape[0], d)),
        )
        self._centres = initial.copy()
        half = particles.size[:, memory[ids]]
        for k, (a, sign) in enumerate(zip(self.faces.axis, self.faces.sign, strict=True)):
            self._centres[a, k] += sign * half[a, k]
        nc = ids.shape[0] * 2 ** (d - 1)
        self.corners = Corners(np.zeros(nc, dtype=np.int64), np.zeros((nc, 2**d)), np.zeros((nc, d)))
        self._evaluated = False
        self._varies = any(
            "t" in component.variables for traction, _ in loads for component, _ in traction.components(d)
        )

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
        grid = self._grid
        lost = add_tractions(
            self.faces, self.corners, particles.X, particles.F, particles.size, position_of_id,
            grid.lower, grid.cell, grid.pad, self._shape, self._section, self._axisymmetric, mp, f,
        )  # fmt: skip
        if lost >= 0:
            raise SimulationError(
                f"a loaded face of particle {self.faces.id[lost]} left the grid at time {time:g}"
            )

    def power_of_momentum(self, mp: Array) -> float:
        """Power of the forces last added, with nodal velocities p/m of ``mp`` (n, 1+d) [power]."""
        return float(sum_power(self.corners, mp, True, self._shape))

    def power_of_velocity(self, v: Array) -> float:
        """Power of the forces last added, with velocities in the first columns of ``v`` (n, ≥d) [power]."""
        return float(sum_power(self.corners, v, False, self._shape))

    def total_forces(self) -> Array:
        """Force (n_loads, d) that each traction put on the grid last (per radian if axisymmetric) [force]."""
        shares = self.corners.force.shape[0] // max(self.faces.id.shape[0], 1)
        return np.array(
            [self.corners.force[r.start * shares : r.stop * shares].sum(axis=0) for r in self._rows]
        ).reshape(len(self._rows), self._shape.shape[0])

    def _evaluate(self, time: float) -> None:
        for (traction, _), rows in zip(self._loads, self._rows, strict=True):
            for a, (component, factor) in enumerate(traction.components(self._shape.shape[0])):
                values = evaluate(component, self._centres[:, rows], time)
                if not np.all(np.isfinite(values)):
                    raise SimulationError(f"load '{traction.name}': its value is not finite at time {time:g}")
                self.faces.traction[rows, a] = factor * values
        self._evaluated = True


def face_corners(dimensions: int) -> int:
    """How many corners a face has."""
    return int(math.pow(2, dimensions - 1))


@inline
def face_force(faces: Faces, k: int, F: Array, p: int, size: Array, flat: bool, force: Array) -> None:
    """Force on face k of particle p for a section of 1, into ``force`` (d,).

    Dead: T A₀. Follower: a = J F⁻ᵀ N A₀ (Nanson); the normal component of T acts along a, the
    tangential ones along the deformed tangents F e_b/|F e_b|. Out of plane the face widens by F_zz unless
    ``flat`` (axisymmetric, where the radius of the corners does that).
    """
    d = force.shape[0]
    axis = faces.axis[k]
    area = 1.0
    for b in range(d):
        if b != axis:
            area *= 2.0 * size[b, p]
    if not faces.follower[k]:
        for a in range(d):
            force[a] = area * faces.traction[k, a]
        return
    b = (axis + 1) % d
    c = (axis + 2) % d
    if d == 1:
        force[0] = faces.traction[k, 0] * area * F[1, p] * F[2, p]
        return
    if d == 2:
        turn = 1.0 if axis == 0 else -1.0
        force[0] = turn * F[2 + b, p]
        force[1] = -turn * F[b, p]
        if not flat:
            area *= F[4, p]
    else:
        for a in range(3):
            i = (a + 1) % 3
            j = (a + 2) % 3
            force[a] = F[3 * i + b, p] * F[3 * j + c, p] - F[3 * j + b, p] * F[3 * i + c, p]
    stretch = 0.0
    for a in range(d):
        stretch += force[a] ** 2
    stretch = np.sqrt(stretch)
    for a in range(d):
        force[a] *= area * faces.traction[k, axis]
    for t in range(d):
        if t != axis:
            length = 0.0
            for a in range(d):
                length += F[d * a + t, p] ** 2
            length = np.sqrt(length)
            for a in range(d):
                force[a] += area * stretch * faces.traction[k, t] * F[d * a + t, p] / length


@inline
def linear_weights(
    x: Array, lower: Array, cell: Array, pad: int, shape: Array, mp: Array, weight: Array
) -> tuple[int, float]:
    """Weights of the nodes of the cell at ``x`` (d,) into ``weight`` (2^d,), zero at nodes without mass.

    Returns the cell's lowest node (-1 outside the grid) and the sum of the weights.
    """
    d = x.shape[0]
    base = 0
    stride = 1
    for w in range(weight.shape[0]):
        weight[w] = 1.0
    for a in range(d):
        xi = (x[a] - lower[a]) / cell[a] + pad
        if not (xi >= 0.0 and xi < shape[a] - 1):
            return -1, 0.0
        i = int(np.floor(xi))
        base += stride * i
        stride *= shape[a]
        for w in range(weight.shape[0]):
            weight[w] *= xi - i if (w >> a) & 1 else 1.0 - (xi - i)
    total = 0.0
    for w in range(weight.shape[0]):
        if mp[cell_node(base, w, shape), 0] <= 0.0:
            weight[w] = 0.0
        total += weight[w]
    return base, total


@inline
def cell_node(base: int, w: int, shape: Array) -> int:
    """Node number w (bits: upper along x, y, z) of the cell whose lowest node is ``base``."""
    node = base
    stride = 1
    for a in range(shape.shape[0]):
        node += stride * ((w >> a) & 1)
        stride *= shape[a]
    return node


@inline
def add_tractions(
    faces: Faces, corners: Corners, X: Array, F: Array, size: Array, position_of_id: Array,
    lower: Array, cell: Array, pad: int, shape: Array, section: float, axisymmetric: bool, mp: Array, f:
    Array,
) -> int:  # fmt: skip
    """Add the forces on all faces to nodal forces, in equal shares per corner.

    At a corner the force goes to the nodes of its cell by linear functions; those without mass are left out
    and the others take their part, so that the total is exact. Where no node of that cell has mass, the nodes
    of the cell of the particle's centre are taken.

    Parameters
    ----------
    faces
        Loaded faces.
    corners
        Overwritten with what each corner gave.
    X, F, size
        (d, N), (nF, N), (d, N): current position, deformation gradient, initial half-sizes.
    position_of_id
        (N,) place in memory of each identity, -1 if the particle is gone.
    lower, cell, pad, shape
        Lower corner and spacing (d,) of the user's grid, ghost layers, number of nodes (d,).
    section
        Thickness, or area in 1D.
    axisymmetric
        Whether areas are weighted with r: of the deformed corner for followers, of the initial one for dead
        loads.
    mp
        (n, 1+d) mass and momentum.
    f
        (n, d) nodal forces; added to.

    Returns
    -------
    int
        -1, or the first face that is off the grid (its forces are left out).
    """
    d = X.shape[0]
    shares = 1 << (d - 1)
    nodes = 1 << d
    force = np.empty(d)
    x = np.empty(d)
    lost = -1
    for k in range(faces.id.shape[0]):
        p = position_of_id[faces.id[k]]
        axis = faces.axis[k]
        if p >= 0:
            face_force(faces, k, F, p, size, axisymmetric, force)
        for corner in range(shares):
            q = k * shares + corner
            for a in range(d):
                corners.force[q, a] = 0.0
            for w in range(nodes):
                corners.weight[q, w] = 0.0
            corners.base[q] = 0
            if p < 0:
                continue
            radius = faces.radius[k]
            for a in range(d):
                x[a] = X[a, p]
            bit = 0
            for t in range(d):
                offset = faces.sign[k] * size[t, p]
                if t != axis:
                    offset = size[t, p] * (1.0 if (corner >> bit) & 1 else -1.0)
                    bit += 1
                for a in range(d):
                    x[a] += F[d * a + t, p] * offset
                if t == 0:
                    radius += offset
            base, total = linear_weights(x, lower, cell, pad, shape, mp, corners.weight[q])
            share = section / shares
            if axisymmetric:
                share *= max(x[0], 0.0) if faces.follower[k] else radius
            if base >= 0 and total <= 0.0:
                base, total = linear_weights(X[:, p], lower, cell, pad, shape, mp, corners.weight[q])
            if base < 0 or total <= 0.0:
                for w in range(nodes):
                    corners.weight[q, w] = 0.0
                if lost < 0:
                    lost = k
                continue
            corners.base[q] = base
            for a in range(d):
                corners.force[q, a] = share * force[a]
            for w in range(nodes):
                corners.weight[q, w] /= total
                if corners.weight[q, w] != 0.0:
                    i = cell_node(base, w, shape)
                    for a in range(d):
                        f[i, a] += corners.weight[q, w] * corners.force[q, a]
    return lost


@inline
def sum_power(corners: Corners, record: Array, momentum: bool, shape: Array) -> float:
    """Σ f·v over corners; velocities are p/m of ``record`` = mp (n, 1+d), or its first columns."""
    power = 0.0
    for q in range(corners.base.shape[0]):
        for w in range(corners.weight.shape[1]):
            weight = corners.weight[q, w]
            if weight != 0.0:
                i = cell_node(corners.base[q], w, shape)
                for a in range(corners.force.shape[1]):
                    v = record[i, 1 + a] / record[i, 0] if momentum else record[i, a]
                    power += weight * corners.force[q, a] * v
    return power
