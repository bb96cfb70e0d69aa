"""Cracks near a tip, in the frame of the tip: which faces count, on which side matter is."""

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import called_once
from mpmcli.cracks.chain import START

Array = np.ndarray

STRAIGHT = 0.02
"""Segments that turn from e₁ by less, in radians, are straight."""
BENT = 0.02
"""Cells by which a crack may leave the line behind its tip and still be straight."""


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
    def left(self) -> float:
        """1 if the face above is the one on the left of e₁, −1 if it is that on the right."""
        return 1.0 if self.end != START else -1.0


@compiled_too
def asks(plane: Any, jump: Any, always: Any, passes: Any, outer: Any, cell: Any) -> Any:
    """Whether faces of a crack within ``outer`` of the tip may count: bent and closed ones, or all, ``always``."""
    for k in range(plane.shape[1] - 1):
        x, y, wx, wy, _ = piece(plane, k)
        if math.sqrt(x * x + y * y) >= outer:
            continue
        opening, slip = opening_of(jump, k, wx, wy)
        is_closed = not passes and opening < 0.1 * abs(slip) + 0.01 * cell
        if always or is_closed or abs(wy) > STRAIGHT:
            return True
    return False


@compiled_too
def bends(plane: Any, outer: Any, cell: Any) -> Any:
    """Whether a crack leaves the line behind its tip by so much that particles lie between, within ``outer``.

    Points beside those within count, too.
    """
    last = plane.shape[1] - 1
    for k in range(last + 1):
        if abs(plane[1, k]) <= BENT * cell:
            continue
        for other in range(max(k - 1, 0), min(k + 1, last) + 1):
            x, y = plane[0, other], plane[1, other]
            if math.sqrt(x * x + y * y) < outer:
                return True
    return False


@compiled_too
def piece(plane: Any, k: Any) -> Any:
    """Middle, unit vector and length of segment ``k``."""
    wx, wy = plane[0, k + 1] - plane[0, k], plane[1, k + 1] - plane[1, k]
    length = math.sqrt(wx * wx + wy * wy)
    x, y = 0.5 * (plane[0, k + 1] + plane[0, k]), 0.5 * (plane[1, k + 1] + plane[1, k])
    return x, y, wx / length, wy / length, length


@compiled_too
def opening_of(jump: Any, k: Any, wx: Any, wy: Any) -> Any:
    """Opening and slip of segment ``k`` along (wx, wy) [length]."""
    jx, jy = 0.5 * (jump[0, k + 1] + jump[0, k]), 0.5 * (jump[1, k + 1] + jump[1, k])
    return wx * jy - wy * jx, wx * jx + wy * jy


@called_once
def see_crack(X, faces, x, y, c, s, span, always, passes, far, outer, cell, plane, jump):
    """Turn the points of a chain within ``span`` of a tip at (x, y), with their neighbours, into the frame of the tip.

    (c, s) is e₁; ``plane`` and ``jump`` (2, P) receive them first. Returns the first point and how many there are, and
    whether faces ``ask`` to be found, and the crack ``bends``.
    """
    count = X.shape[1]
    first, last = count, -1
    for k in range(count):
        if max(abs(X[0, k] - x), abs(X[1, k] - y)) < span:
            first, last = min(first, k), k
    first, last = (max(first - 1, 0), min(last + 1, count - 1)) if last >= 0 else (0, 1)
    for k in range(first, last + 1):
        dx, dy = X[0, k] - x, X[1, k] - y
        jx, jy = faces[0, 0, k] - faces[1, 0, k], faces[0, 1, k] - faces[1, 1, k]
        plane[0, k - first], plane[1, k - first] = c * dx + s * dy, c * dy - s * dx
        jump[0, k - first], jump[1, k - first] = c * jx + s * jy, c * jy - s * jx
    n = last - first + 1
    seen = plane[:, :n]
    return first, n, asks(seen, jump[:, :n], always, passes, far, cell), bends(seen, outer, cell)


@compiled_too
def side_at(plane: Any, x: Any, y: Any) -> Any:
    """On which side of a chain (2, P) a point lies, 1 above and −1 below; and whether it lies beyond an end."""
    last, least, farthest, side, beyond = plane.shape[1] - 2, 1e300, -1.0, 0.0, False
    for k in range(last + 1):
        wx, wy = plane[0, k + 1] - plane[0, k], plane[1, k + 1] - plane[1, k]
        dx, dy = x - plane[0, k], y - plane[1, k]
        square = wx * wx + wy * wy
        along = (dx * wx + dy * wy) / square
        part = min(max(along, 0.0), 1.0)
        rx, ry = dx - part * wx, dy - part * wy
        away = rx * rx + ry * ry
        # of two segments that are as near, at a kink, the one whose line is farther tells the side
        tie = 1e-12 * (square + away)
        if away > least + tie:
            continue
        across = (wx * dy - wy * dx) / math.sqrt(square)
        if away < least - tie or abs(across) > farthest:
            farthest, side = abs(across), 1.0 if across >= 0.0 else -1.0
            beyond = (k == 0 and along < 0.0) or (k == last and along > 1.0)
        least = min(least, away)
    return side, beyond


@compiled_too
def angle_beside(x: Any, y: Any, is_left: Any) -> Any:
    """Angle from e₁ of a point behind a tip: on the left of the crack between 0 and 2π, else below [rad]."""
    angle = math.atan2(y, x)
    if abs(angle) <= 0.5 * math.pi:
        return angle
    if is_left and angle < 0.0:
        return angle + 2.0 * math.pi
    return angle - 2.0 * math.pi if not is_left and angle > 0.0 else angle


@called_once
def find_angles(plane, left, x, angles):
    """Angles (n,) from e₁ of points (2, n) on both sides of the tip's own crack; ``left`` as ``Crack.left``."""
    for i in range(x.shape[1]):
        angles[i] = angle_beside(x[0, i], x[1, i], side_at(plane, x[0, i], x[1, i])[0] * left > 0.0)
