"""Volumetric energies U(J) = M u(J) with modulus M: their stress J U', energy and stiffness.

``j_minus_inverse``: U = ½M(½(J² − 1) − ln J), with pressure −½M(J − 1/J): Eq. 18 of Nairn, Hammerquist &
Smith (2020). ``log``: U = ½M ln²J, with Kirchhoff pressure −M ln J.
"""

from typing import Any

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import logarithm

FORMS = {"j_minus_inverse": 0, "log": 1}
"""Number of each form, as the functions take it."""


@inline
def volumetric_stress(form: Any, M: Any, J: Any) -> Any:
    """Mean Kirchhoff stress J dU/dJ [pressure]."""
    if form == 1:
        return M * logarithm(J)
    return 0.5 * M * (J * J - 1.0)


@inline
def volumetric_slope(form: Any, M: Any, J: Any) -> Any:
    """Derivative of ``volumetric_stress`` by ln J [pressure]."""
    if form == 1:
        return M
    return M * J * J


@inline
def volumetric_energy(form: Any, M: Any, J: Any) -> Any:
    """U per initial volume [pressure]."""
    log = logarithm(J)
    if form == 1:
        return 0.5 * M * log * log
    return 0.5 * M * (0.5 * (J * J - 1.0) - log)


@inline
def volumetric_stiffness(form: Any, M: Any, J: Any) -> Any:
    """ρ₀ c² of a wave that feels U alone: dτ/d(ln J) − τ, τ = J dU/dJ [pressure]."""
    if form == 1:
        return M * (1.0 - logarithm(J))
    return 0.5 * M * (J * J + 1.0)
