"""Pieces of crack faces inside a domain, which integrals over the matter around them must count."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import inline
from mpmcli.cracks.chain import START
from mpmcli.cracks.integrals.base import Matter

Array = np.ndarray

STRAIGHT = 0.02
"""Segments that turn from e₁ by less, in radians, are straight."""
BENT = 0.02
"""Cells by which a crack may leave the line behind its tip and still be straight."""
NEAREST = 2.0
"""Cells from the tip within which tractions are those of the rest of the ring."""
REACH = 1.5
"""Cells from which particles tell of a face."""


class Faces(NamedTuple):
    """Straight pieces of faces in the frame of a tip, k of them; sides are 0, to which the normal points, and 1.

    x : (2, k) where the piece counts, from the tip: where 1/√r has its mean [length]
    normal : (2, k) unit normals from side 1 to side 0
    area : (k,) length, or length times radius [length], [area]
    traction : (2, k) on the matter of side 0; that on side 1 is opposite [pressure]
    slope : (2, 2, k) u_j,1 by side
    stress : (2, 3, k) Cauchy stress 11, 22, 12 by side [pressure]
    energy : (2, k) energy per volume by side, kinetic energy included where inertia counts [pressure]
    angle : (2, k) of ``elastic.tip_field`` by side
    """

    x: Array
    normal: Array
    area: Array
    traction: Array
    slope: Array
    stress: Array
    energy: Array
    angle: Array


class Crack(NamedTuple):
    """A crack in the frame of a tip, as integrals see it.

    plane : (2, P) its points from start to end, from the tip [length]
    jump : (2, P) displacement of the face above relative to that below [length]
    holds : whether its law transmits tension, so that faces that part have tractions, too
    passes : whether its faces pass each other freely
    grip : largest traction along the crack over that across it, where it is known
    pressure : (P − 1,) pressure in the crack on its faces, by segment; None without [pressure]
    given : (2, P − 1) other tractions on the face above, by segment; None without [pressure]
    end : ``START`` or ``END``, of which the tip is one; None for another crack
    """

    plane: Array
    jump: Array
    holds: bool
    passes: bool
    grip: float | None
    pressure: Array | None
    given: Array | None
    end: int | None

    @property
    def way(self) -> Array:
        """Unit vectors (2, P − 1) along the segments, from start to end."""
        step = np.diff(self.plane, axis=1)
        return np.asarray(step / np.hypot(*step))

    @property
    def left(self) -> float:
        """1 if the face above is the one on the left of e₁, −1 if it is that on the right."""
        return 1.0 if self.end != START else -1.0


def must_be_found(crack: Crack, outer: float, cell: float) -> bool:
    """Whether faces of a crack within ``outer`` of the tip may count: bent ones, closed ones, those of other cracks."""
    plane, way = crack.plane, crack.way
    middle = 0.5 * (plane[:, 1:] + plane[:, :-1])
    near = np.hypot(*middle) < outer
    if crack.end is None or crack.holds or crack.pressure is not None or crack.given is not None:
        return bool(near.any())
    opening, slip = _opening(crack)
    closed = (opening < 0.1 * np.abs(slip) + 0.01 * cell) & (not crack.passes)
    return bool((near & (closed | (np.abs(way[1]) > STRAIGHT))).any())


def _opening(crack: Crack) -> tuple[Array, Array]:
    """Opening and slip of the segments (P − 1,) [length]."""
    jump, way = 0.5 * (crack.jump[:, 1:] + crack.jump[:, :-1]), crack.way
    return way[0] * jump[1] - way[1] * jump[0], (way * jump).sum(axis=0)


def side_of(crack: Crack, x: Array) -> tuple[Array, Array]:
    """Tell on which side of a crack points (2, n) lie, 1 above and −1 below; and whether they lie beyond an end."""
    side, beyond = np.empty(x.shape[1]), np.empty(x.shape[1], dtype=np.bool_)
    find_sides(crack.plane, x, side, beyond)
    return side, beyond


@inline
def find_sides(plane, x, side, beyond):
    """Write ``side_of`` for points ``x`` (2, n) and a chain (2, P); both are (n,)."""
    last = plane.shape[1] - 2
    for i in range(x.shape[1]):
        least, farthest = 1e300, -1.0
        for k in range(last + 1):
            wx, wy = plane[0, k + 1] - plane[0, k], plane[1, k + 1] - plane[1, k]
            dx, dy = x[0, i] - plane[0, k], x[1, i] - plane[1, k]
            square = wx * wx + wy * wy
            along = (dx * wx + dy * wy) / square
            part = min(max(along, 0.0), 1.0)
            rx, ry = dx - part * wx, dy - part * wy
            away = rx * rx + ry * ry
            across = (wx * dy - wy * dx) / math.sqrt(square)
            # of two segments that are as near, at a kink, the one whose line is farther tells the side
            tie = 1e-12 * (square + away)
            if away < least - tie or (away <= least + tie and abs(across) > farthest):
                farthest, side[i] = abs(across), 1.0 if across >= 0.0 else -1.0
                beyond[i] = (k == 0 and along < 0.0) or (k == last and along > 1.0)
            least = min(least, away)


def angles_beside(crack: Crack, x: Array, side: Array) -> Array:
    """Angles from e₁ of points behind a tip, (n,): those on the left of the crack between 0 and 2π [rad]."""
    angle, left = np.arctan2(x[1], x[0]), side * crack.left > 0.0
    behind = np.abs(angle) > 0.5 * np.pi
    angle = np.where(behind & left & (angle < 0.0), angle + 2.0 * np.pi, angle)
    return np.where(behind & ~left & (angle > 0.0), angle - 2.0 * np.pi, angle)


def bends(crack: Crack, outer: float, cell: float) -> bool:
    """Whether a crack leaves the line behind its tip by so much that particles lie between."""
    near = np.hypot(*crack.plane) < outer
    near[1:] |= near[:-1].copy()
    near[:-1] |= near[1:].copy()
    return bool(np.any(np.abs(crack.plane[1, near]) > BENT * cell))


def faces_of(
    crack: Crack, own: Crack, matter: Matter, outer: float, cell: float, modulus: float | None
) -> Faces | None:
    """Return the faces of a crack within ``outer`` of a tip, with what the matter beside them tells; None without.

    Stress, slope and energy at a face are those that the particles within 1.5 cells on its side lead to, by least
    squares with linear functions. Faces in contact, and those whose law holds, transmit the mean of both stresses.
    Faces are in contact where that mean presses and they are not open: their opening is below a tenth of their slip,
    and of the strain of a cell under that pressure. The others carry what is given. ``own`` is the crack of
    the tip.
    """
    plane = crack.plane
    middle, step = 0.5 * (plane[:, 1:] + plane[:, :-1]), np.diff(plane, axis=1)
    k = np.flatnonzero(np.hypot(*middle) < outer)
    if not k.size:
        return None
    way, length = crack.way[:, k], np.hypot(*step[:, k])
    normal = np.stack([-way[1], way[0]])
    fields = np.concatenate([matter.stress, matter.slope, matter.whole_energy[None]])
    found = np.empty((2, len(fields), k.size))
    side, beyond = side_of(crack, matter.x)
    side[beyond] = 0.0
    fit_at_faces(
        np.ascontiguousarray(middle[:, k]),
        matter.x,
        side,
        fields,
        REACH * cell,
        np.empty((3, 3 + len(fields))),
        found,
    )
    stress, slope, energies = found[:, :3], found[:, 3:5].copy(), found[:, 5]
    opening, slip = (each[k] for each in _opening(crack))
    pressure, shear = _tractions(stress.mean(axis=0), normal)
    allowed = 1e-3 * cell if modulus is None else np.maximum(pressure, 0.0) * cell / modulus
    closed = (pressure > 0.0) & (opening <= 0.1 * (np.abs(slip) + allowed)) & (not crack.passes)
    # what the points of the chain tell of the jump is better than what particles tell, but along the chain only
    known = way[0] * np.diff(crack.jump, axis=1)[:, k] / length
    jump = np.where(np.abs(normal[0]) < 0.5, known, slope[0] - slope[1])
    if not crack.holds:
        jump = jump - closed * (jump * normal).sum(axis=0) * normal
        if crack.end is not None:
            pressure, shear = _extrapolated(pressure, shear, closed, np.hypot(*middle[:, k]), NEAREST * cell)
    if crack.grip is not None:
        shear = np.clip(shear, -crack.grip * np.abs(pressure), crack.grip * np.abs(pressure))
    touching = closed | crack.holds
    within = 0.0 if crack.pressure is None else crack.pressure[k]
    traction = np.where(touching, pressure, within) * normal + touching * shear * way
    if crack.given is not None:
        traction += np.where(touching, 0.0, crack.given[:, k])
    slope = slope.mean(axis=0) + 0.5 * jump * np.array([1.0, -1.0])[:, None, None]
    x = middle[:, k]
    if crack.end is not None:
        near, far = np.hypot(*plane[:, k]), np.hypot(*plane[:, k + 1])
        x = x * (0.25 * (np.sqrt(near) + np.sqrt(far)) ** 2 / np.hypot(*x))
        angle = np.stack([angles_beside(own, x, np.full(k.size, s)) for s in (1.0, -1.0)])
    else:
        angle = np.stack([angles_beside(own, x, side_of(own, x)[0])] * 2)
    area = length
    if matter.is_ring:
        area = length * (matter.ring.tip + matter.ring.outward * x[0] - matter.ring.across * x[1])
    return Faces(x, normal, area, traction, slope, stress, energies, angle)


def _tractions(stress: Array, normal: Array) -> tuple[Array, Array]:
    """Traction (k,) of a stress (3, k) on the face above: along the normal, and along the crack."""
    (s11, s22, s12), (n1, n2) = stress, normal
    across, along = -(s11 * n1 + s12 * n2), -(s12 * n1 + s22 * n2)
    return across * n1 + along * n2, across * n2 - along * n1


def _extrapolated(
    pressure: Array, shear: Array, closed: Array, r: Array, least: float
) -> tuple[Array, Array]:
    """Take the tractions nearest to the tip, where particles ahead disturb them, as the mean of those farther away."""
    far = closed & (r >= least)
    if not far.any():
        return pressure, shear
    near = closed & (r < least)
    return np.where(near, pressure[far].mean(), pressure), np.where(near, shear[far].mean(), shear)


def together(faces: list[Faces]) -> Faces | None:
    """All faces in one; None without any."""
    if not faces:
        return None
    return Faces(*(np.concatenate(arrays, axis=-1) for arrays in zip(*faces, strict=True)))


@inline
def fit_at_faces(points, x, side, fields, reach, sums, out):
    """Write values of fields (q, n) at points (2, k) on side 1 and on side −1 into ``out`` (2, q, k).

    ``x`` (2, n) are the places at which they are known, ``side`` (n,) where these are. Weighted linear least squares
    over those within reach; 0 without any. ``sums`` (3, 3 + q) is scratch.
    """
    for at in range(2):
        for k in range(points.shape[1]):
            sums[:, :] = 0.0
            for i in range(x.shape[1]):
                dx, dy = (x[0, i] - points[0, k]) / reach, (x[1, i] - points[1, k]) / reach
                if side[i] == 1.0 - 2.0 * at and dx * dx + dy * dy < 1.0:
                    add_to_fit(sums, dx, dy, fields, i)
            for f in range(fields.shape[0]):
                out[at, f, k] = fitted(sums, f)


@compiled_too
def add_to_fit(sums: Any, dx: Any, dy: Any, fields: Any, i: Any) -> None:
    """Add column ``i`` of fields (q, n), known at (dx, dy) within a radius of 1, to the sums (3, 3 + q) of a fit."""
    weight = (1.0 - math.sqrt(dx * dx + dy * dy)) ** 2
    for a in range(3):
        part = weight * (1.0 if a == 0 else (dx if a == 1 else dy))
        sums[a, 0] += part
        sums[a, 1] += part * dx
        sums[a, 2] += part * dy
        for f in range(fields.shape[0]):
            sums[a, 3 + f] += part * fields[f, i]


@compiled_too
def fitted(sums: Any, f: Any) -> Any:
    """Return the value of field ``f`` at the middle; of few places, or places in a line, nearly the mean."""
    s11, s22 = 1e-3 * sums[0, 0] + sums[1, 1], 1e-3 * sums[0, 0] + sums[2, 2]
    c0 = s11 * s22 - sums[1, 2] * sums[2, 1]
    c1 = sums[0, 2] * sums[2, 1] - sums[0, 1] * s22
    c2 = sums[0, 1] * sums[1, 2] - sums[0, 2] * s11
    determinant = c0 * sums[0, 0] + c1 * sums[1, 0] + c2 * sums[2, 0]
    if determinant <= 0.0:
        return 0.0
    return (c0 * sums[0, 3 + f] + c1 * sums[1, 3 + f] + c2 * sums[2, 3 + f]) / determinant
