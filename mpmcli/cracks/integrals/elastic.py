"""Isotropic elastic constants of the plane, and the field of a tip in it."""

import math
from typing import Any, NamedTuple

from mpmcli.core.compiled.compiler import compiled_too


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
