"""Where the faces of cracks meet: the pairs of sides at crack nodes, and the geometry between them."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.area import SMALLEST, contact_area, perpendicular_size
from mpmcli.contact.fields_in_contact import NodeTable, allocate_fields, put_contact
from mpmcli.contact.geometry import allocate_geometry, unsure
from mpmcli.contact.impulses import allocate_rows
from mpmcli.contact.laws.impulse import TINIEST
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.dofs import dof_of, field_of, side_of
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles, determinant_of_particle
from mpmcli.cracks.crossing import BITS, is_left
from mpmcli.cracks.sides import CrackSides
from mpmcli.interfaces.jump import add_inverse_times

Array = np.ndarray

DISPLACEMENT, FACES, POSITION_OFFSET, REGRESSION = 0, 1, 2, 3
SEPARATIONS = {
    "displacement": DISPLACEMENT, "faces": FACES, "position_offset": POSITION_OFFSET, "regression": REGRESSION,
}  # fmt: skip
"""How the distance of faces is found: ``faces.separation`` of a crack."""
FAR_AWAY = 1e300
"""Beyond every distance [length]; compiled code knows no infinity."""
SIDES = 4
"""Sides that a node has at most."""
LIGHT = 1e-5
"""Share of the mass of both sides below which laws that press leave a node alone, as in ``contact.mass_ratio``."""


class Planes(NamedTuple):
    """Where the cracks of a crack node lie, (slots, at least, 2, …): for c₁ and c₂.

    normal : (…, 2) unit normal from below the crack to above, the mean over the crossings that the node sees
    distance : of the crack from the node along the normal [length]
    above : above zero where the node is above the crack
    """

    normal: Array
    distance: Array
    above: Array


class Faces(NamedTuple):
    """Pairs of sides, beside ``FieldsInContact``: one row per contact.

    bit : (k,) 0 for faces of c₁, 1 for those of c₂
    crack : (k,) index of the crack
    jump : (k, 2) δ = u_β − u_α at the start of the step [length]
    aside, mass : (k, 2), (k,) as those of ``interfaces.jump.JumpRows``, where springs join the faces
    sums : (k, 12) scratch
    """

    bit: Array
    crack: Array
    jump: Array
    aside: Array
    mass: Array
    sums: Array


class Springs(NamedTuple):
    """Which laws are springs (laws,), and whether stiff ones act at the node: ``interfaces.jump.find_interfaces``."""

    of_law: Array
    to_node: bool


class Matter(NamedTuple):
    """What faces read of the particles, as ``Particles``, with ``F`` (nF, N)."""

    X: Array
    X0: Any
    F: Array
    vol0: Array
    mass: Array
    field: Array
    size: Array


class Separations(NamedTuple):
    """How the distance of the faces of each crack is found.

    way : (cracks,) ``DISPLACEMENT``, ``FACES``, ``POSITION_OFFSET`` or ``REGRESSION``
    offset : (cracks,) distance of mean positions of faces that touch [cells]
    """

    way: Array
    offset: Array


class Lattice(NamedTuple):
    """The grid: coordinate of its first node, cell size, nodes along each axis (2,); whether volumes are per radian."""

    origin: Array
    cell: Array
    shape: Array
    ring: bool


@compiled_too
def find_planes(count, candidates, entries, nodes, segments, lattice, matter, planes):
    """Normals and places of the cracks of every crack node, from the lines of sight that cross them (Nairn 2023)."""
    normal, distance, above = planes.normal, planes.distance, planes.above
    for slot in range(count):
        column, row = nodes.node[slot] % lattice.shape[0], nodes.node[slot] // lattice.shape[0]
        x, y = lattice.origin[0] + column * lattice.cell[0], lattice.origin[1] + row * lattice.cell[1]
        for bit in range(2):
            nx, ny, away, total, which_side = 0.0, 0.0, 0.0, 0.0, 0.0
            crack = nodes.crack[slot, bit]
            for at in range(entries.first[slot], entries.first[slot + 1]):
                q, j = entries.row[at], entries.column[at]
                p = candidates.particle[q]
                for k in range(min(candidates.number[q, j], 2)):
                    s = candidates.segment[q, j, k]
                    if segments.crack[s] == crack:
                        w = candidates.S[q, j] * determinant_of_particle(matter.F, p) * matter.vol0[p]
                        if lattice.ring:
                            w /= matter.X[0, p]
                        a, b = segments.normal[s, 0], segments.normal[s, 1]
                        left = is_left(
                            segments.ax[s],
                            segments.ay[s],
                            segments.bx[s],
                            segments.by[s],
                            column << BITS,
                            row << BITS,
                        )
                        nx += w * a
                        ny += w * b
                        away += w * (a * (segments.at[s, 0] - x) + b * (segments.at[s, 1] - y))
                        which_side += w if left == (segments.along[s] > 0) else -w
                        total += w
            size = np.sqrt(nx * nx + ny * ny)
            if size > 0.0:
                normal[slot, bit, 0], normal[slot, bit, 1] = nx / size, ny / size
                distance[slot, bit] = away / total
            above[slot, bit] = which_side


@compiled_too
def has_mass(dof, first, end, wanted):
    """Whether a degree of freedom is among those with mass."""
    found = False
    for e in range(first, end):
        found = found or dof[e] == wanted
    return found


@compiled_too
def list_faces(
    nodes, count, planes, laws, skipped, screened, rigid, node_count, mp, dof, first, m, faces, begin
):
    """Write the pairs of sides in contact at the crack nodes into ``m`` and ``faces``; returns their number.

    ``laws`` (cracks,) is the law of each crack, ``dof`` and ``first`` receive the degrees of freedom with mass.
    A field meets itself across a crack; where it has no matter beyond, it meets the others there. Where two cracks
    meet, or a side has matter of several fields, all pairs of the node are coupled.
    """
    fields = rigid.shape[0]
    entries, k = 0, 0
    for slot in range(count):
        first[slot] = entries
        begin[slot] = k
        sides = SIDES if nodes.crack[slot, 1] >= 0 else 2
        several = sides > 2
        for side in range(sides):
            inside = 0
            for field in range(fields):
                i = dof_of(nodes.node[slot], field, side, node_count, fields)
                if not rigid[field] and mp[i, 0] > 0.0:
                    dof[entries] = i
                    entries += 1
                    inside += 1
            several = several or inside > 1
        for bit in range(2):
            crack = nodes.crack[slot, bit]
            if crack < 0:
                continue
            law = laws[crack]
            if skipped[law]:
                continue
            for e in range(first[slot], entries):
                for other in range(e + 1, entries):
                    mine, theirs = (
                        side_of(dof[e], node_count, fields),
                        side_of(dof[other], node_count, fields),
                    )
                    if mine ^ theirs != 1 << bit:
                        continue
                    stride = (1 << bit) * fields * node_count
                    if dof[other] - dof[e] != stride and (
                        has_mass(dof, first[slot], entries, dof[e] + stride)
                        or has_mass(dof, first[slot], entries, dof[other] - stride)
                    ):
                        continue
                    share = mp[dof[e], 0] / (mp[dof[e], 0] + mp[dof[other], 0])
                    if screened[law] and (share < LIGHT or share > 1.0 - LIGHT):
                        continue
                    # e has the bit unset: it is on the node's own side of the crack
                    alpha, partner = (other, e) if planes.above[slot, bit] > 0.0 else (e, other)
                    put_contact(m, k, slot, dof[alpha], dof[partner], partner, partner + 1, law)
                    m.alone[k] = m.both[k] = True
                    m.pair[k] = several
                    faces.bit[k], faces.crack[k] = bit, crack
                    k += 1
    first[count] = entries
    begin[count] = k
    return k


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
def reach_of_particle(F, size, p, nx, ny):
    """How far the deformed inscribed ellipse of a particle reaches along a unit vector [nairn2020, Eq. 25] [length]."""
    a, b, c, d = F[0, p], F[1, p], F[2, p], F[3, p]
    determinant = a * d - b * c
    x, y = (d * nx - b * ny) / (determinant * size[0, p]), (a * ny - c * nx) / (determinant * size[1, p])
    return 1.0 / math.sqrt(x * x + y * y)


@compiled_too
def separation_of_sides(way, offset, h, means, edges):
    """Distance of two sides by ``means``, below and above, or by the ``edges`` of their particles [length]."""
    if way == POSITION_OFFSET:
        return means[1] - means[0] - offset * h
    return edges[1] - edges[0]


@compiled_too
def find_face_geometry(
    axes,
    count,
    fields,
    faces,
    nodes,
    node_count,
    field_count,
    candidates,
    entries,
    lattice,
    matter,
    planes,
    separations,
    points,
    springs,
    geometry,
):
    """Jump, separation and area of every pair of sides, from the particles that its node sees.

    The jump is the difference of the reference positions of the matter that is at the crack now, as that of interfaces;
    its normal part is the separation, so that faces start closed, unless ``separations`` says otherwise. Where laws are
    ``springs``, particles count by their distance from the crack, too: see ``interfaces.jump.find_jump``.
    """
    normal, separation, distances, area, status = (
        geometry.normal, geometry.separation, geometry.distances, geometry.area, geometry.status,
    )  # fmt: skip
    jump, aside, sums = faces.jump, faces.aside, faces.sums
    for k in range(count):
        slot, bit = fields.slot[k], faces.bit[k]
        side_a, field_a = (
            side_of(fields.alpha[k], node_count, field_count), field_of(fields.alpha[k], node_count, field_count),
        )  # fmt: skip
        side_b, field_b = (
            side_of(fields.partner[k], node_count, field_count), field_of(fields.partner[k], node_count, field_count),
        )  # fmt: skip
        column, row = nodes.node[slot] % lattice.shape[0], nodes.node[slot] // lattice.shape[0]
        n, away = normal[k], planes.distance[slot, bit]
        for a in range(2):
            n[a] = planes.normal[slot, bit, a]
        x = lattice.origin[0] + column * lattice.cell[0] + away * n[0]
        y = lattice.origin[1] + row * lattice.cell[1] + away * n[1]
        total = sums[k]
        at_a, at_b, F, along_a, along_b = total[:2], total[2:4], total[4:8], total[8:10], total[10:]
        for a in range(12):
            total[a] = 0.0
        is_spring, h = springs.of_law[fields.law[k]], perpendicular_size(axes, lattice.cell, n)
        to_node, whole_a, whole_b = is_spring and springs.to_node, 0.0, 0.0
        m_a, m_b, volume_a, volume_b = 0.0, 0.0, 0.0, 0.0
        way = separations.way[faces.crack[k]]
        mean_a, mean_b, edge_a, edge_b = 0.0, 0.0, -FAR_AWAY, FAR_AWAY
        here = jump[k]
        for at in range(entries.first[slot], entries.first[slot + 1]):
            q, j = entries.row[at], entries.column[at]
            p, side = candidates.particle[q], candidates.side[q, j]
            is_a = side == side_a and matter.field[p] == field_a
            if not is_a and (side != side_b or matter.field[p] != field_b):
                continue
            w, S = candidates.S[q, j] * matter.mass[p], candidates.S[q, j]
            mine = at_a if is_a else at_b
            here[0], here[1] = x - matter.X[0, p], y - matter.X[1, p]
            if is_spring:
                share = S * max(1.0 - abs(here[0] * n[0] + here[1] * n[1]) / h, SMALLEST)
                w = share * matter.mass[p]
                whole_a += share * matter.vol0[p] if is_a else 0.0
                whole_b += 0.0 if is_a else share * matter.vol0[p]
            for a in range(2):
                mine[a] -= w * (matter.X[a, p] - matter.X0[a, p] + here[a])
            add_inverse_times(axes, matter.F, p, w, 0, here, mine)
            if to_node:
                add_inverse_times(axes, matter.F, p, w, 0, n, along_a if is_a else along_b)
            for a in range(4):
                F[a] += w * matter.F[a, p]
            volume = S * determinant_of_particle(matter.F, p) * matter.vol0[p]
            if way == POSITION_OFFSET:
                along = w * (n[0] * matter.X[0, p] + n[1] * matter.X[1, p])
                mean_a += along if is_a else 0.0
                mean_b += 0.0 if is_a else along
            elif way == REGRESSION:
                along = n[0] * matter.X[0, p] + n[1] * matter.X[1, p]
                reach = reach_of_particle(matter.F, matter.size, p, n[0], n[1])
                if is_a:
                    edge_a = max(edge_a, along + reach)
                else:
                    edge_b = min(edge_b, along - reach)
            if is_a:
                m_a += w
                volume_a += volume
            else:
                m_b += w
                volume_b += volume
        for a in range(2):
            here[a], aside[k, a] = 0.0, 0.0
        if m_a > 0.0 and m_b > 0.0:
            for a in range(2):
                for b in range(2):
                    here[a] += F[2 * a + b] * (at_a[b] / m_a - at_b[b] / m_b) / (m_a + m_b)
                    aside[k, a] += F[2 * a + b] * away * (along_b[b] / m_b - along_a[b] / m_a) / (m_a + m_b)
            faces.mass[k] = 0.5 * h / (whole_a / m_a + whole_b / m_b) if to_node else 0.0
        opening = here[0] * n[0] + here[1] * n[1]
        distances[k, 0], distances[k, 1] = away - 0.5 * opening, away + 0.5 * opening
        gap = opening
        if way == FACES:
            gap = opening_of_chain(points, faces.crack[k], x, y, n)
        elif way != DISPLACEMENT and m_a > 0.0 and m_b > 0.0:
            gap = separation_of_sides(
                way, separations.offset[faces.crack[k]], h, (mean_a / m_a, mean_b / m_b), (edge_a, edge_b)
            )
        separation[k] = gap + unsure(axes, h, lattice.shape, lattice.origin, lattice.cell)
        area[k] = contact_area(volume_a, volume_b, h, distances[k])
        status[k] = 0


@inline
def find_faces(
    nodes, count, candidates, entries, segments, lattice, matter, planes, laws, skipped, screened, separations, points,
    springs, rigid, node_count, mp, dof, first, m, faces, begin, geometry,
):  # fmt: skip
    """Find the pairs of sides in contact and their geometry; returns how many.

    One call for all of it: to hand so many arrays over takes longer than the work on a few nodes.
    """
    find_planes(count, candidates, entries, nodes, segments, lattice, matter, planes)
    found = list_faces(
        nodes, count, planes, laws, skipped, screened, rigid, node_count, mp, dof, first, m, faces, begin
    )
    find_face_geometry(
        (0.0, 0.0), found, m, faces, nodes, node_count, rigid.shape[0], candidates, entries, lattice, matter, planes,
        separations, points, springs, geometry,
    )  # fmt: skip
    return found


class FaceContacts:
    """The pairs of sides in contact in a step, as ``contact.contact_impulses.FoundContacts``.

    Parameters
    ----------
    sides : of the step
    laws : (cracks,) index of the law of each crack
    models : the laws
    separations : how the distance of the faces of each crack is found
    rigid : (fields,) whether a field belongs to a rigid body
    grid, particles : of the simulation
    ring : the analysis is axisymmetric

    Attributes
    ----------
    planes, faces : see ``Planes``, ``Faces``
    """

    def __init__(
        self, sides: CrackSides, laws: Array, models: list[Any], separations: Separations, rigid: Array, grid: Grid,
        particles: Particles, ring: bool,
    ):  # fmt: skip
        self._sides, self._laws, self._rigid = sides, laws, rigid
        self._separations = separations
        self._grid, self._particles = grid, particles
        self._skipped = np.array([model.skipped for model in models])
        self._screened = np.array([model.screened for model in models])
        self._springs = np.array([model.is_interface for model in models])
        origin, shape = grid.lower - grid.pad * grid.cell, np.array(grid.shape, dtype=np.int64)
        self.lattice = Lattice(origin, grid.cell, shape, ring)
        self.count = self.stages = 0
        self.has_pairs = False
        self._slots, self._room = -1, -1
        self._make_room(0, 0)

    def _make_room(self, slots: int, room: int) -> None:
        d, fields = 2, len(self._rigid)
        if slots > self._slots:
            self._slots = slots = max(slots, self._slots + self._slots // 4)
            self.planes = Planes(np.zeros((slots, 2, d)), np.zeros((slots, 2)), np.zeros((slots, 2)))
            self.begin = np.zeros(slots + 1, dtype=np.int64)
            self._first = np.zeros(slots + 1, dtype=np.int64)
            self._dof = np.zeros(slots * SIDES * fields, dtype=np.int64)
        if room <= self._room:
            return
        self._room = room = max(room, self._room + self._room // 4)
        self.fields = allocate_fields(room)
        self.faces = Faces(
            np.zeros(room, dtype=np.int64),
            np.zeros(room, dtype=np.int64),
            np.zeros((room, d)),
            np.zeros((room, d)),
            np.zeros(room),
            np.zeros((room, 12)),
        )
        self.geometry = allocate_geometry(room, d)
        self.rows = allocate_rows(room, d)

    def find(self, F: Array, to_node: bool) -> int:
        """Find the pairs and their geometry; ``F`` (nF, N) are the particles' own. Returns how many.

        ``to_node``: stiff springs act at the node (``Springs``).
        """
        sides, p, grid = self._sides, self._particles, self._grid
        self.count, count = 0, sides.count
        if count == 0:
            return 0
        self._make_room(count, count * (1 if grid.sides == 2 else SIDES) * len(self._rigid) ** 2)
        matter = Matter(p.X, p.X0, F, p.vol0, p.mass, p.velocity_field, p.size)
        self.count = find_faces(
            sides.nodes, count, sides.candidates, sides.entries, sides.segments, self.lattice, matter, self.planes,
            self._laws, self._skipped, self._screened, self._separations, sides.points.get(),
            Springs(self._springs, to_node), self._rigid, grid.node_count, grid.mp, self._dof, self._first, self.fields,
            self.faces, self.begin, self.geometry,
        )  # fmt: skip
        first = self._first[: count + 1]
        self.table = NodeTable(
            sides.nodes.node[:count], first, self._dof[: first[-1]], np.zeros(0), self._rigid, grid.node_count
        )
        self.stages = 1 + int(self.fields.stage[: self.count].max(initial=0))
        self.has_pairs = bool(self.fields.pair[: self.count].any())
        return self.count
