"""Brittle elasticity: a smeared crack with a fixed normal, whose fracture energy does not depend on the cell size."""

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import (
    exponential,
    exponential_1d,
    exponential_symmetric,
    log_symmetric,
    logarithm,
)
from mpmcli.core.model import PositivePressure, Quantity
from mpmcli.core.tensors import (
    determinant,
    eigen_symmetric,
    largest_eigenvalue_bound,
    left_cauchy_green,
    multiply,
)
from mpmcli.materials.base import (
    MATERIALS,
    bulk_slope,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults
from mpmcli.materials.elastic_constants import ElasticModel
from mpmcli.materials.lateral import (
    lateral_stress,
    lateral_stretch,
    search_lateral,
    search_thickness,
    shared_by_trials,
    thickness_stretch,
)
from mpmcli.materials.linear_elastic import hencky_speed_squared
from mpmcli.materials.own_numbers import with_own_numbers

BAND, NORMAL, DRIVER, DAMAGE, OPENING, DISSIPATED = 0, 3, 6, 7, 8, 9


@MATERIALS.register
class IsotropicSoftening(ElasticModel):
    """Hencky elasticity until the largest principal stress reaches a strength, then a smeared crack that opens.

    The crack's normal n is fixed in the material where the strength is first reached. With the traction of the
    undamaged material on the crack, normal part t and shear part s, and the modulus M = λ + 2G, the crack takes the
    shares d t and d s away; where t < 0 the crack is closed and bears t whole. The damage d follows from the largest
    √(t² + M/G s²) so far, such that stress against cracking strain follows the softening law and the crack dissipates
    ``toughness`` per area in any mixture of opening and shear. The opening is the cracking strain times the width of
    the band in which the grid lets strain localise, a cell [bazant1983].
    """

    analyses: ClassVar[frozenset[str]] = frozenset(ANALYSES) - {"axisymmetric"}
    history: ClassVar[tuple[str, ...]] = (
        *(f"band_{axis}" for axis in "xyz"),
        *(f"crack_normal_{axis}" for axis in "xyz"),
        "crack_driver",
        "damage",
        "cracking_strain",
        "dissipated_energy",
    )
    bands: ClassVar[tuple[str, ...]] = ("band_x", "band_y", "band_z")
    properties: ClassVar[frozenset[str]] = frozenset({"isotropic", "stress_free_at_rest"})

    kind: Literal["isotropic_softening"]
    strength: PositivePressure
    """Tensile strength."""
    toughness: Annotated[float, Quantity("energy/area", gt=0)]
    """Fracture energy per area of crack."""
    softening: Literal["linear", "exponential"] = "linear"
    """Stress against opening after the strength is reached."""

    @property
    def widest_band(self) -> float:
        """Width of a band whose stored energy is the fracture energy when its strength is reached [length]."""
        E = 9 * self.bulk_modulus * self.shear_modulus / (3 * self.bulk_modulus + self.shear_modulus)
        return (
            E
            * (self.toughness / self.strength / self.strength)
            * (2.0 if self.softening == "linear" else 1.0)
        )

    def band_problem(self, largest: float) -> str | None:
        """Return why a band is too wide: its stored energy would exceed the fracture energy."""
        limit = self.widest_band
        if largest < limit:
            return None
        words = "2 E·toughness/strength²" if self.softening == "linear" else "E·toughness/strength²"
        return (
            f"cells of size {largest:.3g} would release more energy than a crack dissipates: make them smaller than "
            f"{limit:.3g} ({words}), raise the toughness or lower the strength"
        )

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Moduli, squares of the wave speeds, strength and toughness."""
        made = LinearSoftening if self.softening == "linear" else ExponentialSoftening
        return made(
            self.lame_modulus,
            self.shear_modulus,
            self.initial_wave_speed(analysis) ** 2,
            self.bulk_modulus / self.density,
            self.strength,
            self.toughness,
            self.density,
        )


@with_own_numbers
@with_defaults
class LinearSoftening(NamedTuple):
    """Numbers of the material: λ, G [pressure], squares of wave and bulk speed at rest, strength, energy per area."""

    lame: float
    shear: float
    wave2: float
    bulk2: float
    strength: float
    toughness: float
    density: float


@with_own_numbers
@with_defaults
class ExponentialSoftening(NamedTuple):
    """The same, for exponential softening."""

    lame: float
    shear: float
    wave2: float
    bulk2: float
    strength: float
    toughness: float
    density: float


@generic
def largest_opening(m: Any, driver: Any, band: Any) -> Any:
    """Cracking strain, its derivative by ``driver``, and dissipated energy per volume [pressure].

    ``driver`` is the largest stress of the undamaged material so far, stress + M times the cracking strain.
    """


@largest_opening.register(LinearSoftening)
def _(m: Any, driver: Any, band: Any) -> Any:
    M = m.lame + 2.0 * m.shear
    slope = 0.5 * m.strength * m.strength * band / m.toughness
    opening = (driver - m.strength) / (M - slope)
    stress = m.strength - slope * opening
    if stress > 0.0:
        return opening, 1.0 / (M - slope), 0.5 * m.strength * opening
    return driver / M, 1.0 / M, m.toughness / band


@largest_opening.register(ExponentialSoftening)
def _(m: Any, driver: Any, band: Any) -> Any:
    M = m.lame + 2.0 * m.shear
    rate = m.strength * band / m.toughness
    # σ exp(-rate x) + M x = driver: convex, so that Newton's method from the right never passes the root, where the
    # tangents at x = 0 and at infinity lead, too
    opening = min(driver / M, (driver - m.strength) / (M - rate * m.strength))
    stress = m.strength * exponential_1d(-rate * opening)
    for _ in range(60):
        change = (stress + M * opening - driver) / (M - rate * stress)
        opening -= change
        stress *= exponential(rate * change)
        # the next change is of second order
        if rate * rate * stress * change * change <= 1e-15 * opening * (M - rate * stress):
            break
    x = rate * opening
    released = (m.strength - stress) / rate if x > 1e-6 else m.strength * opening * (1.0 - 0.5 * x)
    return opening, 1.0 / (M - rate * stress), released - 0.5 * stress * opening


@inline
def _elastic(m: Any, F: Any) -> Any:
    """Logarithmic strain ½ ln b, and the Kirchhoff stress of the undamaged material."""
    e = log_symmetric(left_cauchy_green(F))
    e = (0.5 * e[0], 0.5 * e[1], 0.5 * e[2], 0.5 * e[3], 0.5 * e[4], 0.5 * e[5])
    mean, G = m.lame * (e[0] + e[1] + e[2]), 2.0 * m.shear
    return e, (mean + G * e[0], mean + G * e[1], mean + G * e[2], G * e[3], G * e[4], G * e[5])


@inline
def _rotation(F: Any, e: Any) -> Any:
    """R = V⁻¹F with V = exp e; in the plane R turns by the angle of (F_xx + F_yy, F_yx − F_xy)."""
    if F[2] == 0.0 and F[5] == 0.0 and F[6] == 0.0 and F[7] == 0.0:
        c, s = F[0] + F[4], F[3] - F[1]
        r = 1.0 / math.sqrt(c * c + s * s)
        return r * c, -r * s, 0.0, r * s, r * c, 0.0, 0.0, 0.0, 1.0
    v = exponential_symmetric((-e[0], -e[1], -e[2], -e[3], -e[4], -e[5]))
    return multiply((v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2]), F)


@inline
def _largest_axis(T: Any) -> Any:
    """Largest principal value of a symmetric tensor and its axis."""
    v, Q = eigen_symmetric(T)
    if v[0] >= v[1] and v[0] >= v[2]:
        return v[0], (Q[0], Q[3], Q[6])
    if v[1] >= v[2]:
        return v[1], (Q[1], Q[4], Q[7])
    return v[2], (Q[2], Q[5], Q[8])


@inline
def _traction(T: Any, n: Any) -> Any:
    """Normal stress on the plane with normal ``n``, and the shear traction."""
    x = T[0] * n[0] + T[3] * n[1] + T[5] * n[2]
    y = T[3] * n[0] + T[1] * n[1] + T[4] * n[2]
    z = T[5] * n[0] + T[4] * n[1] + T[2] * n[2]
    normal = x * n[0] + y * n[1] + z * n[2]
    return normal, (x - normal * n[0], y - normal * n[1], z - normal * n[2])


@inline
def _relieved(m: Any, T: Any, n: Any, normal: Any, s: Any, damage: Any) -> Any:
    """Stress with a crack: ``T`` less the shares that the crack takes away."""
    opening = damage * max(0.0, normal) / (m.lame + 2.0 * m.shear)
    a, b = m.lame * opening, 2.0 * m.shear * opening
    return (
        T[0] - a - b * n[0] * n[0] - 2.0 * damage * n[0] * s[0],
        T[1] - a - b * n[1] * n[1] - 2.0 * damage * n[1] * s[1],
        T[2] - a - b * n[2] * n[2] - 2.0 * damage * n[2] * s[2],
        T[3] - b * n[0] * n[1] - damage * (n[0] * s[1] + n[1] * s[0]),
        T[4] - b * n[1] * n[2] - damage * (n[1] * s[2] + n[2] * s[1]),
        T[5] - b * n[0] * n[2] - damage * (n[0] * s[2] + n[2] * s[0]),
    )


@inline
def _normal_now(R: Any, H: Any, p: Any) -> Any:
    """The crack's normal, turned with the body."""
    x, y, z = H[NORMAL, p], H[NORMAL + 1, p], H[NORMAL + 2, p]
    return R[0] * x + R[1] * y + R[2] * z, R[3] * x + R[4] * y + R[5] * z, R[6] * x + R[7] * y + R[8] * z


@inline
def _across(R: Any, n: Any) -> Any:
    """``n`` turned back into the undeformed material."""
    return (
        R[0] * n[0] + R[3] * n[1] + R[6] * n[2],
        R[1] * n[0] + R[4] * n[1] + R[7] * n[2],
        R[2] * n[0] + R[5] * n[1] + R[8] * n[2],
    )


@inline
def _damaged(m: Any, T: Any, n: Any, N: Any, driver: Any, H: Any, p: Any) -> Any:
    """Normal and shear traction on a crack with normal ``n``, ``N`` in the undeformed material, its driver, damage, the
    derivative of damage by driver where this grows, and dissipation."""
    normal, s = _traction(T, n)
    M, opened = m.lame + 2.0 * m.shear, max(0.0, normal)
    shear2 = s[0] * s[0] + s[1] * s[1] + s[2] * s[2]
    last, driver = driver, max(driver, math.sqrt(opened * opened + M / m.shear * shear2))
    x, y, z = N[0] * H[BAND, p], N[1] * H[BAND + 1, p], N[2] * H[BAND + 2, p]
    opening, slope, dissipated = largest_opening(m, driver, math.sqrt(x * x + y * y + z * z))
    damage = M * opening / driver
    growth = (M * slope - damage) / driver if driver > last else 0.0
    return normal, s, driver, damage, growth, dissipated


for _Softening in (LinearSoftening, ExponentialSoftening):

    @kirchhoff_stress.register(_Softening)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        e, T = _elastic(m, F)
        driver = H[DRIVER, p]
        if driver == 0.0:
            if largest_eigenvalue_bound(T) <= m.strength:
                return T
            largest, n = _largest_axis(T)
            if largest <= m.strength:
                return T
            N = _across(_rotation(F, e), n)
            driver = m.strength
            if commit:
                H[NORMAL, p], H[NORMAL + 1, p], H[NORMAL + 2, p] = N
        else:
            n = _normal_now(_rotation(F, e), H, p)
            N = (H[NORMAL, p], H[NORMAL + 1, p], H[NORMAL + 2, p])
        normal, s, driver, damage, _, dissipated = _damaged(m, T, n, N, driver, H, p)
        if commit:
            H[DRIVER, p] = driver
            H[DAMAGE, p] = damage
            H[OPENING, p] = damage * max(0.0, normal) / (m.lame + 2.0 * m.shear)
            H[DISSIPATED, p] = dissipated
        return _relieved(m, T, n, normal, s, damage)

    @shared_by_trials.register(_Softening)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        # a stretch across the plane does not turn anything
        e, T = _elastic(m, F)
        R = _rotation(F, e)
        return T, R, _normal_now(R, H, p)

    @lateral_stress.register(_Softening)
    def _(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
        T, R, n = shared
        a, b = (2.0 if both else 1.0) * m.lame * x, 2.0 * m.shear * x
        T = (T[0] + a, T[1] + (a + b if both else a), T[2] + a + b, T[3], T[4], T[5])
        driver, N = H[DRIVER, p], (H[NORMAL, p], H[NORMAL + 1, p], H[NORMAL + 2, p])
        dilated, G = (2.0 if both else 1.0) * m.lame, 2.0 * m.shear
        if driver == 0.0:
            largest, n = _largest_axis(T)
            if largest <= m.strength:
                return T[2], dilated + G
            N, driver = _across(R, n), m.strength
        normal, s, driver, damage, growth, _ = _damaged(m, T, n, N, driver, H, p)
        f = _relieved(m, T, n, normal, s, damage)[2]
        if H[DRIVER, p] == 0.0:
            return f, 0.0  # the axis turns as T changes
        # derivatives by x of the tractions, which follow from those of T, of the driver and of the damage
        change = (dilated, dilated + (G if both else 0.0), dilated + G, 0.0, 0.0, 0.0)
        rise, ds = _traction(change, n)
        opened, rise = max(0.0, normal), rise if normal > 0.0 else 0.0
        M = m.lame + G
        shear = s[0] * ds[0] + s[1] * ds[1] + s[2] * ds[2]
        more = growth * (opened * rise + M / m.shear * shear) / driver
        slope = (m.lame + G * n[2] * n[2]) / M * (damage * rise + more * opened)
        return f, dilated + G - slope - 2.0 * n[2] * (damage * ds[2] + more * s[2])

    @strain_energy.register(_Softening)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        e, T = _elastic(m, F)
        if H[DRIVER, p] > 0.0:
            n = _normal_now(_rotation(F, e), H, p)
            normal, s = _traction(T, n)
            T = _relieved(m, T, n, normal, s, H[DAMAGE, p])
        # secant unloading: the stress is proportional to the strain
        shear = T[3] * e[3] + T[4] * e[4] + T[5] * e[5]
        return 0.5 * (T[0] * e[0] + T[1] * e[1] + T[2] * e[2]) + shear

    @wave_speed_squared.register(_Softening)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        # that of Hencky elasticity, which a closed crack leaves as it is
        return hencky_speed_squared(m, F)

    @bulk_speed_squared.register(_Softening)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return m.bulk2

    @bulk_slope.register(_Softening)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return m.bulk2 * (1.0 - logarithm(determinant(F)))

    @thickness_stretch.register(_Softening)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        if H[DRIVER, p] == 0.0:
            ratio = -m.lame / (m.lame + 2.0 * m.shear)
            z = exponential_1d(ratio * logarithm(F[0] * F[4] - F[1] * F[3]))
            if _stays_whole(m, (F[0], F[1], 0.0, F[3], F[4], 0.0, 0.0, 0.0, z)):
                return z
        return search_thickness(m, F, dF, H, p, dt)

    @lateral_stretch.register(_Softening)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        if H[DRIVER, p] == 0.0:
            w = exponential_1d(-0.5 * m.lame / (m.lame + m.shear) * logarithm(F[0]))
            if _stays_whole(m, (F[0], 0.0, 0.0, 0.0, w, 0.0, 0.0, 0.0, w)):
                return w
        return search_lateral(m, F, dF, H, p, dt)


@inline
def _stays_whole(m: Any, F: Any) -> Any:
    """Whether no crack begins at ``F``."""
    return largest_eigenvalue_bound(_elastic(m, F)[1]) <= m.strength
