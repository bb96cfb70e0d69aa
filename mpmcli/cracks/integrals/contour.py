"""Energy release rate by an integral along a rectangle of nodes around a tip, for comparison (Nairn 2003, 4)."""

from typing import NamedTuple

import numpy as np

from mpmcli.core.compiled.kernel import called_once
from mpmcli.cracks.integrals.base import Frame, Matter
from mpmcli.cracks.integrals.domain import face_terms
from mpmcli.cracks.integrals.faces import NO_FACES, REACH, Faces, add_to_fit, fitted
from mpmcli.cracks.integrals.seen import Crack

Array = np.ndarray

BESIDE = 1e-6
"""Cells from a crack at which the contour ends on one side, and goes on beyond it."""


class Contour(NamedTuple):
    """A rectangle of nodes.

    frame : of the tip
    lower, upper : (2,) its corners [length]
    cell : (2,) [length]
    """

    frame: Frame
    lower: Array
    upper: Array
    cell: Array

    def holds(self, x: Array) -> Array:
        """Whether points (2, n) in the frame of the tip lie in it."""
        (c, s), (px, py) = self.frame.ahead, self.frame.point
        places = np.stack([px + c * x[0] - s * x[1], py + s * x[0] + c * x[1]])
        inside = (places >= self.lower[:, None]) & (places <= self.upper[:, None])
        return np.asarray(inside.all(axis=0))

    def nodes(self) -> Array:
        """The nodes (2, n + 1) on it in the frame of the tip, anticlockwise; the last is the first."""
        x, y = (
            np.linspace(low, high, 1 + round((high - low) / cell))
            for low, high, cell in zip(self.lower, self.upper, self.cell, strict=True)
        )
        sides = [(x, 0 * x + y[0]), (0 * y + x[-1], y), (x[::-1], 0 * x + y[-1]), (0 * y + x[0], y[::-1])]
        around = np.concatenate([np.stack(side)[:, :-1] for side in sides], axis=1)
        around = np.column_stack([around, around[:, 0]])
        return self.frame.turn(around - self.frame.point[:, None])


def contour_around(frame: Frame, lower: Array, cell: Array, size: int) -> Contour:
    """Return the rectangle of nodes ``size`` cells from the node nearest to a tip; ``lower`` (2,) is a node."""
    node = lower + np.rint((frame.point - lower) / cell) * cell
    return Contour(frame, node - size * cell, node + size * cell, cell)


def energy_release_rate_by_contour(
    matter: Matter, contour: Contour, cracks: list[Crack], faces: Faces = NO_FACES
) -> float:
    """Return J₁ of a tip [energy/area].

    J₁ = ∮ ((W + K) n₁ − σ_ij n_i u_j,1) ds + Σ M (a_j u_j,1 − v_j v_j,1) − ∫ (T_j ⟦u_j,1⟧ + ⟦W⟧ n₁) ds, sums and faces
    within the contour. Fields at its points are those that the particles in sight within 1.5 cells lead to, by least
    squares with linear functions. Where a crack crosses it, it ends on one side and goes on on the other. Around an
    axis all parts count with their radius over that of the tip, and Σ V (σ_θθ u_r/r − W)/r e₁·e_r comes on top.
    """
    points, pieces = _points(contour, cracks)
    fields = np.concatenate([matter.stress, matter.slope, matter.whole_energy[None]])
    found = np.empty((len(fields), points.shape[1]))
    segments = np.concatenate([np.concatenate([c.plane[:, :-1], c.plane[:, 1:]]) for c in cracks], axis=1)
    scratch = np.empty((3, 3 + len(fields)))
    fit_in_sight(points, matter.x, segments, fields, REACH * float(contour.cell.min()), scratch, found)
    s11, s22, s12, u11, u21, W = found
    (first, last), ring = pieces.T, matter.ring
    way = points[:, last] - points[:, first]
    n1, n2 = way[1], -way[0]  # outward, times the length
    radius = 1.0 if not matter.is_ring else ring.tip + ring.outward * points[0] - ring.across * points[1]
    flow = np.stack([W - s11 * u11 - s12 * u21, -(s12 * u11 + s22 * u21)]) * radius
    J = float((0.5 * (flow[:, first] + flow[:, last]) * np.stack([n1, n2])).sum())
    J += _within(matter, contour.holds(matter.x))
    J -= float(face_terms(faces) @ (faces.area * contour.holds(faces.x)))
    return J / ring.tip


def _within(m: Matter, inside: Array) -> float:
    """Sums over the particles inside."""
    total = np.zeros(m.r.size)
    if m.moves:
        work = (m.acceleration * m.slope).sum(axis=0) - (m.velocity * m.rate).sum(axis=0)
        total += m.mass * work
    if m.is_ring:
        total += m.volume * m.ring.outward * (m.ring.stress * m.ring.strain - m.whole_energy) / m.ring.radius
    return float(total[inside].sum())


def _points(contour: Contour, cracks: list[Crack]) -> tuple[Array, Array]:
    """Points (2, k) of the contour, and the pieces (n, 2) between them, which leave out where cracks cross it."""
    nodes = contour.nodes()
    points: list[Array] = []
    pieces: list[tuple[int, int]] = []
    beside = BESIDE * float(contour.cell.min())
    for a, b in zip(nodes.T[:-1], nodes.T[1:], strict=True):
        length = float(np.hypot(*(b - a)))
        stops = [0.0]
        for way in sorted(w for crack in cracks for w in _crossings(a, b, crack.plane)):
            stops += [max(way - beside / length, 0.0), min(way + beside / length, 1.0)]
        stops.append(1.0)
        for start, end in zip(stops[::2], stops[1::2], strict=True):
            pieces.append((len(points), len(points) + 1))
            points += [a + start * (b - a), a + end * (b - a)]
    return np.ascontiguousarray(np.array(points).T), np.array(pieces)


def _crossings(a: Array, b: Array, plane: Array) -> list[float]:
    """Shares of the way from ``a`` to ``b`` (2,) at which a chain (2, P) crosses it."""
    step, side, to = b - a, np.diff(plane, axis=1), plane[:, :-1] - a[:, None]
    area = step[0] * side[1] - step[1] * side[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        way = (to[0] * side[1] - to[1] * side[0]) / area
        along = (to[0] * step[1] - to[1] * step[0]) / area
    hits = (area != 0.0) & (way >= 0.0) & (way <= 1.0) & (along >= 0.0) & (along < 1.0)
    return [float(w) for w in way[hits]]


@called_once
def fit_in_sight(points, x, segments, fields, reach, sums, out):
    """Write values of fields (q, n) at points (2, k) into ``out`` (q, k), by those known at ``x`` (2, n) within reach.

    What lies behind a segment of ``segments`` (4, m), two points each, does not count. ``sums`` (3, 3 + q) is scratch.
    """
    for k in range(points.shape[1]):
        sums[:, :] = 0.0
        px, py = points[0, k], points[1, k]
        for i in range(x.shape[1]):
            dx, dy = x[0, i] - px, x[1, i] - py
            if dx * dx + dy * dy >= reach * reach:
                continue
            seen = True
            for s in range(segments.shape[1]):
                ax, ay = segments[0, s] - px, segments[1, s] - py
                bx, by = segments[2, s] - px, segments[3, s] - py
                if max(min(ax, bx), min(ay, by)) > reach or min(max(ax, bx), max(ay, by)) < -reach:
                    continue
                across = (dx * ay - dy * ax >= 0.0) != (dx * by - dy * bx >= 0.0)
                turn = (bx - ax) * ay - (by - ay) * ax  # where the point lies, and where the particle does
                other = (bx - ax) * (ay - dy) - (by - ay) * (ax - dx)
                if across and (turn >= 0.0) != (other >= 0.0):
                    seen = False
            if seen:
                add_to_fit(sums, dx / reach, dy / reach, fields, i)
        for f in range(fields.shape[0]):
            out[f, k] = fitted(sums, f)
