"""Energy release rate by an integral over the particles around a tip."""

import math

import numpy as np

from mpmcli.core.compiled.kernel import called_once
from mpmcli.cracks.integrals.base import Matter, weight_at
from mpmcli.cracks.integrals.faces import NO_FACES, Faces

Array = np.ndarray


def energy_release_rate(matter: Matter, inner: float, outer: float, faces: Faces = NO_FACES) -> float:
    """Return J₁ of a tip [energy/area].

    J₁ = Σ V (σ_ij u_j,1 − W δ_1i) q,_i + Σ M (a_j u_j,1 − v_j v_j,1) q − ∫ (T_j ⟦u_j,1⟧ + ⟦W⟧ n₁) q ds

    with q = 1 up to ``inner`` and 0 from ``outer`` on. The second sum, and the kinetic energy in W, count where the
    matter has accelerations. The last term counts faces of this and of other cracks; it vanishes on free faces along
    e₁. Around an axis Σ V (σ_θθ u_r/r − W) q/r e₁·e_r comes on top, all over the radius of the tip.
    """
    return float(sum_over_domain(matter, inner, outer, faces) / matter.ring.tip)


def face_terms(faces: Faces) -> Array:
    """T_j ⟦u_j,1⟧ + ⟦W⟧ n₁ of the pieces (k,)."""
    work = (faces.traction * (faces.slope[0] - faces.slope[1])).sum(axis=0)
    return np.asarray(work + (faces.energy[0] - faces.energy[1]) * faces.normal[0])


@called_once
def sum_over_domain(m, inner, outer, faces):
    """Return the sums over particles and faces of ``energy_release_rate``."""
    moves, is_ring = m.velocity.shape[1] > 0, m.ring.radius.shape[0] > 0
    J = 0.0
    for k in range(m.r.shape[0]):
        q, fall = weight_at(m.r[k], inner, outer)
        if q == 0.0:
            continue
        part = -fall / max(m.r[k], 1e-300)
        q1, q2 = part * m.x[0, k], part * m.x[1, k]
        s11, s22, s12 = m.stress[0, k], m.stress[1, k], m.stress[2, k]
        u11, u21 = m.slope[0, k], m.slope[1, k]
        W = m.energy[k]
        if moves:
            v1, v2 = m.velocity[0, k], m.velocity[1, k]
            W += 0.5 * m.mass[k] / m.volume[k] * (v1 * v1 + v2 * v2)
            work = m.acceleration[0, k] * u11 + m.acceleration[1, k] * u21
            J += m.mass[k] * q * (work - v1 * m.rate[0, k] - v2 * m.rate[1, k])
        density = (s11 * u11 + s12 * u21 - W) * q1 + (s12 * u11 + s22 * u21) * q2
        if is_ring:
            density += (m.ring.stress[k] * m.ring.strain[k] - W) * q / m.ring.radius[k] * m.ring.outward
        J += m.volume[k] * density
    for k in range(faces.area.shape[0]):
        q, _ = weight_at(
            math.sqrt(faces.x[0, k] * faces.x[0, k] + faces.x[1, k] * faces.x[1, k]), inner, outer
        )
        work = (faces.energy[0, k] - faces.energy[1, k]) * faces.normal[0, k]
        for j in range(2):
            work += faces.traction[j, k] * (faces.slope[0, j, k] - faces.slope[1, j, k])
        J -= faces.area[k] * q * work
    return J
