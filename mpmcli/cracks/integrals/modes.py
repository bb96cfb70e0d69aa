"""Stress intensity factors: by interaction with the field of a tip, or by the opening behind it."""

from __future__ import annotations

import math

import numpy as np

from mpmcli.cracks.integrals.base import Matter, Ring, Weight, weigh
from mpmcli.cracks.integrals.domain import weight_of_faces
from mpmcli.cracks.integrals.elastic import PlaneElasticity, TipField, mixed, strain_of, tip_field
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
    weight = weigh(matter.x, matter.r, inner, outer)
    found = []
    for factors in ((1.0, 0.0), (0.0, 1.0)):
        M = _over_matter(matter, weight, tip_field(matter.x, *factors, elasticity, angle), elasticity)
        if faces is not None:
            sides = [tip_field(faces.x, *factors, elasticity, side) for side in faces.angle]
            M -= _over_faces(faces, sides, elasticity) @ (faces.area * weight_of_faces(faces, inner, outer))
        found.append(0.5 * elasticity.modulus * M / (1.0 if matter.ring is None else matter.ring.tip))
    return float(found[0]), float(found[1])


def _over_matter(m: Matter, weight: Weight, field: TipField, elasticity: PlaneElasticity) -> float:
    q, (q1, q2) = weight
    (s11, s22, s12), (u11, u21) = m.stress, m.slope
    (a11, a22, a12), (b11, b21) = field
    w = mixed(m.stress, strain_of(field.stress, elasticity))
    density = (s11 * b11 + s12 * b21 + a11 * u11 + a12 * u21 - w) * q1
    density += (s12 * b11 + s22 * b21 + a12 * u11 + a22 * u21) * q2
    if m.ring is not None:
        density += q / m.ring.radius * _of_ring(m, m.ring, field, w, elasticity)
    M = m.volume @ density
    if m.acceleration is not None:
        M += m.mass @ ((m.acceleration * field.slope).sum(axis=0) * q)
    return float(M)


def _of_ring(m: Matter, ring: Ring, field: TipField, w: Array, elasticity: PlaneElasticity) -> Array:
    """What the plane field lacks around an axis, where it is neither in equilibrium nor without hoop strain."""
    c, s = ring.outward, -ring.across  # the radial direction in the frame
    (u11, u21), (b11, b21), (a11, a22, a12) = m.slope, field.slope, field.stress
    a33 = 0.25 * (3.0 - elasticity.kappa) * (a11 + a22)
    radial = c * u11 + s * u21
    on_radius = (c * a11 + s * a12) * u11 + (c * a12 + s * a22) * u21
    lack: Array = ring.stress * (c * b11 + s * b21) + on_radius - a33 * (radial - c * ring.strain) - c * w
    return lack


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
