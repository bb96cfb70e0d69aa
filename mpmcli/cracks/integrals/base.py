"""Matter around a tip in the frame of the tip, and the weights of integrals over it (Nairn 2026, chapter 3)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.analysis import Analysis, Axisymmetric

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


class Matter(NamedTuple):
    """Particles around a tip, in its frame; n of them.

    x : (2, n) position from the tip [length]
    r : (n,) distance from the tip [length]
    volume : (n,) current volume per thickness, or per radian [area] or [volume]
    slope : (2, n) u_1,1 and u_2,1 [-]
    stress : (3, n) Cauchy stress 11, 22, 12 [pressure]
    energy : (n,) work of the stress per current volume [pressure]
    mass : (n,) mass per thickness or per radian
    velocity, acceleration, rate : (2, n) v, a and v_j,1; None unless inertia counts
    ring : terms of the hoop direction; None in the plane
    """

    x: Array
    r: Array
    volume: Array
    slope: Array
    stress: Array
    energy: Array
    mass: Array
    velocity: Array | None = None
    acceleration: Array | None = None
    rate: Array | None = None
    ring: Ring | None = None


class Ring(NamedTuple):
    """What the hoop direction of axisymmetric matter adds.

    stress, strain : (n,) Cauchy stress and u_r/r [pressure], [-]
    radius : (n,) distance from the axis [length]
    tip : radius of the tip [length]
    outward, across : component of e₁ along the radius and along the axis
    """

    stress: Array
    strain: Array
    radius: Array
    tip: float
    outward: float
    across: float


class Weight(NamedTuple):
    """Weight q of a domain: 1 near the tip, 0 from the outer radius on.

    q : (n,) values
    slope : (2, n) q,_1 and q,_2 [1/length]
    """

    q: Array
    slope: Array


def matter_near(
    particles: Any,
    analysis: Analysis,
    frame: Frame,
    radius: float,
    thickness: float = 1.0,
    *,
    acceleration: Array | None = None,
    rigid: tuple[int, ...] = (),
    elastic: bool = False,
) -> tuple[Matter, Array]:
    """Return the matter within ``radius`` of a tip, and the places (n,) of its particles in memory.

    The displacement gradient is ∇u = I − R̄ F⁻¹, where R̄ is the mean rotation of that matter, so that a body that
    turns as a whole has none.

    Parameters
    ----------
    particles : ``core.particles.Particles``
    frame, radius, thickness : of the tip, of the domain, across the plane [length]
    acceleration : (2, N) of all particles; None leaves inertia out
    rigid : indices of bodies that do not count
    elastic : take the energy as ½σ:ε instead of the accumulated work of the stress
    """
    p = particles
    dx, dy = p.X[0] - frame.point[0], p.X[1] - frame.point[1]
    near = np.flatnonzero(dx * dx + dy * dy < radius * radius)
    if rigid:
        near = near[~np.isin(p.body[near], rigid)]
    x = frame.turn(np.stack([dx[near], dy[near]]))
    F = p.F[:, near]
    vol0 = p.vol0[near] / thickness
    axisymmetric = isinstance(analysis, Axisymmetric)
    area_ratio = F[0] * F[3] - F[1] * F[2]
    J = area_ratio * F[4]
    gradient = _displacement_gradient(F, area_ratio, vol0, axisymmetric)
    u = turn_tensor(frame, gradient)
    sxx, syy, szz, sxy = p.tau[:, near] / J
    stress = turn_tensor(frame, np.stack([sxx, sxy, sxy, syy]))[[0, 3, 1]]
    hoop = 1.0 - 1.0 / F[4]
    if elastic:
        energy = 0.5 * (stress[0] * u[0] + stress[1] * u[3] + stress[2] * (u[1] + u[2]) + szz * hoop)
    else:
        energy = p.stress_work[near] / (thickness * vol0 * J)
    found = Matter(x, np.hypot(*x), vol0 * J, u[[0, 2]], stress, energy, p.mass[near] / thickness)
    if axisymmetric:
        ring = Ring(szz, hoop, p.X[0, near], float(frame.point[0]), *map(float, frame.ahead))
        found = found._replace(ring=ring)
    if acceleration is not None:
        found = found._replace(
            velocity=frame.turn(p.V[:, near]),
            acceleration=frame.turn(acceleration[:, near]),
            rate=turn_tensor(frame, p.L[:4, near])[[0, 2]],
        )
    return found, near


def _displacement_gradient(F: Array, area_ratio: Array, weight: Array, axisymmetric: bool) -> Array:
    """Components xx, xy, yx, yy of I − R̄ F⁻¹, (4, n); bodies of revolution do not turn."""
    c, s = 1.0, 0.0
    if not axisymmetric and F.size:
        along, across = weight @ (F[0] + F[3]), weight @ (F[2] - F[1])
        size = np.hypot(along, across)
        c, s = along / size, across / size
    ixx, ixy, iyx, iyy = F[3] / area_ratio, -F[1] / area_ratio, -F[2] / area_ratio, F[0] / area_ratio
    return np.stack(
        [1.0 - (c * ixx - s * iyx), s * iyy - c * ixy, -(s * ixx + c * iyx), 1.0 - (s * ixy + c * iyy)]
    )


def turn_tensor(frame: Frame, tensor: Array) -> Array:
    """Components 11, 12, 21, 22 in the frame of tensors (4, n) with xx, xy, yx, yy."""
    c, s = frame.ahead
    xx, xy, yx, yy = tensor
    cc, cs, ss = c * c, c * s, s * s
    return np.stack(
        [
            cc * xx + cs * (xy + yx) + ss * yy,
            cc * xy + cs * (yy - xx) - ss * yx,
            cc * yx + cs * (yy - xx) - ss * xy,
            ss * xx - cs * (xy + yx) + cc * yy,
        ]
    )


def weigh(x: Array, r: Array, inner: float, outer: float) -> Weight:
    """Return the weight at points (2, n) at distances ``r`` (n,) from the tip.

    It falls from ``inner`` to ``outer`` by 1 − t²(3 − 2t). A straight fall has kinks that particles integrate badly:
    J of a Williams field on four particles per cell then scatters by 2.0 % between two and six cells, with this weight
    by 0.3 %.
    """
    t = np.clip((r - inner) / (outer - inner), 0.0, 1.0)
    fall = 6.0 * t * (1.0 - t) / (outer - inner)
    return Weight(1.0 - t * t * (3.0 - 2.0 * t), -fall / np.maximum(r, 1e-300) * x)
