"""Deformed faces of particles: their size and points, and how a force or power goes to the nodes around them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mpmcli.boundary.base import Array, Nodes
from mpmcli.core.analysis import Analysis, Axisymmetric
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.functions import hat, hat_integral, quadratic_spline, quadratic_spline_integral


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


class Matter(NamedTuple):
    """What faces need to know of the particles.

    X, F, size : (d, N) positions, (nF, N) deformation gradients, (d, N) half-sizes at the start
    place : (identities,) place in memory of each identity, -1 if the particle is gone
    """

    X: Array
    F: Array
    size: Array
    place: Array


class Spot(NamedTuple):
    """A point of a face, and work space for the weights of the nodes around it."""

    x: Array
    """(d,) the point [length]."""
    reach: Array
    """(d,) half-sizes over which grid functions are averaged around it [length]."""
    line: Array
    """(w,) weights along an axis."""
    weight: Array
    """(w^d,) weights of the nodes."""


class Cells(NamedTuple):
    """The grid, ghost layers counted, and how particles see it; loops over the length of tuples are unrolled."""

    origin: tuple[float, ...]
    """Coordinates of node 0 [length]."""
    inverse_cell: tuple[float, ...]
    """1 / spacing [1/length]."""
    stride: tuple[int, ...]
    """Distance between neighbouring nodes along each axis, in node indices."""
    offsets: Array
    """(w^d,) distance of the nodes that see a point of a face from the lowest of them, x fastest."""
    last: tuple[int, ...]
    """Index of the last node along each axis."""
    node_count: int
    """Number of nodes: the distance between velocity fields, in node indices."""
    quadratic: bool
    """Whether grid functions are quadratic splines, not hats."""
    points: int
    """Points per axis of a face: 1 its middle, 2 its corners, 3 corners and middles."""
    mean: bool
    """Whether grid functions are averaged along the face, over the particle's undeformed box."""
    width: int
    """w, nodes per axis that see a point of a face."""
    section: float
    """Thickness in plane analyses, area of the section in 1D, else 1."""
    axisymmetric: bool
    """Whether areas are per radian, so that radii weigh them."""

    @classmethod
    def of(cls, grid: Nodes, analysis: Analysis, section: float, grid_functions: str, domain: str) -> Cells:
        """The cells of a grid, for grid functions and particle domains as ``shapes.ShapeEntry`` names them."""
        origin = grid.lower - grid.pad * grid.cell
        strides = tuple(math.prod(grid.shape[:a]) for a in range(len(grid.shape)))
        width = 2 + (grid_functions == "quadratic") + (domain == "box")
        offsets = np.zeros(1, dtype=np.int64)
        for stride in strides:
            offsets = (stride * np.arange(width)[:, None] + offsets).ravel()
        return cls(
            tuple(float(x) for x in origin),
            tuple(float(1 / h) for h in grid.cell),
            strides,
            offsets,
            tuple(n - 1 for n in grid.shape),
            node_count=math.prod(grid.shape),
            quadratic=grid_functions == "quadratic",
            points={"point": 1, "box": 1, "corners": 2, "corners_and_middles": 3}[domain],
            mean=domain == "box",
            width=width,
            section=section,
            axisymmetric=isinstance(analysis, Axisymmetric),
        )


@compiled_too
def new_spot(cells: Cells) -> Spot:
    """Return a spot anywhere."""
    d = len(cells.stride)
    return Spot(np.empty(d), np.zeros(d), np.empty(cells.width), np.empty(cells.width**d))


@compiled_too
def face_force(faces: Faces, cells: Cells, matter: Matter, k: int, p: int, force: Array) -> None:
    """Force on face k of particle p for a section of 1, into ``force`` (d,).

    Dead: T A₀. Follower: a = J F⁻ᵀ N A₀ (Nanson); the normal component of T acts along a, the
    tangential ones along the deformed tangents F e_b/|F e_b|. Out of plane the face widens by F_zz, but not in
    axisymmetric analyses, where the radius does that.
    """
    d, F, size = len(cells.stride), matter.F, matter.size
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
        if not cells.axisymmetric:
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


@compiled_too
def axis_weight(cells: Cells, r: float, reach: float) -> float:
    """Grid function at distance r from its node, or its mean over r ± ``reach`` (in cells)."""
    if reach == 0.0:
        return quadratic_spline(r) if cells.quadratic else hat(r)
    if cells.quadratic:
        rise = quadratic_spline_integral(r + reach) - quadratic_spline_integral(r - reach)
    else:
        rise = hat_integral(r + reach) - hat_integral(r - reach)
    return 0.5 * rise / reach


@compiled_too
def point_weights(cells: Cells, spot: Spot, first: int, mp: Array) -> tuple[int, float]:
    """Weights of the nodes around a spot into ``spot.weight``, zero at nodes without mass.

    ``first`` is node 0 of the velocity field. Returns the stencil's lowest node (-1 outside the grid) and the sum of
    the weights.
    """
    x, reach, line, weight = spot
    base = first
    below = 1.0 if cells.quadratic else 0.0
    weight[0] = 1.0
    across = 1
    for a in range(len(cells.stride)):
        xi = (x[a] - cells.origin[a]) * cells.inverse_cell[a]
        extent = reach[a] * cells.inverse_cell[a]
        low = np.floor(xi - extent + 0.5 * below) - below
        if not (low >= 0.0 and low + cells.width <= cells.last[a] + 1.0):
            return -1, 0.0
        base += cells.stride[a] * int(low)
        for i in range(cells.width):
            line[i] = axis_weight(cells, xi - low - i, extent)
        for i in range(cells.width - 1, -1, -1):
            for w in range(across):
                weight[i * across + w] = weight[w] * line[i]
        across *= cells.width
    total = 0.0
    for w in range(across):
        if mp[np.uint64(base + cells.offsets[w]), 0] <= 0.0:
            weight[w] = 0.0
        total += weight[w]
    return base, total


@compiled_too
def radius_of_face(faces: Faces, cells: Cells, matter: Matter, k: int, p: int, spot: Spot) -> float:
    """Radius of the middle of face k in axisymmetric analyses: now for followers, else at the start."""
    if faces.follower[k]:
        place_middle(faces, cells, matter, k, p, spot)
        return max(spot.x[0], 0.0)
    if faces.axis[k] == 0:
        return faces.radius[k] + faces.sign[k] * matter.size[0, p]
    return faces.radius[k]


@compiled_too
def give_to_nodes(
    faces: Faces,
    cells: Cells,
    matter: Matter,
    k: int,
    p: int,
    first: int,
    mp: Array,
    area: float,
    load: Array,
    f: Array,
    spot: Spot,
) -> bool:
    """Give ``area`` times ``load`` (c,) of face k of particle p to the nodes ``f`` (fields·n, c) around its points.

    ``first`` is node 0 of the particle's field; ``spot`` is work space. Returns False where a point is off the grid.
    """
    d = len(cells.stride)
    shares = cells.points ** (d - 1)
    is_on_grid = True
    for point in range(shares):
        place_middle(faces, cells, matter, k, p, spot)
        share = area * move_along_face(faces, cells, matter, k, point, p, spot.x)
        base, total = point_weights(cells, spot, first, mp)
        if base >= 0 and total <= 0.0:
            for a in range(d):
                spot.x[a] = matter.X[a, p]
            base, total = point_weights(cells, spot, first, mp)
        if base < 0 or total <= 0.0:
            is_on_grid = False
            continue
        for w in range(spot.weight.shape[0]):
            part = spot.weight[w] / total
            if part != 0.0:
                i = np.uint64(base + cells.offsets[w])
                for a in range(load.shape[0]):
                    f[i, a] += part * share * load[a]
    return is_on_grid


@compiled_too
def place_middle(faces: Faces, cells: Cells, matter: Matter, k: int, p: int, spot: Spot) -> None:
    """Put the spot at the middle of face k of particle p.

    Domains that do not follow the deformation keep their size (grid functions end where the undeformed box does) but
    their faces turn with the particle: the middle lies at X + ℓ F e/|F e|, and the average runs along the axes that the
    turned face is least normal to.
    """
    d, F, size = len(cells.stride), matter.F, matter.size
    axis = faces.axis[k]
    offset = faces.sign[k] * size[axis, p]
    across = 0
    length = 0.0
    for a in range(d):
        length += F[d * a + axis, p] ** 2
        if abs(F[d * a + axis, p]) > abs(F[d * across + axis, p]):
            across = a
    if cells.points == 1:
        offset /= np.sqrt(length)
    for a in range(d):
        spot.x[a] = matter.X[a, p] + F[d * a + axis, p] * offset
        spot.reach[a] = size[a, p] if cells.mean and a != across else 0.0


@compiled_too
def move_along_face(
    faces: Faces, cells: Cells, matter: Matter, k: int, point: int, p: int, x: Array
) -> float:
    """Move ``x`` (d,) from the middle of face k to one of its points; returns the point's share of the face."""
    d = len(cells.stride)
    share = 1.0
    rest = point
    for t in range(d):
        if t == faces.axis[k] or cells.points == 1:
            continue
        place = rest % cells.points
        rest //= cells.points
        offset = matter.size[t, p]
        if cells.points == 2:
            share *= 0.5
            offset *= 2.0 * place - 1.0
        else:
            share *= 4.0 / 6.0 if place == 1 else 1.0 / 6.0
            offset *= place - 1.0
        for a in range(d):
            x[a] += matter.F[d * a + t, p] * offset
    return share
