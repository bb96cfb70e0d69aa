"""Stress intensity factors: by interaction with the field of a tip, or by the opening behind it."""

from __future__ import annotations

import math

import numpy as np

from mpmcli.core.compiled.kernel import inline
from mpmcli.cracks.integrals.base import Matter, weight_at
from mpmcli.cracks.integrals.domain import weight_of_faces
from mpmcli.cracks.integrals.elastic import (
    PlaneElasticity,
    TipField,
    field_of_mode,
    mixed,
    strain_of,
    tip_field,
)
from mpmcli.cracks.integrals.faces import Faces

Array = np.ndarray


def modes_by_interaction(
    matter: Matter,
    inner: float,
    outer: float,
    elasticity: PlaneElasticity,
    angle: Array | None = None,
    faces: Faces | None = None,
) -> tuple[float, float]:
    """Return K_I and K_II of a tip [pressure·√length] by K = ½E′ M.

    M = Σ V (σ_ij uᵃ_j,1 + σᵃ_ij u_j,1 − σ_jk uᵃ_j,k δ_1i) q,_i + Σ M a_j uᵃ_j,1 q − faces, where ᵃ marks the plane
    field of a tip with one of the factors 1 and the other 0 (Yau, Wang and Corten 1980).
    """
    found = np.zeros(2)
    angles = np.zeros(0) if angle is None else angle
    sum_modes(matter, inner, outer, elasticity.shear, elasticity.kappa, angles, found)
    if faces is not None:
        weight = faces.area * weight_of_faces(faces, inner, outer)
        for mode, factors in enumerate(((1.0, 0.0), (0.0, 1.0))):
            sides = [tip_field(faces.x, *factors, elasticity, side) for side in faces.angle]
            found[mode] -= _over_faces(faces, sides, elasticity) @ weight
    K_I, K_II = 0.5 * elasticity.modulus / matter.ring.tip * found
    return float(K_I), float(K_II)


@inline
def sum_modes(m, inner, outer, shear, kappa, angles, out):
    """Write the sums over particles of M into ``out`` (2,), mode by mode.

    ``angles`` (n,) are those from e₁; those of places if it is of length 0.
    """
    moves, is_ring = m.velocity.shape[1] > 0, m.ring.radius.shape[0] > 0
    mean, soft = 0.25 * (3.0 - kappa), 0.5 / shear
    out[0] = out[1] = 0.0
    for k in range(m.r.shape[0]):
        q, fall = weight_at(m.r[k], inner, outer)
        if q == 0.0 or (fall == 0.0 and not (moves or is_ring)):
            continue
        r = max(m.r[k], 1e-300)
        q1, q2 = -fall / r * m.x[0, k], -fall / r * m.x[1, k]
        angle = angles[k] if angles.shape[0] > 0 else math.atan2(m.x[1, k], m.x[0, k])
        half = complex(math.cos(0.5 * angle), -math.sin(0.5 * angle)) * (0.5 / math.sqrt(2.0 * math.pi * r))
        ahead = complex(m.x[0, k], m.x[1, k]) / r
        s11, s22, s12 = m.stress[0, k], m.stress[1, k], m.stress[2, k]
        u11, u21 = m.slope[0, k], m.slope[1, k]
        for mode in range(2):
            a11, a22, a12, b11, b21 = field_of_mode(half, ahead * ahead, mode + 1, kappa)
            b11, b21 = soft * b11, soft * b21
            a33 = mean * (a11 + a22)
            w = soft * (s11 * (a11 - a33) + s22 * (a22 - a33) + 2.0 * s12 * a12)
            density = (s11 * b11 + s12 * b21 + a11 * u11 + a12 * u21 - w) * q1
            density += (s12 * b11 + s22 * b21 + a12 * u11 + a22 * u21) * q2
            if is_ring:
                # the plane field is neither in equilibrium around an axis nor without hoop strain
                c, s = m.ring.outward, -m.ring.across
                lack = m.ring.stress[k] * (c * b11 + s * b21) - c * w
                lack += (c * a11 + s * a12) * u11 + (c * a12 + s * a22) * u21
                lack -= a33 * (c * u11 + s * u21 - c * m.ring.strain[k])
                density += q / m.ring.radius[k] * lack
            out[mode] += m.volume[k] * density
            if moves:
                out[mode] += m.mass[k] * q * (m.acceleration[0, k] * b11 + m.acceleration[1, k] * b21)


def _over_faces(faces: Faces, sides: list[TipField], elasticity: PlaneElasticity) -> Array:
    n1, n2 = faces.normal
    lost = (faces.traction * (sides[0].slope - sides[1].slope)).sum(axis=0)
    for sign, field, stress, (u11, u21) in zip((1.0, -1.0), sides, faces.stress, faces.slope, strict=True):
        (a11, a22, a12), strain = field.stress, strain_of(field.stress, elasticity)
        own = (n1 * a11 + n2 * a12) * u11 + (n1 * a12 + n2 * a22) * u21
        lost += sign * (mixed(stress, strain) * n1 - own)
    return np.asarray(lost)


def modes_by_opening(
    J: float, normal: float, tangential: float, elasticity: PlaneElasticity
) -> tuple[float, float]:
    """Return K_I and K_II [pressure·√length] of an energy release rate, shared as the opening behind the tip is.

    ``normal`` and ``tangential`` are the opening and the slip of the faces, of the left one relative to the right one
    looking along e₁ (Nairn 2003, Eq. 20); faces that overlap are closed.
    """
    normal = max(normal, 0.0)
    size = math.hypot(normal, tangential)
    if size == 0.0 or J <= 0.0:
        return 0.0, 0.0
    K = math.sqrt(J * elasticity.modulus)
    return K * normal / size, K * tangential / size
