"""Mohr–Coulomb plasticity of soils and rock, with dilation, tension cut-off and softening."""

import math
from typing import Any, Literal, NamedTuple

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential, log_symmetric
from mpmcli.materials.base import MATERIALS, kirchhoff_stress
from mpmcli.materials.friction_angle import FrictionalModel, FrictionalPart, strength_at
from mpmcli.materials.hencky import STRAIN, hencky_plastic, keep_plastic, keep_tensor, trial_tensor
from mpmcli.materials.lateral import (
    add_laterally,
    free_stress,
    lateral_stress,
    search_strain,
    shared_by_trials,
    stretch_tensor,
    widened,
)
from mpmcli.materials.principal import from_principal, principal_in_plane, principal_strains


@MATERIALS.register
class MohrCoulomb(FrictionalModel):
    """Mohr–Coulomb: τ₁ − τ₃ ≤ 2c cos φ − (τ₁ + τ₃) sin φ, and τ₁ at most the tensile strength (Rankine).

    Hencky elasticity, and an exact return in principal stresses to the plane, its edges and the apex (Clausen,
    Damkilde and Andersen 2006). Plastic flow follows the angle of dilation; at the tension cut-off it is associated.
    """

    kind: Literal["mohr_coulomb"]

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Moduli and strengths."""
        return COULOMB[analysis != "3d"](*self.frictional_parameters(analysis))


COULOMB = hencky_plastic("Coulomb", FrictionalPart._fields, __name__)
"""The parameter tuples in space (False) and in the plane (True)."""


@inline
def return_to_cut_off(x: float, y: float, z: float, limit: float, lame: float, G: float) -> Any:
    """Principal stresses x ≥ y ≥ z returned to x ≤ ``limit``, with associated flow."""
    g = (x - limit) / (lame + 2.0 * G)
    if y - lame * g <= limit:
        return limit, y - lame * g, z - lame * g
    g = (0.5 * (x + y) - limit) / (lame + G)
    return limit, limit, min(limit, z - lame * g)


@inline
def return_to_cone(
    x: float, y: float, z: float, k: float, n: float, strength: float, lame: float, G: float
) -> Any:
    """Principal stresses x ≥ y ≥ z returned to kx − z = ``strength`` or its edges, along the flow nx − z.

    Beyond the apex the result is out of order.
    """
    volume = lame * (n - 1.0)
    g = (k * x - z - strength) / (k * (volume + 2.0 * G * n) - volume + 2.0 * G)
    a, b, c = x - (volume + 2.0 * G * n) * g, y - volume * g, z - (volume - 2.0 * G) * g
    if b > a:
        a = 0.5 * (x + y)
        g = (k * a - z - strength) / (k * (volume + G * n) - volume + 2.0 * G)
        a -= (volume + G * n) * g
        return a, a, z - (volume - 2.0 * G) * g
    if b < c:
        c = 0.5 * (y + z)
        g = (k * x - c - strength) / (k * (volume + 2.0 * G * n) - volume + G)
        c -= (volume - G) * g
        return x - (volume + 2.0 * G * n) * g, c, c
    return a, b, c


@inline
def surface_at(m: Any, alpha: float) -> Any:
    """Slopes k of the cone and n of its potential, and shear and tensile strength at the plastic strain ``alpha``."""
    c, s, d, limit = strength_at(m, alpha)
    k, n = (1.0 + s) / (1.0 - s), (1.0 + d) / (1.0 - d)
    return k, n, 2.0 * c * math.sqrt(k), limit


@inline
def return_principal(m: Any, stress: Any, surface: Any) -> Any:
    """Principal stresses in descending order, returned to the yield surface."""
    (x, y, z), (k, n, strength, limit) = stress, surface
    G, lame = m.shear, m.bulk - 2.0 / 3.0 * m.shear
    shears = k * x - z > strength
    if shears:
        u, v, w = return_to_cone(x, y, z, k, n, strength, lame, G)
        if u <= limit:
            return u, v, w
    elif x <= limit:
        return x, y, z
    u, v, w = return_to_cut_off(x, y, z, limit, lame, G)
    if k * u - w <= strength:
        return u, v, w
    # where both surfaces meet the strain along the middle axis stays, except in the corners
    w = k * limit - strength
    nu = 0.5 * lame / (lame + G)
    v = y - nu * (x + z) + nu * (limit + w)
    return limit, min(limit, max(w, v)), w


@inline
def settled_stress(m: Any, surface: Any, b: Any, e: Any, axes: Any, H: Any, p: Any, commit: Any) -> Any:
    """Kirchhoff stress of a trial state with the tensor b, and with values and axes of ½ ln b."""
    G = m.shear
    mean = (m.bulk - 2.0 / 3.0 * G) * (e[0] + e[1] + e[2])
    trial = (mean + 2.0 * G * e[0], mean + 2.0 * G * e[1], mean + 2.0 * G * e[2])
    tau = return_principal(m, trial, surface)
    if commit:
        dx, dy, dz = trial[0] - tau[0], trial[1] - tau[1], trial[2] - tau[2]
        strain, work = 0.0, 0.0
        if dx != 0.0 or dy != 0.0 or dz != 0.0:
            # plastic strains: deviators of the stress drop over 2G, their mean over 3K
            drop = (dx + dy + dz) / 3.0
            more = drop / (3.0 * m.bulk) - drop / (2.0 * G)
            dx, dy, dz = dx / (2.0 * G) + more, dy / (2.0 * G) + more, dz / (2.0 * G) + more
            work = tau[0] * dx + tau[1] * dy + tau[2] * dz
            third = (dx + dy + dz) / 3.0
            strain = math.sqrt(
                2.0 / 3.0 * ((dx - third) ** 2 + (dy - third) ** 2 + (dz - third) ** 2)
            )  # fmt: skip
            b = from_principal(
                m,
                (
                    exponential(2.0 * (e[0] - dx)),
                    exponential(2.0 * (e[1] - dy)),
                    exponential(2.0 * (e[2] - dz)),
                ),
                axes,
            )
        keep_plastic(H, p, strain, work)
        keep_tensor(m, H, p, b)
    return from_principal(m, tau, axes)


for _Coulomb in COULOMB.values():

    @kirchhoff_stress.register(_Coulomb)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        b = trial_tensor(m, dF, H, p)
        e, _, axes = principal_strains(m, b)
        return settled_stress(m, surface_at(m, H[STRAIN, p]), b, e, axes, H, p, commit)

    @shared_by_trials.register(_Coulomb)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        b = trial_tensor(m, dF, H, p)
        return b, log_symmetric(b), surface_at(m, H[STRAIN, p])

    @lateral_stress.register(_Coulomb)
    def _(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
        _, e, surface = shared
        (a, b, c), (_, _, first, last) = principal_in_plane(add_laterally(e, 2.0 * x, both))
        G, trace = m.shear, (m.bulk / 2.0 - m.shear / 3.0) * (a + b + c)
        tau = return_principal(m, (trace + G * a, trace + G * b, trace + G * c), surface)
        return tau[0] if first else tau[2] if last else tau[1], 0.0

    @free_stress.register(_Coulomb)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
        shared = shared_by_trials(m, F, dF, H, p, dt)
        x = search_strain(m, shared, F, dF, H, p, dt, both)
        b, e, surface = shared
        v, axes = principal_in_plane(add_laterally(e, 2.0 * x, both))
        F1, dF1 = widened(F, dF, F[8] * exponential(x), both)
        b = stretch_tensor(b, x, both)
        e = (0.5 * v[0], 0.5 * v[1], 0.5 * v[2])
        return F1, dF1, settled_stress(m, surface, b, e, axes, H, p, True)
