"""Matter around a tip in the frame of the tip, and the weight of integrals over it (Nairn 2026, chapter 3)."""

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.analysis import Analysis, Axisymmetric
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import called_once

Array = np.ndarray


class Frame(NamedTuple):
    """Where a tip is and where it points.

    point : (2,) the tip [length]
    ahead : (2,) unit vector e₁ out of the crack; e₂ lies to its left
    """

    point: Array
    ahead: Array

    def turn(self, vector: Array) -> Array:
        """Return components along e₁ and e₂ of vectors (2, …)."""
        (c, s), (x, y) = self.ahead, vector
        return np.stack([c * x + s * y, c * y - s * x])


class Ring(NamedTuple):
    """What the hoop direction of axisymmetric matter adds; arrays of length 0 in the plane.

    stress, strain : (n,) Cauchy stress and u_r/r [pressure], [-]
    radius : (n,) distance from the axis [length]
    tip : radius of the tip, 1 in the plane [length]
    outward, across : component of e₁ along the radius and along the axis
    """

    stress: Array
    strain: Array
    radius: Array
    tip: float
    outward: float
    across: float


NO_RING = Ring(np.zeros(0), np.zeros(0), np.zeros(0), 1.0, 0.0, 0.0)
NO_VECTORS = np.zeros((2, 0))


class Matter(NamedTuple):
    """Particles around a tip, in its frame; n of them.

    x : (2, n) position from the tip [length]
    r : (n,) distance from the tip [length]
    volume : (n,) current volume per thickness, or per radian [area] or [volume]
    slope : (2, n) u_1,1 and u_2,1 [-]
    stress : (3, n) Cauchy stress 11, 22, 12 [pressure]
    energy : (n,) work of the stress per current volume [pressure]
    mass : (n,) mass per thickness or per radian
    velocity, acceleration, rate : (2, n) v, a − b with the force per mass b of loads, and v_j,1; v, a and v_j,1 are 0
        where inertia does not count, and all (2, 0) where no such load acts either
    ring : terms of the hoop direction
    """

    x: Array
    r: Array
    volume: Array
    slope: Array
    stress: Array
    energy: Array
    mass: Array
    velocity: Array = NO_VECTORS
    acceleration: Array = NO_VECTORS
    rate: Array = NO_VECTORS
    ring: Ring = NO_RING

    @property
    def moves(self) -> bool:
        """Whether inertia or forces of loads count."""
        return self.velocity.shape[1] > 0

    @property
    def whole_energy(self) -> Array:
        """Energy per current volume (n,), with that of motion where it counts [pressure]."""
        if not self.moves:
            return self.energy
        return np.asarray(self.energy + 0.5 * self.mass / self.volume * (self.velocity**2).sum(axis=0))

    @property
    def is_ring(self) -> bool:
        """Whether it lies around an axis."""
        return self.ring.radius.shape[0] > 0


EVERYWHERE = 1e300
"""Beyond every distance [length]; compiled code knows no infinity."""


class Room:
    """Arrays that matter around tips is written into, used again for each: the matter of the tip before is lost.

    Attributes
    ----------
    near, rows : (n,) places in memory, (14, n) what ``Matter`` holds
    """

    def __init__(self) -> None:
        self.hold(2000)

    def hold(self, particles: int) -> None:
        """Make room for so many particles."""
        self.near, self.rows = np.empty(particles, dtype=np.int64), np.empty((14, particles))


def matter_near(
    particles: Any,
    analysis: Analysis,
    frame: Frame,
    radius: float,
    thickness: float = 1.0,
    *,
    acceleration: Array | None = None,
    inertia: bool = True,
    rigid: tuple[int, ...] = (),
    elastic: bool = False,
    chunks: Array | None = None,
    margin: float = EVERYWHERE,
    room: Room | None = None,
) -> tuple[Matter, Array]:
    """Return the matter within ``radius`` of a tip, and the places (n,) of its particles in memory.

    The displacement gradient is ∇u = I − R̄ F⁻¹, where R̄ is the mean rotation of that matter, so that a body that
    turns as a whole has none; around an axis R̄ = I.

    Parameters
    ----------
    particles : ``core.particles.Particles``
    frame, radius, thickness : of the tip, of the domain, across the plane [length]
    acceleration : (2, N) less the force per mass of loads, of all particles; None where neither counts
    inertia : with ``acceleration``: whether kinetic energy counts
    rigid : indices of bodies that do not count
    elastic : take the energy as ½σ:ε instead of the accumulated work of the stress
    chunks, margin : chunks of lines of particles along x, and by how much those of a chunk may lie outside of where its
        first and its last one are [length]
    room : where the matter is written
    """
    p, is_ring, moves = particles, isinstance(analysis, Axisymmetric), acceleration is not None
    (x, y), (c, s) = frame.point.tolist(), frame.ahead.tolist()
    skipped, room = np.array(rigid, dtype=np.int64), room or Room()
    if chunks is None:
        chunks = np.array([0, p.count], dtype=np.uint64)
    while True:
        n = gather(
            p.X, p.F, p.tau, p.vol0, p.mass, p.stress_work, p.body, skipped, chunks, margin, x, y, c, s, radius,
            thickness, elastic, is_ring, room.near, room.rows,
        )  # fmt: skip
        if n <= len(room.near):
            break
        room.hold(n)
    near, out = room.near[:n], room.rows[:, :n]
    ring, motion = NO_RING, (NO_VECTORS, NO_VECTORS, NO_VECTORS)
    if is_ring:
        ring = Ring(out[11], out[12], out[13], x, c, s)
    if moves:
        motion = np.empty((2, n)), np.empty((2, n)), np.empty((2, n))
        gather_motion(near, p.V, acceleration, p.L, c, s, inertia, *motion)
    return Matter(out[:2], out[2], out[3], out[4:6], out[6:9], out[9], out[10], *motion, ring), near


@compiled_too
def find_near(X, F, vol0, body, skipped, chunks, margin, x, y, radius, near):
    """List the particles within a radius of (x, y), but for those of the bodies ``skipped``.

    Returns how many there are, of which ``near`` receives as many as it holds, and cosine and sine of their mean
    rotation, times a size.
    """
    n, cosine, sine = 0, 0.0, 0.0
    for chunk in range(chunks.shape[0] - 1):
        begin, end = np.int64(chunks[chunk]), np.int64(chunks[chunk + 1])
        if begin == end or X[1, begin] - margin > y + radius or X[1, end - 1] + margin < y - radius:
            continue
        for p in range(begin, end):
            dx, dy = X[0, p] - x, X[1, p] - y
            if dx * dx + dy * dy >= radius * radius:
                continue
            counts = True
            for k in range(skipped.shape[0]):
                counts = counts and body[p] != skipped[k]
            if counts:
                if n < near.shape[0]:
                    near[n] = p
                n += 1
                cosine += vol0[p] * (F[0, p] + F[3, p])
                sine += vol0[p] * (F[2, p] - F[1, p])
    return n, cosine, sine


@called_once
def gather(
    X, F, tau, vol0, mass, work, body, skipped, chunks, margin, x, y, c, s, radius, thickness, elastic, is_ring, near,
    out,
):  # fmt: skip
    """Write what ``Matter`` holds of the particles within a radius of (x, y) into the rows of ``out``.

    Returns how many there are; nothing is written if ``near``, which receives their places, has no room for them.
    (c, s) is e₁.
    """
    n, cosine, sine = find_near(X, F, vol0, body, skipped, chunks, margin, x, y, radius, near)
    if n > near.shape[0]:
        return n
    size = math.sqrt(cosine * cosine + sine * sine)
    c_turn, s_turn = (1.0, 0.0) if is_ring or size == 0.0 else (cosine / size, sine / size)
    for k in range(n):
        p = near[k]
        dx, dy = X[0, p] - x, X[1, p] - y
        out[0, k], out[1, k] = c * dx + s * dy, c * dy - s * dx
        out[2, k] = math.sqrt(dx * dx + dy * dy)
        xx, xy, yx, yy = F[0, p], F[1, p], F[2, p], F[3, p]
        area = xx * yy - xy * yx
        J = area * F[4, p]
        volume = vol0[p] * J / thickness
        gxx = 1.0 - (c_turn * yy + s_turn * yx) / area
        gxy = (c_turn * xy + s_turn * xx) / area
        gyx = (c_turn * yx - s_turn * yy) / area
        gyy = 1.0 - (c_turn * xx - s_turn * xy) / area
        out[3, k] = volume
        out[4, k] = c * c * gxx + c * s * (gxy + gyx) + s * s * gyy
        out[5, k] = c * c * gyx + c * s * (gyy - gxx) - s * s * gxy
        txx, tyy, tzz, txy = tau[0, p] / J, tau[1, p] / J, tau[2, p] / J, tau[3, p] / J
        out[6, k] = c * c * txx + 2.0 * c * s * txy + s * s * tyy
        out[7, k] = s * s * txx - 2.0 * c * s * txy + c * c * tyy
        out[8, k] = c * s * (tyy - txx) + (c * c - s * s) * txy
        hoop = 1.0 - 1.0 / F[4, p]
        if elastic:
            out[9, k] = 0.5 * (txx * gxx + tyy * gyy + txy * (gxy + gyx) + tzz * hoop)
        else:
            out[9, k] = work[p] / (thickness * volume)
        out[10, k] = mass[p] / thickness
        if is_ring:
            out[11, k], out[12, k], out[13, k] = tzz, hoop, X[0, p]
    return n


@called_once
def gather_motion(near, V, A, L, c, s, inertia, velocity, acceleration, rate):
    """Write v, a and v_j,1 of the particles ``near`` (n,) in the frame of e₁ = (c, s), (2, n) each.

    Without inertia v and v_j,1 are 0.
    """
    velocity[:], rate[:] = 0.0, 0.0
    for k in range(near.shape[0]):
        p = near[k]
        acceleration[0, k], acceleration[1, k] = c * A[0, p] + s * A[1, p], c * A[1, p] - s * A[0, p]
        if not inertia:
            continue
        velocity[0, k], velocity[1, k] = c * V[0, p] + s * V[1, p], c * V[1, p] - s * V[0, p]
        xx, xy, yx, yy = L[0, p], L[1, p], L[2, p], L[3, p]
        rate[0, k] = c * c * xx + c * s * (xy + yx) + s * s * yy
        rate[1, k] = c * c * yx + c * s * (yy - xx) - s * s * xy


@compiled_too
def weight_at(r: Any, inner: Any, outer: Any) -> Any:
    """Return the weight q at a distance from the tip, and −dq/dr.

    It falls from ``inner`` to ``outer`` by 1 − t²(3 − 2t). A straight fall has kinks that particles integrate badly:
    J of a Williams field on four particles per cell then scatters by 2.0 % between two and six cells, with this weight
    by 0.3 %.
    """
    t = min(max((r - inner) / (outer - inner), 0.0), 1.0)
    return 1.0 - t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / (outer - inner)
