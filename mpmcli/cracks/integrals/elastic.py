"""Isotropic elastic constants of the plane, and the field of a tip in it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too

Array = np.ndarray


class PlaneElasticity(NamedTuple):
    """Elastic constants at small strain.

    shear : shear modulus G [pressure]
    kappa : Kolosov's constant, 3 − 4ν in plane strain, (3 − ν)/(1 + ν) in plane stress [-]
    """

    shear: float
    kappa: float

    @property
    def modulus(self) -> float:
        """E′ = 8G/(κ + 1): E/(1 − ν²) in plane strain, E in plane stress [pressure]."""
        return 8.0 * self.shear / (self.kappa + 1.0)


def has_plane_elasticity(model: Any) -> bool:
    """Whether a material is isotropic and elastic, so that stress intensity factors describe its tips."""
    return {"isotropic", "hyperelastic"} <= model.properties and hasattr(model, "shear_modulus")


def plane_elasticity(model: Any, plane_stress: bool) -> PlaneElasticity:
    """Return the constants of a material for which ``has_plane_elasticity`` holds."""
    G, K = model.shear_modulus, model.bulk_modulus
    nu = (3.0 * K - 2.0 * G) / (2.0 * (3.0 * K + G))
    return PlaneElasticity(G, (3.0 - nu) / (1.0 + nu) if plane_stress else 3.0 - 4.0 * nu)


def rayleigh_speed(elasticity: PlaneElasticity, density: float) -> float:
    """Return the speed of surface waves in the plane, which no crack that opens exceeds (Freund 1990) [velocity].

    c_R = c_s √x with the root of x³ − 8x² + 8(3 − 2r)x − 16(1 − r) between 0 and 1, r = (c_s/c_p)² = (κ − 1)/(κ + 1).
    """
    r = (elasticity.kappa - 1.0) / (elasticity.kappa + 1.0)
    low, high = 0.0, 1.0
    for _ in range(50):
        x = 0.5 * (low + high)
        below = ((x - 8.0) * x + 8.0 * (3.0 - 2.0 * r)) * x < 16.0 * (1.0 - r)
        low, high = (x, high) if below else (low, x)
    return math.sqrt(high * elasticity.shear / density)


class TipField(NamedTuple):
    """Stress and displacement gradients of a tip.

    stress : (3, n) 11, 22, 12 [pressure]
    slope : (2, n) u_1,1 and u_2,1 [-]
    """

    stress: Array
    slope: Array


def tip_field(
    x: Array, K_I: float, K_II: float, elasticity: PlaneElasticity, angle: Array | None = None
) -> TipField:
    """Return the field of a tip (Williams 1957) at ``x`` (2, n) in its frame.

    ``angle`` (n,) is that from e₁, by default between −π and π; beyond them lies what a crack that is not straight
    leaves on the other side.
    """
    at = np.arctan2(x[1], x[0])
    half = 0.5 * np.exp(-0.5j * (at if angle is None else angle)) / np.sqrt(2.0 * np.pi * np.hypot(*x))
    one, two = (np.stack(field_of_mode(half, np.exp(2j * at), mode, elasticity.kappa)) for mode in (1, 2))
    field = K_I * one + K_II * two
    return TipField(field[:3], field[3:] / (2.0 * elasticity.shear))


@compiled_too
def field_of_mode(half: Any, twice: Any, mode: Any, kappa: Any) -> Any:
    """Return stresses 11, 22, 12 and 2G times u_1,1 and u_2,1 of a tip with K = 1 in mode 1 or 2.

    ``half`` is exp(−iθ/2)/(2√(2πr)), ``twice`` is exp(2iθ) of the place; one point or many.
    """
    phi = half if mode == 1 else -1j * half
    psi = 0.5 * phi if mode == 1 else -1.5 * phi  # derivatives of the potentials of Kolosov
    deviator = 2.0 * psi - phi * twice.conjugate()
    slope = kappa * phi - (phi + psi).conjugate() + 0.5 * phi.conjugate() * twice
    total = 4.0 * phi.real
    s11, s22 = 0.5 * (total - deviator.real), 0.5 * (total + deviator.real)
    return s11, s22, 0.5 * deviator.imag, slope.real, slope.imag


def strain_of(stress: Array, elasticity: PlaneElasticity) -> Array:
    """Strain 11, 22, 12 in the plane of a stress (3, n)."""
    mean = 0.25 * (3.0 - elasticity.kappa) * (stress[0] + stress[1])
    return np.stack([stress[0] - mean, stress[1] - mean, stress[2]]) / (2.0 * elasticity.shear)


def mixed(stress: Array, strain: Array) -> Array:
    """σ:ε of components 11, 22, 12, each (3, n)."""
    return np.asarray(stress[0] * strain[0] + stress[1] * strain[1] + 2.0 * stress[2] * strain[2])
