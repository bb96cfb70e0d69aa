"""Volumetric energies U(J) = M u(J) with modulus M, chosen by name: their stress J U', energy and stiffness."""

from __future__ import annotations

from typing import Any, NamedTuple

from mpmcli.core.dispatch import generic
from mpmcli.core.tensors import logarithm


class JMinusInverse(NamedTuple):
    """U = ½M(½(J² − 1) − ln J), with pressure −½M(J − 1/J): Eq. 18 of Nairn, Hammerquist & Smith (2020)."""

    modulus: float


class Logarithmic(NamedTuple):
    """U = ½M ln²J, with Kirchhoff pressure −M ln J."""

    modulus: float


FORMS: dict[str, type[JMinusInverse] | type[Logarithmic]] = {
    "j_minus_inverse": JMinusInverse,
    "log": Logarithmic,
}


@generic
def volumetric_stress(form: Any, J: Any) -> Any:
    """Mean Kirchhoff stress J dU/dJ [pressure]."""


@generic
def volumetric_energy(form: Any, J: Any) -> Any:
    """U per initial volume [pressure]."""


@generic
def volumetric_stiffness(form: Any, J: Any) -> Any:
    """ρ₀ c² of a wave that feels U alone: dτ/d(ln J) − τ, τ = J dU/dJ [pressure]."""


@volumetric_stress.register(JMinusInverse)
def _(form: Any, J: Any) -> Any:
    return 0.5 * form.modulus * (J * J - 1.0)


@volumetric_energy.register(JMinusInverse)
def _(form: Any, J: Any) -> Any:
    return 0.5 * form.modulus * (0.5 * (J * J - 1.0) - logarithm(J))


@volumetric_stiffness.register(JMinusInverse)
def _(form: Any, J: Any) -> Any:
    return 0.5 * form.modulus * (J * J + 1.0)


@volumetric_stress.register(Logarithmic)
def _(form: Any, J: Any) -> Any:
    return form.modulus * logarithm(J)


@volumetric_energy.register(Logarithmic)
def _(form: Any, J: Any) -> Any:
    log = logarithm(J)
    return 0.5 * form.modulus * log * log


@volumetric_stiffness.register(Logarithmic)
def _(form: Any, J: Any) -> Any:
    return form.modulus * (1.0 - logarithm(J))
