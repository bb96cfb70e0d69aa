"""Distances and areas of the faces of cracks at a node, from the particles that it sees."""

from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.area import SMALLEST, contact_area, perpendicular_size
from mpmcli.contact.geometry import put_radius, unsure
from mpmcli.contact.laws.impulse import TINIEST
from mpmcli.contact.separation.regression import Ellipsoids, radius_along
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.dofs import field_of, side_of
from mpmcli.core.particles import determinant_of_particle

Array = np.ndarray

AXES = (0.0, 0.0)
DISPLACEMENT, FACES, POSITION_OFFSET, REGRESSION = 0, 1, 2, 3
SEPARATIONS = {
    "displacement": DISPLACEMENT, "faces": FACES, "position_offset": POSITION_OFFSET, "regression": REGRESSION,
}  # fmt: skip
"""How the distance of faces is found: ``faces.separation`` of a crack."""
FAR_AWAY = 1e300
"""Beyond every distance [length]; compiled code knows no infinity."""
MASS, VOLUME, REFERENCE, INVERSE, GRADIENT, MEAN, WHOLE, ACROSS = 0, 1, 2, 4, 8, 12, 14, 15
SUMS = 18
"""Sums over the matter of a side, by column: Σ w and Σ S V, Σ w (X₀ − x + F⁻¹ (x − X)), Σ w F⁻¹, Σ w F,
Σ w (X − x) and Σ w V⁰/m, with w = S m and the node's place x. Where springs act, ``ACROSS`` is (n, a)/h⊥ with the
distance a of the crack from the node, and particles count by theirs from the crack, too:
w = S m max(1 − |n·(x − X) + a|/h⊥, 0)."""


class Matter(NamedTuple):
    """What faces read of the particles, as ``Particles``, with ``F`` (nF, N)."""

    X: Array
    X0: Any
    F: Array
    vol0: Array
    mass: Array
    size: Array


class Separations(NamedTuple):
    """How the distance of the faces of each crack is found.

    way : (cracks,) ``DISPLACEMENT``, ``FACES``, ``POSITION_OFFSET`` or ``REGRESSION``
    offset : (cracks,) distance of mean positions of faces that touch [cells]
    """

    way: Array
    offset: Array


class Springs(NamedTuple):
    """Which laws are springs (laws,), and whether stiff ones act at the node: ``interfaces.jump.find_interfaces``."""

    of_law: Array
    to_node: bool


class Lattice(NamedTuple):
    """The grid: coordinate of its first node, cell size, nodes along each axis (2,); whether volumes are per radian."""

    origin: Array
    cell: Array
    shape: Array
    ring: bool


@compiled_too
def sum_matter(rows, sights, width, lattice, matter, places, sums):
    """Sum up the matter of every side of the crack nodes, the first ``places`` ones, into ``sums`` (places, SUMS).

    All but ``ACROSS`` is zero on entry.
    """
    X, X0, F = matter.X, matter.X0, matter.F
    for row in range(rows):
        p = sights.particle[row]
        corner = np.int64(sights.corner[row])
        left = lattice.origin[0] + corner % lattice.shape[0] * lattice.cell[0] - X[0, p]
        y = lattice.origin[1] + corner // lattice.shape[0] * lattice.cell[1] - X[1, p]
        moved_x, moved_y = X0[0, p] - X[0, p], X0[1, p] - X[1, p]
        xx, xy, yx, yy = F[0, p], F[1, p], F[2, p], F[3, p]
        inverse = 1.0 / (xx * yy - xy * yx)
        a, b, c, d = yy * inverse, -xy * inverse, -yx * inverse, xx * inverse
        mass, volume = matter.mass[p], determinant_of_particle(F, p) * matter.vol0[p]
        x, j, end_of_line = left, 0, width
        for e in range(sights.first[row], sights.first[row + 1]):
            at, S = sights.at[e], sights.S[e]
            if at >= places:
                continue
            while j < sights.column[e]:
                j += 1
                x += lattice.cell[0]
                if j == end_of_line:
                    x, end_of_line = left, end_of_line + width
                    y += lattice.cell[1]
            out = sums[at]
            away = abs(out[ACROSS] * x + out[ACROSS + 1] * y + out[ACROSS + 2])
            share = S * max(1.0 - away, SMALLEST)
            w = share * mass
            out[MASS] += w
            out[WHOLE] += share * matter.vol0[p]
            out[VOLUME] += S * volume
            out[REFERENCE] += w * (moved_x - x + a * x + b * y)
            out[REFERENCE + 1] += w * (moved_y - y + c * x + d * y)
            out[INVERSE] += w * a
            out[INVERSE + 1] += w * b
            out[INVERSE + 2] += w * c
            out[INVERSE + 3] += w * d
            out[GRADIENT] += w * xx
            out[GRADIENT + 1] += w * xy
            out[GRADIENT + 2] += w * yx
            out[GRADIENT + 3] += w * yy
            out[MEAN] -= w * x
            out[MEAN + 1] -= w * y


@compiled_too
def find_edges(rows, sights, per, slots, matter, faces, begin, geometry, separations, M):
    """How far the deformed particles of both sides reach, into ``geometry.distances``, where regression asks for it.

    ``per`` is the number of places per node, ``M`` (4, 1) scratch.
    """
    for row in range(rows):
        p = sights.particle[row]
        put_radius(AXES, matter.F, matter.size, p, 0, M, 0)
        for e in range(sights.first[row], sights.first[row + 1]):
            at = sights.at[e]
            if at >= slots * per:
                continue
            for k in range(begin[at // per], begin[at // per + 1]):
                if separations.way[faces.crack[k]] != REGRESSION or (
                    at != faces.at[0, k] and at != faces.at[1, k]
                ):
                    continue
                n, edges = geometry.normal[k], geometry.distances[k]
                along = n[0] * matter.X[0, p] + n[1] * matter.X[1, p]
                reach = radius_along(Ellipsoids(2), AXES, M, 0, n)
                if at == faces.at[0, k]:
                    edges[0] = max(edges[0], along + reach)
                else:
                    edges[1] = min(edges[1], along - reach)


@compiled_too
def opening_of_chain(points, crack, x, y, n):
    """Opening along ``n`` (2,) of the faces of a crack where its plane is nearest to a node [length]."""
    nearest, opening = FAR_AWAY, 0.0
    for k in range(points.first[crack], points.first[crack + 1] - 1):
        wx, wy = points.X[0, k + 1] - points.X[0, k], points.X[1, k + 1] - points.X[1, k]
        dx, dy = x - points.X[0, k], y - points.X[1, k]
        along = min(max((dx * wx + dy * wy) / max(wx * wx + wy * wy, TINIEST), 0.0), 1.0)
        away = (dx - along * wx) ** 2 + (dy - along * wy) ** 2
        if away < nearest:
            nearest, opening = away, 0.0
            for a in range(2):
                before = points.faces[0, a, k] - points.faces[1, a, k]
                after = points.faces[0, a, k + 1] - points.faces[1, a, k + 1]
                opening += n[a] * ((1.0 - along) * before + along * after)
    return opening


@compiled_too
def inverse_times(total, i, x, y):
    """Component ``i`` of what the mean inverse deformation of a side makes of a vector."""
    return (total[INVERSE + 2 * i] * x + total[INVERSE + 2 * i + 1] * y) / total[MASS]


@compiled_too
def reference_at(total, shift, a):
    """Mean reference position of the matter that is now ``shift`` (2,) beside the node, less that place; axis ``a``."""
    return total[REFERENCE + a] / total[MASS] + inverse_times(total, a, shift[0], shift[1]) - shift[a]


@compiled_too
def now_along(a, b, i, x, y):
    """Component ``i`` of what the mean deformation of both sides makes of a vector of the reference state."""
    F = GRADIENT + 2 * i
    return ((a[F] + b[F]) * x + (a[F + 1] + b[F + 1]) * y) / (a[MASS] + b[MASS])


@compiled_too
def find_face_geometry(
    count, rows, sights, width, fields, faces, nodes, node_count, field_count, sides, lattice, matter, planes, begin,
    slots, separations, points, springs, sums, M, geometry,
):  # fmt: skip
    """Jump, separation and area of every pair of sides, from the particles that its node sees.

    The jump is the difference of the reference positions of the matter that is at the crack now, as that of interfaces;
    its normal part is the separation, so that faces start closed, unless ``separations`` says otherwise. Where laws are
    ``springs``, particles count by their distance from the crack, too: see ``interfaces.jump.find_jump``.
    """
    normal, separation, distances = geometry.normal, geometry.separation, geometry.distances
    per = sides * field_count
    for at in range(slots * per):
        for a in range(SUMS):
            sums[at, a] = 0.0
    by_edges = False
    for k in range(count):
        slot, bit = fields.slot[k], faces.bit[k]
        for face in range(2):
            dof = fields.alpha[k] if face == 0 else fields.partner[k]
            side, field = side_of(dof, node_count, field_count), field_of(dof, node_count, field_count)
            faces.at[face, k] = (slot * sides + side) * field_count + field
        normal[k, 0], normal[k, 1] = planes.normal[slot, bit, 0], planes.normal[slot, bit, 1]
        if springs.of_law[fields.law[k]]:
            h = perpendicular_size(AXES, lattice.cell, normal[k])
            for face in range(2):
                across = sums[faces.at[face, k]]
                across[ACROSS], across[ACROSS + 1] = normal[k, 0] / h, normal[k, 1] / h
                across[ACROSS + 2] = planes.distance[slot, bit] / h
        distances[k, 0], distances[k, 1] = -FAR_AWAY, FAR_AWAY
        by_edges = by_edges or separations.way[faces.crack[k]] == REGRESSION
    sum_matter(rows, sights, width, lattice, matter, slots * per, sums)
    if by_edges:
        find_edges(rows, sights, per, slots, matter, faces, begin, geometry, separations, M)
    for k in range(count):
        slot, crack, n, here = fields.slot[k], faces.crack[k], normal[k], faces.jump[k]
        a, b, away = sums[faces.at[0, k]], sums[faces.at[1, k]], planes.distance[slot, faces.bit[k]]
        both = a[MASS] > 0.0 and b[MASS] > 0.0
        shift = (away * n[0], away * n[1])
        here[0] = here[1] = 0.0
        if both:
            jx = reference_at(a, shift, 0) - reference_at(b, shift, 0)
            jy = reference_at(a, shift, 1) - reference_at(b, shift, 1)
            for i in range(2):
                here[i] = now_along(a, b, i, jx, jy)
        opening = here[0] * n[0] + here[1] * n[1]
        h = perpendicular_size(AXES, lattice.cell, n)
        if springs.of_law[fields.law[k]]:
            faces.aside[k, 0] = faces.aside[k, 1] = faces.mass[k] = 0.0
            if both and springs.to_node:
                ax = inverse_times(b, 0, shift[0], shift[1]) - inverse_times(a, 0, shift[0], shift[1])
                ay = inverse_times(b, 1, shift[0], shift[1]) - inverse_times(a, 1, shift[0], shift[1])
                faces.aside[k, 0], faces.aside[k, 1] = now_along(a, b, 0, ax, ay), now_along(a, b, 1, ax, ay)
                faces.mass[k] = 0.5 * h / (a[WHOLE] / a[MASS] + b[WHOLE] / b[MASS])
        way, gap = separations.way[crack], opening
        if way == FACES:
            x = lattice.origin[0] + nodes.node[slot] % lattice.shape[0] * lattice.cell[0] + shift[0]
            y = lattice.origin[1] + nodes.node[slot] // lattice.shape[0] * lattice.cell[1] + shift[1]
            gap = opening_of_chain(points, crack, x, y, n)
        elif way == REGRESSION and both:
            gap = distances[k, 1] - distances[k, 0]
        elif way == POSITION_OFFSET and both:
            gap = -separations.offset[crack] * h
            for i in range(2):
                gap += n[i] * (b[MEAN + i] / b[MASS] - a[MEAN + i] / a[MASS])
        distances[k, 0], distances[k, 1] = away - 0.5 * opening, away + 0.5 * opening
        separation[k] = gap + unsure(AXES, h, lattice.shape, lattice.origin, lattice.cell)
        geometry.area[k] = contact_area(a[VOLUME], b[VOLUME], h, distances[k])
        geometry.status[k] = 0
