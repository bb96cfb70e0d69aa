"""Where and how the two sides of a contact meet: normal, separation and area from the particles that its node sees."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mpmcli.contact.area import contact_area, perpendicular_size
from mpmcli.contact.cloud import Cloud
from mpmcli.contact.clouds import IMAGE_BITS
from mpmcli.contact.normals.base import find_normal
from mpmcli.contact.separation.base import find_separation
from mpmcli.core.kernel import inline, kernel, prange
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


@kernel
def sum_volumes(slots, first, dof, node_count, head, following, seer, S, field, F, vol0, volume):
    """Volume Ω of each field at each contact node, Σ S J V₀, into ``volume`` (entries,)."""
    for slot in prange(slots):
        for e in range(first[slot], first[slot + 1]):
            volume[e] = 0.0
        at = head[slot]
        while at >= 0:
            p = seer[at]
            for e in range(first[slot], first[slot + 1]):
                if dof[e] // node_count == field[p]:
                    volume[e] += S[at] * determinant_of_particle(F, p) * vol0[p]
            at = following[at]


@inline
def put_radius(axes, F, size, p, turned, M, at):
    """Column ``at`` of ``M`` (d·d, capacity): diag(1/R₀) F⁻¹, mirrored as the bits of ``turned`` say."""
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
def share_on_planes(axes, i, shape_of_grid, planes):
    """Share of node ``i`` on this side of the symmetry planes it lies on: its mass is that of real particles alone."""
    share = 1.0
    for image in range(planes.shape[0]):
        turned, on_plane, stride = 0, 0, 1
        for a in range(len(axes)):
            if planes[image, a] >= 0:
                turned += 1
                if i // stride % shape_of_grid[a] == planes[image, a]:
                    on_plane += 1
            stride *= shape_of_grid[a]
        if turned == 1 and on_plane == 1:
            share *= 0.5
    return share


@inline
def row_of(array, row):
    """Row of an array, or None for None."""
    return None if array is None else array[row]


@inline
def gather(
    axes, k, cloud, members, node, node_count, shape_of_grid, origin, cell, ring, head, following, seer, turned, S, G,
    planes, field, rigid_field, X, F, size, vol0, mass, X0, bond, radius_inverse,
):  # fmt: skip
    """Put the particles that contact ``k`` looks at into its cloud.

    Returns their number, the volumes Σ S V of α and of β, and the share of the volume that is bonded. What may be None
    is an argument of its own: numba leaves out branches for arguments only. This must not
    stand in a parallel loop itself: numba would take the writes through the tuple for dead and drop them.
    """
    slot = members.slot[k]
    alpha = members.alpha[k] // node_count
    beta = members.partner[k] // node_count
    i = node[slot]
    n = 0
    bonded, sum_alpha, sum_beta = 0.0, 0.0, 0.0
    at = head[slot]
    while at >= 0:
        p = seer[at]
        mine = field[p] == alpha
        if mine or (field[p] == beta if members.alone[k] else not rigid_field[field[p]]):
            image = (turned[at] >> IMAGE_BITS) - 1
            J = determinant_of_particle(F, p)
            for a in range(len(axes)):
                x, g = X[a, p], G[at, a]
                flip = turned[at] >> a & 1
                if flip:
                    x = 2.0 * (origin[a] + planes[image, a] * cell[a]) - x
                    g = -g
                cloud.x[a, n] = x
                cloud.G[a, n] = g
                if X0 is not None:
                    u = X[a, p] - X0[a, p]
                    cloud.displacement[a, n] = -u if flip else u
            cloud.side[n] = -1.0 if mine else 1.0
            cloud.S[n] = S[at]
            v = J * vol0[p]
            if bond is not None:
                bonded += S[at] * v * bond[p]
            if mine:
                sum_alpha += S[at] * v
            else:
                sum_beta += S[at] * v
            cloud.volume[n] = v if ring is None else v / X[0, p]
            cloud.mass[n] = mass[p]
            if radius_inverse is not None:
                put_radius(axes, F, size, p, turned[at], radius_inverse, n)
            n += 1
        at = following[at]
    stride = 1
    for a in range(len(axes)):
        at_node = origin[a] + (i // stride % shape_of_grid[a]) * cell[a]
        for j in range(n):
            cloud.x[a, j] -= at_node
        stride *= shape_of_grid[a]
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
    normal_method, separation_method, axes, count, members, node, node_count, shape_of_grid, origin, cell, ring,
    head, following, seer, turned, S, G, planes, field, rigid_field, X, F, size, vol0, mass, X0, bond, guesses,
    b_x, b_side, b_S, b_G, b_volume, b_mass, b_displacement, b_radius, b_work,
    normal, separation, distances, area, intact, status,
):  # fmt: skip
    """Normal, separation and area of every contact, from the particles that its node sees.

    ``ring`` is given (not None) in axisymmetric analyses, whose volumes, and so areas, are per radian. Initial
    positions ``X0`` (d, N), ``bond`` (N,) and ``guesses`` (dofs, d) may be None. ``b_…`` are clouds, one per chunk of
    contacts; ``planes`` (images, d) the lines of nodes of ``Images``.
    """
    workers = b_side.shape[0]
    for c in prange(workers):
        cloud = Cloud(
            b_x[c], b_side[c], b_S[c], b_G[c], b_volume[c], b_mass[c], row_of(b_displacement, c), row_of(b_radius, c),
            b_work[c],
        )  # fmt: skip
        for k in range(count * c // workers, count * (c + 1) // workers):
            n, volume_alpha, volume_beta, intact[k] = gather(
                axes, k, cloud, members, node, node_count, shape_of_grid, origin, cell, ring, head, following, seer,
                turned, S, G, planes, field, rigid_field, X, F, size, vol0, mass, X0, bond, row_of(b_radius, c),
            )  # fmt: skip
            side, order = 1.0 if members.rigid[k] else 0.0, members.order[k]
            if guesses is None:
                status[k] = find_normal(normal_method, axes, cloud, n, side, order, b_work[c], normal[k])
            else:
                guess = guesses[members.alpha[k]]
                status[k] = find_normal(normal_method, axes, cloud, n, side, order, guess, normal[k])
                for a in range(len(axes)):
                    guesses[members.alpha[k], a] = normal[k, a]
            h = perpendicular_size(axes, cell, normal[k])
            gap = find_separation(separation_method, axes, cloud, n, normal[k], h, distances[k])
            separation[k] = gap + unsure(axes, h, shape_of_grid, origin, cell)
            part = share_on_planes(axes, node[members.slot[k]], shape_of_grid, planes)
            area[k] = part * contact_area(volume_alpha, volume_beta, h, distances[k])
