"""The isochoric neo-Hookean shear term, shared by hyperelastic solids and equations of state.

W = ½G(I₁ J^(-2/3) − 3), τ = G J^(-2/3) dev(F Fᵀ): the first term of Eq. 18 of Nairn, Hammerquist & Smith
(2020).
"""

from __future__ import annotations

from typing import Any

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential_1d, logarithm
from mpmcli.core.tensors import left_cauchy_green, smallest_eigenvalue_bound


@inline
def isochoric_stress(shear: float, F: Any, J: float) -> Any:
    """Deviatoric Kirchhoff stress, 6-tuple [pressure]."""
    b = left_cauchy_green(F)
    g = shear * exponential_1d(-2.0 / 3.0 * logarithm(J))
    mean = (b[0] + b[1] + b[2]) / 3.0
    return g * (b[0] - mean), g * (b[1] - mean), g * (b[2] - mean), g * b[3], g * b[4], g * b[5]


@inline
def isochoric_energy(shear: float, F: Any, J: float) -> float:
    """Energy per initial volume [pressure]."""
    b = left_cauchy_green(F)
    return 0.5 * shear * ((b[0] + b[1] + b[2]) * exponential_1d(-2.0 / 3.0 * logarithm(J)) - 3.0)


@inline
def isochoric_stiffness(shear: float, F: Any, J: float) -> float:
    """Largest ∂τᵢ/∂(ln λᵢ) − τᵢ of the principal axes i, that of the smallest λ; 4G/3 at rest [pressure]."""
    b = left_cauchy_green(F)
    g = shear * exponential_1d(-2.0 / 3.0 * logarithm(J))
    smallest = max(0.0, smallest_eigenvalue_bound(b))
    return g * (5.0 / 9.0 * (b[0] + b[1] + b[2]) - smallest / 3.0)
