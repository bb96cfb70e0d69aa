"""Snow: neo-Hookean elasticity whose principal stretches are clamped, and which compaction hardens."""

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential, exponential_1d, logarithm_1p
from mpmcli.core.model import Quantity
from mpmcli.core.rows import log1p
from mpmcli.core.tensors import largest_eigenvalue_bound, smallest_eigenvalue_bound
from mpmcli.materials.base import (
    MATERIALS,
    bulk_speed_squared,
    dissipated_heat,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.elastic_constants import ElasticModel, lateral_factor
from mpmcli.materials.hencky import (
    HISTORY,
    elastic_tensor,
    elastic_volume,
    excess_volume,
    keep_tensor,
    trial_tensor,
)
from mpmcli.materials.lateral import lateral_stress, shared_by_trials
from mpmcli.materials.planar import in_space_and_plane
from mpmcli.materials.principal import from_principal, principal_strains

VOLUME, WORK, LAST = 6, 7, 8


@MATERIALS.register
class ClampedNeoHookean(ElasticModel):
    """Snow [stomakhin2013]: neo-Hookean elasticity with the stretches of Fᵉ between 1 − compression and 1 + extension.

    What is beyond them becomes plastic, F = FᵉFᵖ. Compaction stiffens and extension weakens: with J_P = det Fᵖ both
    moduli have the factor exp(hardening (1 − J_P)). The elastic law is that of ``neo_hookean``; the paper has a
    corotated one.
    """

    history: ClassVar[tuple[str, ...]] = (
        *HISTORY[:6],
        "plastic_log_volume",
        "plastic_work",
        "plastic_work_of_step",
    )
    properties: ClassVar[frozenset[str]] = frozenset({"isotropic", "stress_free_at_rest"})

    kind: Literal["clamped_neo_hookean"]
    compression: Annotated[float, Quantity("1", gt=0, lt=1)] = 0.025
    """Largest elastic compression θ_c of a principal axis."""
    extension: Annotated[float, Quantity("1", gt=0)] = 0.0075
    """Largest elastic extension θ_s of a principal axis."""
    hardening: Annotated[float, Quantity("1", ge=0, le=100)] = 10.0
    """Coefficient ξ of hardening by compaction."""

    def parameters(self, analysis: str, adiabatic: bool) -> Any:
        """Moduli, limits of the logarithmic strain, and the square of the wave speed at rest."""
        return SNOW[analysis != "3d"](
            lame=self.lame_modulus,
            shear=self.shear_modulus,
            density=self.density,
            rest2=self.initial_wave_speed(analysis) ** 2,
            lateral=lateral_factor(self.lame_modulus, self.shear_modulus, analysis),
            lowest=log1p(-self.compression),
            highest=log1p(self.extension),
            hardening=self.hardening,
        )


class SnowNumbers(NamedTuple):
    """Numbers of a clamped neo-Hookean material."""

    lame: float
    shear: float
    density: float
    rest2: float
    """Square of the wave speed at rest [velocity²]."""
    lateral: float
    """Wave stiffness of the analysis over that of uniaxial strain."""
    lowest: float
    """Smallest and largest elastic logarithmic strain."""
    highest: float
    hardening: float


SNOW = in_space_and_plane("Snow", SnowNumbers._fields, __name__)
"""The parameter tuples in space (False) and in the plane (True)."""


@inline
def _stiffening(m: Any, log_volume: Any) -> Any:
    """exp(ξ(1 − J_P))."""
    return exponential(m.hardening * (1.0 - exponential(log_volume)))


@inline
def _mean_stress(m: Any, J2: Any) -> Any:
    """The volumetric stress of ``neo_hookean`` from the square of the elastic J, with the moduli at rest [pressure]."""
    return 0.5 * m.lame * (J2 - 1.0)


@inline
def _energy(m: Any, trace: Any, J2: Any, log_J: Any) -> Any:
    """Stored energy from tr bᵉ − 3, J² and ln J of the elastic J, with the moduli at rest [pressure]."""
    return 0.5 * m.lame * (0.5 * (J2 - 1.0) - log_J) + 0.5 * m.shear * (trace - 2.0 * log_J)


@inline
def _bulk(m: Any, J2: Any) -> Any:
    """The volumetric stiffness in the same way."""
    return 0.5 * m.lame * (J2 + 1.0)


@inline
def _clamped(m: Any, low: float, high: float, e: float, v: float) -> Any:
    """Square ``v`` of a stretch kept within both limits, what that cuts off its logarithm ``e``, and 1, or 0 if cut."""
    if e < m.lowest:
        return low, e - m.lowest, 0.0
    if e > m.highest:
        return high, e - m.highest, 0.0
    return v, 0.0, 1.0


for _Snow in SNOW.values():

    @kirchhoff_stress.register(_Snow)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        b = trial_tensor(m, dF, H, p)
        log_volume = H[VOLUME, p]
        h = _stiffening(m, log_volume)
        work = 0.0
        low, high = exponential_1d(2.0 * m.lowest), exponential_1d(2.0 * m.highest)
        if smallest_eigenvalue_bound(b) < low or largest_eigenvalue_bound(b) > high:
            e, whole, axes = principal_strains(m, b)
            x, y, z = (
                min(m.highest, max(m.lowest, e[0])),
                min(m.highest, max(m.lowest, e[1])),
                min(m.highest, max(m.lowest, e[2])),
            )
            log_J, clamped = e[0] + e[1] + e[2], x + y + z
            if x != e[0] or y != e[1] or z != e[2]:
                v = (
                    min(high, max(low, whole[0])),
                    min(high, max(low, whole[1])),
                    min(high, max(low, whole[2])),
                )
                b = from_principal(m, v, axes)
                log_volume += log_J - clamped
                new = _stiffening(m, log_volume)
                if commit:
                    # the stress at the limit does work on what is cut off; the stored energy changes with the moduli
                    J2 = v[0] * v[1] * v[2]
                    mean = _mean_stress(m, J2)
                    cut = (mean + m.shear * (v[0] - 1.0)) * (e[0] - x)
                    cut += (mean + m.shear * (v[1] - 1.0)) * (e[1] - y)
                    cut += (mean + m.shear * (v[2] - 1.0)) * (e[2] - z)
                    work = 0.5 * (h + new) * cut
                    work += (h - new) * _energy(m, v[0] + v[1] + v[2] - 3.0, J2, clamped)
                    H[VOLUME, p] = log_volume
                h = new
        if commit:
            H[WORK, p] += work
            H[LAST, p] = work
            keep_tensor(m, H, p, b)
        J2 = (
            b[0] * (b[1] * b[2] - b[4] * b[4])
            - b[3] * (b[3] * b[2] - b[4] * b[5])
            + b[5] * (b[3] * b[4] - b[1] * b[5])
        )
        G = h * m.shear
        c = h * _mean_stress(m, J2) - G
        return c + G * b[0], c + G * b[1], c + G * b[2], G * b[3], G * b[4], G * b[5]

    @shared_by_trials.register(_Snow)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        # of both axes in the plane the first is the one nearer to x; b_xx in a bar, where y is as free as z
        b = trial_tensor(m, dF, H, p)
        xx, yy, zz = b[0] - 1.0, b[1] - 1.0, b[2] - 1.0
        mean, d = 0.5 * (xx + yy), 0.5 * (xx - yy)
        r = math.copysign(math.sqrt(d * d + b[3] * b[3]), d)
        x, y = mean + r, mean - r
        strains = (0.5 * logarithm_1p(x), 0.5 * logarithm_1p(y), 0.5 * logarithm_1p(zz))
        limits = (exponential_1d(2.0 * m.lowest), exponential_1d(2.0 * m.highest))
        return strains, (1.0 + x, 1.0 + y, 1.0 + zz), limits, H[VOLUME, p]

    @lateral_stress.register(_Snow)
    def _(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
        e, v, (low, high), log_volume = shared
        square = exponential(2.0 * x)
        first, cut_1, _ = _clamped(m, low, high, e[0], v[0])
        second, cut_2, free_2 = _clamped(
            m, low, high, e[1] + x if both else e[1], v[1] * (square if both else 1.0)
        )
        third, cut_3, free = _clamped(m, low, high, e[2] + x, v[2] * square)
        J_plastic = exponential(log_volume + cut_1 + cut_2 + cut_3)
        h = exponential(m.hardening * (1.0 - J_plastic))
        J2 = first * second * third
        stress = h * (_mean_stress(m, J2) + m.shear * (third - 1.0))
        stretches, flows = (free + free_2, 2.0 - free - free_2) if both else (free, 1.0 - free)
        slope = h * (m.lame * J2 * stretches + 2.0 * m.shear * third * free)
        return stress, slope - stress * m.hardening * J_plastic * flows

    @dissipated_heat.register(_Snow)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        return H[LAST, p]

    @strain_energy.register(_Snow)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        trace, J2 = H[0, p] + H[1, p] + H[2, p], 1.0 + excess_volume(m, H, p)
        return _stiffening(m, H[VOLUME, p]) * _energy(m, trace, J2, elastic_volume(m, H, p))

    @wave_speed_squared.register(_Snow)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        # as the neo-Hookean one of the elastic part
        shear = m.shear * (largest_eigenvalue_bound(elastic_tensor(m, H, p)) + 1.0)
        stiffness = _bulk(m, 1.0 + excess_volume(m, H, p)) + shear
        return max(m.rest2, m.lateral * _stiffening(m, H[VOLUME, p]) * stiffness / m.density)

    @bulk_speed_squared.register(_Snow)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        shear = m.shear * (2.0 / 3.0 - (H[0, p] + H[1, p] + H[2, p]) / 9.0)
        stiffness = _bulk(m, 1.0 + excess_volume(m, H, p)) + shear
        return max(0.0, _stiffening(m, H[VOLUME, p]) * stiffness / m.density)
