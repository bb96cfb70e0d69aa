"""Viscoelasticity for large strain: an elastic network beside Maxwell elements in shear and bulk."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.compiled.compiler import compiled_as
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential, exponential_1d, logarithm, logarithm_1p
from mpmcli.core.model import Model, Quantity
from mpmcli.core.rows import sqrt
from mpmcli.core.tensors import determinant, left_cauchy_green, push_forward, smallest_eigenvalue_bound
from mpmcli.materials.base import (
    MATERIALS,
    MaterialModel,
    absorb_work,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.elastic_constants import lateral_factor, wave_modulus
from mpmcli.materials.isochoric import (
    isochoric_energy,
    isochoric_lateral_stress,
    isochoric_stiffness,
    isochoric_stress,
)
from mpmcli.materials.lateral import lateral_stress, shared_by_trials
from mpmcli.materials.planar import in_space_and_plane, is_planar
from mpmcli.materials.volumetric import (
    FORMS,
    volumetric_energy,
    volumetric_stiffness,
    volumetric_stress,
)

MOST_TERMS = 8
ROWS = ("xx", "yy", "zz", "xy", "yz", "xz", "volume")
"""History of a Maxwell element: its tensor minus the identity, and the logarithm of its volume."""
OF_TERM = len(ROWS)
HEAT, STORED = 1, 2
"""Rows after that of the temperature, which follows the terms."""


class MaxwellTerm(Model):
    """One Maxwell element of a Prony series."""

    time: Annotated[float, Quantity("time", gt=0)]
    """Relaxation time."""
    G: Annotated[float, Quantity("pressure", ge=0)] = 0.0
    """Shear modulus."""
    K: Annotated[float, Quantity("pressure", ge=0)] = 0.0
    """Bulk modulus."""

    @model_validator(mode="after")
    def _resists(self) -> Self:
        if self.G == self.K == 0.0:
            raise ValueError("give G, K or both")
        return self


class WilliamsLandelFerry(Model):
    """Shift of all relaxation times by a_T, log₁₀ a_T = −C1 (T − T_ref)/(C2 + T − T_ref) [williams1955].

    Below T_ref − C2 nothing relaxes.
    """

    C1: Annotated[float, Quantity("1", gt=0)] = 17.44
    """First constant."""
    C2: Annotated[float, Quantity("temperature", gt=0)] = 51.6
    """Second constant."""
    T_ref: Annotated[float, Quantity("temperature", gt=0)]
    """Temperature at which the relaxation times are those of the terms."""


class RowsOfTerms:
    """Names of the history: rows of every term (of the class: of one), then temperature, heat and stored energy."""

    def __get__(self, model: Any, kind: type | None = None) -> tuple[str, ...]:
        count = 1 if model is None else len(model.terms)
        rows = (f"term_{k + 1}_{name}" for k in range(count) for name in ROWS)
        return (*rows, "temperature", "heat_energy", "stored_energy")


@MATERIALS.register
class Viscoelastic(MaterialModel):
    """Generalised Maxwell solid: τ = J U' I + G dev b̄ + Σₖ (Gₖ dev aₖ + Kₖ vₖ I), b̄ = J^(−2/3) F Fᵀ.

    The elastic part (G, K) is ``neo_hookean`` with ``split: isochoric``. The tensor aₖ of a Maxwell element follows the
    isochoric deformation as b̄ does and relaxes towards the identity with its time constant; vₖ follows ln J and relaxes
    towards zero [green1946]. At small strain this is the Prony series G + Σ Gₖ exp(−t/tₖ), and alike for the bulk.
    What the work of the stress does not store is in ``heat_energy``, and heats the material if heating is adiabatic.
    """

    analyses: ClassVar[frozenset[str]] = frozenset(ANALYSES)
    history: ClassVar[Any] = RowsOfTerms()
    properties: ClassVar[frozenset[str]] = frozenset({"isotropic", "stress_free_at_rest"})

    kind: Literal["viscoelastic"]
    G: Annotated[float, Quantity("pressure", ge=0)]
    """Shear modulus after all relaxation; 0 is a fluid."""
    K: Annotated[float, Quantity("pressure", gt=0)]
    """Bulk modulus after all relaxation."""
    terms: Annotated[tuple[MaxwellTerm, ...], Field(min_length=1, max_length=MOST_TERMS)]
    """Maxwell elements."""
    volumetric: Literal["j_minus_inverse", "log"] = "j_minus_inverse"
    """Energy of a change of volume of the elastic part, as in ``neo_hookean``."""
    wlf: WilliamsLandelFerry | None = None
    """Shift of the relaxation times with temperature."""

    @model_validator(mode="after")
    def _has_shear(self) -> Self:
        if self.shear_modulus == 0.0:
            raise ValueError("give G, or a term with G: a material without shear modulus is a fluid")
        return self

    @property
    def shear_modulus(self) -> float:
        """G of fast deformation, with all terms [pressure]."""
        return self.G + sum(term.G for term in self.terms)

    @property
    def bulk_modulus(self) -> float:
        """K of fast deformation, with all terms [pressure]."""
        return self.K + sum(term.K for term in self.terms)

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Moduli, what heating needs, the shift, and the numbers of the terms."""
        heating = 0.0
        if adiabatic and self.heat_capacity is not None:
            heating = 1 / (self.density * self.heat_capacity)
        shift = () if self.wlf is None else (self.wlf.C1, self.wlf.C2, self.wlf.T_ref)
        numbers = Network(
            float(FORMS[self.volumetric]),
            self.K,
            self.G,
            self.density,
            self.initial_wave_speed(analysis) ** 2,
            lateral_factor(self._lame, self.shear_modulus, analysis),
            heating,
        )
        terms = (number for term in self.terms for number in (term.time, term.G, term.K))
        made = (MAXWELL if self.wlf is None else SHIFTED)[len(self.terms), analysis != "3d"]
        return made(*numbers, *terms, *shift)  # type: ignore[no-any-return]

    def initial_history(self) -> dict[str, float]:
        """The temperature starts at T0."""
        return {"temperature": self.T0}

    def initial_wave_speed(self, analysis: str) -> float:
        """That of isotropic elasticity with the moduli of fast deformation [velocity]."""
        return sqrt(wave_modulus(self._lame, self.shear_modulus, analysis) / self.density)

    @property
    def _lame(self) -> float:
        return self.bulk_modulus - 2 * self.shear_modulus / 3


class Network(NamedTuple):
    """Numbers of a viscoelastic material but those of its terms; all are floats, so that an index may choose."""

    form: float
    """Volumetric form (``volumetric.FORMS``)."""
    bulk: float
    shear: float
    density: float
    rest2: float
    """Square of the wave speed at rest [velocity²]."""
    lateral: float
    """Wave stiffness of the analysis over that of uniaxial strain."""
    heating: float
    """1/(ρ₀c_v), or 0 where the temperature is held [temperature/pressure]."""


FIRST = len(Network._fields)


def _with_terms(name: str, count: int, more: tuple[str, ...] = ()) -> dict[bool, Any]:
    """Tuple classes of the network's numbers, then (time, G, K) of each term, then others."""
    terms = (f"{word}{k}" for k in range(count) for word in ("time", "G", "K"))
    return in_space_and_plane(f"{name}{count}", (*Network._fields, *terms, *more), __name__)


COUNTS = range(1, MOST_TERMS + 1)
MAXWELL = {
    (count, planar): made for count in COUNTS for planar, made in _with_terms("Maxwell", count).items()
}
"""The parameter tuple for each number of terms, in space (False) and in the plane (True)."""
SHIFTED = {
    (count, planar): made
    for count in COUNTS
    for planar, made in _with_terms("ShiftedMaxwell", count, ("C1", "C2", "T_ref")).items()
}
"""The same for relaxation times that depend on temperature."""


@generic
def terms_of(m: Any) -> Any:
    """Number of terms."""


@generic
def relaxations_of(m: Any, half: Any) -> Any:
    """exp(half/t) of all terms."""


@generic
def haste(m: Any, T: Any) -> Any:
    """1/a_T, by which relaxation is faster than at T_ref."""


def relaxations(m: Any, half: Any, k: Any, count: Any) -> Any:
    """exp(half/t) of ``count`` terms from term ``k`` on, as a tuple."""
    return tuple(exponential_1d(half / m[FIRST + 3 * i]) for i in range(k, k + count))


@compiled_as(relaxations)
def _choose_relaxations(m: Any, half: Any, k: Any, count: Any) -> Any:
    # written out term by term: what does not depend on the particle then leaves the loop over particles
    first, length = getattr(k, "literal_value", 0), getattr(count, "literal_value", 0)
    place, middle, part, rest = FIRST + 3 * first, first + length // 2, length // 2, length - length // 2

    def one(m: Any, half: Any, k: Any, count: Any) -> Any:
        return (exponential_1d(half / m[place]),)

    def two_halves(m: Any, half: Any, k: Any, count: Any) -> Any:
        return relaxations(m, half, first, part) + relaxations(m, half, middle, rest)

    if length == 0:
        return None  # the compiler asks again, with the number
    return one if length == 1 else two_halves


@inline
def excess(m: Any, H: Any, row: Any, p: Any) -> Any:
    """a − I of the Maxwell element whose history begins at ``row``."""
    yz, xz = (0.0, 0.0) if is_planar(m) else (H[row + 4, p], H[row + 5, p])
    return H[row, p], H[row + 1, p], H[row + 2, p], H[row + 3, p], yz, xz


@inline
def stretched(B: Any, s: Any) -> Any:
    """I + sB."""
    return 1.0 + s * B[0], 1.0 + s * B[1], 1.0 + s * B[2], s * B[3], s * B[4], s * B[5]


@inline
def logarithmic_excess(y: Any) -> Any:
    """y − ln(1 + y), also where y is small."""
    if abs(y) > 0.05:
        return y - logarithm(1.0 + y)
    z = y / (2.0 + y)
    s = z * z
    return y * z - 2.0 * z * s * (1.0 / 3.0 + s * (0.2 + s * (1.0 / 7.0 + s * (1.0 / 9.0 + s / 11.0))))


for _Maxwell in MAXWELL.values():

    @terms_of.register(_Maxwell)
    def _(m: Any) -> Any:
        return (len(m) - FIRST) // 3

    @haste.register(_Maxwell)
    def _(m: Any, T: Any) -> Any:
        return 1.0


for _Maxwell in SHIFTED.values():

    @terms_of.register(_Maxwell)
    def _(m: Any) -> Any:
        return (len(m) - FIRST) // 3 - 1

    @haste.register(_Maxwell)
    def _(m: Any, T: Any) -> Any:
        above = m.C2 + T - m.T_ref
        if above <= 0.0:
            return 0.0
        return exponential_1d(math.log(10.0) * m.C1 * (T - m.T_ref) / above)


for (_count, _), _Maxwell in (*MAXWELL.items(), *SHIFTED.items()):

    @relaxations_of.register(_Maxwell)
    def _(m: Any, half: Any, count: int = _count) -> Any:
        return relaxations(m, half, 0, count)

    @kirchhoff_stress.register(_Maxwell)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        J = determinant(F)
        xx, yy, zz, xy, yz, xz = isochoric_stress(m.shear, F, J)
        mean = volumetric_stress(m.form, m.bulk, J)
        rise = logarithm_1p(determinant(dF) - 1.0)
        c = exponential(rise * (-1.0 / 3.0))
        A = (
            c * dF[0], c * dF[1], c * dF[2], c * dF[3], c * dF[4], c * dF[5], c * dF[6], c * dF[7], c * dF[8],
        )  # fmt: skip
        terms = terms_of(m)
        end = OF_TERM * terms
        relaxed = relaxations_of(m, -0.5 * dt * haste(m, H[end, p]))
        for k in range(terms):
            G, K = m[FIRST + 3 * k + 1], m[FIRST + 3 * k + 2]
            row = OF_TERM * k
            # half of the relaxation before the deformation and half after it: of second order in the step
            r = relaxed[k]
            a = push_forward(A, stretched(excess(m, H, row, p), r))
            B = (a[0] - 1.0, a[1] - 1.0, a[2] - 1.0, a[3], a[4], a[5])
            grown = r * H[row + 6, p] + rise
            if commit:
                H[row, p], H[row + 1, p], H[row + 2, p], H[row + 3, p] = (
                    r * B[0],
                    r * B[1],
                    r * B[2],
                    r * B[3],
                )
                if not is_planar(m):
                    H[row + 4, p], H[row + 5, p] = r * B[4], r * B[5]
                H[row + 6, p] = r * grown
            g = G * r
            mean += K * r * grown - g * (B[0] + B[1] + B[2]) / 3.0
            xx, yy, zz = xx + g * B[0], yy + g * B[1], zz + g * B[2]
            xy, yz, xz = xy + g * B[3], yz + g * B[4], xz + g * B[5]
        if commit and dt == 0.0:
            H[end + STORED, p] = strain_energy(m, F, H, p)
        return mean + xx, mean + yy, mean + zz, xy, yz, xz

    @shared_by_trials.register(_Maxwell)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        J, b = determinant(F), left_cauchy_green(F)
        g = m.shear * exponential_1d(-2.0 / 3.0 * logarithm(J))
        xx, yy, zz, mean, rate = g * b[0], g * b[1], g * b[2], 0.0, 0.0
        rise = logarithm_1p(determinant(dF) - 1.0)
        c = exponential(rise * (-2.0 / 3.0))
        terms = terms_of(m)
        relaxed = relaxations_of(m, -0.5 * dt * haste(m, H[OF_TERM * terms, p]))
        for k in range(terms):
            r, row = relaxed[k], OF_TERM * k
            a = push_forward(dF, stretched(excess(m, H, row, p), r))
            g, K = c * r * m[FIRST + 3 * k + 1], r * m[FIRST + 3 * k + 2]
            xx, yy, zz = xx + g * a[0], yy + g * a[1], zz + g * a[2]
            mean, rate = mean + K * (r * H[row + 6, p] + rise), rate + K
        return J, (xx, yy, zz), mean, rate

    @lateral_stress.register(_Maxwell)
    def _(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
        J, b, mean, rate = shared
        return isochoric_lateral_stress(m.form, m.bulk, J, b, (0.0, 0.0, 0.0), mean, rate, x, both)

    @absorb_work.register(_Maxwell)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
        end = OF_TERM * terms_of(m)
        stored = strain_energy(m, F, H, p)
        heat = H[end + STORED, p] + work - stored
        H[end, p] += m.heating * heat
        H[end + HEAT, p] += heat
        H[end + STORED, p] = stored

    @strain_energy.register(_Maxwell)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        J = determinant(F)
        energy = volumetric_energy(m.form, m.bulk, J) + isochoric_energy(m.shear, F, J)
        for k in range(terms_of(m)):
            xx, yy, zz, xy, yz, xz = excess(m, H, OF_TERM * k, p)
            v = H[OF_TERM * k + 6, p]
            # tr B - ln det(I + B) by the invariants of B
            pairs = xx * yy + yy * zz + xx * zz - xy * xy - yz * yz - xz * xz
            triple = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
            more = pairs + triple
            shape = logarithmic_excess(xx + yy + zz + more) - more
            energy += 0.5 * m[FIRST + 3 * k + 1] * shape + 0.5 * m[FIRST + 3 * k + 2] * v * v
        return energy

    @bulk_speed_squared.register(_Maxwell)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        stiffness = volumetric_stiffness(m.form, m.bulk, determinant(F))
        for k in range(terms_of(m)):
            stiffness += m[FIRST + 3 * k + 2] * (1.0 - H[OF_TERM * k + 6, p])
        return max(0.0, stiffness / m.density)

    @wave_speed_squared.register(_Maxwell)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        J = determinant(F)
        stiffness = volumetric_stiffness(m.form, m.bulk, J) + isochoric_stiffness(m.shear, F, J)
        for k in range(terms_of(m)):
            a = stretched(excess(m, H, OF_TERM * k, p), 1.0)
            smallest = max(0.0, smallest_eigenvalue_bound(a))
            stiffness += m[FIRST + 3 * k + 1] * (5.0 / 9.0 * (a[0] + a[1] + a[2]) - smallest / 3.0)
            stiffness += m[FIRST + 3 * k + 2] * (1.0 - H[OF_TERM * k + 6, p])
        return max(m.rest2, m.lateral * stiffness / m.density)
