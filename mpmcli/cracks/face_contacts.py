"""Where the faces of cracks meet: the pairs of sides at crack nodes, and the geometry between them."""

from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.fields_in_contact import FieldsInContact, NodeTable, put_contact
from mpmcli.contact.geometry import Geometry
from mpmcli.contact.impulses import ImpulseRows
from mpmcli.core.compiled.bound import TypedCalls
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import called_once
from mpmcli.core.dofs import dof_of, side_of
from mpmcli.core.grid import Grid
from mpmcli.core.particles import Particles, determinant_of_particle
from mpmcli.cracks.crossing import ALONG, AT, BITS, FROM_X, FROM_Y, NORMAL, OF, TO_X, TO_Y, is_left
from mpmcli.cracks.face_geometry import SUMS, Lattice, Matter, Separations, Springs, find_face_geometry
from mpmcli.cracks.sides import CrackSides
from mpmcli.cracks.sights import CROSSINGS, NODES, SIGHTS

Array = np.ndarray

SIDES = 4
"""Sides that a node has at most."""
LIGHT = 1e-5
"""Share of the mass of both sides below which laws that press leave a node alone, as in ``contact.mass_ratio``."""


class Planes(NamedTuple):
    """Where the cracks of a crack node lie, (slots, at least, 2, …): for c₁ and c₂.

    normal : (…, 2) unit normal from below the crack to above, the mean over the crossings that the node sees
    distance : of the crack from the node along the normal [length]
    above : above zero where the node is above the crack
    total : sum of the weights of the lines of sight
    """

    normal: Array
    distance: Array
    above: Array
    total: Array


class Faces(NamedTuple):
    """Pairs of sides, beside ``FieldsInContact``: one row per contact.

    bit : (k,) 0 for faces of c₁, 1 for those of c₂
    crack : (k,) index of the crack
    jump : (k, 2) δ = u_β − u_α at the start of the step [length]
    aside, mass : (k, 2), (k,) as those of ``interfaces.jump.JumpRows``, where springs join the faces
    at : (2, k) places of α and of the partner, as in ``sights.Sights``
    """

    bit: Array
    crack: Array
    jump: Array
    aside: Array
    mass: Array
    at: Array


class Blocks(NamedTuple):
    """The memory of all that is kept of ``room`` contacts: compiled code takes four arrays sooner than forty.

    whole : (13, room) whole numbers
    flags : (4, room) True or False
    numbers : (9, room)
    vectors : (12, room, 2)
    """

    whole: Array
    flags: Array
    numbers: Array
    vectors: Array


def allocate_blocks(room: int) -> Blocks:
    """Make room for contacts."""
    whole, flags = np.zeros((13, room), dtype=np.int64), np.zeros((4, room), dtype=np.bool_)
    return Blocks(whole, flags, np.zeros((9, room)), np.zeros((12, room, 2)))


@compiled_too
def tables_in(blocks: Blocks) -> tuple[FieldsInContact, Faces, Geometry, ImpulseRows]:
    """The tables of contacts, whose columns are rows of ``blocks``."""
    i, b, r, v = blocks.whole, blocks.flags, blocks.numbers, blocks.vectors
    fields = FieldsInContact(i[0], i[1], i[2], i[3], i[4], i[5], i[6], b[0], b[1], b[2], b[3], r[0])
    faces = Faces(i[7], i[8], v[0], v[1], r[1], i[10:12])
    geometry = Geometry(v[2], r[2], v[3], r[3], r[4], i[9])
    rows = ImpulseRows(v[4], v[5], v[6], v[7], v[8], v[9], v[10], v[11], r[5], r[6], r[7], r[8], i[12])
    return fields, faces, geometry, rows


@compiled_too
def find_planes(counts, sights, weights, width, crossings, nodes, segments, lattice, matter, planes):
    """Normals and places of the cracks of every crack node, from the lines of sight that cross them (Nairn 2023)."""
    normal, distance, above = planes.normal, planes.distance, planes.above
    for slot in range(counts[NODES]):
        for bit in range(2):
            normal[slot, bit, 0] = normal[slot, bit, 1] = distance[slot, bit] = above[slot, bit] = 0.0
            planes.total[slot, bit] = 0.0
    for k in range(counts[CROSSINGS]):
        row, j, s = crossings.row[k], crossings.column[k], crossings.segment[k]
        p, corner = sights.particle[row], np.int64(sights.corner[row])
        column, line = corner % lattice.shape[0] + j % width, corner // lattice.shape[0] + j // width
        slot = nodes.slot_of_node[line * lattice.shape[0] + column]
        segment, place = segments.whole[s], segments.place[s]
        bit = 0 if segment[OF] == nodes.crack[slot, 0] else 1
        w = weights[row, j] * determinant_of_particle(matter.F, p) * matter.vol0[p]
        if lattice.ring:
            w /= matter.X[0, p]
        a, b = place[NORMAL], place[NORMAL + 1]
        left = is_left(
            segment[FROM_X], segment[FROM_Y], segment[TO_X], segment[TO_Y], column << BITS, line << BITS
        )
        normal[slot, bit, 0] += w * a
        normal[slot, bit, 1] += w * b
        x, y = lattice.origin[0] + column * lattice.cell[0], lattice.origin[1] + line * lattice.cell[1]
        distance[slot, bit] += w * (a * (place[AT] - x) + b * (place[AT + 1] - y))
        above[slot, bit] += w if left == (segment[ALONG] > 0) else -w
        planes.total[slot, bit] += w
    for slot in range(counts[NODES]):
        for bit in range(2):
            nx, ny = normal[slot, bit, 0], normal[slot, bit, 1]
            size = np.sqrt(nx * nx + ny * ny)
            if size > 0.0:
                normal[slot, bit, 0], normal[slot, bit, 1] = nx / size, ny / size
                distance[slot, bit] /= planes.total[slot, bit]


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


@called_once
def find_faces(
    counts, nodes, sights, weights, crossings, segments, lattice, matter, planes, laws, skipped, screened, separations,
    points, springs, rigid, node_count, sides, width, mp, dof, first, begin, sums, M, blocks,
):  # fmt: skip
    """Find the pairs of sides in contact and their geometry; returns how many, and whether some are coupled.

    One call for all of it: to hand so many arrays over takes longer than the work on a few nodes. ``sums`` (places, at
    least, SUMS) and ``M`` (4, 1) are scratch.
    """
    slots = counts[NODES]
    m, faces, geometry, _ = tables_in(blocks)
    find_planes(counts, sights, weights, width, crossings, nodes, segments, lattice, matter, planes)
    found = list_faces(
        nodes, slots, planes, laws, skipped, screened, rigid, node_count, mp, dof, first, m, faces, begin
    )
    find_face_geometry(
        found, counts[SIGHTS], sights, width, m, faces, nodes, node_count, rigid.shape[0], sides, lattice, matter,
        planes, begin, slots, separations, points, springs, sums, M, geometry,
    )  # fmt: skip
    coupled = False
    for k in range(found):
        coupled = coupled or m.pair[k]
    return found, coupled


NOTHING = np.zeros(0)


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
    rigid : as given
    blocks : in which the tables of contacts lie
    first, dof : as in ``table``, with room for more
    whole : (at least, count) ones
    """

    def __init__(
        self, sides: CrackSides, laws: Array, models: list[Any], separations: Separations, rigid: Array, grid: Grid,
        particles: Particles, ring: bool,
    ):  # fmt: skip
        self._sides, self._laws, self.rigid = sides, laws, rigid
        self._separations = separations
        self._grid, self._particles = grid, particles
        self._skipped = np.array([model.skipped for model in models])
        self._screened = np.array([model.screened for model in models])
        self._springs = np.array([model.is_interface for model in models])
        origin, shape = grid.lower - grid.pad * grid.cell, np.array(grid.shape, dtype=np.int64)
        self.lattice = Lattice(origin, grid.cell, shape, ring)
        self._M = np.zeros((4, 1))
        self.count, self.stages = 0, 1
        self.has_pairs = False
        self._call = TypedCalls()
        self._slots, self._room = -1, -1
        self._make_room(0, 0)

    def _make_room(self, slots: int, room: int) -> None:
        d, fields = 2, len(self.rigid)
        if slots > self._slots:
            self._slots = slots = max(slots, self._slots + self._slots // 4)
            numbers = (np.zeros((slots, 2)) for _ in range(3))
            self.planes = Planes(np.zeros((slots, 2, d)), *numbers)
            self.begin = np.zeros(slots + 1, dtype=np.int64)
            self.first = np.zeros(slots + 1, dtype=np.int64)
            self.dof = np.zeros(slots * SIDES * fields, dtype=np.int64)
            self._sums = np.zeros((slots * self._grid.sides * fields, SUMS))
        if room <= self._room:
            return
        self._room = room = max(room, self._room + self._room // 4)
        self.blocks = allocate_blocks(room)
        self.fields, self.faces, self.geometry, self.rows = tables_in(self.blocks)
        self.whole = np.ones(room)

    def find(self, F: Array, to_node: bool) -> int:
        """Find the pairs and their geometry; ``F`` (nF, N) are the particles' own. Returns how many.

        ``to_node``: stiff springs act at the node (``Springs``).
        """
        sides, p, grid = self._sides, self._particles, self._grid
        slots = sides.count
        self.count = 0
        if slots == 0:
            return 0
        self._make_room(slots, slots * (1 if grid.sides == 2 else SIDES) * len(self.rigid) ** 2)
        self.count, self.has_pairs = self._call(
            find_faces, sides.counts, sides.nodes, sides.sights, sides.weights, sides.crossings, sides.segments,
            self.lattice, Matter(p.X, p.X0, F, p.vol0, p.mass, p.size), self.planes, self._laws, self._skipped,
            self._screened, self._separations, sides.points.now, Springs(self._springs, to_node), self.rigid,
            grid.node_count, grid.sides, grid.width, grid.mp, self.dof, self.first, self.begin, self._sums, self._M,
            self.blocks,
        )  # fmt: skip
        first = self.first[: slots + 1]
        self.table = NodeTable(
            sides.nodes.node[:slots], first, self.dof[: first[-1]], NOTHING, self.rigid, grid.node_count
        )
        return self.count
