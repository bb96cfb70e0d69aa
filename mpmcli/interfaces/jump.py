"""The jump of displacement between the two sides of a contact."""

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.area import SMALLEST, perpendicular_size
from mpmcli.contact.fields_in_contact import field_at
from mpmcli.contact.geometry import index_at_home
from mpmcli.contact.laws.impulse import dot
from mpmcli.contact.near_particles import IMAGE_BITS, NEAREST
from mpmcli.contact.separation.base import UNKNOWN
from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.interfaces.areas import open_area
from mpmcli.interfaces.base import BREAKS, HISTORY
from mpmcli.interfaces.memory import UNSET, add_histories, add_history

Array = np.ndarray

FAR = 1e300
"""Beyond the square of every distance; compiled code knows no infinity."""
HIGHEST_AT_INTERFACE = 4
"""Highest order of FMPM at which stiff springs are stable with the jump at the interface, without that at the node."""
REACH = 0.2
"""By so many cells matter that was bonded may be farther from an interface than matter that was not."""


def act_at_node(plan: Any) -> bool:
    """Whether stiff springs act at the node in a step of this plan."""
    return bool(plan.has_full_mass_loop and plan.order > HIGHEST_AT_INTERFACE)


class JumpRows(NamedTuple):
    """What the impulses of interfaces need to know of the contacts of a step, a row for each.

    jump : (k, d) δ(0) = u_β − u_α at the start of the step [length]
    aside : (k, d) by how much the jump at the node exceeds that at the interface beside it [length]
    mass : (k,) m_red over the area where an interface lies on a node: half a cell of both sides [mass/area]
    force : (k, d) m_red (f_β/m_β − f_α/m_α) without the interface [force]
    history : (k, 3) largest openings so far, and whether it is broken; what is no interface counts as broken
    """

    jump: Array
    aside: Array
    mass: Array
    force: Array
    history: Array


class EndRows(NamedTuple):
    """What becomes of the contacts of a step that are interfaces, a row for each.

    end : (k, d) δ(Δt) at the end of the step [length]
    now : (k, 2) openings at the end of the step [length]
    pair : (k,) number of its pair of fields
    apart : (k,) whether matter of either side was not bonded at the start of the run
    scratch : (k, 4 d + d d)
    """

    end: Array
    now: Array
    pair: Array
    apart: Array
    scratch: Array


def allocate_jumps(room: int, d: int) -> JumpRows:
    """Rows of zeros for ``room`` contacts in ``d`` dimensions."""
    vectors = {name: np.zeros((room, d)) for name in ("jump", "aside", "force")}
    return JumpRows(**vectors, mass=np.zeros(room), history=np.zeros((room, HISTORY)))


def allocate_ends(room: int, d: int) -> EndRows:
    """Rows of zeros for ``room`` contacts in ``d`` dimensions."""
    return EndRows(
        end=np.zeros((room, d)), now=np.zeros((room, 2)), pair=np.zeros(room, dtype=np.int64),
        apart=np.zeros(room, dtype=bool), scratch=np.zeros((room, 4 * d + d * d)),
    )  # fmt: skip


class Sides(NamedTuple):
    """Which pairs of fields have an interface, and where particles keep its history.

    law, keeps : (laws,) whether a law is one of interfaces, and whether particles keep openings for it
    row : (fields, fields) row of the pair's history on particles of the first field that tells whether it is broken,
        −1 where it has none; openings have the rows before it
    pair : (fields, fields) number of each pair of fields
    """

    law: Array
    keeps: Array
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
def find_interfaces(
    axes, way, opens, sides, count, fields, nodes, around, near, matter, kept, start_gap, geometry, to_node, rows, ends
):  # fmt: skip
    """Jump δ(0), area and history of every contact whose law is one of interfaces.

    With ``GRADIENT`` the jump is the difference of the reference positions of the matter that is at the interface now,
    beside the node along the normal; each particle tells its own by its deformation gradient, and the mean gradient of
    both sides pushes the difference forward: exact for affine motions of both. With ``EXTRAPOLATED`` it is the
    difference of mean displacements (Nairn 2023, Eq. 2.4); with ``EDGES`` the part along the normal is the separation
    less that of the start, ``start_gap`` (pairs,), where regression finds the edges of both sides.

    ``rows.aside`` is what the gradients of both sides add to the jump on the way to the node; 0 unless ``to_node``.

    ``ends.apart`` tells whether the matter of a side that is nearest to the interface was not bonded at the start, by
    the histories ``kept`` (rows, N) of the particles. ``opens``: areas follow the opening (``open_area``).

    One call for all of it: to hand so many arrays over takes longer than the work on a few nodes.
    """
    # unfolded: numba drops what a parallel loop writes through a tuple
    jump, aside, mass, history = rows.jump, rows.aside, rows.mass, rows.history
    pair, apart, scratch = ends.pair, ends.apart, ends.scratch
    area = geometry.area
    reach = REACH * max_of(axes, around.cell)
    for k in prange(count):
        if not sides.law[fields.law[k]]:
            history[k, BREAKS] = 1.0
            continue
        slot = fields.slot[k]
        alpha, beta = field_at(nodes, fields.alpha[k]), field_at(nodes, fields.partner[k])
        normal, rigid = geometry.normal[k], fields.rigid[k]
        h = perpendicular_size(axes, around.cell, normal)
        # the interface lies beside the node: there sides that turn apart have another jump
        beside = 0.5 * (geometry.distances[k, 0] + geometry.distances[k, 1])
        bonded, density = find_jump(
            axes, way, slot, nodes.node[slot], alpha, beta, rigid, around, near, matter, beside, h, normal, sides.row,
            sides.keeps[fields.law[k]], kept, reach, scratch[k], to_node, jump[k], aside[k], history[k],
        )  # fmt: skip
        apart[k] = not bonded
        pair[k] = sides.pair[alpha, beta]
        mass[k] = 0.5 * h * density
        first = start_gap[pair[k]] if way == EDGES else UNKNOWN
        if abs(geometry.separation[k]) < UNKNOWN and abs(first) < UNKNOWN:
            opened = geometry.separation[k] - first - dot(axes, jump[k], normal)
            for a in range(len(axes)):
                jump[k, a] += opened * normal[a]
        if opens:
            area[k] = open_area(
                axes, nodes.node[slot], around, area[k], geometry.distances[k], jump[k], normal, h
            )
        history[k, BREAKS] = 1.0 if apart[k] or history[k, BREAKS] > 0.5 else 0.0


@inline
def max_of(axes, values):
    """Largest of ``values`` (d,)."""
    most = values[0]
    for a in range(1, len(axes)):
        most = max(most, values[a])
    return most


@inline
def find_jump(
    axes, way, slot, i, alpha, beta, rigid, around, near, matter, beside, h, normal, row, keeps, kept, reach, sums,
    to_node, out, aside, history,
):  # fmt: skip
    """Find the jump of one contact, ``beside`` the node along the normal, and its ``history`` (3,); returns whether
    both sides were bonded, and ρ_α ρ_β/(ρ_α + ρ_β), ρ_α beside a rigid body.

    Matter is that of the particle nearest to the interface; where this is not known (``UNKNOWN``), along the surface
    only. ``sums`` is scratch.

    Particles count by their shares S m of the node, and by the linear grid function of their distance from the
    interface. Without the latter, a node of which one side has hardly any mass would compare matter at the interface
    with matter a cell beside it: where strain is not uniform, its jump would be another one than those of the nodes
    next to it, and stiff springs cannot close both.
    """
    d = len(axes)
    knows_place = abs(beside) < UNKNOWN
    if not knows_place:
        beside = 0.0
    stride = 1
    for a in range(d):  # into ``aside``, for the time being: the point of the interface
        aside[a] = (
            around.origin[a] + index_at_home(around, i, stride, a) * around.cell[a] + beside * normal[a]
        )
        stride *= around.shape[a]
    # squares of distances
    bonded_alpha, bonded_beta, other_alpha, other_beta = FAR, FAR, FAR, FAR
    # unfolded: mean reference positions of α and of β relative to the node, mean F⁻¹ n of both, and the mean F
    at_alpha, at_beta, F = sums[:d], sums[d : 2 * d], sums[4 * d :]
    along_alpha, along_beta = sums[2 * d : 3 * d], sums[3 * d : 4 * d]
    for j in range(4 * d + d * d):
        sums[j] = 0.0
    m_alpha, m_beta, m_both, v_alpha, v_beta, remembered = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    row_alpha, row_beta = row[alpha, beta], row[beta, alpha]
    for j in range(HISTORY):
        history[j] = 0.0
    at = near.head[slot]
    while at >= 0:
        p, turned = near.particle[at], near.flag[at]
        field = matter.field[p]
        if field in (alpha, beta):
            is_beta = field == beta
            of_rigid = is_beta and rigid
            mine = at_beta if is_beta else at_alpha
            image = (turned >> IMAGE_BITS) - 1
            square, deep = 0.0, 0.0
            for a in range(d):
                x = matter.X[a, p]
                if turned >> a & 1:
                    x = 2.0 * (around.origin[a] + around.planes[image, a] * around.cell[a]) - x
                elif image >= 0:
                    x += around.shift[image, a] * around.cell[a]
                out[a] = aside[a] - x
                square += out[a] * out[a]
                deep += out[a] * normal[a]
            share = near.S[at]
            if knows_place and way != EXTRAPOLATED:
                share *= max(1.0 - abs(deep) / h, SMALLEST)
            w = share * (matter.vol0[p] if of_rigid else matter.mass[p])
            for a in range(d):
                moved = turn(matter.X[a, p] - matter.X0[a, p], turned, a)
                mine[a] -= w * (moved if way == EXTRAPOLATED else moved + out[a])
            distance = square if knows_place else max(square - deep * deep, 0.0)
            mine_kept = row_beta if is_beta else row_alpha
            was_bonded = kept[mine_kept, p] > UNSET
            if turned & NEAREST:
                remembered += add_history(kept, mine_kept, keeps, p, near.S[at], matter, history)
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
                v_beta += share * matter.vol0[p]
            else:
                m_alpha += w
                v_alpha += share * matter.vol0[p]
        at = near.next[at]
    if remembered == 0.0:
        remembered = add_histories(kept, row, keeps, slot, alpha, beta, near, matter, history)
    for j in range(HISTORY):
        history[j] /= remembered if remembered > 0.0 else 1.0
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
    bonded = (
        math.sqrt(bonded_alpha) <= math.sqrt(other_alpha) + reach
        and math.sqrt(bonded_beta) <= math.sqrt(other_beta) + reach
    )
    return bonded, density
