"""Energy release rate by an integral over the particles around a tip."""

from __future__ import annotations

import numpy as np

from mpmcli.cracks.integrals.base import Matter, Weight, weigh
from mpmcli.cracks.integrals.faces import Faces

Array = np.ndarray


def energy_release_rate(matter: Matter, inner: float, outer: float, faces: Faces | None = None) -> float:
    """Return J₁ of a tip [energy/area].

    J₁ = Σ V (σ_ij u_j,1 − W δ_1i) q,_i + Σ M (a_j u_j,1 − v_j v_j,1) q − ∫ (T_j ⟦u_j,1⟧ + ⟦W⟧ n₁) q ds

    with q = 1 up to ``inner`` and 0 from ``outer`` on. The second sum, and the kinetic energy in W, count where the
    matter has accelerations. The last term counts faces of this and of other cracks; it vanishes on free faces along
    e₁. Around an axis Σ V (σ_θθ u_r/r − W) q/r e₁·e_r comes on top, all over the radius of the tip.
    """
    m = matter
    q = weigh(m.x, m.r, inner, outer)
    J = integral_over(m, q)
    if faces is not None:
        jump = faces.slope[0] - faces.slope[1]
        work = (faces.traction * jump).sum(axis=0)
        work += (faces.energy[0] - faces.energy[1]) * faces.normal[0]
        J -= float(work @ (faces.area * weight_of_faces(faces, inner, outer)))
    return J if m.ring is None else J / m.ring.tip


def weight_of_faces(faces: Faces, inner: float, outer: float) -> Array:
    """Weight of the pieces (k,)."""
    return weigh(faces.x, (faces.x**2).sum(axis=0) ** 0.5, inner, outer).q


def integral_over(matter: Matter, weight: Weight) -> float:
    """Return the sums over particles."""
    m, (q, (q1, q2)) = matter, weight
    (s11, s22, s12), (u11, u21) = m.stress, m.slope
    W = m.energy
    if m.velocity is not None:
        W = W + 0.5 * m.mass / m.volume * (m.velocity**2).sum(axis=0)
    density = (s11 * u11 + s12 * u21 - W) * q1 + (s12 * u11 + s22 * u21) * q2
    if m.ring is not None:
        density += (m.ring.stress * m.ring.strain - W) * q / m.ring.radius * m.ring.outward
    J = m.volume @ density
    if m.velocity is not None and m.acceleration is not None and m.rate is not None:
        J += m.mass @ (((m.acceleration * m.slope).sum(axis=0) - (m.velocity * m.rate).sum(axis=0)) * q)
    return float(J)
