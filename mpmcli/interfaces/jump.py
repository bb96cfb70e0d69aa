"""The jump of displacement between the two sides of a contact, and the area over which it transmits tractions."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mpmcli.contact.area import SMALLEST, perpendicular_size
from mpmcli.contact.fields_in_contact import field_at
from mpmcli.contact.near_particles import IMAGE_BITS, NEAREST
from mpmcli.contact.separation.base import UNKNOWN
from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.particles import determinant_of_particle
from mpmcli.interfaces.base import BREAKS

Array = np.ndarray

UNSET = -1.0
"""Largest opening of particles that no interface has reached yet; what they know of breaks, if never bonded."""
REACH = 0.2
"""By so many cells matter that was bonded may be farther from an interface than matter that was not."""


class JumpRows(NamedTuple):
    """What interfaces know of the contacts of a step, a row for each.

    jump : (k, d) δ(0) = u_β − u_α at the start of the step [length]
    end : (k, d) δ(Δt) at its end [length]
    aside : (k, d) by how much the jump at the node exceeds that at the interface beside it [length]
    mass : (k,) m_red over the area where an interface lies on a node: half a cell of both sides [mass/area]
    force : (k, d) m_red (f_β/m_β − f_α/m_α) without the interface [force]
    history : (k, 3) largest openings so far, and whether it is broken
    now : (k, 2) openings at the end of the step [length]
    work, stored, spent : (k,) energy that the interface takes out of the bodies in the step; that it gives back; that
        is lost for good in the step [energy]
    broke : (k,) area that broke in the step [area]
    lost : (k,) whether its jump is too large for the grid
    apart : (k,) whether matter of either side was not bonded at the start of the run
    sums : (k, 4 d + d d) scratch
    """

    jump: Array
    end: Array
    aside: Array
    mass: Array
    force: Array
    history: Array
    now: Array
    work: Array
    stored: Array
    spent: Array
    broke: Array
    lost: Array
    apart: Array
    sums: Array


class Sides(NamedTuple):
    """Which pairs of fields have an interface, and where particles keep its history.

    law : (laws,) whether a law is one of interfaces
    row : (fields, fields) first row of the pair's history on particles of the first field, −1 where it has none
    pair : (fields, fields) number of each pair of fields
    """

    law: Array
    row: Array
    pair: Array


GRADIENT, EXTRAPOLATED, EDGES = 0, 1, 2
"""Ways to find a jump: ``contact.interface.jump``."""


@inline
def turn(r, turned, axis):
    """A component, mirrored where its axis is turned."""
    return -r if turned >> axis & 1 else r


@inline
def add_inverse_times(axes, F, p, weight, turned, r, out):
    """``out`` (d,) += weight · F⁻¹ r with the deformation gradient of particle ``p``, mirrored as ``turned`` says."""
    d = len(axes)
    x = turn(r[0], turned, 0)
    y = turn(r[1], turned, 1) if d > 1 else 0.0
    z = turn(r[2], turned, 2) if d > 2 else 0.0
    if d == 1:
        out[0] += weight * turn(x / F[0, p], turned, 0)
    elif d == 2:
        inverse = weight / (F[0, p] * F[3, p] - F[1, p] * F[2, p])
        out[0] += turn((F[3, p] * x - F[1, p] * y) * inverse, turned, 0)
        out[1] += turn((F[0, p] * y - F[2, p] * x) * inverse, turned, 1)
    else:
        xx, xy, xz = F[0, p], F[1, p], F[2, p]
        yx, yy, yz = F[3, p], F[4, p], F[5, p]
        zx, zy, zz = F[6, p], F[7, p], F[8, p]
        a, b, c = yy * zz - yz * zy, yz * zx - yx * zz, yx * zy - yy * zx
        inverse = weight / (xx * a + xy * b + xz * c)
        out[0] += turn((a * x + (xz * zy - xy * zz) * y + (xy * yz - xz * yy) * z) * inverse, turned, 0)
        out[1] += turn((b * x + (xx * zz - xz * zx) * y + (xz * yx - xx * yz) * z) * inverse, turned, 1)
        out[2] += turn((c * x + (xy * zx - xx * zy) * y + (xx * yy - xy * yx) * z) * inverse, turned, 2)


@kernel
def find_jumps(
    axes, way, sides, count, fields, nodes, around, near, matter, kept, start_gap, geometry, to_node, rows
):  # fmt: skip
    """Jump δ(0) of every contact whose law is one of interfaces, into ``rows.jump``.

    With ``GRADIENT`` the difference of the reference positions of the matter that is at the interface now, beside the
    node along the normal; each particle tells its own by its deformation gradient, and the mean gradient of both sides
    pushes the difference forward: exact for affine motions of both. With ``EXTRAPOLATED`` the difference of mean
    displacements (Nairn 2023, Eq. 2.4); with ``EDGES`` the part along the normal is the separation less that of the
    start, ``start_gap`` (pairs,), where regression finds the edges of both sides.

    ``rows.aside`` is what the gradients of both sides add to the jump on the way to the node; 0 unless ``to_node``.

    ``rows.apart`` tells whether the matter of a side that is nearest to the interface was not bonded at the start, by
    the histories ``kept`` (rows, N) of the particles.
    """
    d = len(axes)
    jump, aside, mass, sums, apart = rows.jump, rows.aside, rows.mass, rows.sums, rows.apart
    reach = REACH * max_of(axes, around.cell)
    for k in prange(count):
        if not sides.law[fields.law[k]]:
            continue
        slot, i = fields.slot[k], nodes.node[fields.slot[k]]
        alpha, beta = field_at(nodes, fields.alpha[k]), field_at(nodes, fields.partner[k])
        # the interface lies beside the node: there sides that turn apart have another jump
        beside = 0.5 * (geometry.distances[k, 0] + geometry.distances[k, 1])
        knows_place = abs(beside) < UNKNOWN
        if not knows_place:
            beside = 0.0
        bonded, density = find_jump(
            axes, way, slot, i, alpha, beta, fields.rigid[k], around, near, matter, beside, knows_place,
            geometry.normal[k], sides, kept, reach, sums[k], to_node, jump[k], aside[k],
        )  # fmt: skip
        apart[k] = not bonded
        mass[k] = 0.5 * perpendicular_size(axes, around.cell, geometry.normal[k]) * density
        first = start_gap[sides.pair[alpha, beta]] if way == EDGES else UNKNOWN
        if abs(geometry.separation[k]) < UNKNOWN and abs(first) < UNKNOWN:
            along = 0.0
            for a in range(d):
                along += jump[k, a] * geometry.normal[k, a]
            opened = geometry.separation[k] - first - along
            for a in range(d):
                jump[k, a] += opened * geometry.normal[k, a]


@inline
def max_of(axes, values):
    """Largest of ``values`` (d,)."""
    most = values[0]
    for a in range(1, len(axes)):
        most = max(most, values[a])
    return most


@inline
def find_jump(
    axes, way, slot, i, alpha, beta, rigid, around, near, matter, beside, knows_place, normal, sides, kept, reach, sums,
    to_node, out, aside,
):  # fmt: skip
    """``find_jumps`` for one contact, ``beside`` it along the normal; returns whether both sides were bonded, and
    ρ_α ρ_β/(ρ_α + ρ_β), ρ_α beside a rigid body.

    Matter is that of the particle nearest to the interface; where this is not known (``knows_place``), along the
    surface only. ``sums`` is scratch.
    """
    d = len(axes)
    bonded_alpha, bonded_beta, other_alpha, other_beta = math.inf, math.inf, math.inf, math.inf
    # unfolded: mean reference positions of α and of β relative to the node, mean F⁻¹ n of both, and the mean F
    at_alpha, at_beta, F = sums[:d], sums[d : 2 * d], sums[4 * d :]
    along_alpha, along_beta = sums[2 * d : 3 * d], sums[3 * d : 4 * d]
    for j in range(4 * d + d * d):
        sums[j] = 0.0
    m_alpha, m_beta, m_both, v_alpha, v_beta = 0.0, 0.0, 0.0, 0.0, 0.0
    at = near.head[slot]
    while at >= 0:
        p, turned = near.particle[at], near.flag[at]
        field = matter.field[p]
        if field in (alpha, beta):
            is_beta = field == beta
            of_rigid = is_beta and rigid
            w = near.S[at] * (matter.vol0[p] if of_rigid else matter.mass[p])
            mine = at_beta if is_beta else at_alpha
            image = (turned >> IMAGE_BITS) - 1
            stride = 1
            for a in range(d):
                x, moved = matter.X[a, p], matter.X[a, p] - matter.X0[a, p]
                if turned >> a & 1:
                    x = 2.0 * (around.origin[a] + around.planes[image, a] * around.cell[a]) - x
                    moved = -moved
                node = around.origin[a] + (i // stride % around.shape[a]) * around.cell[a]
                out[a] = node + beside * normal[a] - x
                mine[a] -= w * (moved if way == EXTRAPOLATED else moved + out[a])
                stride *= around.shape[a]
            square, deep = 0.0, 0.0
            for a in range(d):
                square += out[a] * out[a]
                deep += out[a] * normal[a]
            distance = math.sqrt(square if knows_place else max(square - deep * deep, 0.0))
            was_bonded = kept[row_of_history(sides, field, alpha, beta) + BREAKS, p] > UNSET
            if is_beta:
                if was_bonded:
                    bonded_beta = min(bonded_beta, distance)
                else:
                    other_beta = min(other_beta, distance)
            elif was_bonded:
                bonded_alpha = min(bonded_alpha, distance)
            else:
                other_alpha = min(other_alpha, distance)
            if way != EXTRAPOLATED:
                add_inverse_times(axes, matter.F, p, w, turned, out, mine)
                if to_node and beside != 0.0:
                    along = along_beta if is_beta else along_alpha
                    add_inverse_times(axes, matter.F, p, w, turned, normal, along)
                if of_rigid or not rigid:  # beside a rigid body the jump is in its frame
                    m_both += w
                    for a in range(d):
                        for b in range(d):
                            F[d * a + b] += w * turn(turn(matter.F[d * a + b, p], turned, a), turned, b)
            if is_beta:
                m_beta += w
                v_beta += near.S[at] * matter.vol0[p]
            else:
                m_alpha += w
                v_alpha += near.S[at] * matter.vol0[p]
        at = near.next[at]
    for a in range(d):
        sees_both = m_alpha > 0.0 and m_beta > 0.0
        at_alpha[a] = at_alpha[a] / m_alpha - at_beta[a] / m_beta if sees_both else 0.0
        along_alpha[a] = beside * (along_beta[a] / m_beta - along_alpha[a] / m_alpha) if sees_both else 0.0
    for a in range(d):
        out[a], aside[a] = at_alpha[a], 0.0
        if way != EXTRAPOLATED:
            out[a] = 0.0
            for b in range(d):
                out[a] += F[d * a + b] * at_alpha[b] / m_both if m_both > 0.0 else 0.0
                aside[a] += F[d * a + b] * along_alpha[b] / m_both if m_both > 0.0 else 0.0
    density = 0.0
    if m_alpha > 0.0 and m_beta > 0.0:
        density = m_alpha / v_alpha if rigid else 1.0 / (v_alpha / m_alpha + v_beta / m_beta)
    return bonded_alpha <= other_alpha + reach and bonded_beta <= other_beta + reach, density


@inline
def share_of_node(a, b, h):
    """Share of an interface that is this node's, of all nodes across it; ``a``, ``b`` are the distances of its edges.

    That is the smaller of the linear grid functions at both edges, over the sum of these at all nodes: where the edge
    of one side hardly reaches the node, the traction is as small as the forces of the stresses there.
    """
    if a * b < 0.0:
        return 1.0
    return max(1.0 - max(abs(a), abs(b)) / h, SMALLEST) / max(1.0 - abs(a - b) / h, 0.5)


@kernel
def open_areas(axes, sides, count, fields, nodes, around, geometry, rows):
    """Let areas neither shrink where interfaces open, since the gap has no volume, nor grow where they are pressed.

    A = (Ω_α + Ω_β) w/(h⊥ − δ_n N), with w of ``share_of_node`` and N = 1 − d/h⊥ the linear grid function of the middle
    of the gap. Where a method does not know the edges, w keeps the share of the area by volumes, and N is 1. Nodes
    beyond the axis of a ring have none: what is there is the image of what counts already.
    """
    area = geometry.area
    for k in prange(count):
        if not sides.law[fields.law[k]]:
            continue
        column = nodes.node[fields.slot[k]] % around.shape[0]
        if around.ring and around.origin[0] + column * around.cell[0] < -0.5 * around.cell[0]:
            area[k] = 0.0
            continue
        opening = 0.0
        for a in range(len(axes)):
            opening += rows.jump[k, a] * geometry.normal[k, a]
        h = perpendicular_size(axes, around.cell, geometry.normal[k])
        first, second = geometry.distances[k, 0], geometry.distances[k, 1]
        share, middle = 1.0, 1.0
        if max(abs(first), abs(second)) < UNKNOWN:
            counted = max(1.0 - min(abs(first), abs(second)) / h, SMALLEST)  # as in ``contact_area``
            share = share_of_node(first, second, h) / counted
            middle = max(1.0 - 0.5 * abs(first + second) / h, 0.0)
        area[k] *= share * h / max(h - opening * middle, 0.5 * h)


@inline
def row_of_history(sides, field, alpha, beta):
    """First row of the history that a particle of ``field`` keeps of the interface of two fields, −1 if none."""
    if field == alpha:
        return sides.row[alpha, beta]
    return sides.row[beta, alpha] if field == beta else -1


@kernel
def recall_histories(sides, count, fields, nodes, near, field, F, vol0, kept, rows):
    """History of every interface from the particles near it, ``kept`` (rows, N), into ``rows.history``.

    It is that of the particles whose nearest node this is, or else of all that the node sees: the mean by their
    shares S V. Particles that no interface has reached count for nothing; broken is an
    interface of whose matter more than half is, or of matter that was not bonded (``rows.apart``).
    """
    history = rows.history
    for k in prange(count):
        if not sides.law[fields.law[k]]:
            continue
        alpha, beta = field_at(nodes, fields.alpha[k]), field_at(nodes, fields.partner[k])
        for j in range(history.shape[1]):
            history[k, j] = 0.0
        for nearest in range(2):
            share = 0.0
            at = near.head[fields.slot[k]]
            while at >= 0:
                p = near.particle[at]
                row = row_of_history(sides, field[p], alpha, beta)
                if row >= 0 and kept[row, p] > UNSET and (nearest == 1 or near.flag[at] & NEAREST):
                    w = near.S[at] * determinant_of_particle(F, p) * vol0[p]
                    share += w
                    for j in range(history.shape[1]):
                        history[k, j] += w * max(kept[row + j, p], 0.0)
                at = near.next[at]
            if share > 0.0:
                for j in range(history.shape[1]):
                    history[k, j] /= share
                break
        history[k, BREAKS] = 1.0 if rows.apart[k] or history[k, BREAKS] > 0.5 else 0.0


@kernel
def keep_histories(sides, count, fields, nodes, near, field, kept, rows):
    """Give the particles nearest to every interface its openings of the step; what broke stays broken."""
    history, now = rows.history, rows.now
    for k in prange(count):
        if not sides.law[fields.law[k]] or rows.apart[k]:
            continue
        alpha, beta = field_at(nodes, fields.alpha[k]), field_at(nodes, fields.partner[k])
        at = near.head[fields.slot[k]]
        while at >= 0:
            p = near.particle[at]
            row = row_of_history(sides, field[p], alpha, beta)
            if row >= 0 and near.flag[at] & NEAREST:
                is_new = kept[row, p] <= UNSET
                for j in range(2):
                    kept[row + j, p] = max(history[k, j] if is_new else kept[row + j, p], now[k, j])
                if history[k, BREAKS] > 0.5:
                    kept[row + BREAKS, p] = 1.0
            at = near.next[at]
