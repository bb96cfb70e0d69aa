"""Drucker–Prager plasticity: the smooth cone that replaces the pyramid of Mohr and Coulomb."""

from __future__ import annotations

import math
from typing import Any, Literal, NamedTuple

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential_symmetric
from mpmcli.materials.base import MATERIALS, kirchhoff_stress
from mpmcli.materials.friction_angle import (
    FrictionalModel,
    FrictionalPart,
    strength_at,
)
from mpmcli.materials.hencky import (
    STRAIN,
    double_contraction,
    hencky_plastic,
    keep_plastic,
    keep_tensor,
    split_strain,
    trial_strain,
    trial_tensor,
)
from mpmcli.materials.lateral import lateral_stress, shared_by_trials

MATCHES = {"outer": 0, "inner": 1, "plane_strain": 2}
"""Number of each match, as the functions take it."""


@MATERIALS.register
class DruckerPrager(FrictionalModel):
    """Drucker–Prager: √J₂ ≤ B − A τₘ, J₂ = ½ dev τ : dev τ, and the mean stress τₘ at most the tensile strength.

    A and B follow from cohesion and friction. Hencky elasticity, and an exact return to the cone, the cut-off or where
    they meet. Plastic flow follows the angle of dilation; at the cut-off it is associated.
    """

    kind: Literal["drucker_prager"]
    match: Literal["outer", "inner", "plane_strain"]
    """Where it has the strength of Mohr and Coulomb: in triaxial compression, triaxial extension, or plane strain."""

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Moduli, strengths, and the number of the match."""
        return PRAGER[analysis != "3d"](*self.frictional_parameters(analysis), MATCHES[self.match])


PRAGER = hencky_plastic("Prager", (*FrictionalPart._fields, "match"), __name__)
"""The parameter tuples in space (False) and in the plane (True)."""


@inline
def cone_of(match: int, s: float, d: float) -> Any:
    """Slope A of the cone, slope a of its plastic potential, and B/(c cos φ), by the sines of friction and dilation."""
    root = math.sqrt(3.0)
    if match == 0:
        r = 2.0 * root / (3.0 - s)
        return r * s, 2.0 * root * d / (3.0 - d), r
    if match == 1:
        r = 2.0 * root / (3.0 + s)
        return r * s, 2.0 * root * d / (3.0 + d), r
    # without plastic strain along z: τ_zz = τₘ - ⅔a √J₂
    a = d / math.sqrt(1.0 + d * d / 3.0)
    r = 1.0 / (math.sqrt(1.0 - a * a / 3.0) + a * s / 3.0)
    return r * s, a, r


@inline
def return_to_surface(m: Any, alpha: float, trial: float, mean: float) -> Any:
    """√J₂ and mean stress at the plastic strain ``alpha``, from their trial values."""
    c, s, d, limit = strength_at(m, alpha)
    A, a, r = cone_of(m.match, s, d)
    B = r * c * math.sqrt(1.0 - s * s)
    # where the trial state is inside the cone, nothing is taken away
    g = max(0.0, trial + A * mean - B) / (m.shear + m.bulk * A * a)
    shear, normal = max(0.0, trial - m.shear * g), mean - m.bulk * a * g
    if normal > limit:
        normal, shear = limit, min(trial, max(0.0, B - A * limit))
    return shear, normal


for _Prager in PRAGER.values():
    shared_by_trials.register(_Prager)(trial_strain)

    @lateral_stress.register(_Prager)
    def _(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
        xx, yy, zz, xy, _, _ = shared
        zz, yy = zz + 2.0 * x, yy + 2.0 * x if both else yy
        third = (xx + yy + zz) / 3.0
        a, b, c = xx - third, yy - third, zz - third
        trial = m.shear * math.sqrt(0.5 * (a * a + b * b + c * c) + xy * xy)
        shear, normal = return_to_surface(m, H[STRAIN, p], trial, 1.5 * m.bulk * third)
        return normal + m.shear * (shear / trial if shear < trial else 1.0) * c

    @kirchhoff_stress.register(_Prager)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        b = trial_tensor(m, dF, H, p)
        trace, e = split_strain(b)
        K, G = m.bulk, m.shear
        trial, mean = G * math.sqrt(2.0 * double_contraction(e)), K * trace
        shear, normal = return_to_surface(m, H[STRAIN, p], trial, mean)
        scale = shear / trial if shear < trial else 1.0
        if commit:
            strain, work = 0.0, 0.0
            if shear < trial or normal < mean:
                strain = (trial - shear) / (math.sqrt(3.0) * G)
                work = shear * (trial - shear) / G + normal * (mean - normal) / K
                third = normal / (3.0 * K)
                b = exponential_symmetric(
                    (
                        2.0 * (scale * e[0] + third), 2.0 * (scale * e[1] + third), 2.0 * (scale * e[2] + third),
                        2.0 * scale * e[3], 2.0 * scale * e[4], 2.0 * scale * e[5],
                    )
                )  # fmt: skip
            keep_plastic(H, p, strain, work)
            keep_tensor(m, H, p, b)
        g = 2.0 * G * scale
        return normal + g * e[0], normal + g * e[1], normal + g * e[2], g * e[3], g * e[4], g * e[5]
