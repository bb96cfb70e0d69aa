"""Viscoelasticity for large strain: an elastic network beside Maxwell elements in shear and bulk."""

from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.registers import each, positive_part, total
from mpmcli.core.exponentials import exponential, exponential_1d, logarithm, logarithm_1p
from mpmcli.core.model import Model, Quantity
from mpmcli.core.rows import sqrt
from mpmcli.core.tensors import determinant, left_cauchy_green, push_forward
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
    FREE_WIDTHS,
    growth_of_thin,
    isochoric_energy,
    isochoric_lateral_stress,
    isochoric_stiffness,
    isochoric_stress,
)
from mpmcli.materials.lateral import (
    free_stress,
    lateral_stress,
    search_strain,
    shared_by_trials,
    stretch_tensor,
    widened,
)
from mpmcli.materials.planar import is_planar
from mpmcli.materials.prony import (
    HEAT,
    LARGE_EXCESS,
    MAXWELL,
    MOST_TERMS,
    ROWS,
    SHIFTED,
    STORED,
    TEMPERATURE,
    Network,
    excess,
    haste,
    keep,
    logarithmic_excess,
    numbers_of,
    relaxations_of,
    small_logarithmic_excess,
    smaller,
    stretched,
    terms_of,
    volumes,
)
from mpmcli.materials.volumetric import FORMS, volumetric_energy, volumetric_stiffness, volumetric_stress


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
    """Names of the history: rows of all terms (of the class: of one), then temperature, heat and stored energy.

    A component of all terms is in rows one after the other, so that they go into a register.
    """

    def __get__(self, model: Any, kind: type | None = None) -> tuple[str, ...]:
        count = 1 if model is None else len(model.terms)
        rows = (f"term_{k + 1}_{name}" for name in ROWS for k in range(count))
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
        shift = () if self.wlf is None else (self.wlf.C1, self.wlf.C2, self.wlf.T_ref)
        numbers = Network(
            float(FORMS[self.volumetric]),
            self.K,
            self.G,
            self.density,
            self.initial_wave_speed(analysis) ** 2,
            lateral_factor(self._lame, self.shear_modulus, analysis),
            FREE_WIDTHS.get(analysis, 0.0),
            self.heating(adiabatic),
        )
        terms = (getattr(term, word) for word in ("time", "G", "K") for term in self.terms)
        made = (MAXWELL if self.wlf is None else SHIFTED)[len(self.terms), analysis != "3d"]
        return made(*numbers, *terms, *shift)  # type: ignore[no-any-return]

    def initial_wave_speed(self, analysis: str) -> float:
        """That of isotropic elasticity with the moduli of fast deformation [velocity]."""
        return sqrt(wave_modulus(self._lame, self.shear_modulus, analysis) / self.density)

    @property
    def _lame(self) -> float:
        return self.bulk_modulus - 2 * self.shear_modulus / 3


@compiled_too
def pushed(m: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """Relaxation in half a step, dF a dFᵀ and volume after it, and ln det dF.

    Half of the relaxation comes before the deformation and half after it: of second order in the step.
    """
    r = relaxations_of(m, -0.5 * dt * haste(m, H[TEMPERATURE * terms_of(m), p]))
    a = push_forward(dF, stretched(excess(m, H, p), r))
    return r, a, r * volumes(m, H, p), logarithm_1p(determinant(dF) - 1.0)


@compiled_too
def stored_by(m: Any, F: Any, B: Any, v: Any) -> Any:
    """Energy per initial volume, with the tensors I + B of the Maxwell elements and their volumes [pressure]."""
    J, G = determinant(F), numbers_of(m, 1)
    energy = volumetric_energy(m.form, m.bulk, J) + isochoric_energy(m.shear, F, J)
    xx, yy, zz, xy, yz, xz = B
    # tr B - ln det(I + B) by the invariants of B
    pairs = xx * yy + yy * zz + xx * zz - xy * xy - yz * yz - xz * xz
    triple = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    more = pairs + triple
    y = xx + yy + zz + more
    energy += 0.5 * total(numbers_of(m, 2) * v * v - G * more)
    if total(y * y) <= LARGE_EXCESS * LARGE_EXCESS:
        return energy + 0.5 * total(G * small_logarithmic_excess(y))
    shear, changes = each(G), each(y)
    for k in range(terms_of(m)):
        energy += 0.5 * shear[k] * logarithmic_excess(changes[k])
    return energy


@compiled_too
def stress_of_step(
    m: Any, F: Any, a: Any, v: Any, rise: Any, r: Any, H: Any, p: Any, dt: Any, commit: Any
) -> Any:
    """Kirchhoff stress at the end of a step, from ``pushed``."""
    J = determinant(F)
    xx, yy, zz, xy, yz, xz = isochoric_stress(m.shear, F, J)
    c = exponential(rise * (-2.0 / 3.0))
    B = (
        r * (c * a[0] - 1.0),
        r * (c * a[1] - 1.0),
        r * (c * a[2] - 1.0),
        r * (c * a[3]),
        r * (c * a[4]),
        r * (c * a[5]),
    )
    v = r * (v + rise)
    if commit:
        keep(m, H, p, B, v)
        # what is stored no longer is heat; the work follows (absorb_work)
        end = TEMPERATURE * terms_of(m)
        stored = stored_by(m, F, B, v)
        released = 0.0 if dt == 0.0 else H[end + STORED, p] - stored
        H[end, p] += m.heating * released
        H[end + HEAT, p] += released
        H[end + STORED, p] = stored
    G, K = numbers_of(m, 1), numbers_of(m, 2)
    x, y, z = total(G * B[0]), total(G * B[1]), total(G * B[2])
    mean = volumetric_stress(m.form, m.bulk, J) + total(K * v) - (x + y + z) / 3.0
    xy += total(G * B[3])
    if not is_planar(m):
        yz, xz = yz + total(G * B[4]), xz + total(G * B[5])
    return mean + xx + x, mean + yy + y, mean + zz + z, xy, yz, xz


@compiled_too
def shared_of(m: Any, F: Any, a: Any, v: Any, rise: Any, r: Any) -> Any:
    """What ``lateral_stress`` needs: J, the diagonal of the shear part, mean stress and its slope; from ``pushed``."""
    J, b = determinant(F), left_cauchy_green(F)
    g = m.shear * exponential_1d(-2.0 / 3.0 * logarithm(J))
    G, K = exponential(rise * (-2.0 / 3.0)) * r * numbers_of(m, 1), r * numbers_of(m, 2)
    b = (g * b[0] + total(G * a[0]), g * b[1] + total(G * a[1]), g * b[2] + total(G * a[2]))
    return J, b, total(K * (v + rise)), total(K)


for _Maxwell in (*MAXWELL.values(), *SHIFTED.values()):

    @kirchhoff_stress.register(_Maxwell)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        r, a, v, rise = pushed(m, dF, H, p, dt)
        return stress_of_step(m, F, a, v, rise, r, H, p, dt, commit)

    @free_stress.register(_Maxwell)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
        r, a, v, rise = pushed(m, dF, H, p, dt)
        x = search_strain(m, shared_of(m, F, a, v, rise, r), F, dF, H, p, dt, both)
        F1, dF1 = widened(F, dF, F[8] * exponential(x), both)
        a, rise = stretch_tensor(a, x, both), rise + (2.0 * x if both else x)
        return F1, dF1, stress_of_step(m, F1, a, v, rise, r, H, p, dt, True)

    @shared_by_trials.register(_Maxwell)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        r, a, v, rise = pushed(m, dF, H, p, dt)
        return shared_of(m, F, a, v, rise, r)

    @lateral_stress.register(_Maxwell)
    def _(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
        J, b, mean, rate = shared
        return isochoric_lateral_stress(m.form, m.bulk, J, b, (0.0, 0.0, 0.0), mean, rate, x, both)

    @absorb_work.register(_Maxwell)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
        end = TEMPERATURE * terms_of(m)
        H[end, p] += m.heating * work
        H[end + HEAT, p] += work

    @strain_energy.register(_Maxwell)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return stored_by(m, F, excess(m, H, p), volumes(m, H, p))

    @bulk_speed_squared.register(_Maxwell)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        stiffness = volumetric_stiffness(m.form, m.bulk, determinant(F))
        stiffness += total(numbers_of(m, 2) * (1.0 - volumes(m, H, p)))
        return max(0.0, stiffness / m.density)

    @wave_speed_squared.register(_Maxwell)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        J = determinant(F)
        stiffness = volumetric_stiffness(m.form, m.bulk, J) + isochoric_stiffness(m.shear, F, J)
        a = stretched(excess(m, H, p), 1.0)
        # the smallest eigenvalue is at least this (Gershgorin)
        xy, yz, xz = abs(a[3]), abs(a[4]), abs(a[5])
        smallest = positive_part(smaller(smaller(a[0] - xy - xz, a[1] - xy - yz), a[2] - xz - yz))
        stiffness += total(numbers_of(m, 1) * (5.0 / 9.0 * (a[0] + a[1] + a[2]) - smallest / 3.0))
        stiffness += total(numbers_of(m, 2) * (1.0 - volumes(m, H, p)))
        # stretched as b̄ is, terms are at their stiffest
        b, s = left_cauchy_green(F), exponential_1d(-2.0 / 3.0 * logarithm(J))
        grown = growth_of_thin(m.free, (s * b[0], s * b[1], s * b[2], s * b[3]), 1.0, 4.0 - m.free)
        grown *= m.shear + total(numbers_of(m, 1))
        return max(m.rest2, m.lateral * stiffness / m.density, m.rest2 + grown / m.density)
