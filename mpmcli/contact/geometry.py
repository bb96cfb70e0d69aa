"""Where and how the two sides of a contact meet: normal, separation and area from the particles that its node sees."""

from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.area import contact_area, perpendicular_size
from mpmcli.contact.fields_in_contact import field_at
from mpmcli.contact.near_particles import IMAGE_BITS
from mpmcli.contact.neighbours import Neighbours
from mpmcli.contact.normals.base import FOUND, find_normal
from mpmcli.contact.normals.gradients import rigid_surface
from mpmcli.contact.separation.base import find_separation
from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.particles import determinant_of_particle

Array = np.ndarray

AT_ONE_PLACE = 1e-10
"""Edges that overlap by no more than this share of a cell only meet: round-off does as much."""
ROUND_OFF = 1e-15
"""The same as a share of the largest coordinate, whose last digits the edges' positions do not have."""


class Geometry(NamedTuple):
    """Where and how they meet: one row per contact.

    normal : (k, d) unit normal from α to β
    separation : (k,) distance of the two sides at the start of the step, negative where they overlap; with
        what round-off may make of no distance (``unsure``) added, so that sides that only meet begin to touch when
        they approach [length]
    distances : (k, 2) of the edges of α and β to the node along the normal, if the method knows them [length]
    area : (k,) contact area [area]; per radian in axisymmetric analyses
    bond : (k,) share of the volume around the node whose adhesion is intact [-]
    status : (k,) how the normal was found (see ``find_normal``)
    """

    normal: Array
    separation: Array
    distances: Array
    area: Array
    bond: Array
    status: Array


def allocate_geometry(room: int, dimensions: int) -> Geometry:
    """Make room for the geometry of contacts."""
    return Geometry(
        normal=np.zeros((room, dimensions)),
        separation=np.zeros(room),
        distances=np.zeros((room, 2)),
        area=np.zeros(room),
        bond=np.zeros(room),
        status=np.zeros(room, dtype=np.int64),
    )


class Surroundings(NamedTuple):
    """The grid around contact nodes.

    shape : (d,) nodes along each axis
    origin, cell : (d,) coordinate of the first node, cell size [length]
    planes, shift : (images, d) lines and shifts of ``Images``
    pad : ghost layers
    period : (d,) nodes after which nodes are one with those before, 0 along axes that are not periodic
    thickness : of a plane analysis [length], area of a 1D one [area], else 1
    ring : the analysis is axisymmetric, so that volumes and areas are per radian
    """

    shape: Array
    origin: Array
    cell: Array
    planes: Array
    shift: Array
    pad: int
    period: Array
    thickness: float
    ring: bool


class Matter(NamedTuple):
    """What contact reads of the particles.

    field : (N,) velocity field
    X : (d, N) positions [length]
    F : (nF, N) deformation gradients
    size : (d, N) half sides at the start [length]
    vol0, mass : (N,) initial volume and mass
    X0 : (d, N) initial positions [length], or None
    bond : (N,) 1 while adhesion is intact, or None
    outward : (d + 1, N) ``Particles.outward``, or None
    """

    field: Array
    X: Array
    F: Array
    size: Array
    vol0: Array
    mass: Array
    X0: Any
    bond: Any
    outward: Any


@kernel
def sum_volumes(nodes, near, field, F, vol0):
    """Volume Ω of each field at each contact node, Σ S J V₀, into ``nodes.volume``; of particles see ``Matter``."""
    volume = nodes.volume  # unfolded: numba drops what a parallel loop writes through a tuple
    for slot in prange(nodes.node.shape[0]):
        for e in range(nodes.first[slot], nodes.first[slot + 1]):
            mine, total = field_at(nodes, nodes.dof[e]), 0.0
            at = near.head[slot]
            while at >= 0:
                p = near.particle[at]
                if field[p] == mine:
                    total += near.S[at] * determinant_of_particle(F, p) * vol0[p]
                at = near.next[at]
            volume[e] = total


@inline
def put_radius(axes, F, size, p, turned, M, at):
    """Column ``at`` of ``M`` (d·d, capacity), or None: diag(1/R₀) F⁻¹, mirrored as the bits of ``turned`` say."""
    if M is None:
        return
    d = len(axes)
    if d == 1:
        M[0, at] = 1.0 / (F[0, p] * size[0, p])
    elif d == 2:
        a, b, c, e = F[0, p], F[1, p], F[2, p], F[3, p]
        inverse = 1.0 / (a * e - b * c)
        M[0, at], M[1, at] = e * inverse / size[0, p], -b * inverse / size[0, p]
        M[2, at], M[3, at] = -c * inverse / size[1, p], a * inverse / size[1, p]
    else:
        inverse = 1.0 / determinant_of_particle(F, p)
        for i in range(3):
            for j in range(3):
                # cofactor of F[j, i]
                r, s = (j + 1) % 3, (j + 2) % 3
                t, u = (i + 1) % 3, (i + 2) % 3
                minor = F[3 * r + t, p] * F[3 * s + u, p] - F[3 * r + u, p] * F[3 * s + t, p]
                M[3 * i + j, at] = minor * inverse / size[i, p]
    for j in range(d):
        if turned >> j & 1:
            for i in range(d):
                M[d * i + j, at] = -M[d * i + j, at]


@inline
def put_displacement(axes, X, X0, p, turned, u, at):
    """Column ``at`` of ``u`` (d, capacity), if there is one: displacement, mirrored as the bits of ``turned`` say."""
    if u is None or X0 is None:
        return
    for a in range(len(axes)):
        moved = X[a, p] - X0[a, p]
        u[a, at] = -moved if turned >> a & 1 else moved


@inline
def put_outward(axes, outward, p, turned, to, at):
    """Column ``at`` of ``to`` (d + 1, capacity), if there is one, mirrored as the bits of ``turned`` say."""
    if to is None or outward is None:
        return
    for a in range(len(axes)):
        to[a, at] = -outward[a, p] if turned >> a & 1 else outward[a, p]
    to[len(axes), at] = outward[len(axes), p]


@inline
def bond_of(bond, p):
    """Whether adhesion near particle ``p`` is intact; 0 without adhesion."""
    return 0.0 if bond is None else bond[p]


@inline
def share_on_planes(axes, i, around):
    """Share of node ``i`` on this side of the symmetry planes it lies on: its mass is that of real particles alone."""
    share = 1.0
    for image in range(around.planes.shape[0]):
        turned, on_plane, stride = 0, 0, 1
        for a in range(len(axes)):
            if around.planes[image, a] >= 0:
                turned += 1
                if i // stride % around.shape[a] == around.planes[image, a]:
                    on_plane += 1
            if around.shift[image, a] != 0:  # images of the same planes, a period away
                turned += 1
            stride *= around.shape[a]
        if turned == 1 and on_plane == 1:
            share *= 0.5
    return share


@inline
def index_at_home(around, i, stride, a):
    """Index along axis ``a`` of node ``i``, or of the node within the first period that it is one with."""
    index = i // stride % around.shape[a]
    return around.pad + (index - around.pad) % around.period[a] if around.period[a] > 0 else index


@inline
def row_of(array, row):
    """Row of an array, or None for None."""
    return None if array is None else array[row]


@inline
def gather(axes, slot, alpha, beta, alone, neighbours, nodes, around, near, matter):
    """Put the particles that a contact of field ``alpha`` with ``beta`` evaluates into its neighbours.

    Unless ``alone``, β are all deformable fields but α. Returns their number, the volumes Σ S V of α and of β, and the
    share of the volume that is bonded. What may be None is handed on: numba leaves out branches for arguments only.
    """
    i = nodes.node[slot]
    n = 0
    bonded, sum_alpha, sum_beta = 0.0, 0.0, 0.0
    at = near.head[slot]
    while at >= 0:
        p, turned = near.particle[at], near.flag[at]
        field = matter.field[p]
        mine = field == alpha
        if mine or (field == beta if alone else not nodes.rigid[field]):
            image = (turned >> IMAGE_BITS) - 1
            J = determinant_of_particle(matter.F, p)
            for a in range(len(axes)):
                x, g = matter.X[a, p], near.G[at, a]
                if turned >> a & 1:
                    x = 2.0 * (around.origin[a] + around.planes[image, a] * around.cell[a]) - x
                    g = -g
                elif image >= 0:
                    x += around.shift[image, a] * around.cell[a]
                neighbours.x[a, n] = x
                neighbours.G[a, n] = g
            put_displacement(axes, matter.X, matter.X0, p, turned, neighbours.displacement, n)
            put_radius(axes, matter.F, matter.size, p, turned, neighbours.radius_inverse, n)
            put_outward(axes, matter.outward, p, turned, neighbours.outward, n)
            neighbours.side[n] = -1.0 if mine else 1.0
            neighbours.S[n] = near.S[at]
            v = J * matter.vol0[p]
            bonded += near.S[at] * v * bond_of(matter.bond, p)
            if mine:
                sum_alpha += near.S[at] * v
            else:
                sum_beta += near.S[at] * v
            neighbours.volume[n] = v / matter.X[0, p] if around.ring else v
            neighbours.mass[n] = matter.mass[p]
            n += 1
        at = near.next[at]
    stride = 1
    for a in range(len(axes)):
        at_node = around.origin[a] + index_at_home(around, i, stride, a) * around.cell[a]
        for j in range(n):
            neighbours.x[a, j] -= at_node
        stride *= around.shape[a]
    whole = sum_alpha + sum_beta
    return n, sum_alpha, sum_beta, bonded / whole if whole > 0.0 else 0.0


@inline
def unsure(axes, h, shape_of_grid, origin, cell):
    """How far edges that meet exactly may seem to overlap, generously [length]; ``h`` as for separations."""
    largest = 0.0
    for a in range(len(axes)):
        largest = max(largest, abs(origin[a]), abs(origin[a] + shape_of_grid[a] * cell[a]))
    return AT_ONE_PLACE * h + ROUND_OFF * largest


@kernel
def find_geometry(
    normal_method,
    separation_method,
    axes,
    begin,
    fields,
    nodes,
    around,
    near,
    matter,
    guesses,
    buffers,
    geometry,
):
    """Normal, separation and area of every contact, from the particles that its node sees.

    ``begin`` (slots + 1,) is where the contacts of each node begin. ``guesses`` (dofs, d) may be None; contacts of one
    node read what those before them found, so that chunks are of nodes. ``buffers`` has ``Neighbours`` in each row, for
    a chunk.
    """
    # unfolded: numba drops what a parallel loop writes through a tuple
    normal, separation, distances, area, intact, status = geometry
    workers, slots = buffers.side.shape[0], nodes.node.shape[0]
    for c in prange(workers):
        neighbours = Neighbours(
            buffers.x[c], buffers.side[c], buffers.S[c], buffers.G[c], buffers.volume[c], buffers.mass[c],
            row_of(buffers.displacement, c), row_of(buffers.radius_inverse, c), buffers.work[c],
            row_of(buffers.outward, c),
        )  # fmt: skip
        for k in range(begin[slots * c // workers], begin[slots * (c + 1) // workers]):
            slot = fields.slot[k]
            alpha, beta = field_at(nodes, fields.alpha[k]), field_at(nodes, fields.partner[k])
            n, volume_alpha, volume_beta, intact[k] = gather(
                axes, slot, alpha, beta, fields.alone[k], neighbours, nodes, around, near, matter
            )
            side, order = 1.0 if fields.rigid[k] else 0.0, fields.order[k]
            if rigid_surface(axes, neighbours.outward, neighbours, n, fields.rigid[k], normal[k]):
                status[k] = FOUND
            elif guesses is None:
                status[k] = find_normal(
                    normal_method, axes, neighbours, n, side, order, buffers.work[c], normal[k]
                )
            else:
                guess = guesses[fields.alpha[k]]
                status[k] = find_normal(normal_method, axes, neighbours, n, side, order, guess, normal[k])
                for a in range(len(axes)):
                    guesses[fields.alpha[k], a] = normal[k, a]
            h = perpendicular_size(axes, around.cell, normal[k])
            gap = find_separation(separation_method, axes, neighbours, n, normal[k], h, distances[k])
            separation[k] = gap + unsure(axes, h, around.shape, around.origin, around.cell)
            part = share_on_planes(axes, nodes.node[slot], around)
            area[k] = part * contact_area(volume_alpha, volume_beta, h, distances[k])
