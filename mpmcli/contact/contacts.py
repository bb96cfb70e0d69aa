"""The contacts of a step: which velocity fields meet at which node, and the geometry of their meeting.

A contact is seen from one field, α, against β: the other field of a node with two, all others lumped at a node with
more (Nairn et al. 2020, Eq. 50), or one rigid field. At a node with two fields that share a normal one contact serves
both sides; otherwise each field has a contact of its own.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import prange

from mpmcli.contact.area import contact_area, perpendicular_size
from mpmcli.contact.cloud import WORK, Cloud
from mpmcli.contact.clouds import IMAGE_BITS, Clouds
from mpmcli.contact.normals.base import find_normal
from mpmcli.contact.separation.base import find_separation
from mpmcli.core.kernel import inline, kernel

Array = np.ndarray

WORKERS = 64
"""Contacts are looked at in at most this many chunks, each with a cloud of its own."""


class Rules(NamedTuple):
    """What fields do when they meet.

    law : (fields, fields) index of the law of each pair
    skipped, screened : (laws,) whether a law leaves fields alone; whether it passes over small mass ratios
    rigid : (fields,) whether a field belongs to a rigid body
    mass_ratio : smallest share of the mass at a node that counts
    explicit : nodes of three or more fields are settled pair by pair where that can be done
    coupled : they always are, so that lumped contacts are not needed
    shares_normal : one normal serves both sides
    """

    law: Array
    skipped: Array
    screened: Array
    rigid: Array
    mass_ratio: float
    explicit: bool
    coupled: bool
    shares_normal: bool


class Members(NamedTuple):
    """Who meets whom: one row per contact, (k,) each.

    slot : contact node, as counted by ``Clouds``
    alpha, partner : degrees of freedom of α and of the field of β with most volume
    first, last : the entries of the node among which β is (all others but α, or the rigid one alone)
    law : index of the law
    stage : contacts of one stage act at once, those of the next on what comes of it
    rigid : β is a rigid body
    alone : β is the partner alone, else all other deformable fields lumped
    pair : one of the pairs at a node of three or more fields that is to be settled pair by pair
    both : the contact acts on both sides, else on α alone
    order : +1 if α comes before its partner, or the partner is rigid; else −1
    """

    slot: Array
    alpha: Array
    partner: Array
    first: Array
    last: Array
    law: Array
    stage: Array
    rigid: Array
    alone: Array
    pair: Array
    both: Array
    order: Array


class Geometry(NamedTuple):
    """Where and how they meet: one row per contact.

    normal : (k, d) unit normal from α to β
    separation : (k,) distance of the two sides at the start of the step, negative where they overlap [length]
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


@inline
def put_contact(m, k, slot, alpha, partner, first, last, law):
    """Write row ``k`` of the members ``m``: a contact of α with others lumped, on α alone."""
    m.slot[k] = slot
    m.alpha[k] = alpha
    m.partner[k] = partner
    m.first[k], m.last[k] = first, last
    m.law[k] = law
    m.stage[k] = 0
    m.rigid[k] = m.alone[k] = m.pair[k] = m.both[k] = False
    m.order[k] = 1.0


@inline
def list_contacts(rules, node_count, slots, first, dof, volume, mp, m, begin):
    """Write the contacts of all contact nodes into ``m``; returns their number.

    ``first`` (slots + 1,), ``dof`` and ``volume`` (entries,) describe the nodes; ``begin`` (slots + 1,) receives
    where the contacts of each node begin.
    """
    k = 0
    for slot in range(slots):
        begin[slot] = k
        low, high = first[slot], first[slot + 1]
        soft = 0
        for e in range(low, high):
            if not rules.rigid[dof[e] // node_count]:
                soft += 1
        if soft == 2 or (soft > 2 and not rules.coupled):
            total = 0.0
            for e in range(low, high):
                if not rules.rigid[dof[e] // node_count]:
                    total += mp[dof[e], 0]
            both = soft == 2 and rules.shares_normal
            for e in range(low, high):
                field = dof[e] // node_count
                if rules.rigid[field]:
                    continue
                partner = -1
                for other in range(low, high):
                    if other == e or rules.rigid[dof[other] // node_count]:
                        continue
                    if partner < 0 or volume[other] > volume[partner]:
                        partner = other
                law = rules.law[field, dof[partner] // node_count]
                share = mp[dof[e], 0] / total
                small = share < rules.mass_ratio or share > 1.0 - rules.mass_ratio
                if rules.skipped[law] or (small and rules.screened[law]):
                    if both:
                        break
                    continue
                put_contact(m, k, slot, dof[e], dof[partner], low, high, law)
                m.alone[k] = soft == 2
                m.both[k] = both
                m.order[k] = 1.0 if dof[e] < dof[partner] else -1.0
                k += 1
                if both:
                    break
        if soft > 2 and rules.explicit:
            for e in range(low, high):
                for other in range(e + 1, high):
                    field, partner_field = dof[e] // node_count, dof[other] // node_count
                    if rules.rigid[field] or rules.rigid[partner_field]:
                        continue
                    law = rules.law[field, partner_field]
                    share = mp[dof[e], 0] / (mp[dof[e], 0] + mp[dof[other], 0])
                    small = share < rules.mass_ratio or share > 1.0 - rules.mass_ratio
                    if rules.skipped[law] or (small and rules.screened[law]):
                        continue
                    put_contact(m, k, slot, dof[e], dof[other], other, other + 1, law)
                    m.alone[k] = True
                    m.pair[k] = True
                    m.both[k] = True
                    k += 1
        stage = 0
        for r in range(low, high):
            if not rules.rigid[dof[r] // node_count]:
                continue
            stage += 1
            for e in range(low, high):
                field = dof[e] // node_count
                law = rules.law[field, dof[r] // node_count]
                if rules.rigid[field] or rules.skipped[law]:
                    continue
                put_contact(m, k, slot, dof[e], dof[r], r, r + 1, law)
                m.stage[k] = stage
                m.rigid[k] = True
                m.alone[k] = True
                k += 1
    begin[slots] = k
    return k


@inline
def most_contacts(rules, node_count, slots, first, dof):
    """Upper bound of the number of contacts of these nodes."""
    most = 0
    for slot in range(slots):
        soft, hard = 0, 0
        for e in range(first[slot], first[slot + 1]):
            if rules.rigid[dof[e] // node_count]:
                hard += 1
            else:
                soft += 1
        most += soft + soft * hard
        if rules.explicit:
            most += soft * (soft - 1) // 2
    return most


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
                    volume[e] += S[at] * determinant(F, p) * vol0[p]
            at = following[at]


@inline
def determinant(F, p):
    """J = det F of particle ``p``; ``F`` (3 | 5 | 9, N)."""
    if F.shape[0] == 3:
        return F[0, p] * F[1, p] * F[2, p]
    if F.shape[0] == 5:
        return (F[0, p] * F[3, p] - F[1, p] * F[2, p]) * F[4, p]
    return (
        F[0, p] * (F[4, p] * F[8, p] - F[5, p] * F[7, p])
        - F[1, p] * (F[3, p] * F[8, p] - F[5, p] * F[6, p])
        + F[2, p] * (F[3, p] * F[7, p] - F[4, p] * F[6, p])
    )


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
        inverse = 1.0 / determinant(F, p)
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
            J = determinant(F, p)
            for a in range(len(axes)):
                stride = 1
                for lower in range(a):
                    stride *= shape_of_grid[lower]
                index = i // stride % shape_of_grid[a]
                at_node = origin[a] + index * cell[a]
                x, g = X[a, p], G[at, a]
                flip = turned[at] >> a & 1
                if flip:
                    x = 2.0 * (origin[a] + planes[image, a] * cell[a]) - x
                    g = -g
                cloud.x[a, n] = x - at_node
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
    whole = sum_alpha + sum_beta
    return n, sum_alpha, sum_beta, bonded / whole if whole > 0.0 else 0.0


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
            separation[k] = find_separation(separation_method, axes, cloud, n, normal[k], h, distances[k])
            area[k] = contact_area(volume_alpha, volume_beta, h, distances[k])


class Contacts:
    """The contacts of the current step.

    Parameters
    ----------
    clouds : contact nodes and what they see
    rules : what fields do when they meet
    node_count : nodes of the grid
    dimensions : axes of the analysis

    Attributes
    ----------
    members, geometry : rows of all contacts; the first ``count`` are valid
    count : number of contacts
    begin : (slots + 1,) where the contacts of each node begin
    """

    def __init__(self, clouds: Clouds, rules: Rules, node_count: int, dimensions: int):
        self.clouds, self.rules = clouds, rules
        self._node_count, self._dimensions = node_count, dimensions
        self.count = 0
        self.stages = 0
        self._volume = np.zeros(0)
        self.begin = np.zeros(1, dtype=np.int64)
        self._room = -1
        self._make_room(0)
        self._clouds_at_work: tuple[Any, ...] = ()
        self._capacity = 0

    def _make_room(self, room: int) -> None:
        if room <= self._room:
            return
        room = max(room, 2 * self._room)
        d = self._dimensions
        self._room = room
        integers = {name: np.zeros(room, dtype=np.int64) for name in Members._fields}
        flags = {name: np.zeros(room, dtype=bool) for name in ("rigid", "alone", "pair", "both")}
        self.members = Members(**(integers | flags | {"order": np.zeros(room)}))
        self.geometry = Geometry(
            normal=np.zeros((room, d)),
            separation=np.zeros(room),
            distances=np.zeros((room, 2)),
            area=np.zeros(room),
            bond=np.zeros(room),
            status=np.zeros(room, dtype=np.int64),
        )
        self.dp0 = np.zeros((room, d))
        self.dp = np.zeros((room, d))
        self.total = np.zeros((room, d))
        self.settled = np.zeros((room, d))
        self.state = np.zeros(room, dtype=np.int64)
        self.start = np.zeros((room, d))
        self.prior = np.zeros((room, d))
        self.net = np.zeros((room, d))
        self.slip = np.zeros((room, d))
        self.separation_now = np.zeros(room)
        self.push = np.zeros(room)

    def sum_volumes(self, p: Any, F: Array, parallel: bool) -> None:
        """Find the volume of each field at each contact node."""
        c, s = self.clouds, self.clouds.sights
        self._size_volumes()
        sum_volumes[parallel](
            c.count, c.first, c.dof, self._node_count, s.head, s.next, s.particle, s.S, p.velocity_field, F, p.vol0,
            self._volume,
        )  # fmt: skip

    def _size_volumes(self) -> None:
        if len(self._volume) < len(self.clouds.dof):
            self._volume = np.zeros(2 * len(self.clouds.dof))

    def find_members(self, mp: Array) -> None:
        """List who meets whom at the contact nodes; masses from ``mp``."""
        c = self.clouds
        self._size_volumes()
        self._make_room(most_contacts(self.rules, self._node_count, c.count, c.first, c.dof))
        if len(self.begin) < c.count + 1:
            self.begin = np.zeros(2 * c.count + 1, dtype=np.int64)
        self.count = list_contacts(
            self.rules, self._node_count, c.count, c.first, c.dof, self._volume, mp, self.members, self.begin
        )
        self.stages = 1 + int(self.members.stage[: self.count].max(initial=0))

    def find_geometry(
        self, normal: Any, separation: Any, grid: Any, p: Any, F: Array, ring: bool, X0: Array | None,
        needs_radius: bool, guesses: Array | None, parallel: bool,
    ) -> None:  # fmt: skip
        """Find normals, separations and areas of all contacts."""
        if self.count == 0:
            return
        s, g, d = self.clouds.sights, self.geometry, self._dimensions
        self._size_clouds(int(s.number[: self.clouds.count].max()), X0 is not None, needs_radius)
        axes = (0.0,) * d
        find_geometry[parallel](
            normal, separation, axes, self.count, self.members, self.clouds.node, self._node_count,
            grid.shape, tuple(float(x) for x in grid.lower - grid.pad * grid.cell), tuple(float(c) for c in grid.cell),
            True if ring else None, s.head, s.next, s.particle, s.flag, s.S, s.G, self.clouds.images.line,
            p.velocity_field, self.rules.rigid, p.X, F, p.size, p.vol0, p.mass, X0, p.bond, guesses,
            *self._clouds_at_work, g.normal, g.separation, g.distances, g.area, g.bond, g.status,
        )  # fmt: skip

    def _size_clouds(self, most: int, displacement: bool, radius: bool) -> None:
        if most <= self._capacity and self._clouds_at_work:
            return
        self._capacity = n = max(most, 2 * self._capacity, 32)
        d, w = self._dimensions, WORKERS
        self._clouds_at_work = (
            np.zeros((w, d, n)),
            np.zeros((w, n)),
            np.zeros((w, n)),
            np.zeros((w, d, n)),
            np.zeros((w, n)),
            np.zeros((w, n)),
            np.zeros((w, d, n)) if displacement else None,
            np.zeros((w, d * d, n)) if radius else None,
            np.zeros((w, WORK)),
        )
