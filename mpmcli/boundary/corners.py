"""Kernels of tractions: the force on each deformed face, given to the nodes around its corners."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.boundary.base import Array, Nodes
from mpmcli.core.kernel import inline


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


class Cells(NamedTuple):
    """The grid as the kernels need it, ghost layers counted; loops over the length of tuples are unrolled."""

    origin: tuple[float, ...]
    """Coordinates of node 0 [length]."""
    inverse_cell: tuple[float, ...]
    """1 / spacing [1/length]."""
    stride: tuple[int, ...]
    """Distance between neighbouring nodes along each axis, in node indices."""
    last: tuple[int, ...]
    """Index of the last node along each axis."""

    @classmethod
    def of(cls, grid: Nodes) -> Cells:
        """The cells of a grid."""
        origin = grid.lower - grid.pad * grid.cell
        strides = (math.prod(grid.shape[:a]) for a in range(len(grid.shape)))
        return cls(
            tuple(float(x) for x in origin),
            tuple(float(1 / h) for h in grid.cell),
            tuple(strides),
            tuple(n - 1 for n in grid.shape),
        )


@inline
def face_force(
    faces: Faces, cells: Cells, k: int, F: Array, p: int, size: Array, flat: bool, force: Array
) -> None:
    """Force on face k of particle p for a section of 1, into ``force`` (d,).

    Dead: T A₀. Follower: a = J F⁻ᵀ N A₀ (Nanson); the normal component of T acts along a, the
    tangential ones along the deformed tangents F e_b/|F e_b|. Out of plane the face widens by F_zz unless
    ``flat`` (axisymmetric, where the radius of the corners does that).
    """
    d = len(cells.stride)
    axis = faces.axis[k]
    area = 1.0
    for b in range(d):
        if b != axis:
            area *= 2.0 * size[b, p]
    if not faces.follower[k]:
        for a in range(d):
            force[a] = area * faces.traction[k, a]
        return
    if d == 1:
        force[0] = faces.traction[k, 0] * area * F[1, p] * F[2, p]
        return
    if d == 2:
        turn = 1.0 if axis == 0 else -1.0
        force[0] = turn * F[3 - axis, p]
        force[1] = -turn * F[1 - axis, p]
        if not flat:
            area *= F[4, p]
    else:
        b = (axis + 1) % 3
        c = (axis + 2) % 3
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
        if t != axis and faces.traction[k, t] != 0.0:
            length = 0.0
            for a in range(d):
                length += F[d * a + t, p] ** 2
            shear = area * stretch * faces.traction[k, t] / np.sqrt(length)
            for a in range(d):
                force[a] += shear * F[d * a + t, p]


@inline
def cell_node(cells: Cells, base: int, w: int) -> Any:
    """Node number w (bits: upper along x, y, z) of the cell whose lowest node is ``base``."""
    node = base
    for a in range(len(cells.stride)):
        node += cells.stride[a] * ((w >> a) & 1)
    return np.uint64(node)


@inline
def linear_weights(cells: Cells, x: Array, mp: Array, weight: Array, q: int) -> tuple[int, float]:
    """Weights of the nodes of the cell at ``x`` (d,) into row q of ``weight``, zero at nodes without mass.

    Returns the cell's lowest node (-1 outside the grid) and the sum of the weights.
    """
    base = 0
    for w in range(1 << len(cells.stride)):
        weight[q, w] = 1.0
    for a in range(len(cells.stride)):
        xi = (x[a] - cells.origin[a]) * cells.inverse_cell[a]
        if not (xi >= 0.0 and xi < cells.last[a]):
            return -1, 0.0
        i = int(xi)
        base += cells.stride[a] * i
        upper = xi - i
        for w in range(1 << len(cells.stride)):
            weight[q, w] *= upper if (w >> a) & 1 else 1.0 - upper
    total = 0.0
    for w in range(1 << len(cells.stride)):
        if mp[cell_node(cells, base, w), 0] <= 0.0:
            weight[q, w] = 0.0
        total += weight[q, w]
    return base, total


@inline
def add_tractions(
    faces: Faces,
    corners: Corners,
    cells: Cells,
    X: Array,
    F: Array,
    size: Array,
    position_of_id: Array,
    section: float,
    axisymmetric: bool,
    mp: Array,
    f: Array,
) -> int:
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
    cells
        The grid.
    X, F, size
        (d, N), (nF, N), (d, N): current position, deformation gradient, initial half-sizes.
    position_of_id
        (N,) place in memory of each identity, -1 if the particle is gone.
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
    d = len(cells.stride)
    shares = 1 << (d - 1)
    force = np.empty(d)
    x = np.empty(d)
    lost = -1
    corners.force[:] = 0.0
    corners.weight[:] = 0.0
    for k in range(faces.id.shape[0]):
        p = position_of_id[faces.id[k]]
        if p < 0:
            continue
        face_force(faces, cells, k, F, p, size, axisymmetric, force)
        for corner in range(shares):
            q = k * shares + corner
            radius = faces.radius[k] + place_corner(faces, cells, k, corner, X, F, p, size, x)
            base, total = linear_weights(cells, x, mp, corners.weight, q)
            share = section / shares
            if axisymmetric:
                share *= max(x[0], 0.0) if faces.follower[k] else radius
            if base >= 0 and total <= 0.0:
                for a in range(d):
                    x[a] = X[a, p]
                base, total = linear_weights(cells, x, mp, corners.weight, q)
            if base < 0 or total <= 0.0:
                corners.weight[q] = 0.0
                if lost < 0:
                    lost = k
                continue
            corners.base[q] = base
            for a in range(d):
                corners.force[q, a] = share * force[a]
            for w in range(1 << d):
                weight = corners.weight[q, w] / total
                corners.weight[q, w] = weight
                if weight != 0.0:
                    i = cell_node(cells, base, w)
                    for a in range(d):
                        f[i, a] += weight * share * force[a]
    return lost


@inline
def place_corner(
    faces: Faces, cells: Cells, k: int, corner: int, X: Array, F: Array, p: int, size: Array, x: Array
) -> float:
    """Position of a corner of face k of particle p into ``x`` (d,); returns its initial distance in x."""
    d = len(cells.stride)
    for a in range(d):
        x[a] = X[a, p]
    first = 0.0
    bit = 0
    for t in range(d):
        offset = size[t, p]
        if t == faces.axis[k]:
            offset *= faces.sign[k]
        else:
            if not (corner >> bit) & 1:
                offset = -offset
            bit += 1
        for a in range(d):
            x[a] += F[d * a + t, p] * offset
        if t == 0:
            first = offset
    return first


@inline
def sum_power(corners: Corners, cells: Cells, record: Array, momentum: bool) -> float:
    """Σ f·v over corners; velocities are p/m of ``record`` = mp (n, 1+d), or its first columns."""
    power = 0.0
    for q in range(corners.base.shape[0]):
        for w in range(1 << len(cells.stride)):
            weight = corners.weight[q, w]
            if weight != 0.0:
                i = cell_node(cells, corners.base[q], w)
                for a in range(len(cells.stride)):
                    v = record[i, 1 + a] / record[i, 0] if momentum else record[i, a]
                    power += weight * corners.force[q, a] * v
    return power
