"""Drucker–Prager plasticity: the smooth cone that replaces the pyramid of Mohr and Coulomb."""

import math
from typing import Any, Literal, NamedTuple

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential, log_symmetric
from mpmcli.materials.base import MATERIALS, kirchhoff_stress
from mpmcli.materials.friction_angle import FrictionalModel, FrictionalPart, strength_at
from mpmcli.materials.hencky import (
    STRAIN,
    double_contraction,
    hencky_plastic,
    keep_plastic,
    keep_tensor,
    split_logarithm,
    split_strain,
    tensor_of_strain,
    trial_tensor,
)
from mpmcli.materials.lateral import (
    add_laterally,
    free_stress,
    lateral_stress,
    search_strain,
    shared_by_trials,
    stretch_tensor,
    widened,
)

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
def surface_at(m: Any, alpha: float) -> Any:
    """B and slope A of the cone, the return of √J₂ and mean stress over the excess, and the tensile strength.

    At the plastic strain ``alpha``.
    """
    c, s, d, limit = strength_at(m, alpha)
    A, a, r = cone_of(m.match, s, d)
    g = 1.0 / (m.shear + m.bulk * A * a)
    return r * c * math.sqrt(1.0 - s * s), A, m.shear * g, m.bulk * a * g, limit


@inline
def return_to_surface(m: Any, surface: Any, trial: float, mean: float, more: float, rise: float) -> Any:
    """√J₂ and mean stress from their trial values, and what they grow by while these grow by ``more`` and ``rise``."""
    B, A, down, back, limit = surface
    shear, normal, grows = trial, mean, more
    # where the trial state is inside the cone, nothing is taken away
    excess = trial + A * mean - B
    if excess > 0.0:
        change = more + A * rise
        shear, grows = trial - down * excess, more - down * change
        normal, rise = mean - back * excess, rise - back * change
        if shear < 0.0:
            shear, grows = 0.0, 0.0
    if normal > limit:
        shear, normal, grows, rise = max(0.0, B - A * limit), limit, 0.0, 0.0
        if shear > trial:
            shear, grows = trial, more
    return shear, normal, grows, rise


@inline
def settled_stress(m: Any, surface: Any, b: Any, trace: float, e: Any, H: Any, p: Any, commit: Any) -> Any:
    """Kirchhoff stress of a trial state with the tensor b, and with trace and deviator of ½ ln b."""
    K, G = m.bulk, m.shear
    trial, mean = G * math.sqrt(2.0 * double_contraction(e)), K * trace
    shear, normal, _, _ = return_to_surface(m, surface, trial, mean, 0.0, 0.0)
    scale = shear / trial if shear < trial else 1.0
    if commit:
        strain, work = 0.0, 0.0
        if shear < trial or normal < mean:
            strain = (trial - shear) / (math.sqrt(3.0) * G)
            work = shear * (trial - shear) / G + normal * (mean - normal) / K
            third = normal / (3.0 * K)
            b = tensor_of_strain(scale, e, third)
        keep_plastic(H, p, strain, work)
        keep_tensor(m, H, p, b)
    g = 2.0 * G * scale
    return normal + g * e[0], normal + g * e[1], normal + g * e[2], g * e[3], g * e[4], g * e[5]


for _Prager in PRAGER.values():

    @kirchhoff_stress.register(_Prager)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        b = trial_tensor(m, dF, H, p)
        trace, e = split_strain(b)
        return settled_stress(m, surface_at(m, H[STRAIN, p]), b, trace, e, H, p, commit)

    @shared_by_trials.register(_Prager)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        b = trial_tensor(m, dF, H, p)
        return b, log_symmetric(b), surface_at(m, H[STRAIN, p])

    @lateral_stress.register(_Prager)
    def _(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
        _, e, surface = shared
        xx, yy, zz, xy, _, _ = add_laterally(e, 2.0 * x, both)
        G, free, third = m.shear, 2.0 if both else 1.0, (xx + yy + zz) * (1.0 / 3.0)
        a, b, c = xx - third, yy - third, zz - third
        trial = G * math.sqrt(0.5 * (a * a + b * b + c * c) + xy * xy)
        inverse = 1.0 / max(trial, 1e-300)
        more = G * G * (b + c if both else c) * inverse
        shear, normal, grows, rise = return_to_surface(
            m, surface, trial, 1.5 * m.bulk * third, more, free * m.bulk
        )
        scale, bend = 1.0, 0.0
        if shear < trial:
            scale = shear * inverse
            bend = (grows - scale * more) * c * inverse
        slope = rise + G * (bend + scale * (2.0 - free * (2.0 / 3.0)))
        return normal + G * scale * c, slope

    @free_stress.register(_Prager)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
        shared = shared_by_trials(m, F, dF, H, p, dt)
        x = search_strain(m, shared, F, dF, H, p, dt, both)
        b, e, surface = shared
        trace, e = split_logarithm(add_laterally(e, 2.0 * x, both))
        b = stretch_tensor(b, x, both)
        F1, dF1 = widened(F, dF, F[8] * exponential(x), both)
        return F1, dF1, settled_stress(m, surface, b, trace, e, H, p, True)
