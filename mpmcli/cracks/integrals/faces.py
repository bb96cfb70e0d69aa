"""Pieces of crack faces inside a domain, which integrals over the matter around them must count."""

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import called_once
from mpmcli.cracks.integrals.base import NO_VECTORS, Matter
from mpmcli.cracks.integrals.seen import Crack, angle_beside, opening_of, piece, side_at

Array = np.ndarray

NEAREST = 2.0
"""Cells from the tip within which tractions are those of the rest of the ring."""
REACH = 1.5
"""Cells from which particles tell of a face."""
NOTHING = np.zeros(0)


class Faces(NamedTuple):
    """Straight pieces of faces in the frame of a tip, k of them; sides are 0, to which the normal points, and 1.

    x : (2, k) where the piece counts, from the tip: where 1/√r has its mean [length]
    normal : (2, k) unit normals from side 1 to side 0
    area : (k,) length, or length times radius [length], [area]
    traction : (2, k) on the matter of side 0; that on side 1 is opposite [pressure]
    slope : (2, 2, k) u_j,1 by side
    stress : (2, 3, k) Cauchy stress 11, 22, 12 by side [pressure]
    energy : (2, k) energy per volume by side, kinetic energy included where inertia counts [pressure]
    angle : (2, k) from e₁ by side; behind the tip, beyond π in size on the other side of e₁ [rad]
    """

    x: Array
    normal: Array
    area: Array
    traction: Array
    slope: Array
    stress: Array
    energy: Array
    angle: Array


NO_FACES = Faces(
    NO_VECTORS,
    NO_VECTORS,
    NOTHING,
    NO_VECTORS,
    np.zeros((2, 2, 0)),
    np.zeros((2, 3, 0)),
    NO_VECTORS,
    NO_VECTORS,
)


ROWS = 21
"""Numbers of a piece of a face, in the order of ``Faces``."""
AREA, TRACTION, SLOPE, STRESS, ENERGY, ANGLE = 4, 5, 7, 11, 17, 19
"""Places of numbers of pieces, after their places and their normals."""
FIELDS = 6
"""What matter tells of faces: stress 11, 22, 12, u_1,1, u_2,1 and energy."""
UNKNOWN = -1.0


def faces_near(
    cracks: list[Crack], own: Crack, matter: Matter, outer: float, cell: float, modulus: float | None
) -> Faces:
    """Return the faces of cracks within ``outer`` of a tip, with what the matter beside them tells; see ``find_faces``.

    ``own`` is the crack of the tip, ``modulus`` the E′ of its material, if it is known.
    """
    fields = np.concatenate([matter.stress, matter.slope, matter.whole_energy[None]])
    most = sum(crack.plane.shape[1] for crack in cracks)
    places = np.empty(most, dtype=np.int64)
    sums, found, out = np.empty((most, 2, 3, 3 + FIELDS)), np.empty((most, 2, FIELDS)), np.empty((ROWS, most))
    ring, count = matter.ring, 0
    for crack in cracks:
        count += find_faces(
            crack.plane, crack.jump, crack.holds, crack.passes, UNKNOWN if crack.grip is None else crack.grip,
            NOTHING if crack.pressure is None else crack.pressure, NO_VECTORS if crack.given is None else crack.given,
            crack.end is not None, own.plane, own.left, matter.x, fields, matter.is_ring,
            (ring.tip, ring.outward, ring.across), outer, cell, UNKNOWN if modulus is None else modulus,
            places, sums, found, count, out,
        )  # fmt: skip
    k, out = count, out[:, :count].copy()
    return Faces(
        x=out[:2], normal=out[2:AREA], area=out[AREA], traction=out[TRACTION:SLOPE],
        slope=out[SLOPE:STRESS].reshape(2, 2, k), stress=out[STRESS:ENERGY].reshape(2, 3, k),
        energy=out[ENERGY:ANGLE], angle=out[ANGLE:],
    )  # fmt: skip


@called_once
def find_faces(
    plane, jump, holds, passes, grip, pressure, given, is_own, own, left, x, fields, is_ring, radius, outer, cell,
    modulus, places, sums, found, begin, out,
):  # fmt: skip
    """Write the pieces of a crack within ``outer`` of a tip into ``out`` (ROWS, …) from ``begin`` on; returns how many.

    Stress, slope and energy at a face are those that the particles within 1.5 cells on its side lead to, by least
    squares with linear functions. Faces in contact, and those whose law holds, transmit the mean of both stresses.
    Faces are in contact where that mean presses and they are not open: their opening is below a tenth of their slip,
    and of the strain of a cell under that pressure. The others carry what is given.

    ``own`` is the plane of the tip's crack, ``left`` its ``Crack.left``; ``x`` (2, n) are particles with the values
    ``fields`` (FIELDS, n); ``grip`` and ``modulus`` are below 0 where they are not known, ``pressure`` and ``given``
    empty. ``radius`` is that of the tip, with the components of e₁ along it and across. ``places``, ``sums`` and
    ``found`` are scratch.
    """
    n = 0
    for k in range(plane.shape[1] - 1):
        mx, my, _, _, _ = piece(plane, k)
        if math.sqrt(mx * mx + my * my) < outer:
            places[n] = k
            n += 1
    fit_at_faces(plane, places, n, x, fields, REACH * cell, sums, found)
    far, pressed, rubbed = 0, 0.0, 0.0
    for r in range(n):
        k, at = places[r], begin + r
        mx, my, wx, wy, length = piece(plane, k)
        nx, ny = -wy, wx
        above, below = found[r, 0], found[r, 1]
        across = -0.5 * ((above[0] + below[0]) * nx + (above[2] + below[2]) * ny)
        along = -0.5 * ((above[2] + below[2]) * nx + (above[1] + below[1]) * ny)
        pressing, shear = across * nx + along * ny, across * ny - along * nx
        allowed = 1e-3 * cell if modulus < 0.0 else max(pressing, 0.0) * cell / modulus
        opening, slip = opening_of(jump, k, wx, wy)
        closed = pressing > 0.0 and opening <= 0.1 * (abs(slip) + allowed) and not passes
        # what the points of the chain tell of the jump is better than what particles tell, but along the chain only
        jx, jy = above[3] - below[3], above[4] - below[4]
        if abs(nx) < 0.5:
            jx, jy = wx * (jump[0, k + 1] - jump[0, k]) / length, wx * (jump[1, k + 1] - jump[1, k]) / length
        if closed and not holds:
            inward = jx * nx + jy * ny
            jx, jy = jx - inward * nx, jy - inward * ny
            if math.sqrt(mx * mx + my * my) >= NEAREST * cell:
                far, pressed, rubbed = far + 1, pressed + pressing, rubbed + shear
        out[2, at], out[3, at] = nx, ny
        out[TRACTION, at], out[TRACTION + 1, at] = pressing, shear  # for now
        for side in range(2):
            sign, here = (0.5, above) if side == 0 else (-0.5, below)
            out[SLOPE + 2 * side, at] = 0.5 * (above[3] + below[3]) + sign * jx
            out[SLOPE + 2 * side + 1, at] = 0.5 * (above[4] + below[4]) + sign * jy
            for a in range(3):
                out[STRESS + 3 * side + a, at] = here[a]
            out[ENERGY + side, at] = here[5]
        out[AREA, at] = 1.0 if closed else 0.0  # for now
    for r in range(n):
        k, at = places[r], begin + r
        mx, my, wx, wy, length = piece(plane, k)
        pressing, shear, closed = out[TRACTION, at], out[TRACTION + 1, at], out[AREA, at] > 0.0
        if closed and is_own and not holds and far > 0 and math.sqrt(mx * mx + my * my) < NEAREST * cell:
            # particles ahead disturb the tractions nearest to the tip
            pressing, shear = pressed / far, rubbed / far
        if grip >= 0.0:
            shear = min(max(shear, -grip * abs(pressing)), grip * abs(pressing))
        if not (closed or holds):
            pressing, shear = pressure[k] if pressure.shape[0] > 0 else 0.0, 0.0
        tx, ty = -pressing * wy + shear * wx, pressing * wx + shear * wy
        if given.shape[1] > 0 and not (closed or holds):
            tx, ty = tx + given[0, k], ty + given[1, k]
        out[TRACTION, at], out[TRACTION + 1, at] = tx, ty
        if is_own:
            roots = 0.0
            for end in range(k, k + 2):
                roots += math.sqrt(math.sqrt(plane[0, end] * plane[0, end] + plane[1, end] * plane[1, end]))
            scale = 0.25 * roots * roots / math.sqrt(mx * mx + my * my)
            mx, my = scale * mx, scale * my
            out[ANGLE, at], out[ANGLE + 1, at] = (
                angle_beside(mx, my, left > 0.0),
                angle_beside(mx, my, left < 0.0),
            )
        else:
            is_left = side_at(own, mx, my)[0] * left > 0.0
            out[ANGLE, at] = out[ANGLE + 1, at] = angle_beside(mx, my, is_left)
        out[0, at], out[1, at] = mx, my
        out[AREA, at] = length * (radius[0] + radius[1] * mx - radius[2] * my) if is_ring else length
    return n


@compiled_too
def fit_at_faces(plane, places, count, x, fields, reach, sums, found):
    """Values of fields (FIELDS, n) in the middle of segments, above the chain and below, into ``found`` (…, 2, FIELDS).

    ``places`` are the segments, ``x`` (2, n) the places at which fields are known. Weighted linear least squares over
    those within reach, but for those beyond an end of the chain; 0 without any. ``sums`` is scratch.
    """
    low_x, low_y, high_x, high_y = 1e300, 1e300, -1e300, -1e300
    for r in range(count):
        mx, my, _, _, _ = piece(plane, places[r])
        low_x, high_x = min(low_x, mx - reach), max(high_x, mx + reach)
        low_y, high_y = min(low_y, my - reach), max(high_y, my + reach)
        sums[r, :, :, :] = 0.0
    for i in range(x.shape[1]):
        if not (low_x < x[0, i] < high_x and low_y < x[1, i] < high_y):
            continue
        side, beyond, is_known = 0.0, False, False
        for r in range(count):
            mx, my, _, _, _ = piece(plane, places[r])
            dx, dy = (x[0, i] - mx) / reach, (x[1, i] - my) / reach
            if dx * dx + dy * dy >= 1.0:
                continue
            if not is_known:
                side, beyond = side_at(plane, x[0, i], x[1, i])
                is_known = True
            if not beyond:
                add_to_fit(sums[r, 0 if side > 0.0 else 1], dx, dy, fields, i)
    for r in range(count):
        for side in range(2):
            for f in range(fields.shape[0]):
                found[r, side, f] = fitted(sums[r, side], f)


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
