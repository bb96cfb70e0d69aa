"""The isochoric neo-Hookean shear term, shared by hyperelastic solids and equations of state.

W = ½G(I₁ J^(-2/3) − 3), τ = G J^(-2/3) dev(F Fᵀ): the first term of Eq. 18 of Nairn, Hammerquist & Smith
(2020).
"""

import math
from typing import Any

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential, exponential_1d, logarithm
from mpmcli.core.tensors import left_cauchy_green, smallest_eigenvalue_bound
from mpmcli.materials.volumetric import volumetric_slope, volumetric_stress


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


FREE_WIDTHS = {"plane_stress": 1.0, "uniaxial_stress": 2.0}
"""Number of free widths of an analysis, where there are any."""


@inline
def growth_of_thin(free: float, b: Any, own: float, across: float) -> float:
    """By what ρ₀c² of sheets and bars has grown since rest, over the shear modulus; 0 without ``free`` widths.

    An incompressible W = ½G tr b has ρ₀c² = G(λᵢ² + 3 λ_z²) along axis i of a sheet and G(λ_x² + 2 λ_z²) in a bar:
    ``own`` times the largest component in the plane and ``across`` times that across it.
    """
    if free == 0.0:
        return 0.0
    largest = b[0]
    if free == 1.0:
        largest = 0.5 * (b[0] + b[1]) + math.sqrt(0.25 * (b[0] - b[1]) * (b[0] - b[1]) + b[3] * b[3])
    return own * (largest - 1.0) + across * (b[2] - 1.0)


@inline
def isochoric_lateral_stress(
    form: Any, bulk: float, J: float, b: Any, c: Any, mean: float, rate: float, x: float, both: Any
) -> Any:
    """τ_zz, and its derivative by x, once F_zz (and F_yy, if ``both``) are multiplied by exp x [pressure].

    τ = (J U' + mean + rate·tr ε) I + dev b − dev c, where tr ε is the change of ln J, b is proportional to
    J^(−2/3) F Fᵀ and c to its inverse; of both the diagonals at x = 0 are given.
    """
    t = exponential(x / 3.0)
    s = t * t
    free, up, down = (2.0, s, 1.0 / (s * s)) if both else (1.0, s * s, 1.0 / s)
    J *= s * s * s if both else s * t
    # of the dilating axes, and of the others
    y, d = (2.0, 0.0) if both else (4.0, 1.0)
    b_up, c_up = (2.0 * b[2] - (1.0 - d) * b[1]) / 3.0 * up, (2.0 * c[2] - (1.0 - d) * c[1]) / 3.0 / up
    b_down, c_down = (b[0] + d * b[1]) / 3.0 * down, (c[0] + d * c[1]) / 3.0 / down
    f = volumetric_stress(form, bulk, J) + mean + free * rate * x + b_up - b_down - c_up + c_down
    slope = free * (volumetric_slope(form, bulk, J) + rate)
    return f, slope + (y * (b_up + c_up) + (6.0 - y) * (b_down + c_down)) / 3.0
