"""Stress intensity factors: by interaction with the field of a tip, or by the opening behind it."""

import math

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import called_once
from mpmcli.cracks.integrals.base import Matter, weight_at
from mpmcli.cracks.integrals.domain import sum_over_domain
from mpmcli.cracks.integrals.elastic import PlaneElasticity, field_of_mode
from mpmcli.cracks.integrals.faces import NO_FACES, NOTHING, Faces

Array = np.ndarray


def modes_by_interaction(
    matter: Matter,
    inner: float,
    outer: float,
    elasticity: PlaneElasticity,
    angle: Array | None = None,
    faces: Faces = NO_FACES,
) -> tuple[float, float]:
    """Return K_I and K_II of a tip [pressure·√length] by K = ½E′ M.

    M = Σ V (σ_ij uᵃ_j,1 + σᵃ_ij u_j,1 − σ_jk uᵃ_j,k δ_1i) q,_i + Σ M a_j uᵃ_j,1 q − faces, where ᵃ marks the plane
    field of a tip with one of the factors 1 and the other 0 (Yau, Wang and Corten 1980).
    """
    found = np.zeros(2)
    angles = NOTHING if angle is None else angle
    sum_modes(matter, inner, outer, elasticity.shear, elasticity.kappa, angles, faces, found)
    K_I, K_II = 0.5 * elasticity.modulus / matter.ring.tip * found
    return float(K_I), float(K_II)


def domain_and_modes(
    matter: Matter,
    inner: float,
    outer: float,
    elasticity: PlaneElasticity,
    angle: Array | None = None,
    faces: Faces = NO_FACES,
) -> tuple[float, float, float]:
    """Return what ``energy_release_rate`` and ``modes_by_interaction`` do, by one call of compiled code."""
    found, angles = np.zeros(2), NOTHING if angle is None else angle
    J = sum_both(matter, inner, outer, elasticity.shear, elasticity.kappa, angles, faces, found)
    K_I, K_II = 0.5 * elasticity.modulus / matter.ring.tip * found
    return float(J / matter.ring.tip), float(K_I), float(K_II)


@called_once
def sum_both(m, inner, outer, shear, kappa, angles, faces, out):
    """``sum_modes``; returns ``sum_over_domain``."""
    sum_modes(m, inner, outer, shear, kappa, angles, faces, out)
    return sum_over_domain(m, inner, outer, faces)


@called_once
def sum_modes(m, inner, outer, shear, kappa, angles, faces, out):
    """Write the sums over particles and faces of M into ``out`` (2,), mode by mode.

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
        half = half_turn(m.x[0, k] / r, m.x[1, k] / r)
        if angles.shape[0] > 0:
            half = complex(math.cos(0.5 * angles[k]), -math.sin(0.5 * angles[k]))
        half *= 0.5 / math.sqrt(2.0 * math.pi * r)
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
    for k in range(faces.area.shape[0]):
        q, _ = weight_at(
            math.sqrt(faces.x[0, k] * faces.x[0, k] + faces.x[1, k] * faces.x[1, k]), inner, outer
        )
        for mode in range(2):
            out[mode] -= faces.area[k] * q * lost_at_face(faces, k, mode, shear, kappa)


@compiled_too
def half_turn(c, s):
    """exp(−iθ/2) for the angle θ between −π and π whose cosine and sine are given."""
    if c >= 0.0:
        cosine = math.sqrt(0.5 * (1.0 + c))
        return complex(cosine, -0.5 * s / cosine)
    sine = math.copysign(math.sqrt(0.5 * (1.0 - c)), s)
    return complex(0.5 * s / sine, -sine)


@compiled_too
def lost_at_face(faces, k, mode, shear, kappa):
    """What piece ``k`` of the faces takes from M of a mode, per area."""
    x, y, n1, n2 = faces.x[0, k], faces.x[1, k], faces.normal[0, k], faces.normal[1, k]
    r, mean, lost = math.sqrt(x * x + y * y), 0.25 * (3.0 - kappa), 0.0
    ahead, scale = complex(x, y) / r, 0.5 / math.sqrt(2.0 * math.pi * r)
    for side in range(2):
        angle, sign = 0.5 * faces.angle[side, k], 1.0 if side == 0 else -1.0
        half = complex(math.cos(angle), -math.sin(angle)) * scale
        a11, a22, a12, b11, b21 = field_of_mode(half, ahead * ahead, mode + 1, kappa)
        lost += sign * (faces.traction[0, k] * b11 + faces.traction[1, k] * b21) / (2.0 * shear)
        s11, s22, s12 = faces.stress[side, 0, k], faces.stress[side, 1, k], faces.stress[side, 2, k]
        u11, u21, a33 = faces.slope[side, 0, k], faces.slope[side, 1, k], mean * (a11 + a22)
        w = (s11 * (a11 - a33) + s22 * (a22 - a33) + 2.0 * s12 * a12) / (2.0 * shear)
        lost += sign * (w * n1 - (n1 * a11 + n2 * a12) * u11 - (n1 * a12 + n2 * a22) * u21)
    return lost


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
